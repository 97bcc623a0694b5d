// The pieces fill the body exactly, whatever the body and the seeds, and fields of the body are fields of theirs.
#include "engine/shatter/cut.h"

#include "engine/mesh/boundary.h"
#include "engine/shatter/pattern.h"
#include "engine/shatter/piece_mesh.h"
#include "engine/shatter/pieces.h"
#include "tests/shatter/bodies.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <vector>

namespace ringdown::test {
namespace {

using shatter::cut_body;
using shatter::CutBody;
using shatter::Level;
using shatter::piece_mesh;
using shatter::PieceMesh;

// Volume, first and second moments about the origin of a body of density 1.
struct Moments {
  double volume = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

  Moments& operator+=(const Moments& other) {
    volume += other.volume, first += other.first, second += other.second;
    return *this;
  }
};

Moments moments_of(const mesh::TetMesh& mesh) {
  Moments sum;
  const int order = mesh.order();
  for (const mesh::QuadraturePoint& point : mesh::tet_quadrature(3 * (order - 1) + 2 * order)) {
    const mesh::ReferenceGradient gradient = mesh::interpolation_gradient(order, point.barycentric);
    const Eigen::VectorXd shares = mesh::interpolation(order, point.barycentric);
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      const mesh::ElementNodes nodes = mesh::nodes_of(mesh, e);
      const double weight = point.weight * mesh::jacobian(nodes, gradient).determinant() / 6;
      const Eigen::Vector3d at = (shares.transpose() * nodes).transpose();
      sum += {weight, weight * at, weight * at * at.transpose()};
    }
  }
  return sum;
}

// Seeds of a pattern, and the pieces they make.
struct Broken {
  CutBody cut;
  std::vector<Level> levels;
  std::vector<PieceMesh> pieces;  // of the finest level
};

Broken broken(const mesh::TetMesh& body, int count, shatter::Pattern pattern, unsigned seed) {
  const Eigen::RowVector3d at = body.nodes.row(seed * 7919 % body.nodes.rows());
  const Vec3 impact = {at[0], at[1], at[2]};
  const auto seeds =
      shatter::make_seeds(body, {.pattern = pattern, .pieces = {count}, .impact_m = impact, .seed = seed}).value();
  Broken broken{cut_body(body, seeds.points).value(), {}, {}};
  broken.levels = levels_of(broken.cut, body, seeds.group_of_cell);
  for (std::int32_t k = 0; k < std::ssize(broken.levels[0].pieces); ++k) {
    broken.pieces.push_back(piece_mesh(broken.cut, body, elements_of(broken.levels[0], k)));
  }
  return broken;
}

std::vector<Body> bodies() {
  return {{"plate", plate(8)},
          {"block of six elements", box_mesh({1, 1, 1}, {0.1, 0.1, 0.1})},
          {"shaken slab", shaken(box_mesh({5, 5, 1}, {0.1, 0.1, 0.01}), 0.002)},
          {"slab with a thin layer", moved(box_mesh({6, 6, 2}, {1, 1, 0.1}),
                                           [](const Eigen::Vector3d& at) {
                                             return Eigen::Vector3d(at[0], at[1],
                                                                    std::abs(at[2] - 0.05) < 0.01 ? 0.1 - 3e-8 : at[2]);
                                           })},
          {"tube, straight", tube(1, 20, 6)},
          {"tube, order 2", tube(2, 16, 5)},
          {"tube, order 3", tube(3, 12, 4)},
          {"bowl, order 2", bowl(2, 6)},
          {"bowl, order 3", bowl(3, 5)},
          {"bowl, order 4", bowl(4, 4)}};
}

// Whether elements are joined to one another by faces, by spreading from the first.
bool is_joined_by_faces(const mesh::TetMesh& mesh) {
  std::map<std::array<std::int32_t, 3>, std::vector<Eigen::Index>> at_face;
  const auto face_of = [&](Eigen::Index e, int opposite) {
    const auto& f = mesh::kTetFaces[opposite];
    std::array<std::int32_t, 3> face = {mesh.elements(e, f[0]), mesh.elements(e, f[1]), mesh.elements(e, f[2])};
    std::sort(face.begin(), face.end());
    return face;
  };
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (int f = 0; f < 4; ++f) at_face[face_of(e, f)].push_back(e);
  }
  std::set<Eigen::Index> reached = {0};
  std::vector<Eigen::Index> waiting = {0};
  while (!waiting.empty()) {
    const Eigen::Index e = waiting.back();
    waiting.pop_back();
    for (int f = 0; f < 4; ++f) {
      for (const Eigen::Index next : at_face[face_of(e, f)]) {
        if (reached.insert(next).second) waiting.push_back(next);
      }
    }
  }
  return std::ssize(reached) == mesh.elements.rows();
}

