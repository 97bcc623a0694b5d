#include "engine/mesh/fill.h"

#include "engine/mesh/boundary.h"
#include "engine/mesh/gmsh_reader.h"
#include "engine/mesh/surface/remesh.h"
#include "engine/mesh/surface/shells.h"
#include "engine/mesh/surface/surface_check.h"
#include "engine/mesh/surface/surface_distance.h"

#include <Eigen/Geometry>
#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

// Filling, with two ways back
//
// The surface is cut into triangles of the wanted size (sized()); if those would leave the surface, enclose another
// volume or cut each other, smaller triangles are tried. gmsh fills the triangles with straight tetrahedra
// (fill_as_it_is()), whose outer nodes of higher order are then put onto the original surface (curved()). Last, the
// volume is compared with the surface's. If any step fails, all steps are repeated once at a smaller size. If that
// fails, the surface's original triangles are filled, unless they are far more than the size requires, as in a scan.
namespace ringdown::mesh {
namespace {

constexpr double kEdgePerSize = 0.85;      // CGAL's edges scatter about the length asked for
constexpr double kEdgePerWall = 0.7;       // shortest edge at first, so that a wall's rounded rim gets two or three
constexpr double kMaxDeviation = 1 / 7.0;  // share of the local thickness
constexpr double kQuickDeviation = 0.3;    // share for a preview, whose nodes are put back on the surface as well
constexpr double kMaxLeaving = 0.03;       // share of the area where triangles may deviate more
// Numbers of triangles if all had the shortest edges, at the first try and at later ones.
constexpr double kFirstTriangles = 12e3, kFirstQuickTriangles = 4000, kMaxFirstTriangles = 40e3;
constexpr double kLeave = 0.8;  // share of the largest deviation given to remesh(), so that few triangles exceed it
constexpr double kFiner = 0.6, kFewerDegrees = 0.85;
constexpr int kMaxTries = 4;
constexpr double kVolumeSlip = 0.03;
constexpr double kVolumeToCurve = 0.15;  // share of the volume that flat triangles may lose and curved ones regain

double max_deviation(const FillOptions& options) { return options.quick ? kQuickDeviation : kMaxDeviation; }

// Shells as gmsh's surfaces, in units of `unit_m`, and the mesh between them.
class GmshBody {
 public:
  GmshBody(const TriangleMesh& surface, const Shells& shells, double unit_m)
      : surface_(surface), shells_(shells), unit_m_(unit_m) {}

  // Meshes the regions directly inside these shells, which share their nodes. Elements are in the order of the regions;
  // `counts` gets the number of each region's elements.
  Result<TetMesh> mesh(const std::vector<int>& regions, double size_m, std::vector<Eigen::Index>& counts) {
    const GmshSession session;
    try {
      gmsh::model::add("body");
      std::vector<int> loop_of(static_cast<std::size_t>(shells_.count), 0);
      const auto loop = [&](int s) {
        int& tag = loop_of[static_cast<std::size_t>(s)];
        if (tag > 0) return tag;
        add_shell(s);
        return tag = gmsh::model::geo::addSurfaceLoop({s + 1});
      };
      std::vector<int> volumes;
      for (const int region : regions) {
        std::vector<int> loops;
        for (int s = 0; s < shells_.count; ++s) {
          if (s != region && shells_.parent[static_cast<std::size_t>(s)] != region) continue;
          loops.push_back(loop(s));
          if (s == region) std::swap(loops.front(), loops.back());  // the outer one first
        }
        volumes.push_back(gmsh::model::geo::addVolume(loops));
      }
      gmsh::model::geo::synchronize();
      if (size_m > 0) gmsh::option::setNumber("Mesh.MeshSizeMax", size_m / unit_m_);
      gmsh::model::mesh::generate(3);
      if (const auto error = session.first_error()) return fail(ErrorKind::bad_input, *error);
      return take(volumes, counts);
    } catch (...) {
      return fail(ErrorKind::bad_input, session.first_error().value_or("gmsh gave no reason"));
    }
  }

 private:
  void add_shell(int shell) {
    std::unordered_map<std::int32_t, std::size_t> tags;
    std::vector<std::size_t> node_tags, corners;
    std::vector<double> coordinates;
    for (Eigen::Index t = 0; t < surface_.triangles.rows(); ++t) {
      if (shells_.shell[static_cast<std::size_t>(t)] != shell) continue;
      for (int i = 0; i < 3; ++i) {
        const std::int32_t node = surface_.triangles(t, i);
        const auto [known, fresh] = tags.try_emplace(node, static_cast<std::size_t>(node) + 1);
        corners.push_back(known->second);
        if (!fresh) continue;
        node_tags.push_back(known->second);
        for (int axis = 0; axis < 3; ++axis) coordinates.push_back(surface_.nodes(node, axis) / unit_m_);
      }
    }
    constexpr int kTriangle = 2;
    gmsh::model::addDiscreteEntity(2, shell + 1);
    gmsh::model::mesh::addNodes(2, shell + 1, node_tags, coordinates);
    gmsh::model::mesh::addElementsByType(shell + 1, kTriangle, {}, corners);
  }

