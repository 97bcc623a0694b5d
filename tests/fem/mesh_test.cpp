#include "engine/fem/element.h"
#include "engine/mesh/boundary.h"
#include "engine/mesh/coarsen.h"
#include "engine/mesh/mesh_check.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>

namespace ringdown::mesh_test {
namespace {

const Eigen::Vector3d kSize(0.1, 0.08, 0.06);

// Gauss: a third of the sum of a . (b x c) / 2 over outward triangles.
double enclosed_volume(const mesh::Boundary& surface, const mesh::Points& nodes) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Eigen::Vector3d p = nodes.row(surface.nodes[a]), q = nodes.row(surface.nodes[b]),
                          r = nodes.row(surface.nodes[c]);
    sum += p.dot(q.cross(r)) / 6;
  }
  return sum;
}

// In a closed, consistently turned surface every edge is walked once in each direction.
bool is_closed(const mesh::Boundary& surface) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> walked;
  for (const auto& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) ++walked[{t[k], t[(k + 1) % 3]}];
  }
  return std::all_of(walked.begin(), walked.end(), [&](const auto& entry) {
    const auto& [edge, count] = entry;
    const auto back = walked.find({edge.second, edge.first});
    return back != walked.end() && back->second == count;
  });
}

std::string refusal(const mesh::TetMesh& mesh) {
  const auto checked = mesh::check_mesh(mesh, "broken.msh");
  return checked ? "accepted" : checked.error().message;
}

// As in shape(): the node of the element at `place`.
Eigen::Index node_at(int order, const Eigen::RowVector4d& place) {
  Eigen::Index found = 0;
  (mesh::reference_nodes(order).rowwise() - place).rowwise().norm().minCoeff(&found);
  return found;
}

class MeshOfOrder : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, MeshOfOrder, testing::Range(1, mesh::kMaxOrder + 1));

TEST_P(MeshOfOrder, AMeshOfAnyOrderHasItsElementsTurnedThatAreInsideOut) {
  const mesh::TetMesh box = mesh::to_order(test::box_mesh({2, 2, 2}, kSize), GetParam());
  mesh::TetMesh wrong = box;
  const mesh::Barycentric places = mesh::reference_nodes(GetParam());
  for (Eigen::Index e = 0; e < wrong.elements.rows(); e += 3) {
    for (Eigen::Index a = 0; a < places.rows(); ++a) {
      const Eigen::RowVector4d place = places(a, {0, 1, 3, 2});
      wrong.elements(e, a) = box.elements(e, node_at(GetParam(), place));
    }
  }
  const auto checked = mesh::check_mesh(wrong, "wrong");
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_EQ(checked->flipped, 16);
  EXPECT_EQ(checked->straightened, 0) << "nodes lie on the wrong edges or faces";
  EXPECT_NEAR(enclosed_volume(mesh::boundary_of(checked->mesh), checked->mesh.nodes), kSize.prod(), 1e-15);
}

// The smallest det J of the mesh in many points at random, over that of the straight element.
double min_jacobian(const mesh::TetMesh& mesh) {
  std::mt19937 random(3);
  std::exponential_distribution<double> part;
  double min = 1;
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector4d parts(part(random), part(random), part(random), part(random));
    const auto gradient = mesh::interpolation_gradient(mesh.order(), parts / parts.sum());
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      const double straight = mesh::jacobian(mesh::corners_of(mesh, e)).determinant();
      min = std::min(min, mesh::jacobian(mesh::nodes_of(mesh, e), gradient).determinant() / straight);
    }
  }
  return min;
}

TEST(CheckMesh, TheCheckTakesCurvatureFromElementsThatFold) {
  for (const int order : {2, 3, 4}) {
    for (const double shift : {0.05, 0.5}) {
      mesh::TetMesh box = mesh::to_order(test::box_mesh({1, 1, 1}, kSize), order);
      box.nodes.row(box.elements(0, 4)) += shift * Eigen::RowVector3d(1, 0.8, 0.6);
      ASSERT_LT(min_jacobian(box), 0);
      const auto checked = mesh::check_mesh(box, "folded");
      ASSERT_TRUE(checked);
      EXPECT_GE(checked->straightened, 1);
      EXPECT_GT(min_jacobian(checked->mesh), 0);
      EXPECT_EQ(test::checked(checked->mesh).straightened, 0);
    }
  }
}

