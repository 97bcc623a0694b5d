#include "engine/mesh/face_points.h"
#include "engine/mesh/gmsh_reader.h"

#include "tests/fem/sample_meshes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iomanip>
#include <numbers>
#include <sstream>
#include <utility>

namespace ringdown::gmsh_reader_test {
namespace {

using test::TemporaryFolder;

const char* const kBox = R"(SetFactory("OpenCASCADE");
DefineConstant[ side = 10, mesh_size = 4 ];
Box(1) = {0, 0, 0, side, side, side};
)";

double volume(const mesh::CheckedMesh& mesh) {
  return fem::assemble(mesh.mesh, fem::Elastic{1e9, 0.3, 1}, test::element_of(mesh.mesh))->node_mass.sum();
}

mesh::GmshOptions in_millimetres(std::map<std::string, double> parameters = {}) {
  return {.unit_m = 0.001, .mesh_size_m = 0.004, .order = 2, .parameters = std::move(parameters)};
}

std::string refusal(const std::filesystem::path& path, const mesh::GmshOptions& options = in_millimetres()) {
  const auto mesh = mesh::read_with_gmsh(path, options);
  return mesh ? "accepted" : mesh.error().message;
}

TEST(GmshReader, TheReaderMeshesAGeometryInItsUnit) {
  const TemporaryFolder folder;
  const auto mesh = mesh::read_with_gmsh(folder.write("box.geo", kBox), in_millimetres());
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->mesh.order(), 2);
  EXPECT_EQ(mesh->pieces, 1);
  EXPECT_NEAR(volume(*mesh), 1e-6, 1e-15);
}

TEST(GmshReader, TheReaderHandsOverParameters) {
  const TemporaryFolder folder;
  const auto path = folder.write("box.geo", kBox);
  const auto large = mesh::read_with_gmsh(path, in_millimetres({{"side", 20}}));
  ASSERT_TRUE(large) << large.error().message;
  EXPECT_NEAR(volume(*large), 8e-6, 1e-14);
  const auto standard = mesh::read_with_gmsh(path, in_millimetres());
  EXPECT_NEAR(volume(*standard), 1e-6, 1e-15) << "the last call's parameters are forgotten";
}

TEST(GmshReader, MeshSizeAndOrderAreObeyed) {
  const TemporaryFolder folder;
  const auto path = folder.write("box.geo", kBox);
  mesh::GmshOptions fine = in_millimetres();
  fine.mesh_size_m = 0.001;
  fine.order = 1;
  const auto coarse = mesh::read_with_gmsh(path, in_millimetres()), finer = mesh::read_with_gmsh(path, fine);
  EXPECT_GT(finer->mesh.elements.rows(), 3 * coarse->mesh.elements.rows());
  EXPECT_EQ(finer->mesh.order(), 1);
}

// With each order the error of the volume falls by more than ten, to what is left of chords of 40 degrees.
TEST(GmshReader, CurvedElementsFollowTheSphere) {
  const TemporaryFolder folder;
  const auto path = folder.write("ball.geo", "SetFactory(\"OpenCASCADE\"); Sphere(1) = {0, 0, 0, 10};");
  const double exact = 4.0 / 3 * std::numbers::pi * 1e-6;
  const std::array<double, mesh::kMaxOrder> max = {0.2, 2e-3, 5e-4, 2e-5};
  for (int order = 1; order <= mesh::kMaxOrder; ++order) {
    mesh::GmshOptions options = in_millimetres();
    options.order = order;
    const auto ball = mesh::read_with_gmsh(path, options);
    ASSERT_TRUE(ball) << ball.error().message;
    EXPECT_EQ(ball->mesh.order(), order);
    EXPECT_EQ(ball->straightened, 0);
    EXPECT_LT(std::abs(volume(*ball) / exact - 1), max[order - 1]) << order;
    if (order == 1) {
      EXPECT_LT(volume(*ball) / exact, 0.97);
    }
  }
}

// Elements as long as 80 degrees of the section lose 0.3 % of its volume, so bends are meshed again.
TEST(GmshReader, BendsGetSmallerElementsWhereTheMeshWouldLoseVolume) {
  const TemporaryFolder folder;
  const auto path = folder.write("ring.geo", "SetFactory(\"OpenCASCADE\"); Torus(1) = {0, 0, 0, 20, 8};");
  mesh::GmshOptions options = in_millimetres();
  options.mesh_size_m = 0.011;
  const auto ring = mesh::read_with_gmsh(path, options);
  ASSERT_TRUE(ring) << ring.error().message;
  EXPECT_NEAR(volume(*ring) / (2 * std::numbers::pi * std::numbers::pi * 0.02 * 0.008 * 0.008), 1, 2e-3);
  EXPECT_EQ(ring->gaps_m.size(), 0);
}

