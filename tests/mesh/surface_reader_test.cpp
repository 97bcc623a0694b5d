#include "engine/mesh/files/surface_file.h"

#include "engine/base/file_format.h"
#include "tests/mesh/sample_surfaces.h"
#include "tests/mesh/surface_files.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace ringdown {
namespace {

using test::TemporaryFolder;

std::string refusal(const std::filesystem::path& path) {
  const auto read = mesh::read_surface(path);
  return read ? "accepted" : read.error().message;
}

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// Every format gives back the points and triangles that went in, STL's repeated points welded.
TEST(SurfaceReader, EveryFormatGivesTheSameBody) {
  const TemporaryFolder folder;
  const auto cup = test::cup(0.04, 0.09, 0.003, 24);
  for (const std::string ending : {".obj", ".stl", "ascii.stl", ".ply", "ascii.ply", ".off", ".glb"}) {
    const auto read = mesh::read_surface(folder.write("cup" + ending, test::file_of(cup, ending)));
    ASSERT_TRUE(read) << ending << ": " << read.error().message;
    EXPECT_EQ(read->nodes.rows(), cup.nodes.rows()) << ending;
    ASSERT_EQ(read->triangles.rows(), cup.triangles.rows()) << ending;
    double farthest = 0;
    for (Eigen::Index t = 0; t < cup.triangles.rows(); ++t) {
      for (int i = 0; i < 3; ++i) {
        farthest =
            std::max(farthest, (read->nodes.row(read->triangles(t, i)) - cup.nodes.row(cup.triangles(t, i))).norm());
      }
    }
    EXPECT_LT(farthest, 1e-7) << ending;
  }
}

TEST(SurfaceReader, ObjMayHavePolygonsTextureCoordinatesAndNormals) {
  const TemporaryFolder folder;
  const auto read = mesh::read_surface(folder.write("box.obj", R"(v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
vt 0 0
vn 0 0 1
f 4/1/1 3/1/1 2/1/1 1/1/1
f 5//1 6//1 7//1 8//1
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f -8 -4 -1 -5
)"));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->nodes.rows(), 8);
  EXPECT_EQ(read->triangles.rows(), 12);
}

TEST(SurfaceReader, TransformsOfGltfNodesAreApplied) {
  const TemporaryFolder folder;
  const auto box = test::box({1, 2, 3}, {4, 6, 8});
  const auto read = mesh::read_surface(folder.write("box.glb", test::file_of(box, ".glb", 0.01)));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_LT((read->nodes.colwise().maxCoeff() - test::Vec(4, 6, 8)).norm(), 1e-5);
}

TEST(SurfaceReader, PointsWithinAMillionthOfTheDiagonalAreOne) {
  const TemporaryFolder folder;
  const auto cup = test::cup(0.04, 0.09, 0.003, 24);
  const auto near = mesh::read_surface(folder.write("near.stl", test::file_of(test::exploded(cup, 4e-8), ".stl")));
  EXPECT_EQ(near->nodes.rows(), cup.nodes.rows());
  const auto far = mesh::read_surface(folder.write("far.stl", test::file_of(test::exploded(cup, 4e-5), ".stl")));
  EXPECT_GT(far->nodes.rows(), 2 * cup.nodes.rows());
}

TEST(SurfaceReader, TheReaderRefusesWithOneSentence) {
  const TemporaryFolder folder;
  EXPECT_TRUE(says(refusal(folder.path() / "none.stl"), "there is no such file"));
  EXPECT_TRUE(says(refusal(folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")), "points.obj"));
  EXPECT_TRUE(says(refusal(folder.write("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nl 2 3\n")), "lines.obj"));
  EXPECT_TRUE(says(refusal(folder.write("noise.stl", "this is no surface")), "noise.stl"));
  EXPECT_TRUE(says(refusal(folder.write("empty.ply", "")), "empty.ply"));
  EXPECT_TRUE(says(refusal(folder.write("noise.glb", "glTF nonsense")), "noise.glb"));
  auto box = test::box({0, 0, 0}, {1, 1, 1});
  std::string cut = test::file_of(box, ".glb");
  cut.resize(cut.size() - 60);
  EXPECT_TRUE(says(refusal(folder.write("cut.glb", cut)), "was cut off"));
  EXPECT_TRUE(says(refusal(folder.write("cut.stl", test::file_of(box, ".stl").substr(0, 300))), "cut.stl"));
  box.nodes(3, 1) = std::nan("");
  EXPECT_TRUE(says(refusal(folder.write("nan.stl", test::file_of(box, ".stl"))), "not a finite number"));
  box.nodes.setZero();
  EXPECT_TRUE(says(refusal(folder.write("dot.ply", test::file_of(box, ".ply"))), "all its points coincide"));
}

TEST(SurfaceReader, EveryFormatOfSurfacesHasAReader) {
  const TemporaryFolder folder;
  std::size_t formats = 0;
  for (const FileFormat& format : file_formats()) {
    if (!mesh::is_surface_file("a" + std::string(format.ending))) continue;
    EXPECT_FALSE(says(refusal(folder.write("empty" + std::string(format.ending), "")), "not a surface file"))
        << format.ending;
    ++formats;
  }
  EXPECT_GE(formats, 6u);
  EXPECT_TRUE(says(refusal(folder.write("empty.veg", "")), "not a surface file"));
}

TEST(SurfaceReader, TheReaderKnowsItsFilesByTheirEndings) {
  EXPECT_TRUE(mesh::is_surface_file("a/b.STL"));
  EXPECT_TRUE(mesh::is_surface_file("cup.glb"));
  EXPECT_FALSE(mesh::is_surface_file("cup.msh"));
  EXPECT_FALSE(mesh::is_surface_file("stl"));
}

}  // namespace
}  // namespace ringdown