TEST(CheckMesh, TheCheckLeavesCurvedElementsThatDoNotFold) {
  for (const int order : {2, 3, 4}) {
    const mesh::TetMesh bent = test::bent(mesh::to_order(test::box_mesh({2, 2, 1}, kSize), order), 8);
    const auto checked = mesh::check_mesh(bent, "bent");
    ASSERT_TRUE(checked);
    EXPECT_EQ(checked->straightened, 0);
    EXPECT_EQ(checked->mesh.nodes, bent.nodes);
  }
}

TEST(CheckMesh, TheCheckDropsNodesThatNothingUses) {
  mesh::TetMesh box = test::box_mesh({1, 1, 1}, kSize);
  mesh::TetMesh padded = test::both({mesh::Points::Random(5, 3), mesh::Indices(0, 4)}, box);
  const auto checked = mesh::check_mesh(padded, "padded");
  ASSERT_TRUE(checked);
  EXPECT_EQ(checked->unused_nodes, 5);
  EXPECT_EQ(checked->mesh.nodes, box.nodes);
  EXPECT_EQ(checked->mesh.elements, box.elements);
}

TEST(CheckMesh, TheCheckCountsPieces) {
  const mesh::TetMesh box = test::box_mesh({2, 1, 1}, kSize);
  mesh::TetMesh far = box;
  far.nodes.array() += 1;
  EXPECT_EQ(test::checked(box).pieces, 1);
  EXPECT_EQ(test::checked(test::both(box, far)).pieces, 2);
}

TEST(CheckMesh, TheCheckRefusesWhatHasNoRightRepair) {
  const mesh::TetMesh box = test::box_mesh({1, 1, 1}, kSize);
  mesh::TetMesh broken = box;
  broken.elements.resize(0, 4);
  EXPECT_NE(refusal(broken).find("no tetrahedra"), std::string::npos);

  broken = box;
  broken.elements(3, 2) = 99;
  EXPECT_NE(refusal(broken).find("element 3 names node 99"), std::string::npos);

  broken = box;
  broken.elements(0, 0) = -1;
  EXPECT_NE(refusal(broken).find("names node -1"), std::string::npos);

  broken = box;
  broken.nodes(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(broken).find("node 2 is not a finite number"), std::string::npos);

  broken = box;
  broken.elements(1, 3) = broken.elements(1, 2);
  EXPECT_NE(refusal(broken).find("element 1 names node"), std::string::npos);

  broken = box;
  broken.elements = mesh::Indices::Zero(1, 8);
  EXPECT_NE(refusal(broken).find("elements of 8 nodes"), std::string::npos);
}

// Euler: V - E + F - T = 1 for a ball. Every edge, face and element has its inner nodes once, whoever shares it.
TEST_P(MeshOfOrder, AMeshOfAnyOrderSharesItsNodes) {
  const int p = GetParam();
  const mesh::TetMesh box = test::box_mesh({2, 1, 2}, kSize), raised = mesh::to_order(box, p);
  const Eigen::Index vertices = box.nodes.rows(), elements = box.elements.rows();
  const auto outer = static_cast<Eigen::Index>(mesh::boundary_of(box).triangles.size());
  const Eigen::Index faces = (4 * elements + outer) / 2, edges = vertices + faces - elements - 1;
  EXPECT_EQ(raised.nodes.rows(),
            vertices + edges * (p - 1) + faces * (p - 1) * (p - 2) / 2 + elements * (p - 1) * (p - 2) * (p - 3) / 6);
  EXPECT_EQ(raised.order(), p);
  EXPECT_EQ(test::checked(raised).unused_nodes, 0);
  for (Eigen::Index e = 0; e < elements; ++e) {
    const mesh::Corners corners = mesh::corners_of(box, e);
    EXPECT_LT((mesh::nodes_of(raised, e) - mesh::reference_nodes(p) * corners).norm(), 1e-16) << e;
  }
}

TEST_P(MeshOfOrder, AMeshOfAnyOrderComesBackFromEveryHigherOrder) {
  mesh::TetMesh mesh = mesh::to_order(test::box_mesh({2, 1, 2}, kSize), GetParam());
  if (GetParam() > 1) mesh = test::bent(mesh, 8);
  for (int higher = GetParam(); higher <= mesh::kMaxOrder; ++higher) {
    const mesh::TetMesh back = mesh::to_order(mesh::to_order(mesh, higher), GetParam());
    EXPECT_EQ(back.elements, mesh.elements);
    EXPECT_LT((back.nodes - mesh.nodes).cwiseAbs().maxCoeff(), 1e-15);
  }
}

