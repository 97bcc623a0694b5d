// Pieces hang together, nest, and are not too small.
#include "engine/shatter/pieces.h"

#include "engine/shatter/pattern.h"
#include "tests/shatter/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace ringdown::test {
namespace {

using shatter::cut_body;
using shatter::CutBody;
using shatter::elements_of;
using shatter::Level;
using shatter::levels_of;
using shatter::make_seeds;
using shatter::piece_mesh;

std::vector<std::int32_t> each_its_own(int cells) {
  std::vector<std::int32_t> groups(static_cast<std::size_t>(cells));
  std::iota(groups.begin(), groups.end(), 0);
  return groups;
}

// The elements whose middle satisfies a condition, as a body.
template <class Kept>
mesh::TetMesh part_of(mesh::TetMesh mesh, const Kept& kept) {
  Eigen::Index count = 0;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    if (kept(Eigen::RowVector3d(corners_of(mesh, e).colwise().mean())))
      mesh.elements.row(count++) = mesh.elements.row(e).eval();
  }
  mesh.elements.conservativeResize(count, Eigen::NoChange);
  mesh::drop_unused_nodes(mesh.nodes, mesh.elements);
  return mesh;
}

TEST(ShatterPieces, ACellOnBothWallsOfATumblerIsTwoPieces) {
  for (const int order : {1, 3}) {
    const mesh::TetMesh body = tube(order, 24, 6);
    mesh::Points seeds(3, 3);
    seeds << 0, -0.03, 0.05, 0, 0, 0.05, 0, 0.03, 0.05;
    const CutBody cut = cut_body(body, seeds).value();
    EXPECT_EQ(levels_of(cut, body, {each_its_own(3)}, {}).front().pieces.size(), 4u);
  }
}

TEST(ShatterPieces, PiecesOfAConvexPlateAreItsCells) {
  const mesh::TetMesh body = plate(16);
  for (const auto pattern : {shatter::Pattern::kUniform, shatter::Pattern::kRadial}) {
    const auto seeds = make_seeds(body, {.pattern = pattern, .pieces = {24}, .impact_m = {0.1, 0.1, 0}}).value();
    const CutBody cut = cut_body(body, seeds.points).value();
    const Level level = levels_of(cut, body, seeds.group_of_cell, 0).front();
    EXPECT_EQ(level.pieces.size(), 24u) << "nothing taken for a neck";
  }
}

TEST(ShatterPieces, LevelsAreNested) {
  for (const Body& body : {Body{"plate", plate(12)}, {"tube", tube(2, 20, 8)}, {"bowl", bowl(3, 6)}}) {
    const Eigen::RowVector3d at = body.mesh.nodes.row(20);
    const Vec3 impact = {at[0], at[1], at[2]};
    for (const auto pattern : {shatter::Pattern::kUniform, shatter::Pattern::kImpact, shatter::Pattern::kRadial}) {
      const auto seeds = make_seeds(body.mesh, {.pattern = pattern, .pieces = {3, 10, 40}, .impact_m = impact}).value();
      const CutBody cut = cut_body(body.mesh, seeds.points).value();
      const auto levels = levels_of(cut, body.mesh, seeds.group_of_cell);
      ASSERT_EQ(levels.size(), 3u);
      for (const shatter::Piece& piece : levels[0].pieces) EXPECT_EQ(piece.coarser, -1);
      for (std::size_t level = 1; level < 3; ++level) {
        EXPECT_GT(levels[level].pieces.size(), levels[level - 1].pieces.size());
        EXPECT_GT(levels[level].crack_area_m2, levels[level - 1].crack_area_m2);
        double cracks_m2 = levels[level - 1].crack_area_m2;
        for (const shatter::Piece& piece : levels[level - 1].pieces) cracks_m2 += piece.crack_area_m2;
        EXPECT_NEAR(cracks_m2 / levels[level].crack_area_m2, 1, 1e-12) << "cracks are inside a piece or between pieces";
        std::vector<double> volumes(levels[level - 1].pieces.size(), 0);
        for (const shatter::Piece& piece : levels[level].pieces) volumes[piece.coarser] += piece.volume_m3;
        for (std::size_t k = 0; k < volumes.size(); ++k) {
          EXPECT_NEAR(volumes[k] / levels[level - 1].pieces[k].volume_m3, 1, 1e-10);
        }
        for (std::size_t e = 0; e < cut.elements.size(); ++e) {
          ASSERT_EQ(levels[level].pieces[levels[level].piece_of_element[e]].coarser,
                    levels[level - 1].piece_of_element[e]);
        }
      }
      // The coarse pieces are sound meshes, too, across the borders of the cells in them.
      for (std::int32_t k = 0; k < std::ssize(levels[0].pieces); ++k) {
        const auto checked = mesh::check_mesh(piece_mesh(cut, body.mesh, elements_of(levels[0], k)).mesh, "piece");
        ASSERT_TRUE(checked) << body.name << ": " << checked.error().message;
        EXPECT_EQ(checked->flipped + checked->straightened, 0) << body.name;
      }
    }
  }
}

