#include "tests/radiate/shapes.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace ringdown {
namespace {

using Vector = Eigen::Vector3d;

// Collects triangles by the coordinates of their corners, so that what touches shares nodes.
class Collector {
 public:
  void add(const Vector& a, const Vector& b, const Vector& c) { triangles_.push_back({node(a), node(b), node(c)}); }
  [[nodiscard]] mesh::TriangleMesh mesh() const {
    mesh::TriangleMesh mesh;
    mesh.nodes.resize(static_cast<Eigen::Index>(nodes_.size()), 3);
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      mesh.nodes.row(static_cast<Eigen::Index>(n)) = nodes_[n].transpose();
    mesh.triangles.resize(static_cast<Eigen::Index>(triangles_.size()), 3);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      mesh.triangles.row(static_cast<Eigen::Index>(t)) << triangles_[t][0], triangles_[t][1], triangles_[t][2];
    }
    return mesh;
  }

 private:
  int node(const Vector& at) {
    const std::array<long, 3> key = {std::lround(at[0] * 1e8), std::lround(at[1] * 1e8), std::lround(at[2] * 1e8)};
    const auto [found, fresh] = numbers_.emplace(key, static_cast<int>(nodes_.size()));
    if (fresh) nodes_.push_back(at);
    return found->second;
  }
  std::map<std::array<long, 3>, int> numbers_;
  std::vector<Vector> nodes_;
  std::vector<std::array<int, 3>> triangles_;
};

using LongComplex = std::complex<long double>;

// h_n of the first kind and its derivative.
std::pair<LongComplex, LongComplex> hankel(int n, long double x) {
  const LongComplex i(0, 1), wave = std::exp(i * x);
  LongComplex before = wave / (i * x), now = -wave / x * (LongComplex(1) + i / x);
  if (n == 0) return {before, -now};
  for (int l = 1; l < n; ++l) {
    const LongComplex next = static_cast<long double>(2 * l + 1) / x * now - before;
    before = now;
    now = next;
  }
  return {now, before - static_cast<long double>(n + 1) / x * now};
}

}  // namespace

mesh::TriangleMesh sphere(double radius_m, int parts) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  const Vector v[12] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                        {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  const int faces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                            {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                            {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  Collector collector;
  for (const auto& face : faces) {
    const auto at = [&](int i, int j) -> Vector {
      const Vector flat = v[face[0]] + (v[face[1]] - v[face[0]]) * i / parts + (v[face[2]] - v[face[0]]) * j / parts;
      return radius_m * flat.normalized();
    };
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        collector.add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < parts) collector.add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  }
  return collector.mesh();
}

mesh::TriangleMesh disc(int rings, double thickness) {
  Collector collector;
  const auto at = [&](int ring, int step, double z) -> Vector {
    const double angle = ring == 0 ? 0 : std::numbers::pi / 3 * step / ring, r = static_cast<double>(ring) / rings;
    return {r * std::cos(angle), r * std::sin(angle), z};
  };
  const double z = thickness / 2;
  for (int ring = 0; ring < rings; ++ring) {
    for (int sector = 0; sector < 6; ++sector) {
      for (int s = 0; s <= ring; ++s) {
        const int inner = sector * ring + s, outer = sector * (ring + 1) + s;
        for (const double side : {z, -z}) {
          const Vector a = at(ring, inner, side), b = at(ring + 1, outer, side), c = at(ring + 1, outer + 1, side);
          side > 0 ? collector.add(a, b, c) : collector.add(a, c, b);
          if (s == ring) continue;
          const Vector d = at(ring, inner + 1, side);
          side > 0 ? collector.add(a, c, d) : collector.add(a, d, c);
        }
      }
    }
  }
  for (int step = 0; step < 6 * rings; ++step) {
    const Vector a = at(rings, step, -z), b = at(rings, step + 1, -z), c = at(rings, step, z),
                 d = at(rings, step + 1, z);
    collector.add(a, b, d);
    collector.add(a, d, c);
  }
  return collector.mesh();
}

mesh::TriangleMesh box(const Eigen::Vector3d& size_m, double side_m) {
  Collector collector;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const int nu = std::max(1, static_cast<int>(std::ceil(size_m[u] / side_m))),
              nv = std::max(1, static_cast<int>(std::ceil(size_m[v] / side_m)));
    for (const double sign : {-1.0, 1.0}) {
      const auto at = [&](int i, int j) {
        Vector p;
        p[axis] = sign * size_m[axis] / 2;
        p[u] = size_m[u] * (static_cast<double>(i) / nu - 0.5);
        p[v] = size_m[v] * (static_cast<double>(j) / nv - 0.5);
        return p;
      };
      for (int i = 0; i < nu; ++i) {
        for (int j = 0; j < nv; ++j) {
          const Vector a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          if (sign > 0) {
            collector.add(a, b, c);
            collector.add(a, c, d);
          } else {
            collector.add(a, c, b);
            collector.add(a, d, c);
          }
        }
      }
    }
  }
  return collector.mesh();
}

