#include "engine/radiate/skin.h"

#include "engine/radiate/mirror_part.h"
#include "engine/radiate/retile.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

namespace ringdown::radiate {
namespace {

constexpr int kMaxWallTriangles = 3000;

// The side of equilateral triangles of which `count` make up the area.
double side_for(double area, double count) { return std::sqrt(area / count * 4 / std::sqrt(3.0)); }

// Decides by the solid angle that the surface fills around the point: van Oosterom & Strackee, IEEE Trans. Biomed. Eng.
// 30, 1983.
bool is_inside(const Panels& panels, const Eigen::Vector3d& point) {
  double halves = 0;
  for (int t = 0; t < panels.triangle_count(); ++t) {
    const Eigen::Vector3d a = panels.corner(t, 0) - point, b = panels.corner(t, 1) - point,
                          c = panels.corner(t, 2) - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    halves += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return halves > std::numbers::pi;
}

Eigen::Vector3d middle_of_wall(const Original& original, int triangle) {
  const Panels& walls = *original.walls;
  return walls.centers[triangle] - original.thickness_m[triangle] / 2 * walls.normals[triangle];
}

// Where a thin wall bends more sharply than the triangles can follow, its faces pass through each other, and rays leave
// the body without meeting the other face. Such thicknesses are replaced by the median.
void mend_thickness(Original& original) {
  constexpr double kSuspect = 1.5;  // of the median
  std::vector<double> sorted = original.thickness_m;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double median = sorted[sorted.size() / 2];
  for (int t = 0; t < original.walls->triangle_count(); ++t) {
    double& thickness = original.thickness_m[t];
    if (thickness > kSuspect * median && !is_inside(*original.panels, middle_of_wall(original, t))) thickness = median;
  }
}

// The nodes all of whose triangles lie within 40 degrees of their mean normal.
std::vector<bool> smooth_nodes(const Panels& panels, const std::vector<Eigen::Vector3d>& normals) {
  std::vector<bool> smooth(panels.node_count(), true);
  for (int t = 0; t < panels.triangle_count(); ++t) {
    for (const int n : panels.corners[t]) smooth[n] = smooth[n] && normals[n].dot(panels.normals[t]) > 0.766;
  }
  return smooth;
}

void keep_volume(const Original& original, const Panels& panels, mesh::TriangleMesh& mesh) {
  const std::vector<Eigen::Vector3d> normals = node_normals(panels);
  const std::vector<bool> smooth = smooth_nodes(panels, normals);
  std::vector<double> gap(panels.node_count(), 0), weight(panels.node_count(), 0);
  for (const Side& side : panels.sides) {
    const Eigen::Vector3d& left = panels.normals[side.triangles[0]];
    Eigen::Vector3d right = left;
    double area = panels.areas[side.triangles[0]];
    if (side.triangles[1] >= 0) {
      right = panels.normals[side.triangles[1]];
      area += panels.areas[side.triangles[1]];
    } else {
      const int planes = panels.planes_at(side.nodes[0]) & panels.planes_at(side.nodes[1]);
      right = image_of(left, planes & -planes);
    }
    const Eigen::Vector3d normal = (left + right).normalized();
    const NearestPoint place = original.search->nearest(side.middle, normal);
    const double max = 0.3 * (panels.nodes.row(side.nodes[0]) - panels.nodes.row(side.nodes[1])).norm();
    double here = (place.at - side.middle).dot(normal);
    if (left.dot(right) < 0.766 || std::abs(here) > max) here = 0;
    for (int i = 0; i < 2; ++i) {
      gap[side.nodes[i]] += area * here;
      weight[side.nodes[i]] += area;
    }
  }
  for (int n = 0; n < panels.node_count(); ++n) {
    if (smooth[n] && weight[n] > 0) mesh.nodes.row(n) += gap[n] / weight[n] * normals[n].transpose();
  }
}

// A class's share of data given on each image (V rows): the mean over the images, with the signs of the class.
template <class Columns>
Columns class_share(const Skin& skin, int image_class, const std::vector<Columns>& by_image) {
  const int images = skin.panels.image_count();
  Columns share = by_image[0];
  for (int image = 1; image < images; ++image) {
    share += static_cast<typename Columns::RealScalar>(sign_of(image_class, image)) * by_image[image];
  }
  share /= static_cast<typename Columns::RealScalar>(images);
  for (const int n : skin.zero_nodes[image_class]) share.row(n).setZero();
  return share;
}

// Sums the flow through each image, then computes the classes' flow from these sums.
void share_flow(const FlowSamples& samples, Skin& skin) {
  const SurfaceSearch search(skin.panels);
  const Eigen::Index modes = samples.flow.cols();
  const int images = skin.panels.image_count();
  std::vector<Eigen::MatrixXf> by_mode(  // the modes of a sample are adjacent in memory
      images, Eigen::MatrixXf::Zero(modes, skin.panels.node_count()));
  const Eigen::MatrixXf flow = samples.flow.transpose();
  for (Eigen::Index s = 0; s < samples.positions.rows(); ++s) {
    const Eigen::Vector3d at = samples.positions.row(s).transpose();
    int image = 0;
    for (int axis = 0; axis < skin.panels.mirrors; ++axis) image |= at[axis] < 0 ? 1 << axis : 0;
    const NearestPoint place =
        search.nearest(image_of(at, image), image_of(Eigen::Vector3d(samples.normals.row(s).transpose()), image));
    for (int i = 0; i < 3; ++i) {
      by_mode[image].col(skin.panels.corners[place.triangle][i]) += static_cast<float>(place.weights[i]) * flow.col(s);
    }
  }
  std::vector<Eigen::MatrixXf> by_image;
  for (Eigen::MatrixXf& own : by_mode) by_image.emplace_back(own.transpose());
  for (int c = 0; c < images; ++c) skin.flow.push_back(class_share(skin, c, by_image));
}

void add_source(const Eigen::Vector3d& inside, double k, const Eigen::Vector3d& normal, double area,
                const std::array<Eigen::Vector3d, 3>& corners, const std::array<std::array<double, 3>, 3>& hats,
                int depth, std::array<std::complex<double>, 3>& sums) {
  const Eigen::Vector3d center = (corners[0] + corners[1] + corners[2]) / 3;
  double longest = 0;
  for (int i = 0; i < 3; ++i) longest = std::max(longest, (corners[i] - corners[(i + 1) % 3]).norm());
  const bool divide = depth < 10 && longest > 0.4 * (center - inside).norm();
  std::array<Eigen::Vector3d, 3> middles;
  std::array<std::array<double, 3>, 3> at_middles{};
  for (int e = 0; e < 3; ++e) {  // side opposite corner e
    middles[e] = (corners[(e + 1) % 3] + corners[(e + 2) % 3]) / 2;
    for (int i = 0; i < 3; ++i) at_middles[e][i] = (hats[(e + 1) % 3][i] + hats[(e + 2) % 3][i]) / 2;
  }
  if (divide) {
    for (int c = 0; c < 3; ++c) {
      const int n = (c + 1) % 3, p = (c + 2) % 3;
      add_source(inside, k, normal, area / 4, {corners[c], middles[p], middles[n]},
                 {hats[c], at_middles[p], at_middles[n]}, depth + 1, sums);
    }
    add_source(inside, k, normal, area / 4, middles, at_middles, depth + 1, sums);
    return;
  }
  for (int e = 0; e < 3; ++e) {
    const Eigen::Vector3d away = middles[e] - inside;
    const double r = away.norm();
    const std::complex<double> wave = std::polar(1 / (4 * std::numbers::pi * r), k * r);
    const std::complex<double> flow = wave * std::complex<double>(-1 / r, k) * away.dot(normal) / r;
    for (int i = 0; i < 3; ++i) sums[i] += area / 3 * at_middles[e][i] * flow;
  }
}

}  // namespace

std::vector<Eigen::Vector3d> node_normals(const Panels& panels) {
  std::vector<Eigen::Vector3d> normals(panels.node_count(), Eigen::Vector3d::Zero());
  for (int t = 0; t < panels.triangle_count(); ++t) {
    for (const int n : panels.corners[t]) normals[n] += panels.areas[t] * panels.normals[t];
  }
  for (int n = 0; n < panels.node_count(); ++n) {
    for (int axis = 0; axis < panels.mirrors; ++axis) {
      if ((panels.planes_at(n) >> axis & 1) != 0) normals[n][axis] = 0;
    }
    normals[n].normalize();
  }
  return normals;
}

Result<Original> Original::of(const Body& body, int mirrors) {
  auto panels = panels_of(body.surface);
  if (!panels) return fail(panels);
  if (panels->volume() <= 0) return fail(ErrorKind::bad_input, "the surface is turned inside out");
  Original original;
  original.body = &body;
  original.panels = std::make_shared<const Panels>(std::move(*panels));
  original.search = std::make_shared<const SurfaceSearch>(*original.panels);
  original.mirrors = mirrors;
  original.part = mirror_part_of(mesh_of(*original.panels), mirrors);
  original.walls = original.panels;
  if (original.panels->triangle_count() > kMaxWallTriangles) {
    auto coarse =
        panels_of(retile(mesh_of(*original.panels), side_for(original.panels->area(), kMaxWallTriangles / 2.0)));
    if (!coarse) return fail(coarse);
    original.walls = std::make_shared<const Panels>(std::move(*coarse));
  }
  original.wall_search = std::make_shared<const SurfaceSearch>(*original.walls);
  const Panels& walls = *original.walls;
  for (int t = 0; t < walls.triangle_count(); ++t) {
    const double inward = nearest_hit(walls, walls.centers[t], -walls.normals[t], Face::back).distance_m;
    original.thickness_m.push_back(std::isfinite(inward) ? inward : std::cbrt(std::abs(walls.volume())));
  }
  mend_thickness(original);
  return original;
}

Result<Skin> skin_of(const Original& original, double side_m) {
  return skin_of(original, retile(original.part, side_m, original.mirrors));
}

Result<Skin> skin_of(const Original& original, mesh::TriangleMesh mesh) {
  auto flat = panels_of(mesh, original.mirrors);
  if (!flat) return fail(flat);
  mesh = mesh_of(*flat);
  keep_volume(original, *flat, mesh);
  auto panels = panels_of(mesh, original.mirrors);
  if (!panels) return fail(panels);
  Skin skin;
  skin.panels = std::move(*panels);
  for (int image = 0; image < skin.panels.image_count(); ++image) {
    skin.near.push_back(near_integrals(skin.panels, image));
    std::vector<int>& zero = skin.zero_nodes.emplace_back();  // nodes on which the class of this number is 0
    for (int n = 0; n < skin.panels.node_count(); ++n) {
      if ((skin.panels.planes_at(n) & image) != 0) zero.push_back(n);
    }
  }
  const std::vector<Eigen::Vector3d> normals = node_normals(skin.panels);
  for (int n = 0; n < skin.panels.node_count(); ++n) {
    const NearestPoint place = original.wall_search->nearest(skin.panels.nodes.row(n).transpose(), normals[n]);
    skin.thickness_m.push_back(original.thickness_m[place.triangle]);
  }
  share_flow(original.body->flow, skin);
  return skin;
}

Eigen::VectorXf node_areas(const Panels& panels) {
  Eigen::VectorXf areas = Eigen::VectorXf::Zero(panels.node_count());
  for (int t = 0; t < panels.triangle_count(); ++t) {
    for (const int n : panels.corners[t]) areas[n] += static_cast<float>(panels.areas[t] / 3);
  }
  return areas;
}

std::vector<double> coupling_of(const Skin& skin, double wavenumber_rad_m) {
  std::vector<double> coupling;
  for (const double thickness : skin.thickness_m) {
    coupling.push_back(wavenumber_rad_m * std::min(1.0, wavenumber_rad_m * thickness));
  }
  return coupling;
}

std::vector<double> shape_wavenumbers(const Skin& skin) {
  const Panels& panels = skin.panels;
  const Eigen::Index modes = skin.flow[0].cols();
  const std::vector<bool> smooth = smooth_nodes(panels, node_normals(panels));
  Eigen::VectorXd slopes = Eigen::VectorXd::Zero(modes), squares = slopes;
  for (const Eigen::MatrixXf& flow : skin.flow) {
    const Eigen::MatrixXf motion = node_areas(panels).cwiseInverse().asDiagonal() * flow;  // V x M
    for (int t = 0; t < panels.triangle_count(); ++t) {
      const auto& corners = panels.corners[t];
      if (!smooth[corners[0]] || !smooth[corners[1]] || !smooth[corners[2]]) continue;
      for (Eigen::Index m = 0; m < modes; ++m) {
        Eigen::Vector3d slope = Eigen::Vector3d::Zero();
        double square = 0;
        for (int i = 0; i < 3; ++i) {
          slope += static_cast<double>(motion(corners[i], m)) * panels.curls[t][i];
          square += static_cast<double>(motion(corners[i], m)) * motion(corners[i], m) / 3;
        }
        slopes[m] += panels.areas[t] * slope.squaredNorm();
        squares[m] += panels.areas[t] * square;
      }
    }
  }
  std::vector<double> wavenumbers;
  for (Eigen::Index m = 0; m < modes; ++m) {
    wavenumbers.push_back(squares[m] > 0 ? std::sqrt(slopes[m] / squares[m]) : 0);
  }
  return wavenumbers;
}

// The source's flow through an image equals the flow of the source's image through the part.
Eigen::MatrixXcf source_flow(const Skin& skin, const Eigen::Vector3d& inside, double wavenumber_rad_m) {
  const Panels& panels = skin.panels;
  const int images = panels.image_count();
  std::vector<Eigen::VectorXcd> by_image(images, Eigen::VectorXcd::Zero(panels.node_count()));
  for (int image = 0; image < images; ++image) {
    const Eigen::Vector3d source = image_of(inside, image);
    for (int t = 0; t < panels.triangle_count(); ++t) {
      std::array<std::complex<double>, 3> sums{};
      add_source(source, wavenumber_rad_m, panels.normals[t], panels.areas[t],
                 {panels.corner(t, 0), panels.corner(t, 1), panels.corner(t, 2)}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                 0, sums);
      for (int i = 0; i < 3; ++i) by_image[image][panels.corners[t][i]] += sums[i];
    }
  }
  Eigen::MatrixXcf classes(panels.node_count(), images);
  for (int c = 0; c < images; ++c) classes.col(c) = class_share(skin, c, by_image).cast<std::complex<float>>();
  return classes;
}

std::vector<Eigen::Vector3d> inner_places(const Original& original) {
  std::vector<int> order(original.walls->triangle_count());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return original.thickness_m[a] > original.thickness_m[b]; });
  std::vector<Eigen::Vector3d> places;
  for (const std::size_t from : {std::size_t{0}, order.size() / 2}) {
    const auto found = std::find_if(order.begin() + static_cast<std::ptrdiff_t>(from), order.end(),
                                    [&](int t) { return is_inside(*original.panels, middle_of_wall(original, t)); });
    if (found != order.end()) places.push_back(middle_of_wall(original, *found));
  }
  return places;
}

}  // namespace ringdown::radiate