TEST(ShatterPieces, NoPieceIsBelowTheLeastShare) {
  const mesh::TetMesh body = plate(12);
  const auto seeds = make_seeds(body, {.pieces = {5, 60}, .impact_m = {0.1, 0.1, 0}}).value();
  const CutBody cut = cut_body(body, seeds.points).value();
  std::size_t before = 1000;
  for (const double share : {0.0, 0.005, 0.02, 0.1}) {
    const auto levels = levels_of(cut, body, seeds.group_of_cell, share);
    for (const Level& level : levels) {
      for (const shatter::Piece& piece : level.pieces) EXPECT_GE(piece.volume_m3, share * 0.26 * 0.26 * 0.0045);
    }
    EXPECT_LT(levels.back().pieces.size(), before);
    before = levels.back().pieces.size();
  }
}

TEST(ShatterPieces, TheCrackAreaOfOnePlaneIsKnown) {
  const mesh::TetMesh body = plate(8);
  mesh::Points seeds(2, 3);
  seeds << 0.065, 0.13, 0.002, 0.195, 0.13, 0.002;
  const CutBody cut = cut_body(body, seeds).value();
  const Level level = levels_of(cut, body, {each_its_own(2)}).front();
  EXPECT_NEAR(level.crack_area_m2, 0.26 * 0.0045, 1e-12);
  ASSERT_EQ(level.pieces.size(), 2u);
  EXPECT_EQ(levels_of(cut, body, {{0, 0}}).front().crack_area_m2, 0);
}

// A square of wall, 10 thicknesses wide, joined by a bridge to another one, or to a strip.
TEST(ShatterPieces, ANarrowNeckParts) {
  struct Case {
    double bridge, strip;  // widths, in wall thicknesses
    bool is_neck;
  };
  for (const auto& [bridge, strip, is_neck] : {Case{0.25, 10, true}, {0.15, 2, true}, {6, 10, false}, {3, 2, false}}) {
    mesh::TetMesh body = part_of(box_mesh({22, 21, 1}, {22, 21, 1}), [&](const Eigen::RowVector3d& at) {
      return at[0] < 10 || (at[0] > 12 && at[0] < 12 + strip) || (at[0] < 12 && std::abs(at[1] - 10.5) < 0.5);
    });
    for (auto node : body.nodes.rowwise()) {  // the middle row of elements becomes as wide as the bridge
      const double from_middle = node[1] - 10.5, rows = std::abs(from_middle) - 0.5;
      node[1] = std::copysign(0.5 * bridge + rows / 10 * (5 - 0.5 * bridge), from_middle);
    }
    const CutBody cut = cut_body(checked(body).mesh, mesh::Points::Zero(1, 3)).value();
    const Level level = levels_of(cut, checked(body).mesh, {{0}}).front();
    ASSERT_EQ(level.pieces.size(), is_neck ? 2u : 1u) << bridge << " " << strip;
    if (!is_neck) continue;
    EXPECT_NEAR(level.crack_area_m2, bridge, 0.02);
    EXPECT_NEAR(level.pieces[0].volume_m3, 100, 0.5);
    EXPECT_NEAR(level.pieces[1].volume_m3, 10 * strip, 0.5);
  }
}

// In the lower layer two blocks touch along an edge only; the upper layer connects them.
TEST(ShatterPieces, PartsThatTouchAlongAnEdgeAreNotJoinedThere) {
  for (const int order : {1, 2}) {
    const mesh::TetMesh body = mesh::to_order(box_mesh({2, 2, 2}, {2, 2, 2}), order);
    const CutBody cut = cut_body(body, mesh::Points::Constant(1, 3, 1)).value();
    std::vector<std::int64_t> kept, corner;
    for (std::size_t e = 0; e < cut.elements.size(); ++e) {
      Eigen::RowVector3d at = Eigen::RowVector3d::Zero();
      for (const std::int32_t c : cut.elements[e].corners) at += cut.points.row(c) / 4;
      if ((at[2] > 1 && (at[0] > 1 || at[1] < 1)) || (at[0] > 1) == (at[1] > 1))
        kept.push_back(static_cast<std::int64_t>(e));
      if ((at[0] > 1) == (at[1] > 1) && (at[0] > 1) == (at[2] > 1)) corner.push_back(static_cast<std::int64_t>(e));
    }
    const shatter::PieceMesh piece = piece_mesh(cut, body, kept);
    const auto checked = mesh::check_mesh(piece.mesh, "piece");
    ASSERT_TRUE(checked) << checked.error().message;
    EXPECT_EQ(checked->pieces, 1);
    EXPECT_NEAR(volume_of(piece.mesh), 5, 1e-12);

    // Two blocks that touch in a point.
    const auto apart = mesh::check_mesh(piece_mesh(cut, body, corner).mesh, "piece");
    ASSERT_TRUE(apart) << apart.error().message;
    EXPECT_EQ(apart->pieces, 2);
  }
}

}  // namespace
}  // namespace ringdown::test
