#include "engine/mesh/surface.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/tet_shape.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>

namespace ringdown {
namespace {

const Eigen::Vector3d kSize(0.1, 0.08, 0.06);

// Gauss: a third of the sum of a . (b x c) / 2 over outward triangles.
double enclosed_volume(const mesh::Surface& surface, const mesh::Points& nodes) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Eigen::Vector3d p = nodes.row(surface.nodes[a]), q = nodes.row(surface.nodes[b]),
                          r = nodes.row(surface.nodes[c]);
    sum += p.dot(q.cross(r)) / 6;
  }
  return sum;
}

// In a closed, consistently turned surface every edge is walked once in each direction.
bool is_closed(const mesh::Surface& surface) {
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

TEST(CheckMesh, TurnsElementsThatAreInsideOut) {
  for (const bool quadratic : {false, true}) {
    mesh::TetMesh box = test::box_mesh({2, 2, 2}, kSize);
    if (quadratic) box = mesh::to_quadratic(box);
    mesh::TetMesh wrong = box;
    for (Eigen::Index e = 0; e < wrong.elements.rows(); e += 3) {
      wrong.elements.row(e).head<4>() = box.elements(e, {0, 1, 3, 2}).eval();
      if (quadratic) wrong.elements.row(e).tail<6>() = box.elements(e, {4, 8, 7, 6, 5, 9}).eval();
    }
    const auto checked = mesh::check_mesh(wrong, "wrong");
    ASSERT_TRUE(checked) << checked.error().message;
    EXPECT_EQ(checked->flipped, 16);
    EXPECT_EQ(checked->straightened, 0) << "edge nodes lie on the wrong edges";
    EXPECT_NEAR(enclosed_volume(mesh::boundary_surface(checked->mesh), checked->mesh.nodes), kSize.prod(), 1e-15);
  }
}

TEST(CheckMesh, StraightensCurvedElementsThatFold) {
  mesh::TetMesh box = mesh::to_quadratic(test::box_mesh({1, 1, 1}, kSize));
  box.nodes.row(box.elements(0, 4)) += Eigen::RowVector3d(0.5, 0.4, 0.3);
  const auto checked = mesh::check_mesh(box, "folded");
  ASSERT_TRUE(checked);
  EXPECT_GE(checked->straightened, 1);
  mesh::Nodes10 nodes;
  for (int a = 0; a < 10; ++a) nodes.row(a) = checked->mesh.nodes.row(checked->mesh.elements(0, a));
  EXPECT_TRUE(mesh::is_straight(nodes));
}

TEST(CheckMesh, DropsNodesThatNothingUses) {
  mesh::TetMesh box = test::box_mesh({1, 1, 1}, kSize);
  mesh::TetMesh padded = test::both({mesh::Points::Random(5, 3), mesh::Indices(0, 4)}, box);
  const auto checked = mesh::check_mesh(padded, "padded");
  ASSERT_TRUE(checked);
  EXPECT_EQ(checked->unused_nodes, 5);
  EXPECT_EQ(checked->mesh.nodes, box.nodes);
  EXPECT_EQ(checked->mesh.elements, box.elements);
}

TEST(CheckMesh, CountsPieces) {
  const mesh::TetMesh box = test::box_mesh({2, 1, 1}, kSize);
  mesh::TetMesh far = box;
  far.nodes.array() += 1;
  EXPECT_EQ(test::checked(box).pieces, 1);
  EXPECT_EQ(test::checked(test::both(box, far)).pieces, 2);
}

TEST(CheckMesh, RefusesWhatHasNoRightRepair) {
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
  EXPECT_NE(refusal(broken).find("element 1 has no volume"), std::string::npos);

  broken = box;
  broken.elements = mesh::Indices::Zero(1, 8);
  EXPECT_NE(refusal(broken).find("elements of 8 nodes"), std::string::npos);
}

TEST(Order, QuadraticAndBackIsTheSameMesh) {
  const mesh::TetMesh box = test::box_mesh({2, 1, 2}, kSize), quadratic = mesh::to_quadratic(box);
  const mesh::TetMesh back = mesh::to_linear(quadratic);
  EXPECT_EQ(back.nodes, box.nodes);
  EXPECT_EQ(back.elements, box.elements);
  // Euler: a node for every vertex and every edge, and V - E + F - T = 1 for a ball.
  const auto vertices = box.nodes.rows(), elements = box.elements.rows();
  const auto outer = static_cast<Eigen::Index>(mesh::boundary_surface(box).triangles.size());
  const Eigen::Index faces = (4 * elements + outer) / 2, edges = vertices + faces - elements - 1;
  EXPECT_EQ(quadratic.nodes.rows(), vertices + edges);
}

TEST(Surface, IsClosedAndFacesOutward) {
  const mesh::TetMesh box = test::box_mesh({3, 2, 2}, kSize);
  for (const mesh::TetMesh& mesh : {box, mesh::to_quadratic(box)}) {
    const mesh::Surface surface = mesh::boundary_surface(mesh);
    EXPECT_EQ(surface.triangles.size(), 2u * (2 * (3 * 2 + 3 * 2 + 2 * 2)));
    EXPECT_TRUE(is_closed(surface));
    EXPECT_NEAR(enclosed_volume(surface, mesh.nodes), kSize.prod(), 1e-15);
  }
}

TEST(Surface, DecimationKeepsToItsOwnPointsAndForm) {
  const mesh::TetMesh mesh = test::bent(test::box_mesh({24, 8, 4}, kSize), 5);
  const mesh::Surface surface = mesh::boundary_surface(mesh);
  const std::set<int> points(surface.nodes.begin(), surface.nodes.end());
  for (const std::size_t most : {8u, 50u, 120u}) {
    const auto smaller = mesh::decimate(surface, mesh.nodes, most);
    ASSERT_TRUE(smaller);
    EXPECT_LE(smaller->nodes.size(), most);
    EXPECT_GE(smaller->nodes.size(), most / 2);
    EXPECT_TRUE(std::all_of(smaller->nodes.begin(), smaller->nodes.end(), [&](int n) { return points.contains(n); }));
    EXPECT_TRUE(is_closed(*smaller));
    EXPECT_NEAR(enclosed_volume(*smaller, mesh.nodes), enclosed_volume(surface, mesh.nodes), 0.1 * kSize.prod());
  }
  EXPECT_EQ(mesh::decimate(surface, mesh.nodes, 100000)->nodes, surface.nodes);
}

TEST(Surface, AreaWeightsSumToOneAndFollowTheArea) {
  const mesh::TetMesh box = test::box_mesh({1, 1, 1}, {1, 1, 100});
  const mesh::Surface surface = mesh::boundary_surface(box);
  const std::vector<double> weights = mesh::area_weights(surface, box.nodes);
  double sum = 0;
  for (const double weight : weights) sum += weight;
  EXPECT_NEAR(sum, 1, 1e-14);
}

}  // namespace
}  // namespace ringdown
