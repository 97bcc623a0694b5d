// Files of surfaces as other programs and hands write them. Each holds a body whose volume is known by hand.
#include "engine/mesh/files/surface_file.h"
#include "tests/mesh/sample_surfaces.h"
#include "tests/mesh/surface_files.h"
#include "tests/mesh/surface_measure.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace ringdown {
namespace {

using test::TemporaryFolder;

// A box of 0.1 x 0.2 x 0.3.
constexpr double kVolume = 0.006;
const mesh::TriangleMesh& box() {
  static const mesh::TriangleMesh mesh = test::box({0, 0, 0}, {0.1, 0.2, 0.3});
  return mesh;
}

Result<mesh::TriangleMesh> read(const std::string& name, const std::string& content,
                                std::vector<std::string>* notes = nullptr) {
  const TemporaryFolder folder;
  return mesh::read_surface(folder.write(name, content), notes);
}

void expect_volume(const Result<mesh::TriangleMesh>& read, double volume, const std::string& what) {
  ASSERT_TRUE(read) << what << ": " << read.error().message;
  EXPECT_NEAR(test::volume_of(*read) / volume, 1, 1e-6) << what;
}

std::string refusal(const std::string& name, const std::string& content) {
  const auto mesh = read(name, content);
  return mesh ? "accepted" : mesh.error().message;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

const std::string kUglyObj = R"(# box

mtllib ../../no/such.mtl
o box
v .0 0. 0 # the first
v	.1 -0 +0
 v 1e-1 .2 0.
v 0 +2.E-1 0 1.0
v 0 0 3e-01 0.5 0.5 0.5
v +1e-1 0 .3
v 0.1 0.2 0.3
v 0 0.2 .3
vt 0.5 0.5
s off
g lid
f 4/1 3/1 2/1 1/1
f 5 6 7 8
f 1 2 6 \
  5
f 2// 3// 7// 6//
l 1 2
f -6 -5 -1 -2
f -8 -4 -1 -5
)";

TEST(UglyFiles, ObjAsHandsWriteIt) {
  const double volume = kVolume;
  expect_volume(read("a.obj", kUglyObj), volume, "\\n");
  expect_volume(read("a.OBJ", replaced(kUglyObj, "\n", "\r\n")), volume, "\\r\\n");
  expect_volume(read("a.obj", "\xEF\xBB\xBF" + replaced(kUglyObj, "# box\n", "")), volume, "byte order mark");
  std::string old = replaced(kUglyObj, " \\\n ", "");
  expect_volume(read("a.obj", replaced(old, "\n", "\r")), volume, "\\r");
  EXPECT_NE(refusal("a.obj", "v 0,1 0 0\n").find("line 1"), std::string::npos);
  EXPECT_NE(refusal("a.obj", "v 0 0\n").find("line 1"), std::string::npos);
  const std::string beyond = refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n");
  EXPECT_NE(beyond.find("line 5"), std::string::npos) << beyond;
  EXPECT_NE(beyond.find('3'), std::string::npos) << beyond;
  EXPECT_NE(refusal("a.obj", "v 0 0 0\nf 0 1 1\n").find("line 2"), std::string::npos);
  EXPECT_NE(refusal("a.obj", "v 0 0 0\nf -2 1 1\n").find("line 2"), std::string::npos);
}

// The letter L, also from a corner where a fan of triangles would leave it, with a point in the middle of a side.
TEST(UglyFiles, ConcavePolygonsAreCutInside) {
  const std::vector<std::array<double, 2>> letter = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {1, 3}, {0, 3}};
  const std::size_t n = letter.size();
  for (std::size_t first = 0; first < n; ++first) {
    std::string text, below = "f", above = "f", sides;
    for (const double z : {0.0, 0.5}) {
      for (const auto& [x, y] : letter)
        text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    }
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t at = (first + k) % n, next = (at + 1) % n;
      below += " " + std::to_string(1 + (2 * n + first - k) % n);
      above += " " + std::to_string(1 + n + at);
      sides += "f " + std::to_string(1 + at) + " " + std::to_string(1 + next) + " " + std::to_string(1 + n + next) +
               " " + std::to_string(1 + n + at) + "\n";
    }
    const auto mesh = read("l.obj", text + below + "\n" + above + "\n" + sides);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_NEAR(test::volume_of(*mesh), 4 * 0.5, 1e-12) << first;
    double area = 0;
    for (const auto& row : mesh->triangles.rowwise()) {
      const Eigen::RowVector3d a = mesh->nodes.row(row[0]), b = mesh->nodes.row(row[1]), c = mesh->nodes.row(row[2]);
      area += 0.5 * (b - a).cross(c - a).norm();
    }
    EXPECT_NEAR(area, 2 * 4 + 0.5 * 10, 1e-12) << first << ": no triangle leaves its polygon";
    EXPECT_EQ(mesh->triangles.rows(), static_cast<Eigen::Index>(4 * n - 4));
  }
}