TEST(ShatterCut, PiecesAreSoundMeshesThatFillTheBody) {
  for (const Body& body : bodies()) {
    const double volume = volume_of(body.mesh);
    for (unsigned seed = 1; seed <= 2; ++seed) {
      for (const int count : {1, 5, 30}) {
        const Broken all =
            broken(body.mesh, count, seed == 1 ? shatter::Pattern::kImpact : shatter::Pattern::kUniform, seed);
        double sum = 0, stated = 0;
        for (const PieceMesh& piece : all.pieces) {
          sum += volume_of(piece.mesh);
          const auto checked = mesh::check_mesh(piece.mesh, "piece");
          ASSERT_TRUE(checked) << body.name << ": " << checked.error().message;
          EXPECT_EQ(checked->pieces, 1) << body.name;
          EXPECT_EQ(checked->flipped + checked->straightened + checked->unused_nodes + checked->duplicates, 0)
              << body.name;
          EXPECT_EQ(piece.mesh.order(), body.mesh.order());
          EXPECT_TRUE(is_joined_by_faces(piece.mesh)) << body.name;
        }
        for (const shatter::Piece& piece : all.levels[0].pieces) stated += piece.volume_m3;
        EXPECT_NEAR(sum / volume, 1, 1e-12) << body.name << ", " << count << " seeds";
        EXPECT_NEAR(stated / volume, 1, 1e-12) << body.name;
        if (count == 1) {
          EXPECT_EQ(all.pieces.size(), 1u) << body.name;
        }
      }
    }
  }
}

TEST(ShatterCut, MomentsOfThePiecesSumToTheBodys) {
  for (const Body& body : {Body{"plate", plate(6)}, {"tube", tube(2, 12, 4)}, {"bowl", bowl(3, 4)}}) {
    const Moments whole = moments_of(body.mesh);
    Moments sum;
    for (const PieceMesh& piece : broken(body.mesh, 8, shatter::Pattern::kUniform, 3).pieces)
      sum += moments_of(piece.mesh);
    const Eigen::Vector3d center = whole.first / whole.volume;
    const auto central = [&](const Moments& m) {
      const Eigen::Matrix3d mixed = m.first * center.transpose();
      return Eigen::Matrix3d(m.second - mixed - mixed.transpose() + m.volume * center * center.transpose());
    };
    EXPECT_NEAR(sum.volume / whole.volume, 1, 1e-12) << body.name;
    EXPECT_LT((sum.first - whole.first).norm() / whole.volume, 1e-13) << body.name;
    EXPECT_LT((central(sum) - central(whole)).norm(), 1e-10 * central(whole).norm()) << body.name;
  }
}