  [[nodiscard]] Result<TetMesh> take(const std::vector<int>& volumes, std::vector<Eigen::Index>& counts) const {
    constexpr int kTetrahedron = 4;
    std::vector<std::size_t> node_tags, corners;
    std::vector<double> coordinates, parametric;
    gmsh::model::mesh::getNodes(node_tags, coordinates, parametric);
    counts.clear();
    for (const int volume : volumes) {
      std::vector<std::size_t> element_tags, own;
      gmsh::model::mesh::getElementsByType(kTetrahedron, element_tags, own, volume);
      if (element_tags.empty()) return fail(ErrorKind::bad_input, "gmsh made no tetrahedra");
      counts.push_back(static_cast<Eigen::Index>(element_tags.size()));
      corners.insert(corners.end(), own.begin(), own.end());
    }
    TetMesh mesh;
    mesh.nodes = unit_m_ * Eigen::Map<const Points>(coordinates.data(), static_cast<Eigen::Index>(node_tags.size()), 3);
    std::unordered_map<std::size_t, std::int32_t> number;
    for (std::size_t i = 0; i < node_tags.size(); ++i) number.emplace(node_tags[i], static_cast<std::int32_t>(i));
    mesh.elements.resize(static_cast<Eigen::Index>(corners.size() / 4), 4);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      mesh.elements(static_cast<Eigen::Index>(k / 4), static_cast<Eigen::Index>(k % 4)) = number.at(corners[k]);
    }
    return mesh;
  }