// The file itself says that a circle has three elements, of order 2; what they lack becomes a gap.
TEST(GmshReader, VolumeThatCannotBeWonBackIsStatedAsAGap) {
  const TemporaryFolder folder;
  const auto path = folder.write("rod.geo",
                                 "SetFactory(\"OpenCASCADE\"); Disk(1) = {0, 0, 0, 5}; Transfinite Curve{1} = 4;\n"
                                 "Extrude {0, 0, 30} { Surface{1}; Layers{ 3 }; }\n");
  mesh::GmshOptions options = in_millimetres();
  options.mesh_size_m = 0.01;
  const auto rod = mesh::read_with_gmsh(path, options);
  ASSERT_TRUE(rod) << rod.error().message;
  ASSERT_GT(rod->gaps_m.size(), 0);
  const double lost = std::numbers::pi * 0.005 * 0.005 * 0.03 - volume(*rod);
  EXPECT_GT(lost, 0.03 * volume(*rod));
  EXPECT_NEAR(rod->gaps_m.dot(mesh::face_points(rod->mesh).areas) / lost, 1, 1e-6);
}

// Without cuts of their mantles, gmsh does not come to an end with these within minutes.
TEST(GmshReader, SlenderConesAreMeshedToTheirTips) {
  const TemporaryFolder folder;
  struct Cone {
    double end_mm;  // the radius at the end of 100 mm; 5 mm at the beginning
    const char* rest;
  };
  for (const Cone& cone : {Cone{0, ""}, Cone{0.02, ""},
                           Cone{0,
                                "Box(9) = {-10, -10, -10, 20, 20, 10}; BooleanUnion{ "
                                "Volume{1}; Delete; }{ Volume{9}; Delete; }\n"}}) {
    const std::string text =
        "SetFactory(\"OpenCASCADE\");\nCone(1) = {0, 0, 0, 0, 0, 100, 5, " + std::to_string(cone.end_mm) + "};\n" +
        cone.rest + "Physical Volume(\"all\", 3) = {Volume{:}}; Physical Surface(\"skin\", 5) = {Surface{:}};\n";
    const auto mesh = mesh::read_with_gmsh(folder.write("cone.geo", text), in_millimetres());
    ASSERT_TRUE(mesh) << text << mesh.error().message;
    const double r = cone.end_mm, box = *cone.rest == 0 ? 0 : 4000;
    const double exact = 1e-9 * (std::numbers::pi * 100 * (25 + 5 * r + r * r) / 3 + box);
    EXPECT_NEAR(volume(*mesh) / exact, 1, 2e-3) << text;
    EXPECT_EQ(mesh->groups.volumes, std::vector<std::string>{"all"}) << text;
    EXPECT_TRUE(std::ranges::all_of(mesh->groups.volume_of, [](std::int32_t group) { return group == 0; })) << text;
    ASSERT_EQ(mesh->groups.surfaces.size(), 1u) << text;
  }
}

// A block of 100 x 80 x 6; only the statement that follows may use mesh_size.
TEST(GmshReader, WhetherAMeshDependsOnItsFilesMeshSizeIsTried) {
  const TemporaryFolder folder;
  const std::string box =
      "SetFactory(\"OpenCASCADE\"); DefineConstant[ mesh_size = 2 ];\nBox(1) = {0, 0, 0, 100, 80, 6};\n";
  const std::string sheet =
      "SetFactory(\"OpenCASCADE\"); DefineConstant[ mesh_size = 2 ];\nRectangle(1) = {0, 0, 0, 100, 80};\n";
  const std::pair<std::string, bool> kFiles[] = {
      {box, false},
      {box + "h = 2 * mesh_size; Printf(\"%g\", mesh_size); // mesh_size\n", false},
      {box + "MeshSize{ PointsOf{ Volume{1}; } } = mesh_size;\n", true},
      {box + "h = mesh_size; n = Ceil(100 / h) + 1; Transfinite Curve{9} = n;\n", true},
      {box + "Mesh.MeshSizeMax = mesh_size;\n", true},
      {box + "Field[1] = MathEval; Field[1].F = Sprintf(\"%g + x / 8\", mesh_size); Background Field = 1;\n", true},
      {sheet + "Extrude {0, 0, 6} { Surface{1}; Layers{ Ceil(6 / mesh_size) }; }\n", true},
      {sheet + "Extrude {0, 0, 6} { Surface{1}; Layers{ 3 }; }\n", false},
  };
  for (const auto& [text, depends] : kFiles) {
    const auto path = folder.write("block.geo", text);
    EXPECT_EQ(mesh::depends_on_mesh_size(path, {.unit_m = 0.001, .parameters = {}}, 0.128), depends) << text;
  }
}