// A polynomial in x, y, z of the mesh's degree is a field of straight elements, on the body and on its pieces.
TEST(ShatterCut, PolynomialsRestrictExactly) {
  for (int order = 1; order <= 4; ++order) {
    const mesh::TetMesh body = mesh::to_order(shaken(box_mesh({4, 4, 1}, {1, 1, 0.3}), 0.05), order);
    const auto field = [order](const mesh::Points& at) {
      Eigen::MatrixXd values(3 * at.rows(), 2);
      for (Eigen::Index n = 0; n < at.rows(); ++n) {
        const double x = at(n, 0), y = at(n, 1), z = at(n, 2);
        values.col(0).segment<3>(3 * n) << 1 + x - 2 * y, 3 * z - y, 0.5 - x + z;
        values.col(1).segment<3>(3 * n) << std::pow(x - 2 * y + z, order), std::pow(1 + x, order) - z,
            std::pow(y - z, order);
      }
      return values;
    };
    for (const PieceMesh& piece : broken(body, 6, shatter::Pattern::kUniform, 1).pieces) {
      const Eigen::MatrixXd found = restricted(piece, body, field(body.nodes)), expected = field(piece.mesh.nodes);
      EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-12) << "order " << order;
    }
  }
}

// Random values at the nodes of a curved body: at random points of a piece's element, the piece's field is the body's.
TEST(ShatterCut, AnyFieldOfACurvedBodyIsAFieldOfItsPieces) {
  for (const Body& body : {Body{"tube", tube(2, 12, 4)}, {"tube", tube(3, 12, 4)}, {"bowl", bowl(4, 4)}}) {
    const int order = body.mesh.order();
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(0, 1);
    Eigen::MatrixXd field(3 * body.mesh.nodes.rows(), 2);
    for (double& value : field.reshaped()) value = any(random);
    const Broken all = broken(body.mesh, 7, shatter::Pattern::kUniform, 2);
    for (std::size_t k = 0; k < all.pieces.size(); ++k) {
      const auto numbers = elements_of(all.levels[0], static_cast<std::int32_t>(k));
      const PieceMesh& piece = all.pieces[k];
      ASSERT_EQ(piece.mesh.elements.rows(), std::ssize(numbers)) << "no edge had to be divided";
      const Eigen::MatrixXd own = restricted(piece, body.mesh, field);
      for (std::size_t e = 0; e < numbers.size(); ++e) {
        Eigen::Vector4d at(any(random), any(random), any(random), any(random));
        at /= at.sum();
        const shatter::SubElement& part = all.cut.elements[static_cast<std::size_t>(numbers[e])];
        const Eigen::VectorXd in_part = mesh::interpolation(order, at);
        const Eigen::VectorXd in_whole = mesh::interpolation(order, part.barycentric.transpose() * at);
        Eigen::MatrixXd found = Eigen::MatrixXd::Zero(3, 2), expected = found;
        Eigen::RowVector3d place = Eigen::RowVector3d::Zero(), true_place = place;
        for (Eigen::Index a = 0; a < in_part.size(); ++a) {
          const Eigen::Index node = piece.mesh.elements(static_cast<Eigen::Index>(e), a);
          const Eigen::Index whole_node = body.mesh.elements(part.parent, a);
          found += in_part[a] * own.middleRows<3>(3 * node);
          expected += in_whole[a] * field.middleRows<3>(3 * whole_node);
          place += in_part[a] * piece.mesh.nodes.row(node);
          true_place += in_whole[a] * body.mesh.nodes.row(whole_node);
        }
        ASSERT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-12) << body.name;
        ASSERT_LT((place - true_place).norm(), 1e-13) << body.name;
      }
    }
  }
}