std::string with_count(std::string stl, std::uint32_t count) {
  std::memcpy(stl.data() + 80, &count, sizeof count);
  return stl;
}

TEST(UglyFiles, StlOfAStreamIsReadByItsLength) {
  const std::string stl = test::file_of(box(), ".stl");
  for (const std::uint32_t count : {0u, 5u, 13u, 0xffffffffu}) {
    std::vector<std::string> notes;
    expect_volume(read("a.stl", with_count(stl, count), &notes), kVolume, std::to_string(count));
    ASSERT_EQ(notes.size(), 1u) << count;
    EXPECT_NE(notes[0].find(std::to_string(count)), std::string::npos) << notes[0];
    EXPECT_NE(notes[0].find("12"), std::string::npos) << notes[0];
  }
  std::vector<std::string> notes;
  expect_volume(read("a.stl", stl, &notes), kVolume, "right");
  EXPECT_TRUE(notes.empty());
  expect_volume(read("a.stl", stl + "tail"), kVolume, "a tail of four bytes");
  EXPECT_NE(refusal("a.stl", with_count(stl, 0) + "tail").find("cut off"), std::string::npos);
  EXPECT_NE(refusal("a.stl", stl.substr(0, 300)).find("cut off"), std::string::npos);
}

TEST(UglyFiles, StlIsTextOrBinaryByWhatItHolds) {
  std::string binary = test::file_of(box(), ".stl");
  std::memcpy(binary.data(), "solid facet", 11);
  expect_volume(read("a.stl", binary), kVolume, "binary that begins with solid");
  const std::string text = test::file_of(box(), "ascii.stl");
  std::string large = text;
  std::ranges::transform(large, large.begin(), [](unsigned char c) { return std::toupper(c); });
  expect_volume(read("a.STL", large), kVolume, "capitals");
  expect_volume(read("a.stl", replaced(text, "\n", "\r\n")), kVolume, "\\r\\n");
  expect_volume(read("a.stl", replaced(text, "\n", "\r")), kVolume, "\\r");
  expect_volume(read("a.stl", "\n\t" + replaced(text, "  ", "\t")), kVolume, "tabs");
  expect_volume(read("a.stl", "solid vertex of a box\n" + text.substr(text.find('\n') + 1)), kVolume, "name");
  EXPECT_NE(refusal("a.stl", text.substr(0, text.size() / 2)).find("line"), std::string::npos);
  EXPECT_NE(refusal("a.stl", replaced(text, "vertex 0", "vertex x")).find("line"), std::string::npos);
}

template <class Number>
void put_swapped(std::string& bytes, Number value) {
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), &value, sizeof value);
  bytes.append(raw.rbegin(), raw.rend());
}