  const TriangleMesh& surface_;
  const Shells& shells_;
  double unit_m_;
};

double volume_of(const Shells& shells) {
  return std::accumulate(shells.volume_m3.begin(), shells.volume_m3.end(), 0.0);
}

// The nodes of outer faces, and of those between groups of elements.
std::vector<std::int32_t> nodes_of_skins(const TetMesh& mesh, const MeshGroups& groups) {
  if (groups.volumes.empty()) return boundary_of(mesh).nodes;
  std::vector<std::int32_t> nodes;
  for (std::int32_t group = -1; group < static_cast<std::int32_t>(groups.volumes.size()); ++group) {
    std::vector<Eigen::Index> own;
    for (std::size_t e = 0; e < groups.volume_of.size(); ++e) {
      if (groups.volume_of[e] == group) own.push_back(static_cast<Eigen::Index>(e));
    }
    if (own.empty()) continue;
    const TetMesh part{mesh.nodes, mesh.elements(own, Eigen::all)};
    const std::vector<std::int32_t> skin = boundary_of(part).nodes;
    nodes.insert(nodes.end(), skin.begin(), skin.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

// Raises the order and puts nodes between the corners of outer faces, and of faces between groups, on the surface.
Result<CheckedMesh> curved(const CheckedMesh& straight, const PartedSurface& onto, const FillOptions& options,
                           const std::string& name) {
  TetMesh mesh = to_order(straight.mesh, options.order);
  const SurfaceRays surface(onto.mesh);
  const double farthest =
      std::max(2 * max_deviation(options) * options.wall_m, (options.wall_m > 0 ? 0.1 : 0.25) * options.size_m);
  std::vector<bool> corner(static_cast<std::size_t>(mesh.nodes.rows()), false);
  for (const std::int32_t n : mesh.elements.leftCols(4).reshaped()) corner[static_cast<std::size_t>(n)] = true;
  for (const std::int32_t n : nodes_of_skins(mesh, straight.groups)) {
    if (corner[static_cast<std::size_t>(n)]) continue;
    const Eigen::RowVector3d at = mesh.nodes.row(n), to = surface.nearest(at);
    if ((to - at).norm() <= farthest) mesh.nodes.row(n) = to;
  }
  Result<CheckedMesh> checked = check_mesh(std::move(mesh), name);
  if (checked) checked->groups = straight.groups;
  return checked;
}

double area_of(const TriangleMesh& surface) {
  double area = 0;
  for (const auto& row : surface.triangles.rowwise()) {
    const Eigen::RowVector3d a = surface.nodes.row(row[0]), b = surface.nodes.row(row[1]),
                             c = surface.nodes.row(row[2]);
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

struct Sized {
  TriangleMesh surface;
  double size_m;
};

// Returns the share of the area where triangles leave the old surface by too much: by more than a share of the local
// thickness, or of the thinnest wall if that is more, as beside a sharp rim.
double share_that_leaves(const Remeshed& remeshed, const FillOptions& options) {
  const SurfaceRays rays(remeshed.mesh);
  double area = 0, leaves = 0;
  for (Eigen::Index t = 0; t < remeshed.mesh.triangles.rows(); ++t) {
    const auto row = remeshed.mesh.triangles.row(t);
    const Eigen::RowVector3d a = remeshed.mesh.nodes.row(row[0]), b = remeshed.mesh.nodes.row(row[1]),
                             c = remeshed.mesh.nodes.row(row[2]);
    const double part = (b - a).cross(c - a).norm();
    area += part;
    const double deviation = remeshed.deviations_m[static_cast<std::size_t>(t)];
    if (deviation > max_deviation(options) * std::max(options.wall_m, rays.inward(t))) leaves += part;
  }
  return leaves / area;
}

// Returns the surface in triangles of the wanted size where it is flat, and in smaller triangles where it bends or, at
// the second attempt, where triangles would leave it.
Result<Sized> sized(const PartedSurface& parted, const FillOptions& options) {
  const TriangleMesh& surface = parted.mesh;
  const double area = area_of(surface);
  const auto edge_of = [area](double triangles) { return std::sqrt(area / (std::sqrt(3) / 4 * triangles)); };
  EdgeLengths lengths{.longest_m = kEdgePerSize * options.size_m,
                      .shortest_m = kEdgePerWall * (options.wall_m > 0 ? options.wall_m : options.size_m),
                      .leave_m = kLeave * max_deviation(options) * options.wall_m,
                      .leave_share = kLeave * max_deviation(options)};
  lengths.shortest_m = std::clamp(lengths.shortest_m, lengths.longest_m / 8, lengths.longest_m / 4);
  lengths.shortest_m = std::max(lengths.shortest_m, edge_of(options.quick ? kFirstQuickTriangles : kFirstTriangles));
  const double volume = volume_of(shells_of(surface));
  const double slip = options.order > 1 ? kVolumeToCurve : kVolumeSlip;
  std::string why;
  for (int attempt = 0; attempt < kMaxTries; ++attempt) {
    const Result<Remeshed> remeshed = remesh(surface, lengths);
    if (!remeshed) return fail(remeshed);
    const double now = volume_of(shells_of(remeshed->mesh));
    if (share_that_leaves(*remeshed, options) > kMaxLeaving || std::abs(now - volume) > slip * volume) {
      why = "triangles of the chosen size leave it";
    } else if (!self_intersections(remeshed->mesh, 1).empty()) {
      why = "triangles of the chosen size cut each other";
    } else {
      return Sized{remeshed->mesh, lengths.longest_m / kEdgePerSize};
    }
    lengths.shortest_m = std::max(kFiner * lengths.shortest_m, edge_of(kMaxFirstTriangles));
    lengths.turn_deg *= kFewerDegrees;
    if (attempt > 0) lengths.longest_m *= kFiner;
  }
  return fail(ErrorKind::bad_input, why);
}

// The largest number of the surface's own triangles that may replace triangles of the wanted size.
double max_own_triangles(const PartedSurface& parted, double size_m) {
  constexpr double kTimes = 4, kAlways = 2000;
  return kAlways + kTimes * area_of(parted.mesh) / (std::sqrt(3) / 4 * size_m * size_m);
}

// Return the volumes of the parts, and last the volume outside all parts: of a mesh, and of the regions between shells.
std::vector<double> part_volumes(const CheckedMesh& mesh) {
  std::vector<double> volumes(mesh.groups.volumes.size() + 1, 0);
  for (std::size_t p = 0; p < volumes.size(); ++p) {
    const std::int32_t group = p + 1 < volumes.size() ? static_cast<std::int32_t>(p) : -1;
    std::vector<Eigen::Index> own;
    for (std::size_t e = 0; e < mesh.groups.volume_of.size(); ++e) {
      if (mesh.groups.volume_of[e] == group) own.push_back(static_cast<Eigen::Index>(e));
    }
    volumes[p] = volume_of(TetMesh{mesh.mesh.nodes, mesh.mesh.elements(own, Eigen::all)});
  }
  return volumes;
}

std::vector<double> part_volumes(const std::vector<Region>& regions, std::size_t parts) {
  std::vector<double> volumes(parts + 1, 0);
  for (const Region& region : regions) {
    if (region.filled) volumes[region.part < 0 ? parts : static_cast<std::size_t>(region.part)] += region.volume_m3;
  }
  return volumes;
}

Result<void> check_parts(const CheckedMesh& mesh, const std::vector<double>& wanted, double slip) {
  const std::vector<double> found = part_volumes(mesh);
  for (std::size_t p = 0; p < wanted.size(); ++p) {
    if (std::abs(found[p] - wanted[p]) <= slip * wanted[p]) continue;
    if (wanted.size() == 1) return fail(ErrorKind::bad_input, "the mesh has the wrong volume");
    const std::string what = p < mesh.groups.volumes.size() ? mesh.groups.volumes[p] : "the body around its parts";
    return fail(ErrorKind::bad_input, "in the mesh, the volume of " + what + " is wrong");
  }
  return {};
}

// `surface` is the surface of `parted` in other triangles.
Result<CheckedMesh> fill_as_it_is(const TriangleMesh& surface, const PartedSurface& parted, double size_m,
                                  const std::string& name) {
  const Shells shells = shells_of(surface);
  const std::vector<Region> regions = regions_of(shells, sources_of(shells, surface, parted));
  std::vector<int> filled;
  for (int s = 0; s < shells.count; ++s) {
    if (regions[static_cast<std::size_t>(s)].filled) filled.push_back(s);
  }
  std::vector<Eigen::Index> counts;
  Result<TetMesh> mesh = GmshBody(surface, shells, diagonal_of(surface)).mesh(filled, size_m, counts);
  if (!mesh) return fail(mesh);
  MeshGroups groups{.volumes = parted.names, .volume_of = {}, .surfaces = {}};
  for (std::size_t r = 0; r < filled.size(); ++r)
    groups.volume_of.insert(groups.volume_of.end(), static_cast<std::size_t>(counts[r]),
                            regions[static_cast<std::size_t>(filled[r])].part);
  Result<CheckedMesh> checked = check_mesh(std::move(*mesh), name);
  if (!checked) return checked;
  if (checked->duplicates > 0) return fail(ErrorKind::bad_input, "gmsh made duplicate elements");
  checked->groups = std::move(groups);
  if (auto good = check_parts(*checked, part_volumes(regions, parted.names.size()), 1e-3); !good) return fail(good);
  return checked;
}

Result<CheckedMesh> fill_sized(const PartedSurface& parted, const FillOptions& options, const std::string& name) {
  const Result<Sized> triangles = sized(parted, options);
  if (!triangles) return fail(triangles);
  Result<CheckedMesh> mesh = fill_as_it_is(triangles->surface, parted, triangles->size_m, name);
  if (!mesh) return mesh;
  if (options.order > 1) mesh = curved(*mesh, parted, options, name);
  if (!mesh) return mesh;
  const Shells shells = shells_of(parted.mesh);
  const std::vector<Region> regions = regions_of(shells, sources_of(shells, parted.mesh, parted));
  if (auto good = check_parts(*mesh, part_volumes(regions, parted.names.size()), kVolumeSlip); !good) return fail(good);
  return mesh;
}

}  // namespace

Result<Filled> fill_parts(const PartedSurface& parted, const FillOptions& options, const std::string& name) {
  std::string why;
  FillOptions finer = options;
  for (int attempt = 0; options.size_m > 0 && attempt < 2; ++attempt, finer.size_m *= kFiner) {
    Result<CheckedMesh> mesh = fill_sized(parted, finer, name);
    if (mesh) return Filled{std::move(*mesh), ""};
    why = mesh.error().message;
  }
  if (options.size_m > 0 &&
      static_cast<double>(parted.mesh.triangles.rows()) > max_own_triangles(parted, options.size_m))
    return fail(ErrorKind::bad_input, why + ", and the surface has far more triangles than this mesh size needs");
  Result<CheckedMesh> mesh = fill_as_it_is(parted.mesh, parted, options.size_m, name);
  if (!mesh) return fail(mesh);
  return Filled{std::move(*mesh), why.empty() ? "" : "filled with its own triangles, because " + why};
}

Result<Filled> fill(const TriangleMesh& surface, const FillOptions& options, const std::string& name) {
  const std::vector<std::int32_t> own(static_cast<std::size_t>(surface.triangles.rows()), -1);
  Result<Filled> filled = fill_parts({surface, own, {}}, options, name);
  if (filled) filled->mesh.groups = {};
  return filled;
}

}  // namespace ringdown::mesh
