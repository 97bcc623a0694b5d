// Meshes with faults: what has one right repair is repaired, counted, and bakes like the sound mesh; the rest is
// refused, and the sentence says what and where.
#include "tests/stress/claims.h"
#include "tests/stress/hard_meshes.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace ringdown {
namespace {

mesh::TetMesh solid_block() { return test::box_mesh({3, 2, 2}, {0.1, 0.08, 0.06}); }

mesh::TetMesh with_element(mesh::TetMesh mesh, const std::vector<std::int32_t>& nodes) {
  const Eigen::Index count = mesh.elements.rows();
  mesh.elements.conservativeResize(count + 1, mesh.elements.cols());
  for (std::size_t a = 0; a < nodes.size(); ++a) mesh.elements(count, static_cast<Eigen::Index>(a)) = nodes[a];
  return mesh;
}

// Repaired ------------------------------------------------------------------------------------------------------------

struct Repair {
  const char* name;
  std::function<void(mesh::TetMesh&)> spoil;
  int flipped = 0, unused_nodes = 0, duplicates = 0;
};

void PrintTo(const Repair& repair, std::ostream* out) { *out << repair.name; }

void add_loose_nodes(mesh::TetMesh& mesh) {
  mesh = test::both({mesh::Points::Constant(7, 3, 0.5), mesh::Indices(0, mesh.elements.cols())}, mesh);
}

void turn_every_third(mesh::TetMesh& mesh) {
  for (Eigen::Index e = 0; e < mesh.elements.rows(); e += 3) std::swap(mesh.elements(e, 2), mesh.elements(e, 3));
}

void repeat_five(mesh::TetMesh& mesh) {
  for (int e = 0; e < 5; ++e) {
    mesh = with_element(mesh, {mesh.elements(e, 1), mesh.elements(e, 2), mesh.elements(e, 0), mesh.elements(e, 3)});
  }
}

const std::vector<Repair> kRepairs = {
    {.name = "unreferenced nodes", .spoil = add_loose_nodes, .unused_nodes = 7},
    {.name = "inverted elements", .spoil = turn_every_third, .flipped = 24},
    {.name = "duplicate elements", .spoil = repeat_five, .duplicates = 5},
    {.name = "all three",
     .spoil = [](mesh::TetMesh& mesh) { turn_every_third(mesh), repeat_five(mesh), add_loose_nodes(mesh); },
     .flipped = 26,
     .unused_nodes = 7,
     .duplicates = 5},
};

class FaultyMesh : public testing::TestWithParam<Repair> {};
INSTANTIATE_TEST_SUITE_P(Stress, FaultyMesh, testing::ValuesIn(kRepairs));

TEST_P(FaultyMesh, AFaultyMeshIsRepairedCountedAndSoundsLikeTheSoundOne) {
  mesh::TetMesh spoiled = solid_block();
  GetParam().spoil(spoiled);
  const auto checked = mesh::check_mesh(spoiled, "spoiled");
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_EQ(checked->flipped, GetParam().flipped);
  EXPECT_EQ(checked->unused_nodes, GetParam().unused_nodes);
  EXPECT_EQ(checked->duplicates, GetParam().duplicates);
  EXPECT_EQ(checked->pieces, 1);
  test::expect_like({.name = GetParam().name,
                     .hard = std::to_string(checked->flipped) + " turned, " + std::to_string(checked->duplicates) +
                             " copies and " + std::to_string(checked->unused_nodes) + " nodes dropped",
                     .mesh = checked->mesh,
                     .limit = 1e-9,
                     .oracle = "the sound mesh"},
                    solid_block(), 40e3);
}

// Refused -------------------------------------------------------------------------------------------------------------

struct Fault {
  const char* name;
  const char* hard;
  std::function<mesh::TetMesh()> mesh;
  std::vector<std::string> words;  // of the sentence
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

// The block with one thing changed.
template <class Change>
std::function<mesh::TetMesh()> spoiled(Change change) {
  return [change] {
    mesh::TetMesh mesh = solid_block();
    change(mesh);
    return mesh;
  };
}

// A node pushed through the opposite faces of its elements, some of which turn inside out and are turned back.
void tangle(mesh::TetMesh& mesh) {
  const Eigen::RowVector3d middle(0.1 / 3, 0.04, 0.03);
  for (auto node : mesh.nodes.rowwise()) {
    if ((node - middle).norm() < 1e-9) node[0] += 0.1;
  }
}

// The last element gets corners of its own at one of its faces' other nodes: the faces' edges are not shared.
mesh::TetMesh unmerged_edges() {
  mesh::TetMesh mesh = mesh::to_order(solid_block(), 2);
  const auto nodes = static_cast<std::int32_t>(mesh.nodes.rows());
  mesh.nodes.conservativeResize(nodes + 6, 3);
  for (int k = 0; k < 6; ++k) {
    mesh.nodes.row(nodes + k) = mesh.nodes.row(mesh.elements(30, 4 + k)).eval();
    mesh.elements(30, 4 + k) = nodes + k;
  }
  return mesh;
}

const double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

const std::vector<Fault> kFaults = {
    {"no element",
     "0 elements",
     spoiled([](auto& m) { m.elements.resize(0, 4); }),
     {"no tetrahedra", "mesh its volume"}},
    {"node out of range",
     "one past the last",
     spoiled([](auto& m) { m.elements(3, 2) = m.nodes.rows(); }),
     {"element 3 names node 36", "only 36"}},
    {"negative node", "-1", spoiled([](auto& m) { m.elements(3, 2) = -1; }), {"element 3 names node -1"}},
    {"NaN coordinate", "of one node", spoiled([](auto& m) { m.nodes(5, 1) = kNaN; }), {"node 5", "not a finite"}},
    {"infinite coordinate",
     "of one node",
     spoiled([](auto& m) { m.nodes(5, 1) = kInfinity; }),
     {"node 5", "not a finite"}},
    {"no volume",
     "four corners in a plane",
     spoiled([](auto& m) { m.nodes.col(2).setZero(); }),
     {"element 0 has no volume", "mesh the object again"}},
    {"repeated node",
     "one corner twice",
     spoiled([](auto& m) { m.elements(1, 3) = m.elements(1, 2); }),
     {"element 1 names node", "twice"}},
    {"repeated edge node",
     "of a 10-node element",
     [] {
       mesh::TetMesh mesh = mesh::to_order(solid_block(), 2);
       mesh.elements(1, 8) = mesh.elements(1, 5);
       return mesh;
     },
     {"element 1 names node", "twice"}},
    {"tangled mesh", "a node pulled through faces", spoiled(tangle), {"elements overlap", "tangled"}},
    {"three at a face",
     "an element too many",
     spoiled([](auto& m) {
       const auto corners = m.elements.row(0).eval();
       m.nodes.conservativeResize(m.nodes.rows() + 1, 3);
       m.nodes.row(m.nodes.rows() - 1).setConstant(0.2);
       for (const auto& [a, b, c] : mesh::kTetFaces) {
         m = with_element(m, {corners[a], corners[b], corners[c], static_cast<int>(m.nodes.rows()) - 1});
       }
     }),
     {"elements overlap"}},
    {"unmerged edge nodes", "corners shared, edges not", unmerged_edges, {"share the corners", "merge the nodes"}},
    {"the same body twice",
     "with nodes of its own",
     spoiled([](auto& m) { m = test::both(m, m); }),
     {"elements overlap at", "appears twice"}},
    {"bodies in each other",
     "two blocks, half a cell apart",
     spoiled([](auto& m) {
       mesh::TetMesh other = m;
       other.nodes.col(0).array() += 0.09;
       m = test::both(m, other);
     }),
     {"elements overlap at", "bodies intersect"}},
    {"hinge at an edge",
     "two cubes share an edge",
     [] {
       return test::cubes({{0, 0, 0}, {1, 1, 0}});
     },
     {"touch only along an edge from (0.1, 0.1, 0) m to (0.1, 0.1, 0.1) m", "hinge"}},
    {"hinge at a point",
     "two cubes share a vertex",
     [] {
       return test::cubes({{0, 0, 0}, {1, 1, 1}});
     },
     {"touch only in the point (0.1, 0.1, 0.1) m"}},
    {"touches itself at an edge",
     "whole without it",
     [] {
       return test::cubes({{0, 0, 0},
                           {1, 0, 0},
                           {0, 1, 0},
                           {1, 1, 0},
                           {0, 0, 1},
                           {1, 1, 1},
                           {0, 0, 2},
                           {1, 0, 2},
                           {0, 1, 2},
                           {1, 1, 2}});
     },
     {"touch only along an edge from (0.1, 0.1, 0.1) m to (0.1, 0.1, 0.2) m"}},
    {"touches itself at a vertex",
     "whole without it",
     [] {
       return test::cubes({{1, 1, 1}, {0, 1, 1}, {0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}, {2, 2, 3}, {2, 2, 2}});
     },
     {"touch only in the point (0.2, 0.2, 0.2) m"}},
    {"far from the origin",
     "0.14 m long, 1000 km away",
     spoiled([](auto& m) { m.nodes.array() += 1e6; }),
     {"0.141 m long", "1e+06 m from the origin", "move it"}},
    {"flat to rounding",
     "slivers of 1e-6 degree in a plate 1:500",
     [] {
       return test::box_with_slivers({5, 5, 2}, {0.5, 0.5, 0.001}, 1e-6);
     },
     {"cannot be told from rigid motions", "too flat"}},
};

class WrongMesh : public testing::TestWithParam<Fault> {};
INSTANTIATE_TEST_SUITE_P(Stress, WrongMesh, testing::ValuesIn(kFaults));

TEST_P(WrongMesh, AWrongMeshIsRefusedWithASentenceThatSaysWhatAndWhere) {
  test::expect_refused(GetParam().name, GetParam().hard, GetParam().mesh(), test::kSteel, GetParam().words);
}

// What stands beside the refused ones and is sound.
TEST(Joints, BodiesThatMeetInFacesPass) {
  EXPECT_TRUE(mesh::check_mesh(test::cubes({{0, 0, 0}, {1, 0, 0}}), "two cubes"));
  EXPECT_TRUE(mesh::check_mesh(test::cubes({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}), "three in a corner"));
  const auto apart = mesh::check_mesh(test::cubes({{0, 0, 0}, {2, 0, 0}}), "apart");
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->pieces, 2);
  std::vector<std::array<int, 3>> around_a_void;
  for (int cell = 0; cell < 27; ++cell) {
    if (cell != 13) around_a_void.push_back({cell % 3, cell / 3 % 3, cell / 9});
  }
  EXPECT_TRUE(mesh::check_mesh(test::cubes(around_a_void), "a void inside"));
  for (int order = 1; order <= 4; ++order) {
    EXPECT_TRUE(mesh::check_mesh(test::hollow_sphere(0.05, 0.1, 1, order), "a hollow sphere"));
  }
}

}  // namespace
}  // namespace ringdown
