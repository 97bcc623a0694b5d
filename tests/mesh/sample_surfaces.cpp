#include "tests/mesh/sample_surfaces.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace ringdown::test {
namespace {

struct Builder {
  std::vector<Vec> points;
  std::vector<std::array<std::int32_t, 3>> triangles;

  std::int32_t point(const Vec& at) {
    points.push_back(at);
    return static_cast<std::int32_t>(points.size()) - 1;
  }
  void triangle(std::int32_t a, std::int32_t b, std::int32_t c) {
    if (a != b && b != c && c != a) triangles.push_back({a, b, c});
  }
  [[nodiscard]] mesh::TriangleMesh mesh() const {
    mesh::TriangleMesh made;
    made.nodes.resize(static_cast<Eigen::Index>(points.size()), 3);
    made.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
    for (std::size_t i = 0; i < points.size(); ++i) made.nodes.row(static_cast<Eigen::Index>(i)) = points[i];
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (int i = 0; i < 3; ++i) made.triangles(static_cast<Eigen::Index>(t), i) = triangles[t][i];
    }
    return made;
  }
};

Builder builder_of(const mesh::TriangleMesh& mesh) {
  Builder builder;
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) builder.points.emplace_back(mesh.nodes.row(n));
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    builder.triangles.push_back({mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2)});
  }
  return builder;
}

}  // namespace

mesh::TriangleMesh box(const Vec& low, const Vec& high) {
  Builder made;
  for (int corner = 0; corner < 8; ++corner) {
    made.point({corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1], corner & 4 ? high[2] : low[2]});
  }
  const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& [a, b, c, d] : faces) {
    made.triangle(a, b, c);
    made.triangle(a, c, d);
  }
  return made.mesh();
}

mesh::TriangleMesh lathe(const std::vector<std::array<double, 2>>& profile, int segments) {
  Builder made;
  std::vector<std::vector<std::int32_t>> rings;
  for (const auto& [r, z] : profile) {
    std::vector<std::int32_t> ring;
    for (int s = 0; s < segments; ++s) {
      const double angle = 2 * std::numbers::pi * s / segments;
      ring.push_back(r == 0 && s > 0 ? ring.front() : made.point({r * std::cos(angle), r * std::sin(angle), z}));
    }
    rings.push_back(ring);
  }
  for (std::size_t p = 0; p < rings.size(); ++p) {
    const auto &from = rings[p], &to = rings[(p + 1) % rings.size()];
    for (int s = 0; s < segments; ++s) {
      const int next = (s + 1) % segments;
      made.triangle(from[s], from[next], to[next]);
      made.triangle(from[s], to[next], to[s]);
    }
  }
  return made.mesh();
}

mesh::TriangleMesh cylinder(double radius, double height, int segments) {
  return lathe({{0, 0}, {radius, 0}, {radius, height}, {0, height}}, segments);
}

mesh::TriangleMesh tube(double inner, double outer, double height, int segments) {
  return lathe({{inner, 0}, {outer, 0}, {outer, height}, {inner, height}}, segments);
}

mesh::TriangleMesh cup(double radius, double height, double wall, int segments) {
  return lathe({{0, 0}, {radius, 0}, {radius, height}, {radius - wall, height}, {radius - wall, wall}, {0, wall}},
               segments);
}

mesh::TriangleMesh bowl(double radius, double wall, int segments) {
  std::vector<std::array<double, 2>> profile;
  const int steps = segments / 4;
  for (int i = 0; i <= steps; ++i) {
    const double angle = std::numbers::pi / 2 * i / steps;
    profile.push_back({i == 0 ? 0 : radius * std::sin(angle), -radius * std::cos(angle)});
  }
  for (int i = steps; i >= 0; --i) {
    const double angle = std::numbers::pi / 2 * i / steps;
    profile.push_back({i == 0 ? 0 : (radius - wall) * std::sin(angle), -(radius - wall) * std::cos(angle)});
  }
  return lathe(profile, segments);
}

mesh::TriangleMesh sphere(double radius, int segments) {
  std::vector<std::array<double, 2>> profile;
  const int steps = segments / 2;
  for (int i = 0; i <= steps; ++i) {
    const double angle = std::numbers::pi * i / steps;
    profile.push_back({i == 0 || i == steps ? 0 : radius * std::sin(angle), -radius * std::cos(angle)});
  }
  return lathe(profile, segments);
}

mesh::TriangleMesh torus(double radius, double section, int segments) {
  std::vector<std::array<double, 2>> profile;
  for (int i = 0; i < segments; ++i) {
    const double angle = 2 * std::numbers::pi * i / segments;
    profile.push_back({radius + section * std::cos(angle), section * std::sin(angle)});
  }
  return lathe(profile, 2 * segments);
}

