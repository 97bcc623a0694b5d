#include "engine/liquid/wetted.h"

#include "engine/radiate/mirror_part.h"

#include <Eigen/Geometry>

#include <utility>

namespace ringdown::liquid {

Wetted wetted_by(const WetWall& wall, const std::vector<Piece>& pieces, double level, bool outside) {
  const Skin& skin = wall.skin();
  Wetted liquid;
  liquid.outside = outside;
  liquid.open = outside || !pieces.front().is_closed();
  const Eigen::Vector3d down = -wall.up(), side = down.unitOrthogonal();
  liquid.turn.row(0) = down.transpose();
  liquid.turn.row(1) = side.transpose();
  liquid.turn.row(2) = down.cross(side).transpose();
  liquid.shift = {level, 0, 0};

  std::vector<bool> below(static_cast<std::size_t>(skin.surface.nodes.rows()), false);
  mesh::TriangleMesh part;
  part.nodes = (skin.surface.nodes * liquid.turn.transpose()).rowwise() + liquid.shift.transpose();
  std::vector<Eigen::Index>& triangles = liquid.triangles;
  for (const Piece& piece : pieces) triangles.insert(triangles.end(), piece.triangles.begin(), piece.triangles.end());
  part.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    auto corners = part.triangles.row(static_cast<Eigen::Index>(t));
    corners = skin.surface.triangles.row(triangles[t]);
    for (const int node : corners) below[node] = below[node] || part.nodes(node, 0) > 0;
    if (!outside) std::swap(corners[1], corners[2]);
  }
  mesh::drop_unused_nodes(part);
  liquid.wall = liquid.open ? radiate::mirror_part_of(part, 1) : std::move(part);

  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  for (Eigen::Index s = 0; s < skin.at.rows(); ++s) {
    if (!(liquid.shift[0] + down.dot(skin.at.row(s)) > 0)) continue;
    bool wet = false;
    for (Rows::InnerIterator node(skin.samples.interpolation, s); node; ++node) wet = wet || below[node.col()];
    if (wet) liquid.samples.push_back(s);
  }
  const auto count = static_cast<Eigen::Index>(liquid.samples.size());
  liquid.at.resize(count, 3);
  liquid.normals.resize(count, 3);
  liquid.areas.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index s = liquid.samples[i];
    liquid.at.row(i) = (liquid.turn * skin.at.row(s).transpose() + liquid.shift).transpose();
    liquid.normals.row(i) = -(liquid.turn * skin.samples.normals.row(s).transpose()).transpose();
    liquid.areas[i] = skin.samples.areas[s];
  }
  return liquid;
}

Eigen::MatrixXd flow_of(const Wetted& liquid, const Skin& skin, const Eigen::MatrixXd& shapes) {
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  Eigen::MatrixXd flow = Eigen::MatrixXd::Zero(liquid.areas.size(), shapes.cols());
  const mesh::Points normals = liquid.normals * liquid.turn;
  for (Eigen::Index i = 0; i < flow.rows(); ++i) {
    for (Rows::InnerIterator node(skin.samples.interpolation, liquid.samples[i]); node; ++node) {
      flow.row(i) += (node.value() * liquid.areas[i]) * (normals.row(i) * shapes.middleRows<3>(3 * node.col()));
    }
  }
  return flow;
}

}  // namespace ringdown::liquid