TEST(UglyFiles, PlyOfAnyTypesInAnyOrder) {
  std::string big =
      "ply\r\nformat binary_big_endian 1.0\r\ncomment made by # a test\r\nelement camera 1\r\nproperty list "
      "ushort double trail\r\nelement face 12\r\nproperty uchar flag\r\nproperty list uint ushort "
      "vertex_index\r\nelement vertex 8\r\nproperty double z\r\nproperty short ignored\r\nproperty float "
      "x\r\nproperty double y\r\nend_header\r\n";
  put_swapped<std::uint16_t>(big, 2);
  put_swapped<double>(big, 1);
  put_swapped<double>(big, 2);
  for (const auto& row : box().triangles.rowwise()) {
    put_swapped<std::uint8_t>(big, 7);
    put_swapped<std::uint32_t>(big, 3);
    for (const std::int32_t corner : row) put_swapped<std::uint16_t>(big, static_cast<std::uint16_t>(corner));
  }
  for (const auto& at : box().nodes.rowwise()) {
    put_swapped<double>(big, at[2]);
    put_swapped<std::int16_t>(big, -3);
    put_swapped<float>(big, static_cast<float>(at[0]));
    put_swapped<double>(big, at[1]);
  }
  expect_volume(read("a.ply", big), kVolume, "big endian");
  EXPECT_NE(refusal("a.ply", big.substr(0, big.size() - 3)).find("vertex 7 of 8"), std::string::npos);
  const std::string text = test::file_of(box(), "ascii.ply");
  expect_volume(read("a.Ply", replaced(text, "\n", "\r\n")), kVolume, "\\r\\n");
  EXPECT_NE(refusal("a.ply", replaced(text, "format ascii", "format asci")).find("line 2"), std::string::npos);
  EXPECT_NE(refusal("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                    "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
                    "0\n0 1 0\n3 0 1 3\n")
                .find("point 3"),
            std::string::npos);
}

TEST(UglyFiles, OffWithColoursAndComments) {
  std::string text = "COFF 8 12 0 # counts in the first line\n";
  for (const auto& at : box().nodes.rowwise())
    text += std::to_string(at[0]) + " " + std::to_string(at[1]) + "\t" + std::to_string(at[2]) + " 255 0 0 255\n\n";
  for (const auto& row : box().triangles.rowwise())
    text +=
        "3 " + std::to_string(row[0]) + " " + std::to_string(row[1]) + " " + std::to_string(row[2]) + " 0.5 0.5 1\n";
  expect_volume(read("a.off", text), kVolume, "colours");
  expect_volume(read("a.off", replaced(text, "COFF 8", "8")), kVolume, "no header");
  EXPECT_NE(refusal("a.off", replaced(text, "COFF 8", "4OFF 8")).find("four coordinates"), std::string::npos);
  EXPECT_NE(refusal("a.off", replaced(text, "3 0 ", "3 8 ")).find("line"), std::string::npos);
}

// 32-bit floats near 10 km lie 1 mm apart: a box of 0.1 x 0.2 x 0.3 m may gain or lose 0.5 mm at each side.
TEST(UglyFiles, ABodyFarFromItsOriginSaysWhatRoundingMayCost) {
  const mesh::TriangleMesh far = test::moved(box(), {1e4, 0, 0});
  for (const char* ending : {".stl", ".ply"}) {
    std::vector<std::string> notes;
    ASSERT_TRUE(read(std::string("far") + ending, test::file_of(far, ending), &notes));
    ASSERT_EQ(notes.size(), 1u) << ending;
    EXPECT_NE(notes[0].find("1e+04"), std::string::npos) << notes[0];
    EXPECT_NE(notes[0].find("1.8 %"), std::string::npos) << notes[0];
    ASSERT_TRUE(read(std::string("near") + ending, test::file_of(box(), ending), &notes));
    EXPECT_TRUE(notes.empty()) << ending;
  }
  std::vector<std::string> notes;
  expect_volume(read("far.obj", test::file_of(far, ".obj"), &notes), kVolume, "text has as many digits as it has");
  EXPECT_TRUE(notes.empty());
}

}  // namespace
}  // namespace ringdown