mesh::TriangleMesh l_shape(double length, double width, double height) {
  Builder made;
  const double half = length / 2;
  const std::array<std::array<double, 2>, 6> outline = {
      {{0, 0}, {length, 0}, {length, width}, {half, width}, {half, 2 * width}, {0, 2 * width}}};
  for (const double z : {0.0, height}) {
    for (const auto& [x, y] : outline) made.point({x, y, z});
  }
  const int fans[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  for (const auto& [a, b, c] : fans) {
    made.triangle(a, c, b);
    made.triangle(a + 6, b + 6, c + 6);
  }
  for (int i = 0; i < 6; ++i) {
    const int next = (i + 1) % 6;
    made.triangle(i, next, next + 6);
    made.triangle(i, next + 6, i + 6);
  }
  return made.mesh();
}

mesh::TriangleMesh united(const mesh::TriangleMesh& a, const mesh::TriangleMesh& b) {
  Builder made = builder_of(a);
  const auto first = static_cast<std::int32_t>(made.points.size());
  const Builder other = builder_of(b);
  made.points.insert(made.points.end(), other.points.begin(), other.points.end());
  for (const auto& [x, y, z] : other.triangles) made.triangles.push_back({first + x, first + y, first + z});
  return made.mesh();
}

mesh::TriangleMesh inside_out(mesh::TriangleMesh mesh) { return with_flipped(std::move(mesh), 1); }

mesh::TriangleMesh moved(mesh::TriangleMesh mesh, const Vec& by) {
  mesh.nodes.rowwise() += by;
  return mesh;
}

mesh::TriangleMesh subdivided(const mesh::TriangleMesh& mesh) {
  Builder made = builder_of(mesh);
  const auto old = std::exchange(made.triangles, {});
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const auto middle = [&](std::int32_t a, std::int32_t b) {
    const auto [known, fresh] = middles.try_emplace(std::minmax(a, b), 0);
    if (fresh) known->second = made.point((made.points[a] + made.points[b]) / 2);
    return known->second;
  };
  for (const auto& [a, b, c] : old) {
    const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    made.triangle(a, ab, ca);
    made.triangle(ab, b, bc);
    made.triangle(ca, bc, c);
    made.triangle(ab, bc, ca);
  }
  return made.mesh();
}

mesh::TriangleMesh without(const mesh::TriangleMesh& mesh, const std::vector<int>& triangles) {
  Builder made = builder_of(mesh);
  for (auto t = triangles.rbegin(); t != triangles.rend(); ++t) made.triangles.erase(made.triangles.begin() + *t);
  return made.mesh();
}

mesh::TriangleMesh with_flipped(mesh::TriangleMesh mesh, int every) {
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); t += every) std::swap(mesh.triangles(t, 1), mesh.triangles(t, 2));
  return mesh;
}

mesh::TriangleMesh with_copies(const mesh::TriangleMesh& mesh, int every) {
  Builder made = builder_of(mesh);
  const auto old = made.triangles;
  for (std::size_t t = 0; t < old.size(); t += static_cast<std::size_t>(every)) {
    made.triangles.push_back({old[t][1], old[t][2], old[t][0]});
  }
  return made.mesh();
}

mesh::TriangleMesh with_fin(const mesh::TriangleMesh& mesh, const Vec& tip) {
  Builder made = builder_of(mesh);
  const auto [a, b, c] = made.triangles.front();
  made.triangle(a, b, made.point(tip));
  return made.mesh();
}

mesh::TriangleMesh with_split_side(const mesh::TriangleMesh& mesh, int triangle) {
  Builder made = builder_of(mesh);
  const auto [a, b, c] = made.triangles[static_cast<std::size_t>(triangle)];
  const std::int32_t middle = made.point((made.points[a] + made.points[b]) / 2);
  made.triangles[static_cast<std::size_t>(triangle)] = {a, middle, c};
  made.triangle(middle, b, c);
  made.triangle(a, b, middle);
  return made.mesh();
}

mesh::TriangleMesh exploded(const mesh::TriangleMesh& mesh, double jitter) {
  Builder made;
  std::uint32_t seed = 1;
  const auto noise = [&seed, jitter] {
    seed = seed * 1664525 + 1013904223;
    return jitter * (seed / 4294967296.0 - 0.5);
  };
  const Builder old = builder_of(mesh);
  for (const auto& corners : old.triangles) {
    std::array<std::int32_t, 3> fresh{};
    for (int i = 0; i < 3; ++i) fresh[i] = made.point(old.points[corners[i]] + Vec(noise(), noise(), noise()));
    made.triangles.push_back(fresh);
  }
  return made.mesh();
}

mesh::TriangleMesh with_stray_points(const mesh::TriangleMesh& mesh, int count) {
  Builder made = builder_of(mesh);
  for (int i = 0; i < count; ++i) made.point({1000.0 + i, 0, 0});
  return made.mesh();
}

}  // namespace ringdown::test