TEST_P(MeshOfOrder, AMeshOfAnyOrderKeepsItsCurvedFormWhenRaised) {
  const int order = GetParam();
  const mesh::TetMesh mesh = test::bent(mesh::to_order(test::box_mesh({2, 1, 2}, kSize), order), 8);
  const Eigen::Vector4d place(0.1, 0.2, 0.3, 0.4);
  for (int higher = order; higher <= mesh::kMaxOrder; ++higher) {
    const mesh::TetMesh raised = mesh::to_order(mesh, higher);
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      const Eigen::Vector3d before = mesh::nodes_of(mesh, e).transpose() * mesh::interpolation(order, place),
                            after = mesh::nodes_of(raised, e).transpose() * mesh::interpolation(higher, place);
      EXPECT_LT((after - before).norm(), 1e-15);
    }
  }
}

TEST(Order, LoweringTheOrderKeepsCornersAndPutsTheOtherNodesOnTheOldCurve) {
  const mesh::TetMesh cubic = test::bent(mesh::to_order(test::box_mesh({2, 1, 2}, kSize), 3), 8);
  const mesh::TetMesh quadratic = mesh::to_order(cubic, 2);
  const mesh::ElementNodes before = mesh::nodes_of(cubic, 3), after = mesh::nodes_of(quadratic, 3);
  EXPECT_EQ(before.topRows<4>(), after.topRows<4>());
  // A cubic through four even points has the mean (9 (b + c) - (a + d)) / 16 in its middle.
  const Eigen::RowVector3d middle =
      (9 * (before.row(4) + before.row(5)) - before.row(mesh::kTetEdges[0][0]) - before.row(mesh::kTetEdges[0][1])) /
      16;
  EXPECT_LT((after.row(4) - middle).norm(), 1e-15);
}

TEST_P(MeshOfOrder, AMeshOfAnyOrderHasAClosedSurfaceThatFacesOutward) {
  const mesh::TetMesh mesh = mesh::to_order(test::box_mesh({3, 2, 2}, kSize), GetParam());
  const mesh::Boundary surface = mesh::boundary_of(mesh);
  EXPECT_EQ(surface.triangles.size(), 2u * (2 * (3 * 2 + 3 * 2 + 2 * 2)) * GetParam() * GetParam());
  EXPECT_TRUE(is_closed(surface));
  EXPECT_NEAR(enclosed_volume(surface, mesh.nodes), kSize.prod(), 1e-15);
}

// Bent into a ring piece, the flat triangles come nearer to the true volume with the square of their size.
TEST(Surface, TheBoundaryOfCurvedElementsFollowsTheirNodes) {
  const mesh::TetMesh box = test::box_mesh({3, 2, 2}, kSize);
  const auto volume_error = [&](int order) {
    const mesh::TetMesh mesh = test::bent(mesh::to_order(box, order), 8);
    const double exact = kSize[0] * kSize[1] * (kSize[2] + 8 * kSize[2] * kSize[2] / 2);
    return std::abs(enclosed_volume(mesh::boundary_of(mesh), mesh.nodes) / exact - 1);
  };
  EXPECT_LT(volume_error(2), volume_error(1) / 3);
  EXPECT_LT(volume_error(4), volume_error(1) / 12);
}