TEST(GmshReader, TheSameFileGivesTheSameMesh) {
  const TemporaryFolder folder;
  const auto path = folder.write("box.geo", kBox);
  const auto first = mesh::read_with_gmsh(path, in_millimetres()),
             second = mesh::read_with_gmsh(path, in_millimetres());
  EXPECT_TRUE(first->mesh.nodes == second->mesh.nodes);
  EXPECT_TRUE(first->mesh.elements == second->mesh.elements);
}

TEST(GmshReader, TheReaderReadsAMeshAsItIs) {
  const TemporaryFolder folder;
  const auto path = folder.write("one.msh", R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
$EndNodes
$Elements
1
1 4 2 1 1 1 2 3 4
$EndElements
)");
  const auto mesh = mesh::read_with_gmsh(path, {.mesh_size_m = 0.01, .parameters = {}});
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->mesh.elements.rows(), 1);
  EXPECT_EQ(mesh->mesh.order(), 1);
  EXPECT_NEAR(volume(*mesh), 1.0 / 6, 1e-15);
}

// gmsh's order of 20 nodes, from its manual: inner nodes of the edges 01 12 20 30 32 31, middles of the faces 021 013
// 032 312.
TEST(GmshReader, TheReaderReadsAMeshOfHigherOrder) {
  const std::array<std::array<int, 2>, 6> edges = {{{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}}};
  const std::array<std::array<int, 3>, 4> faces = {{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {3, 1, 2}}};
  mesh::Corners corners;
  corners << 0, 0, 0, 3, 0, 0, 1, 2, 0, 0, 1, 2;
  std::vector<Eigen::RowVector3d> nodes;
  for (int i = 0; i < 4; ++i) nodes.emplace_back(corners.row(i));
  for (const auto& [a, b] : edges) {
    nodes.emplace_back((2 * corners.row(a) + corners.row(b)) / 3);
    nodes.emplace_back((corners.row(a) + 2 * corners.row(b)) / 3);
  }
  for (const auto& [a, b, c] : faces) nodes.emplace_back((corners.row(a) + corners.row(b) + corners.row(c)) / 3);
  std::ostringstream file;
  file << std::setprecision(17) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n20\n";
  for (int n = 0; n < 20; ++n) file << n + 1 << ' ' << nodes[n] << '\n';
  file << "$EndNodes\n$Elements\n1\n1 29 2 1 1";
  for (int n = 0; n < 20; ++n) file << ' ' << n + 1;
  file << "\n$EndElements\n";

  const TemporaryFolder folder;
  const auto mesh = mesh::read_with_gmsh(folder.write("cubic.msh", file.str()), {.parameters = {}});
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->mesh.order(), 3);
  EXPECT_EQ(mesh->straightened, 0);
  EXPECT_LT((mesh::nodes_of(mesh->mesh, 0) - mesh::reference_nodes(3) * corners).norm(), 1e-14);
  EXPECT_NEAR(volume(*mesh), 2, 1e-13);
}

TEST(GmshReader, TheReaderRefusesWithOneSentence) {
  const TemporaryFolder folder;
  EXPECT_NE(refusal(folder.path() / "none.msh").find("there is no such file"), std::string::npos);
  EXPECT_NE(refusal(folder.write("bad.geo", "Box(1) = {0, 0,;\n")).find("bad.geo"), std::string::npos);
  EXPECT_NE(refusal(folder.write("bad2.geo", "Point(1) = {nowhere, 0, 0};\n")).find("nowhere"), std::string::npos);
  EXPECT_NE(refusal(folder.write("bad.msh", "this is no mesh")).find("bad.msh"), std::string::npos);
  EXPECT_NE(refusal(folder.write("flat.geo", "SetFactory(\"OpenCASCADE\"); Rectangle(1) = {0, 0, 0, 1, 1};"))
                .find("no tetrahedra"),
            std::string::npos);
  EXPECT_NE(refusal(folder.write("box.geo", kBox), in_millimetres({{"hight", 3}})).find("no parameter 'hight'"),
            std::string::npos);
  EXPECT_NE(refusal(folder.write("brick.geo", R"(SetFactory("Built-in");
Point(1) = {0, 0, 0}; e1[] = Extrude {1, 0, 0} { Point{1}; Layers{1}; };
e2[] = Extrude {0, 1, 0} { Curve{e1[1]}; Layers{1}; Recombine; };
Extrude {0, 0, 1} { Surface{e2[1]}; Layers{1}; Recombine; }
)"))
                .find("Hexahedron"),
            std::string::npos);
  mesh::GmshOptions dust = in_millimetres();
  dust.mesh_size_m = 1e-6;
  EXPECT_NE(refusal(folder.write("box.geo", kBox), dust).find("far too small"), std::string::npos);
  mesh::GmshOptions no_unit = in_millimetres();
  no_unit.unit_m = 0;
  EXPECT_NE(refusal(folder.write("box.geo", kBox), no_unit).find("unit"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::gmsh_reader_test
