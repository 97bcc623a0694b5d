// One mesh in every format that gmsh writes: each is read back as the same body.
#include "engine/bake/bake.h"
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
