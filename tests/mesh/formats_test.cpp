// One mesh in every format that gmsh writes: each is read back as the same body.
#include "engine/bake/bake.h"
#include "engine/base/file_format.h"
#include "engine/mesh/body_reader.h"
#include "engine/mesh/gmsh_reader.h"
#include "tests/support/temporary_folder.h"

#include <gmsh.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace ringdown {
namespace {

struct Format {
  const char *name, *file;
  double version = 4.1;
  bool binary = false;
};

constexpr Format kFormats[] = {
    {"msh 2.2", "a22.msh", 2.2},
    {"msh 2.2 binary", "b22.msh", 2.2, true},
    {"msh 4.1", "a41.msh"},
    {"msh 4.1 binary", "b41.msh", 4.1, true},
    {"Medit", "a.mesh"},
    {"VTK", "a.vtk"},
    {"VTK binary", "b.vtk", 4.1, true},
    {"I-deas", "a.unv"},
    {"Abaqus", "a.inp"},
};

void write(const std::filesystem::path& folder, int order) {
  const mesh::GmshSession session;
  gmsh::model::add("body");
  gmsh::model::occ::addBox(0, 0, 0, 0.1, 0.08, 0.06);
  gmsh::model::occ::synchronize();
  gmsh::model::addPhysicalGroup(3, {1}, 1);
  gmsh::option::setNumber("Mesh.MeshSizeMax", 0.05);
  gmsh::model::mesh::generate(3);
  gmsh::model::mesh::setOrder(order);
  for (const Format& format : kFormats) {
    gmsh::option::setNumber("Mesh.MshFileVersion", format.version);
    gmsh::option::setNumber("Mesh.Binary", format.binary ? 1 : 0);
    gmsh::write((folder / format.file).string());
  }
}

std::vector<double> notes_of(const mesh::CheckedMesh& mesh) {
  const modal::Material ceramic{"ceramic", 70e9, 0.22, 2400, {5, 1e-8}};
  bake::BakeOptions options;
  options.element = fem::Element::kTet10;
  options.band_high_hz = 35e3;
  options.points = 40;
  const auto baked = bake::bake(mesh, ceramic, options, "body");
  if (!baked) return {};
  std::vector<double> notes = baked->bank.frequency_hz;
  std::sort(notes.begin(), notes.end());
  return notes;
}

TEST(Formats, FilesOfOneBodyBakeToTheSameFrequencies) {
  for (const int order : {1, 2}) {
    const test::TemporaryFolder folder;
    write(folder.path(), order);
    std::vector<double> right;
    for (const Format& format : kFormats) {
      if (order == 2 && std::string(format.name) == "Medit") continue;  // gmsh writes the corners only
      const auto body = mesh::BodyReader(folder.path() / format.file).read({.parameters = {}});
      // gmsh 4.13 reads no binary VTK, not even its own; 4.8 reads that of both.
      if (!body && std::string(format.name) == "VTK binary" && GMSH_API_VERSION_MINOR >= 13) continue;
      if (!body) {
        ADD_FAILURE() << format.name << ", order " << order << ": " << body.error().message;
        continue;
      }
      EXPECT_EQ(body->making, mesh::Making::kRead);
      EXPECT_EQ(body->mesh.mesh.order(), order) << format.name;
      const std::vector<double> notes = notes_of(body->mesh);
      if (right.empty()) right = notes;
      ASSERT_EQ(notes.size(), right.size()) << format.name;
      ASSERT_GT(notes.size(), 5u);
      for (std::size_t i = 0; i < notes.size(); ++i) EXPECT_NEAR(notes[i] / right[i], 1, 1e-6) << format.name;
    }
  }
}

// Of a ball, nodes exchanged on edges show.
TEST(Formats, AnAbaqusDeckOfABallIsTheMeshOfItsMsh) {
  constexpr double kWritten = 1e-15;  // [m]: gmsh writes 14 digits, of at most 0.08 m
  for (const int order : {1, 2}) {
    const test::TemporaryFolder folder;
    {
      const mesh::GmshSession session;
      gmsh::model::add("ball");
      gmsh::model::occ::addSphere(0.01, 0.02, 0.03, 0.05);
      gmsh::model::occ::synchronize();
      gmsh::option::setNumber("Mesh.MeshSizeMax", 0.04);
      gmsh::model::mesh::generate(3);
      gmsh::model::mesh::setOrder(order);
      gmsh::write((folder.path() / "ball.msh").string());
      gmsh::write((folder.path() / "ball.inp").string());
    }
    const auto msh = mesh::BodyReader(folder.path() / "ball.msh").read({.parameters = {}});
    const auto inp = mesh::BodyReader(folder.path() / "ball.inp").read({.parameters = {}});
    ASSERT_TRUE(msh) << msh.error().message;
    ASSERT_TRUE(inp) << inp.error().message;
    EXPECT_EQ(inp->mesh.mesh.order(), order);
    EXPECT_EQ(inp->mesh.straightened, 0);
    ASSERT_EQ(inp->mesh.mesh.nodes.rows(), msh->mesh.mesh.nodes.rows());
    ASSERT_EQ(inp->mesh.mesh.elements.rows(), msh->mesh.mesh.elements.rows());
    for (Eigen::Index e = 0; e < inp->mesh.mesh.elements.rows(); ++e) {
      const double far_m = (nodes_of(inp->mesh.mesh, e) - nodes_of(msh->mesh.mesh, e)).cwiseAbs().maxCoeff();
      EXPECT_LT(far_m, kWritten) << "element " << e;
    }
    const std::vector<double> notes = notes_of(inp->mesh), right = notes_of(msh->mesh);
    ASSERT_EQ(notes.size(), right.size());
    ASSERT_GT(notes.size(), 5u);
    for (std::size_t i = 0; i < notes.size(); ++i) EXPECT_NEAR(notes[i] / right[i], 1, 1e-9) << i;
  }
}

TEST(Formats, AUniversalFileSaysItsUnit) {
  const test::TemporaryFolder folder;
  EXPECT_DOUBLE_EQ(mesh::unit_in_file(folder.write("mm.unv", R"(    -1
   164
         5mm (milli-newton)           2
  1.0000000000000000D+03  1.0000000000000000D+03  1.0000000000000000D+00
  2.7314999999999998D+02
    -1
)")),
                   0.001);
  EXPECT_EQ(mesh::unit_in_file(folder.write("silent.unv", "    -1\n  2411\n    -1\n")), 1);
  EXPECT_EQ(mesh::unit_in_file("part.step"), 0.001);
  EXPECT_EQ(mesh::unit_in_file("part.stl"), 1);
}

// Every element is in one of the three partitions, and in none twice.
TEST(Formats, PartitionsOfAMeshAreOneBodyWithItsGroups) {
  const test::TemporaryFolder folder;
  std::size_t elements = 0;
  {
    const mesh::GmshSession session;
    gmsh::model::add("body");
    gmsh::model::occ::addBox(0, 0, 0, 0.2, 0.04, 0.02);
    gmsh::model::occ::synchronize();
    gmsh::model::addPhysicalGroup(3, {1}, 7);
    gmsh::model::setPhysicalName(3, 7, "steel");
    gmsh::option::setNumber("Mesh.MeshSizeMax", 0.02);
    gmsh::model::mesh::generate(3);
    std::vector<std::size_t> tags, nodes;
    gmsh::model::mesh::getElementsByType(4, tags, nodes);
    elements = tags.size();
    gmsh::model::mesh::partition(3);
    for (const Format& format : kFormats) {
      if (!std::string(format.name).starts_with("msh")) continue;
      gmsh::option::setNumber("Mesh.MshFileVersion", format.version);
      gmsh::option::setNumber("Mesh.Binary", format.binary ? 1 : 0);
      gmsh::write((folder.path() / format.file).string());
    }
  }
  // Two tetrahedra of the elementary entity 1 without a group, in the partitions 1 and 2.
  const auto old = folder.write("old.msh", R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
5
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 1 1 1
$EndNodes
$Elements
2
1 4 4 0 1 1 1 1 2 3 4
2 4 4 0 1 1 2 2 3 4 5
$EndElements
)");
  const auto halves = mesh::BodyReader(old).read({.parameters = {}});
  ASSERT_TRUE(halves) << halves.error().message;
  EXPECT_EQ(halves->mesh.mesh.elements.rows(), 2);
  for (const Format& format : kFormats) {
    if (!std::string(format.name).starts_with("msh")) continue;
    const auto body = mesh::BodyReader(folder.path() / format.file).read({.parameters = {}});
    ASSERT_TRUE(body) << format.name << ": " << body.error().message;
    EXPECT_EQ(body->mesh.mesh.elements.rows(), static_cast<Eigen::Index>(elements)) << format.name;
    EXPECT_EQ(body->mesh.duplicates, 0) << format.name;
    EXPECT_NEAR(mesh::volume_of(body->mesh.mesh) / (0.2 * 0.04 * 0.02), 1, 1e-12) << format.name;
    EXPECT_EQ(body->mesh.groups.volumes, std::vector<std::string>{"steel"}) << format.name;
  }
}

// Unit, making and mesh are those of the small letters.
TEST(Formats, EndingsMeanTheSameInAnyLetters) {
  const test::TemporaryFolder folder;
  const auto body = [&](const std::string& name) {
    mesh::GmshOptions options{.mesh_size_m = 0.05, .order = 1, .parameters = {}};
    if (has_ending(name, ".brep")) options.unit_m = 0.001;
    return mesh::BodyReader(folder.path() / name).read(options);
  };
  {
    const mesh::GmshSession session;
    gmsh::model::add("body");
    gmsh::model::occ::addBox(0, 0, 0, 100, 80, 60);
    gmsh::model::occ::synchronize();
    for (const char* name : {"a.step", "a.stp", "a.brep"}) gmsh::write((folder.path() / name).string());
    gmsh::model::mesh::generate(3);
    for (const char* name : {"a.vtk", "a.unv", "a.mesh", "a.msh"}) gmsh::write((folder.path() / name).string());
  }
  static_cast<void>(folder.write("a.geo", "SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 0.1, 0.08, 0.06};\n"));
  const auto renamed = [&](const std::string& name, const std::string& to) {
    std::filesystem::copy_file(folder.path() / name, folder.path() / to);
    return body(to);
  };
  const std::pair<const char*, std::vector<const char*>> kNames[] = {{"a.step", {"B.STEP", "b.Step"}},
                                                                     {"a.stp", {"B.STP", "b.Stp"}},
                                                                     {"a.brep", {"B.BREP", "b.Brep"}},
                                                                     {"a.geo", {"B.GEO", "b.Geo"}},
                                                                     {"a.msh", {"B.MSH", "b.Msh"}},
                                                                     {"a.vtk", {"B.VTK"}},
                                                                     {"a.unv", {"B.UNV"}},
                                                                     {"a.mesh", {"B.MESH"}}};
  for (const auto& [small, others] : kNames) {
    const auto right = body(small);
    ASSERT_TRUE(right) << small << ": " << right.error().message;
    for (const char* name : others) {
      const auto other = renamed(small, name);
      ASSERT_TRUE(other) << name << ": " << other.error().message;
      EXPECT_EQ(other->making, right->making) << name;
      EXPECT_EQ(other->mesh.mesh.nodes, right->mesh.mesh.nodes) << name;
      EXPECT_EQ(mesh::unit_in_file(name), mesh::unit_in_file(small)) << name;
    }
  }
  const auto mixed = renamed("a.vtk", "b.Vtk");
  ASSERT_FALSE(mixed);
  EXPECT_NE(mixed.error().message.find("rename"), std::string::npos) << mixed.error().message;
}

TEST(Formats, AnUnknownFormatIsRefusedWithThoseThatAreRead) {
  const test::TemporaryFolder folder;
  for (const char* name : {"cup.3mf", "cup.blend", "cup.amf", "cup.usda", "cup.vtu", "cup.fbx", "cup.stl.gz", "cup.dae",
                           "cup.x3d", "cup", "cup.", ".stl"}) {
    const auto body = mesh::BodyReader(folder.write(name, "v300 is (no) script")).read({.parameters = {}});
    ASSERT_FALSE(body) << name;
    EXPECT_EQ(body.error().kind, ErrorKind::bad_input);
    for (const char* word : {name, "not in a format", ".stl", ".step", ".msh", "export it as glTF, OBJ, STL or PLY"})
      EXPECT_NE(body.error().message.find(word), std::string::npos) << body.error().message;
  }
}

// gmsh writes STEP in millimetres, whatever its numbers meant; 100 of them come back as 0.1 m.
TEST(Formats, StepIsReadInTheUnitItSays) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "block.step";
  {
    const mesh::GmshSession session;
    gmsh::model::add("body");
    gmsh::model::occ::addBox(0, 0, 0, 100, 80, 60);
    gmsh::model::occ::synchronize();
    gmsh::write(path.string());
  }
  const auto body = mesh::BodyReader(path).read({.mesh_size_m = 0.05, .order = 1, .parameters = {}});
  ASSERT_TRUE(body) << body.error().message;
  EXPECT_NEAR(body->mesh.mesh.nodes.col(0).maxCoeff(), 0.1, 1e-12);
}

}  // namespace
}  // namespace ringdown
