#include "tests/bake/curved_skin.h"

#include "engine/dense/decompositions.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <utility>

namespace ringdown::test {
namespace {

using Shares = std::array<int, 4>;  // of a node of order p, in p-ths: its barycentric coordinates times p

// The nodes of an element in the order that tet_element.h documents.
std::vector<Shares> element_nodes(int order) {
  constexpr std::array<std::array<int, 2>, 6> kEdges = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  constexpr std::array<std::array<int, 3>, 4> kFaces = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::vector<Shares> nodes;
  for (int corner = 0; corner < 4; ++corner) {
    nodes.push_back({});
    nodes.back()[corner] = order;
  }
  for (const auto& [from, to] : kEdges) {
    for (int step = 1; step < order; ++step) {
      nodes.push_back({});
      nodes.back()[from] = order - step;
      nodes.back()[to] = step;
    }
  }
  for (const auto& face : kFaces) {
    for (int nearest = 0; order >= 3 && nearest < (order == 4 ? 3 : 1); ++nearest) {
      nodes.push_back({});
      for (int k = 0; k < 3; ++k) nodes.back()[face[k]] = 1;
      if (order == 4) nodes.back()[face[nearest]] = 2;
    }
  }
  if (order == 4) nodes.push_back({1, 1, 1, 1});
  return nodes;
}

// The corners of the face opposite a corner of a positively oriented element, counter-clockwise from outside.
std::array<int, 3> corners_opposite(int corner) {
  std::array<int, 3> others{};
  for (int k = 0, n = 0; k < 4; ++k) {
    if (k != corner) others[n++] = k;
  }
  if (corner % 2 == 1) std::swap(others[1], others[2]);
  return others;
}

Eigen::VectorXd monomials(int order, double u, double v) {
  Eigen::VectorXd values((order + 1) * (order + 2) / 2);
  Eigen::Index n = 0;
  for (int i = 0; i <= order; ++i) {
    for (int j = 0; i + j <= order; ++j) values[n++] = std::pow(u, i) * std::pow(v, j);
  }
  return values;
}

// Derivatives of the monomials by u and by v.
Eigen::MatrixX2d slopes(int order, double u, double v) {
  Eigen::MatrixX2d values((order + 1) * (order + 2) / 2, 2);
  Eigen::Index n = 0;
  for (int i = 0; i <= order; ++i) {
    for (int j = 0; i + j <= order; ++j, ++n) {
      values(n, 0) = i == 0 ? 0 : i * std::pow(u, i - 1) * std::pow(v, j);
      values(n, 1) = j == 0 ? 0 : j * std::pow(u, i) * std::pow(v, j - 1);
    }
  }
  return values;
}

}  // namespace

CurvedSkin::CurvedSkin(const mesh::TetMesh& mesh) : order_(mesh.order()) {
  const std::vector<Shares> places = element_nodes(order_);
  std::array<std::array<int, 3>, 4> corners{};
  for (int kind = 0; kind < 4; ++kind) {
    corners[kind] = corners_opposite(kind);
    std::vector<int>& nodes = kinds_[kind].nodes;
    for (int n = 0; n < static_cast<int>(places.size()); ++n) {
      if (places[n][kind] == 0) nodes.push_back(n);
    }
    const auto count = static_cast<Eigen::Index>(nodes.size());
    Eigen::MatrixXd vandermonde(count, count);
    for (Eigen::Index n = 0; n < count; ++n) {
      const Shares& at = places[nodes[n]];
      vandermonde.row(n) =
          monomials(order_, double(at[corners[kind][1]]) / order_, double(at[corners[kind][2]]) / order_);
    }
    kinds_[kind].coefficients = dense::inverse(vandermonde);
  }

  std::map<std::array<std::int32_t, 3>, std::pair<Eigen::Index, int>> alone;  // by corners: element and kind
  std::set<std::array<std::int32_t, 3>> met;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (int kind = 0; kind < 4; ++kind) {
      std::array<std::int32_t, 3> key{};
      for (int k = 0; k < 3; ++k) key[k] = mesh.elements(e, corners[kind][k]);
      std::sort(key.begin(), key.end());
      if (met.insert(key).second) {
        alone[key] = {e, kind};
      } else {
        alone.erase(key);
      }
    }
  }
  std::set<std::int32_t> nodes;
  for (const auto& [key, place] : alone) {
    for (const int n : kinds_[place.second].nodes) nodes.insert(mesh.elements(place.first, n));
  }
  nodes_.assign(nodes.begin(), nodes.end());

