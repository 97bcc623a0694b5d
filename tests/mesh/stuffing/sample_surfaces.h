// Surfaces for tests, sound ones and what becomes of them in the world.
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace ringdown::test {

using Soup = mesh::TriangleMesh;
using Vector3 = Eigen::Vector3d;

inline Soup soup_of(const std::vector<Vector3>& nodes, const std::vector<Eigen::Vector3i>& triangles) {
  Soup soup;
  soup.nodes.resize(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t n = 0; n < nodes.size(); ++n) soup.nodes.row(n) = nodes[n];
  soup.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) soup.triangles.row(t) = triangles[t].transpose();
  return soup;
}

// `f` maps the unit square, each side cut n times, into space; joined to itself where `closed_u` and `closed_v` say so
// only as far as places agree: nodes are not shared across the seam.
inline Soup patch(int nu, int nv, const std::function<Vector3(double, double)>& f) {
  std::vector<Vector3> nodes;
  std::vector<Eigen::Vector3i> triangles;
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i <= nu; ++i) nodes.push_back(f(double(i) / nu, double(j) / nv));
  }
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      const int a = j * (nu + 1) + i, b = a + 1, c = b + nu + 1, d = a + nu + 1;
      triangles.emplace_back(a, b, c);
      triangles.emplace_back(a, c, d);
    }
  }
  return soup_of(nodes, triangles);
}

inline Soup joined(const Soup& a, const Soup& b) {
  Soup both;
  both.nodes.resize(a.nodes.rows() + b.nodes.rows(), 3);
  both.nodes << a.nodes, b.nodes;
  both.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
  both.triangles << a.triangles, (b.triangles.array() + static_cast<int>(a.nodes.rows())).matrix();
  return both;
}

inline Soup moved(Soup soup, const Vector3& shift, const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) {
  soup.nodes = (soup.nodes * turn.transpose()).rowwise() + shift.transpose();
  return soup;
}

inline Eigen::Matrix3d some_turn() {
  return (Eigen::AngleAxisd(0.5, Vector3(1, 0.3, 0.2).normalized()) * Eigen::AngleAxisd(0.9, Vector3::UnitZ()))
      .toRotationMatrix();
}

inline Soup inside_out(Soup soup) {
  soup.triangles.col(1).swap(soup.triangles.col(2));
  return soup;
}

// From the origin to `size`; n cuts of each face's sides.
inline Soup box_surface(const Vector3& size, int n = 1) {
  Soup all;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto face = [&](double at, bool swapped) {
      return patch(n, n, [&, at, swapped](double s, double t) {
        Vector3 p;
        p[axis] = at;
        p[u] = size[u] * (swapped ? t : s);
        p[v] = size[v] * (swapped ? s : t);
        return p;
      });
    };
    const Soup pair = joined(face(size[axis], false), face(0, true));
    all = axis == 0 ? pair : joined(all, pair);
  }
  return all;
}

// A turned profile: radius and height along it, from the lower end of the axis round the outside to its upper end.
inline Soup turned_surface(int around, int along, const std::function<Eigen::Vector2d(double)>& profile) {
  return patch(around, along, [&](double s, double t) {
    const Eigen::Vector2d at = profile(t);
    const double angle = 2 * std::numbers::pi * s;
    return Vector3(at[0] * std::cos(angle), at[0] * std::sin(angle), at[1]);
  });
}

inline Soup sphere_surface(double radius, int around = 96) {
  return turned_surface(around, around / 2, [=](double t) {
    return Eigen::Vector2d(radius * std::sin(std::numbers::pi * t), -radius * std::cos(std::numbers::pi * t));
  });
}

inline Soup torus_surface(double ring, double tube, int around = 160, int along = 48) {
  return turned_surface(around, along, [=](double t) {
    const double angle = 2 * std::numbers::pi * t;
    return Eigen::Vector2d(ring + tube * std::cos(angle), tube * std::sin(angle));
  });
}

// A hemisphere's shell, open above.
inline Soup bowl_surface(double outer, double wall, int around = 128) {
  const double pi = std::numbers::pi, inner = outer - wall;
  return turned_surface(around, around, [=](double t) -> Eigen::Vector2d {
    if (t < 0.48) return outer * Eigen::Vector2d(std::sin(pi / 0.96 * t), -std::cos(pi / 0.96 * t));
    if (t < 0.52) return {outer - (t - 0.48) / 0.04 * wall, 0};
    return inner * Eigen::Vector2d(std::sin(pi / 0.96 * (1 - t)), -std::cos(pi / 0.96 * (1 - t)));
  });
}

inline Soup cone_surface(double radius, double height, int around = 96) {
  return turned_surface(around, 40, [=](double t) -> Eigen::Vector2d {
    if (t < 0.5) return {2 * t * radius, 0};
    return {2 * (1 - t) * radius, (2 * t - 1) * height};
  });
}

// Each triangle with chance `share` thrown away / turned / doubled.
inline Soup with_holes(const Soup& soup, double share, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < soup.triangles.rows(); ++t) {
    if (random() > share * 4294967295.0) kept.push_back(t);
  }
  Soup less = soup;
  less.triangles = soup.triangles(kept, Eigen::all).eval();
  return less;
}

inline Soup with_turned(Soup soup, double share, unsigned seed = 2) {
  std::mt19937 random(seed);
  for (Eigen::Index t = 0; t < soup.triangles.rows(); ++t) {
    if (random() < share * 4294967295.0) std::swap(soup.triangles(t, 1), soup.triangles(t, 2));
  }
  return soup;
}

inline Soup with_doubled(const Soup& soup, double share, unsigned seed = 3) {
  Soup twice = with_holes(soup, 1 - share, seed);
  return joined(soup, twice);
}

// Triangles at random in the unit cube: no body at all.
inline Soup random_soup(int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0, 1), small(-size, size);
  std::vector<Vector3> nodes;
  std::vector<Eigen::Vector3i> triangles;
  for (int t = 0; t < count; ++t) {
    const Vector3 at(any(random), any(random), any(random));
    for (int k = 0; k < 3; ++k) nodes.push_back(at + Vector3(small(random), small(random), small(random)));
    triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
  }
  return soup_of(nodes, triangles);
}

}  // namespace ringdown::test