// A field that is linear in space is interpolated exactly on a curved face as elsewhere, and the areas and normals of a
// closed surface add up to nothing.
TEST_P(MeshOfOrder, QuadratureOfASurfaceIsTakenOnItsCurvedFaces) {
  const mesh::TetMesh mesh = test::bent(mesh::to_order(test::box_mesh({6, 2, 2}, kSize), GetParam()), 5);
  const mesh::Boundary surface = mesh::boundary_of(mesh);
  const mesh::SurfaceQuadrature middles = mesh::quadrature_of(surface, mesh, 1);
  EXPECT_NEAR(mesh::quadrature_of(surface, mesh, 3).areas.sum() / middles.areas.sum(), 1, 1e-3);
  ASSERT_EQ(middles.areas.size(), static_cast<Eigen::Index>(surface.triangles.size()));
  EXPECT_LT((middles.interpolation * Eigen::VectorXd::Ones(middles.interpolation.cols()) -
             Eigen::VectorXd::Ones(middles.areas.size()))
                .norm(),
            1e-12);
  EXPECT_LT((middles.areas.transpose() * middles.normals).norm(), 2e-3 * middles.areas.sum());
  mesh::Points nodes(static_cast<Eigen::Index>(surface.nodes.size()), 3);
  for (Eigen::Index p = 0; p < nodes.rows(); ++p) nodes.row(p) = mesh.nodes.row(surface.nodes[p]);
  const mesh::Points at = middles.interpolation * nodes;
  const double volume = middles.areas.dot(at.cwiseProduct(middles.normals).rowwise().sum()) / 3;
  EXPECT_NEAR(volume / enclosed_volume(surface, mesh.nodes), 1, 0.02);
  for (Eigen::Index t = 0; t < at.rows(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    const Eigen::RowVector3d flat = (nodes.row(a) + nodes.row(b) + nodes.row(c)) / 3;
    const double side = (nodes.row(b) - nodes.row(a)).norm();
    EXPECT_LT((at.row(t) - flat).norm(), 0.2 * side) << "the middle of triangle " << t << " belongs to another one";
  }
}

// What flows in flows out, and a field x along x, y along y or z along z flows out by the same volume: Gauss's theorem
// holds to rounding, for integrals are exact.
TEST_P(MeshOfOrder, FlowThroughCurvedFacesIsExact) {
  const mesh::TetMesh mesh = test::bent(mesh::to_order(test::box_mesh({6, 2, 2}, kSize), GetParam()), 5);
  const mesh::Boundary surface = mesh::boundary_of(mesh);
  const mesh::SurfaceQuadrature samples = mesh::flow_quadrature_of(surface, mesh);
  mesh::Points nodes(static_cast<Eigen::Index>(surface.nodes.size()), 3);
  for (Eigen::Index p = 0; p < nodes.rows(); ++p) nodes.row(p) = mesh.nodes.row(surface.nodes[p]);
  const mesh::Points at = samples.interpolation * nodes;
  const Eigen::MatrixXd flow = samples.areas.asDiagonal() * samples.normals;
  EXPECT_LT(flow.colwise().sum().norm(), 1e-14 * samples.areas.sum());
  const Eigen::RowVector3d volumes = at.cwiseProduct(flow).colwise().sum();
  EXPECT_NEAR(volumes[1] / volumes[0], 1, 1e-12);
  EXPECT_NEAR(volumes[2] / volumes[0], 1, 1e-12);
  EXPECT_NEAR(volumes[0] / enclosed_volume(surface, mesh.nodes), 1, 0.02);
}

double min_angle_deg(const mesh::Points& nodes, const std::array<std::uint32_t, 3>& triangle) {
  double min = 180;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d at = nodes.row(triangle[i]);
    const Eigen::Vector3d a = nodes.row(triangle[(i + 1) % 3]).transpose() - at;
    const Eigen::Vector3d b = nodes.row(triangle[(i + 2) % 3]).transpose() - at;
    min = std::min(min, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi);
  }
  return min;
}