  constexpr int kParts = 12;       // along a side of a face
  constexpr double kMargin = 1.5;  // of largest_stretch over what was found at the middles of the parts
  double sum = 0;
  for (const auto& [key, place] : alone) {
    const auto [element, kind] = place;
    Face face{.kind = kind, .nodes = {}, .at_m = {}, .largest_stretch = 0};
    face.at_m.resize(static_cast<Eigen::Index>(kinds_[kind].nodes.size()), 3);
    for (const int n : kinds_[kind].nodes) {
      const std::int32_t node = mesh.elements(element, n);
      face.at_m.row(static_cast<Eigen::Index>(face.nodes.size())) = mesh.nodes.row(node);
      face.nodes.push_back(std::lower_bound(nodes_.begin(), nodes_.end(), node) - nodes_.begin());
    }
    for (int i = 0; i < kParts; ++i) {
      for (int j = 0; i + j < kParts; ++j) {
        for (const double third : {1 / 3.0, 2 / 3.0}) {  // the parts that point up, and those that point down
          if (third > 0.5 && i + j == kParts - 1) continue;
          const double stretch = stretched_normal(face, (i + third) / kParts, (j + third) / kParts).norm();
          area_ += stretch / (2 * kParts * kParts);
          face.largest_stretch = std::max(face.largest_stretch, kMargin * stretch);
        }
      }
    }
    steps_.push_back(sum += face.largest_stretch);
    faces_.push_back(std::move(face));
  }
}

Eigen::Vector3d CurvedSkin::stretched_normal(const Face& face, double u, double v) const {
  const Eigen::MatrixX2d tangents = kinds_[face.kind].coefficients.transpose() * slopes(order_, u, v);
  const Eigen::Matrix<double, 3, 2> along = face.at_m.transpose() * tangents;
  return along.col(0).cross(along.col(1));
}

// By rejection: a face is chosen by the bound of its stretch, a point on its reference triangle evenly, and both are
// kept with the chance of the stretch there over the bound.
std::vector<SkinPoint> CurvedSkin::random_points(std::size_t count, std::uint64_t seed) const {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> chance(0, 1);
  std::vector<SkinPoint> points;
  while (points.size() < count) {
    const double step = chance(random) * steps_.back();
    const auto at = std::upper_bound(steps_.begin(), steps_.end() - 1, step) - steps_.begin();
    const Face& face = faces_[static_cast<std::size_t>(at)];
    double u = chance(random), v = chance(random);
    if (u + v > 1) std::tie(u, v) = std::pair(1 - u, 1 - v);
    const Eigen::Vector3d normal = stretched_normal(face, u, v);
    if (chance(random) * face.largest_stretch > normal.norm()) continue;
    const Eigen::VectorXd weights = kinds_[face.kind].coefficients.transpose() * monomials(order_, u, v);
    points.push_back({face.at_m.transpose() * weights, normal.normalized(), face.nodes, weights});
  }
  return points;
}

Eigen::Matrix3Xd displacement(const SkinPoint& point, const Eigen::MatrixXd& shapes) {
  Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, shapes.cols());
  for (std::size_t n = 0; n < point.nodes.size(); ++n) {
    sum += point.weights[static_cast<Eigen::Index>(n)] * shapes.middleRows<3>(3 * point.nodes[n]);
  }
  return sum;
}

}  // namespace ringdown::test
