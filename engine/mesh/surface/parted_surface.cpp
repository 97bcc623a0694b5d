#include "engine/mesh/surface/parted_surface.h"

#include "engine/mesh/surface/surface_check.h"
#include "engine/mesh/surface/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace ringdown::mesh {
namespace {

std::string surface_name(std::int32_t source, const PartedSurface& parted, const std::string& body) {
  return source < 0 ? body : parted.names[static_cast<std::size_t>(source)];
}

void append(PartedSurface& parted, const TriangleMesh& mesh, std::int32_t source) {
  const Eigen::Index nodes = parted.mesh.nodes.rows(), triangles = parted.mesh.triangles.rows();
  parted.mesh.nodes.conservativeResize(nodes + mesh.nodes.rows(), 3);
  parted.mesh.nodes.bottomRows(mesh.nodes.rows()) = mesh.nodes;
  parted.mesh.triangles.conservativeResize(triangles + mesh.triangles.rows(), 3);
  parted.mesh.triangles.bottomRows(mesh.triangles.rows()) = mesh.triangles.array() + static_cast<std::int32_t>(nodes);
  parted.source.insert(parted.source.end(), static_cast<std::size_t>(mesh.triangles.rows()), source);
}

Result<void> check_apart(const PartedSurface& parted, const std::string& body) {
  const auto cuts = self_intersections(parted.mesh, 1);
  if (cuts.empty()) return {};
  const auto [a, b] = cuts.front();
  const Eigen::RowVector3d at = parted.mesh.nodes.row(parted.mesh.triangles(a, 0));
  const std::string where = formatted(" near ({:.4g}, {:.4g}, {:.4g}) m", at[0], at[1], at[2]);
  return fail(ErrorKind::bad_input,
              "the surfaces {} and {} cross or touch{}; a part's surface must lie completely inside the body. Parts "
              "that reach its skin are groups of a geometry or a mesh",
              surface_name(parted.source[static_cast<std::size_t>(a)], parted, body),
              surface_name(parted.source[static_cast<std::size_t>(b)], parted, body), where);
}

}  // namespace

std::vector<Region> regions_of(const Shells& shells, const std::vector<std::int32_t>& source) {
  std::vector<Region> regions(static_cast<std::size_t>(shells.count));
  for (std::size_t s = 0; s < regions.size(); ++s) regions[s].volume_m3 += std::abs(shells.volume_m3[s]);
  for (std::size_t s = 0; s < regions.size(); ++s) {
    if (shells.parent[s] >= 0)
      regions[static_cast<std::size_t>(shells.parent[s])].volume_m3 -= std::abs(shells.volume_m3[s]);
    // Goes from the shell outward: a region is inside a surface if an odd number of that surface's shells is around it.
    std::vector<std::int32_t> inward;
    std::map<std::int32_t, int> around;
    for (int at = static_cast<int>(s); at >= 0; at = shells.parent[static_cast<std::size_t>(at)]) {
      inward.push_back(source[static_cast<std::size_t>(at)]);
      ++around[inward.back()];
    }
    regions[s].filled = around[-1] % 2 == 1;
    const auto innermost = std::ranges::find_if(inward, [&](std::int32_t k) { return k >= 0 && around[k] % 2 == 1; });
    if (innermost != inward.end()) regions[s].part = *innermost;
  }
  return regions;
}

std::vector<std::int32_t> sources_of(const Shells& shells, const TriangleMesh& mesh, const PartedSurface& parted) {
  constexpr int kAsked = 20;  // number of triangles tested for each shell
  const SurfaceRays old(parted.mesh);
  std::vector<std::map<std::int32_t, int>> votes(static_cast<std::size_t>(shells.count));
  std::vector<int> asked(votes.size(), 0);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const std::int32_t s = shells.shell[static_cast<std::size_t>(t)];
    if (s < 0 || asked[static_cast<std::size_t>(s)]++ >= kAsked) continue;
    const Eigen::RowVector3d corner = mesh.nodes.row(mesh.triangles(t, 0));  // corners lie on the old surface
    ++votes[static_cast<std::size_t>(s)][parted.source[static_cast<std::size_t>(old.nearest_triangle(corner))]];
  }
  std::vector<std::int32_t> sources;
  for (const auto& of_shell : votes) {
    const auto max = std::ranges::max_element(of_shell, {}, [](const auto& vote) { return vote.second; });
    sources.push_back(max == of_shell.end() ? -1 : max->first);
  }
  return sources;
}

Result<PartedSurface> part(const TriangleMesh& body, const std::vector<NamedSurface>& inner, const std::string& name) {
  PartedSurface parted;
  append(parted, body, -1);
  for (const NamedSurface& surface : inner) {
    if (std::ranges::find(parted.names, surface.name) != parted.names.end())
      return fail(ErrorKind::bad_input, "two parts have the surface " + surface.name + "; give each its own");
    append(parted, surface.mesh, static_cast<std::int32_t>(parted.names.size()));
    parted.names.push_back(surface.name);
  }
  if (auto apart = check_apart(parted, name); !apart) return fail(apart);
  const Shells shells = shells_of(parted.mesh);
  std::vector<std::int32_t> source(static_cast<std::size_t>(shells.count), -1);
  for (std::size_t t = 0; t < parted.source.size(); ++t) {
    if (shells.shell[t] >= 0) source[static_cast<std::size_t>(shells.shell[t])] = parted.source[t];
  }
  const std::vector<Region> regions = regions_of(shells, source);
  for (std::size_t s = 0; s < regions.size(); ++s) {
    const bool inside = shells.parent[s] >= 0 && regions[static_cast<std::size_t>(shells.parent[s])].filled;
    if (source[s] < 0 || inside) continue;
    return fail(ErrorKind::bad_input,
                "the surface of a part, {}, lies outside of {} or in one of its cavities; move it inside",
                surface_name(source[s], parted, name), name);
  }
  for (Eigen::Index t = 0; t < parted.mesh.triangles.rows(); ++t) {
    const std::int32_t s = shells.shell[static_cast<std::size_t>(t)];
    if (s < 0) continue;
    const bool outward = shells.depth[static_cast<std::size_t>(s)] % 2 == 0;
    if ((shells.volume_m3[static_cast<std::size_t>(s)] > 0) != outward)
      std::swap(parted.mesh.triangles(t, 1), parted.mesh.triangles(t, 2));
  }
  return parted;
}

}  // namespace ringdown::mesh