radiate::FlowSamples sample(const mesh::TriangleMesh& surface, int modes,
                            const std::function<double(int, const Eigen::Vector3d&, const Eigen::Vector3d&)>& flow,
                            double side_m, const Eigen::Vector3d& center, double graded) {
  struct Point {
    Vector at, normal;
    double area;
  };
  std::vector<Point> points;
  const std::function<void(const Vector&, const Vector&, const Vector&)> divide = [&](const Vector& a, const Vector& b,
                                                                                      const Vector& c) {
    const double longest = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
    const Vector middle = (a + b + c) / 3;
    if (longest > std::min(side_m, graded * (middle - center).norm())) {
      const Vector ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
      divide(a, ab, ca);
      divide(ab, b, bc);
      divide(ca, bc, c);
      divide(ab, bc, ca);
      return;
    }
    const Vector twice = (b - a).cross(c - a);
    for (const Vector& at : {Vector((a + b) / 2), Vector((b + c) / 2), Vector((c + a) / 2)}) {
      points.push_back({at, twice.normalized(), twice.norm() / 6});
    }
  };
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    divide(surface.nodes.row(surface.triangles(t, 0)).transpose(),
           surface.nodes.row(surface.triangles(t, 1)).transpose(),
           surface.nodes.row(surface.triangles(t, 2)).transpose());
  }
  radiate::FlowSamples samples;
  const auto count = static_cast<Eigen::Index>(points.size());
  samples.positions.resize(count, 3);
  samples.normals.resize(count, 3);
  samples.areas.resize(count);
  samples.flow.resize(count, modes);
  for (Eigen::Index p = 0; p < count; ++p) {
    samples.positions.row(p) = points[p].at.transpose();
    samples.normals.row(p) = points[p].normal.transpose();
    samples.areas[p] = points[p].area;
    for (int m = 0; m < modes; ++m) {
      samples.flow(p, m) = static_cast<float>(flow(m, points[p].at, points[p].normal) * points[p].area);
    }
  }
  return samples;
}

// Outside p = h_n(kr) / (k h_n'(ka)) Y, and far away h_n(kr) is (-i)^(n+1) exp(ikr) / (kr).
std::complex<double> sphere_factor(int n, double k, double a) {
  const LongComplex slope = hankel(n, static_cast<long double>(k) * a).second;
  const LongComplex powers[4] = {{0, -1}, {-1, 0}, {0, 1}, {1, 0}};  // (-i)^(n+1)
  return std::complex<double>(powers[n % 4] / (static_cast<long double>(k) * k * slope));
}

double below_pulsation_db(int n, double ka) {
  return 20 * std::log10(std::abs(sphere_factor(0, ka, 1)) / std::abs(sphere_factor(n, ka, 1)));
}

}  // namespace ringdown