// A box whose one half carries a wave and whose other half is at rest.
TEST(Surface, CoarseningKeepsPointsWhereAFieldBendsAndTheSurfaceClosed) {
  const mesh::TetMesh mesh = test::box_mesh({40, 10, 4}, {0.4, 0.1, 0.04});
  const mesh::Boundary surface = mesh::boundary_of(mesh);
  const mesh::SurfaceQuadrature samples = mesh::quadrature_of(surface, mesh, 3);
  mesh::Points nodes(static_cast<Eigen::Index>(surface.nodes.size()), 3);
  Eigen::MatrixXf fields(1, nodes.rows());
  for (Eigen::Index p = 0; p < nodes.rows(); ++p) {
    nodes.row(p) = mesh.nodes.row(surface.nodes[p]);
    fields(0, p) = nodes(p, 0) > 0.2 ? static_cast<float>(std::sin(70 * nodes(p, 0)) - std::sin(14.0)) : 0.0F;
  }
  const Eigen::MatrixXf there = fields * samples.interpolation.transpose().cast<float>();
  mesh::Coarsening coarse(nodes, surface.triangles, fields,
                          {samples.interpolation * nodes, samples.normals, samples.areas, there}, 0.02);
  for (const std::size_t points : {400u, 150u}) {
    ASSERT_TRUE(coarse.reduce_to(points));
    EXPECT_EQ(coarse.point_count(), points);
    mesh::Points now(nodes.rows(), 3);
    const mesh::Points at_samples = samples.interpolation * nodes;
    for (Eigen::Index p = 0; p < nodes.rows(); ++p) {
      const Eigen::Index from = coarse.origins()[p];
      if (from < nodes.rows()) now.row(p) = nodes.row(from);
      if (from >= nodes.rows()) now.row(p) = at_samples.row(from - nodes.rows());
    }
    mesh::Boundary left{surface.nodes, coarse.triangles()};
    EXPECT_TRUE(is_closed(left));
    mesh::Points everywhere = mesh.nodes;
    for (Eigen::Index p = 0; p < now.rows(); ++p) everywhere.row(surface.nodes[p]) = now.row(p);
    EXPECT_NEAR(enclosed_volume(left, everywhere) / (0.4 * 0.1 * 0.04), 1, 0.01);
    std::set<std::uint32_t> waving, resting;
    for (const auto& triangle : left.triangles) {
      EXPECT_GE(min_angle_deg(now, triangle), 20);
      for (const std::uint32_t p : triangle) (now(p, 0) > 0.2 ? waving : resting).insert(p);
    }
    EXPECT_GT(waving.size(), (points == 400 ? 3 : 1) * resting.size()) << "few triangles must grow slowly";
    for (const mesh::SurfacePlace& place : coarse.places()) ASSERT_LT(place.triangle, left.triangles.size());
  }
  EXPECT_FALSE(coarse.reduce_to(3, true)) << "four points are the least that enclose something";
  EXPECT_TRUE(is_closed({surface.nodes, coarse.triangles()}));
}

TEST(Surface, AreaWeightsSumToOneAndFollowTheArea) {
  const mesh::TetMesh box = test::box_mesh({1, 1, 1}, {1, 1, 100});
  const mesh::Boundary surface = mesh::boundary_of(box);
  const std::vector<double> weights = mesh::area_weights(surface, box.nodes);
  double sum = 0;
  for (const double weight : weights) sum += weight;
  EXPECT_NEAR(sum, 1, 1e-14);
}

// Faces between two elements.
Eigen::Index inner_faces(const mesh::TetMesh& mesh) {
  std::map<std::array<int, 3>, int> seen;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (const auto& face : mesh::kTetFaces) {
      std::array<int, 3> nodes = {mesh.elements(e, face[0]), mesh.elements(e, face[1]), mesh.elements(e, face[2])};
      std::sort(nodes.begin(), nodes.end());
      ++seen[nodes];
    }
  }
  return std::count_if(seen.begin(), seen.end(), [](const auto& face) { return face.second == 2; });
}

TEST(Split, SplittingMakesEightOfEachAndIsTheSameBody) {
  for (int order = 1; order <= mesh::kMaxOrder; ++order) {
    const mesh::TetMesh coarse = test::bent(mesh::to_order(test::box_mesh({2, 2, 1}, kSize), order), 8);
    const mesh::TetMesh fine = mesh::split(coarse);
    EXPECT_EQ(fine.order(), order);
    ASSERT_EQ(fine.elements.rows(), 8 * coarse.elements.rows());
    const auto checked = mesh::check_mesh(fine, "fine");
    ASSERT_TRUE(checked) << checked.error().message;
    EXPECT_EQ(checked->flipped + checked->straightened + checked->unused_nodes, 0) << order;
    EXPECT_EQ(checked->pieces, 1);
    // Each edge, face and inside of the coarse mesh has the new nodes once: Euler's count of a ball is 1.
    const mesh::TetMesh corners = mesh::to_order(fine, 1), edges = mesh::to_order(corners, 2);
    const auto faces = 4 * fine.elements.rows() - inner_faces(fine);
    EXPECT_EQ(faces - inner_faces(fine), 4 * (4 * coarse.elements.rows() - 2 * inner_faces(coarse)));  // of the surface
    EXPECT_EQ(corners.nodes.rows() - (edges.nodes.rows() - corners.nodes.rows()) + faces - fine.elements.rows(), 1);
    const auto mass = [&](const mesh::TetMesh& m) {
      double sum = 0;
      for (Eigen::Index e = 0; e < m.elements.rows(); ++e)
        sum += fem::consistent_mass(mesh::nodes_of(m, e), 1000).sum();
      return sum;
    };
    EXPECT_NEAR(mass(fine) / mass(coarse), 1, 1e-12) << order;
  }
}

}  // namespace
}  // namespace ringdown::mesh_test