// A piece of a coarser piece has the same field, whether it comes from the body at once or by way of that piece.
TEST(ShatterCut, FieldsComeThroughCoarserPieces) {
  for (const Body& body : {Body{"tube", tube(2, 12, 4)}, {"bowl", bowl(3, 4)}}) {
    const auto seeds =
        shatter::make_seeds(body.mesh, {.pattern = shatter::Pattern::kUniform, .pieces = {3, 10}}).value();
    const CutBody cut = cut_body(body.mesh, seeds.points).value();
    const std::vector<Level> levels = levels_of(cut, body.mesh, seeds.group_of_cell);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(0, 1);
    Eigen::MatrixXd field(3 * body.mesh.nodes.rows(), 2);
    for (double& value : field.reshaped()) value = any(random);
    std::vector<PieceMesh> coarse;
    for (std::int32_t k = 0; k < std::ssize(levels[0].pieces); ++k)
      coarse.push_back(piece_mesh(cut, body.mesh, elements_of(levels[0], k)));
    for (std::int32_t k = 0; k < std::ssize(levels[1].pieces); ++k) {
      const PieceMesh piece = piece_mesh(cut, body.mesh, elements_of(levels[1], k));
      const PieceMesh& whole = coarse[static_cast<std::size_t>(levels[1].pieces[static_cast<std::size_t>(k)].coarser)];
      const Eigen::MatrixXd through = restricted(piece, whole, restricted(whole, body.mesh, field));
      EXPECT_LT((through - restricted(piece, body.mesh, field)).cwiseAbs().maxCoeff(), 1e-11) << body.name;
    }
  }
}

// A face that belongs to one part only lies on the body's skin.
TEST(ShatterCut, NeighboursShareFacesAcrossCells) {
  for (const mesh::TetMesh& body : {plate(8), tube(1, 16, 5), shaken(box_mesh({4, 4, 4}, {1, 1, 1}), 0.04)}) {
    const CutBody cut = broken(body, 25, shatter::Pattern::kUniform, 1).cut;
    mesh::TetMesh all{cut.points, mesh::Indices(std::ssize(cut.elements), 4)};
    for (std::size_t e = 0; e < cut.elements.size(); ++e) {
      for (int c = 0; c < 4; ++c) all.elements(static_cast<Eigen::Index>(e), c) = cut.elements[e].corners[c];
    }
    const auto checked = mesh::check_mesh(all, "all parts");
    ASSERT_TRUE(checked) << checked.error().message;
    const auto skin_area = [](const mesh::TetMesh& mesh) {
      double area = 0;
      for (const mesh::OuterFace& face : mesh::outer_faces(mesh.elements)) {
        const Eigen::RowVector3d a = mesh.nodes.row(face.corners[0]), u = mesh.nodes.row(face.corners[1]) - a,
                                 v = mesh.nodes.row(face.corners[2]) - a;
        area += 0.5 * u.cross(v).norm();
      }
      return area;
    };
    EXPECT_NEAR(skin_area(all) / skin_area(body), 1, 1e-12);
  }
}

TEST(ShatterCut, CellsAreNearestToTheirSeedsButForBentBorders) {
  const mesh::TetMesh body = plate(10);
  const auto seeds = shatter::make_seeds(body, {.pieces = {20}, .impact_m = {0.1, 0.1, 0}}).value();
  const CutBody cut = cut_body(body, seeds.points).value();
  double wrong = 0, sum = 0;
  for (std::size_t e = 0; e < cut.elements.size(); ++e) {
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    for (const std::int32_t corner : cut.elements[e].corners) middle += cut.points.row(corner) / 4;
    Eigen::Index nearest = 0;
    (seeds.points.rowwise() - middle).rowwise().squaredNorm().minCoeff(&nearest);
    const double volume = cut.elements[e].barycentric.determinant() *
                          mesh::jacobian(corners_of(body, cut.elements[e].parent)).determinant();
    sum += volume;
    if (nearest != cut.cell[e]) wrong += volume;
  }
  EXPECT_LT(wrong / sum, 0.02);
}

TEST(ShatterCut, APlaneThroughNodesCutsNoElement) {
  const mesh::TetMesh body = box_mesh({8, 2, 1}, {0.8, 0.2, 0.1});
  mesh::Points seeds(2, 3);
  seeds << 0.25, 0.1, 0.05, 0.55, 0.1, 0.05;
  const CutBody cut = cut_body(body, seeds).value();
  EXPECT_EQ(std::ssize(cut.elements), body.elements.rows());
  EXPECT_EQ(std::count(cut.cell.begin(), cut.cell.end(), 0), body.elements.rows() / 2);
}

// Cells that meet in fours and eights, on planes that run through nodes and faces of the mesh.
TEST(ShatterCut, SeedsOnAGridGiveEqualPieces) {
  for (const int cells : {3, 4, 5}) {
    const mesh::TetMesh body = box_mesh({cells, cells, cells}, {1, 1, 1});
    mesh::Points seeds(8, 3);
    for (int k = 0; k < 8; ++k) seeds.row(k) << 0.25 + 0.5 * (k & 1), 0.25 + 0.25 * (k & 2), 0.25 + 0.125 * (k & 4);
    const CutBody cut = cut_body(body, seeds).value();
    const auto levels = levels_of(cut, body, {{0, 1, 2, 3, 4, 5, 6, 7}}, {});
    ASSERT_EQ(levels[0].pieces.size(), 8u);
    double sum = 0;
    for (std::int32_t k = 0; k < 8; ++k) {
      const PieceMesh piece = piece_mesh(cut, body, elements_of(levels[0], k));
      ASSERT_TRUE(mesh::check_mesh(piece.mesh, "piece"));
      sum += volume_of(piece.mesh);
      EXPECT_NEAR(volume_of(piece.mesh), 0.125, 0.01) << cells;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

TEST(ShatterCut, TheSameSeedsGiveTheSameCut) {
  const mesh::TetMesh body = bowl(3, 5);
  const auto one = broken(body, 12, shatter::Pattern::kImpact, 1), two = broken(body, 12, shatter::Pattern::kImpact, 1);
  EXPECT_EQ(one.cut.points, two.cut.points);
  EXPECT_EQ(one.cut.cell, two.cut.cell);
  EXPECT_EQ(one.levels[0].piece_of_element, two.levels[0].piece_of_element);
  ASSERT_EQ(one.pieces.size(), two.pieces.size());
  for (std::size_t k = 0; k < one.pieces.size(); ++k) EXPECT_EQ(one.pieces[k].mesh.nodes, two.pieces[k].mesh.nodes);
  EXPECT_NE(one.cut.cell, broken(body, 12, shatter::Pattern::kImpact, 2).cut.cell);
}

TEST(ShatterCut, MorePiecesThanElementsDivideTheElements) {
  const mesh::TetMesh body = box_mesh({1, 1, 1}, {0.1, 0.1, 0.1});
  const Broken all = broken(body, 60, shatter::Pattern::kUniform, 1);
  const std::set<std::int32_t> cells(all.cut.cell.begin(), all.cut.cell.end());
  EXPECT_EQ(cells.size(), 60u);
  EXPECT_GT(all.pieces.size(), 50u);
}

TEST(ShatterCut, SeedsOutsideTheBodyMayHaveNoCell) {
  const mesh::TetMesh body = plate(4);
  mesh::Points seeds(2, 3);
  seeds << 0.1, 0.1, 0.002, 5, 5, 5;
  const CutBody cut = cut_body(body, seeds).value();
  EXPECT_EQ(std::count(cut.cell.begin(), cut.cell.end(), 0), std::ssize(cut.cell));
}

TEST(ShatterCut, SeedsThatCannotBeDividedAreRefusedInASentence) {
  const mesh::TetMesh body = plate(4);
  mesh::Points same(2, 3), broken_number(1, 3);
  same << 0.1, 0.1, 0, 0.1, 0.1, 1e-9;
  broken_number << 0, std::numeric_limits<double>::quiet_NaN(), 0;
  for (const mesh::Points& seeds : {same, broken_number, mesh::Points(0, 3), mesh::Points(5000, 3)}) {
    const auto cut = cut_body(body, seeds);
    ASSERT_FALSE(cut);
    EXPECT_EQ(cut.error().kind, ErrorKind::bad_input);
    EXPECT_GT(cut.error().message.size(), 30u);
  }
}

}  // namespace
}  // namespace ringdown::test
