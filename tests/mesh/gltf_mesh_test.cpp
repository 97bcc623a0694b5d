// A box of 0.2 x 0.04 x 0.02 m in all the ways in which glTF can say where a mesh is. What must come out is known by
// hand.
#include "engine/mesh/files/surface_file.h"
#include "tests/mesh/surface_measure.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>

namespace ringdown {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

constexpr double kVolume = 0.2 * 0.04 * 0.02;
const Eigen::RowVector3d kExtent(0.2, 0.04, 0.02);

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kFloat = 5126;

// The eight corners in units of half a side, x first.
std::array<std::array<double, 3>, 8> corners() {
  std::array<std::array<double, 3>, 8> all{};
  for (int k = 0; k < 8; ++k) all[k] = {k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0};
  return all;
}

constexpr std::array<int, 36> kTriangles = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                            2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

// A .gltf whose buffer is the file numbers.bin beside it. Accessor 0 has the triangles, accessor 1 the box.
class GltfFile {
 public:
  GltfFile() {
    add(kUnsignedByte, "SCALAR", kTriangles);
    std::vector<float> places;
    for (const auto& corner : corners()) {
      for (int axis = 0; axis < 3; ++axis) places.push_back(static_cast<float>(0.5 * kExtent[axis] * corner[axis]));
    }
    add(kFloat, "VEC3", places);
  }

  // Returns the accessor's number. `more` goes into its object.
  template <class List>
  int add(int type, const std::string& shape, const List& values, const std::string& more = "") {
    const std::size_t width = shape == "SCALAR" ? 1 : shape == "VEC3" ? 3 : shape == "VEC4" ? 4 : 16;
    const int view = add_view(type, values);
    accessors_ += (accessors_.empty() ? "" : ", ") + std::string("{\"bufferView\": ") + std::to_string(view) +
                  ", \"componentType\": " + std::to_string(type) + ", \"type\": \"" + shape +
                  "\", \"count\": " + std::to_string(std::size(values) / width) + more + "}";
    return accessor_count_++;
  }

  template <class List>
  int add_view(int type, const List& values) {
    numbers_.resize((numbers_.size() + 3) / 4 * 4);
    const std::size_t start = numbers_.size();
    for (const auto& value : values) put(type, static_cast<double>(value));
    views_ += (views_.empty() ? "" : ", ") + std::string("{\"buffer\": 0, \"byteOffset\": ") + std::to_string(start) +
              ", \"byteLength\": " + std::to_string(numbers_.size() - start) + "}";
    return view_count_++;
  }

  // An accessor without a view, all zeros but for some elements.
  int add_sparse(const std::string& shape, std::size_t count, const std::vector<int>& at,
                 const std::vector<double>& values) {
    const int places = add_view(kUnsignedByte, at), numbers = add_view(kFloat, values);
    accessors_ += ", {\"componentType\": 5126, \"type\": \"" + shape + "\", \"count\": " + std::to_string(count) +
                  ", \"sparse\": {\"count\": " + std::to_string(at.size()) +
                  ", \"indices\": {\"bufferView\": " + std::to_string(places) +
                  ", \"componentType\": 5121}, \"values\": {\"bufferView\": " + std::to_string(numbers) + "}}}";
    return accessor_count_++;
  }

  // `rest` is everything else, after a comma.
  [[nodiscard]] std::string text(const std::string& rest, const std::string& uri = "numbers.bin") const {
    return R"({"asset": {"version": "2.0"}, "buffers": [{"uri": ")" + uri + R"(", "byteLength": )" +
           std::to_string(numbers_.size()) + R"(}], "bufferViews": [)" + views_ + R"(], "accessors": [)" + accessors_ +
           "], " + rest + "}";
  }
  [[nodiscard]] const std::string& numbers() const { return numbers_; }

  [[nodiscard]] Result<mesh::TriangleMesh> read(const std::string& rest,
                                                std::vector<std::string>* notes = nullptr) const {
    const TemporaryFolder folder;
    static_cast<void>(folder.write("numbers.bin", numbers_));
    return mesh::read_surface(folder.write("body.gltf", text(rest)), notes);
  }

 private:
  template <class Number>
  void append(double value) {
    const auto number = static_cast<Number>(value);
    numbers_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  void put(int type, double value) {
    if (type == kByte) append<std::int8_t>(value);
    if (type == kUnsignedByte) append<std::uint8_t>(value);
    if (type == kShort) append<std::int16_t>(value);
    if (type == kUnsignedShort) append<std::uint16_t>(value);
    if (type == kFloat) append<float>(value);
  }

  std::string numbers_, views_, accessors_;
  int view_count_ = 0, accessor_count_ = 0;
};

const std::string kMesh = R"("meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}])";
const std::string kScene = R"("scene": 0, "scenes": [{"nodes": [0]}], )";

void expect_box(const Result<mesh::TriangleMesh>& read, const std::string& what, double scale = 1) {
  ASSERT_TRUE(read) << what << ": " << read.error().message;
  EXPECT_LT((test::extent_of(*read) - scale * kExtent).norm(), 1e-4 * scale) << what;
  EXPECT_NEAR(test::volume_of(*read) / (std::pow(scale, 3) * kVolume), 1, 1e-3) << what;
}

std::string refusal(const Result<mesh::TriangleMesh>& read) { return read ? "accepted" : read.error().message; }

TEST(GltfMesh, QuantizedPositionsAreWhatTheirTypeSays) {
  struct Kind {
    int type;
    double largest;  // in the file, where the corner lies at half of a side
    bool normalized;
    double scale;  // of the node, for a side of 2
  };
  for (const Kind& kind :
       {Kind{kShort, 32767, true, 1}, Kind{kByte, 127, true, 1}, Kind{kShort, 20000, false, 1.0 / 20000},
        Kind{kByte, 100, false, 0.01}, Kind{kShort, 32767, false, 1.0 / 32767}}) {
    GltfFile file;
    std::vector<double> values;
    for (const auto& corner : corners()) {
      for (const double part : corner) values.push_back(kind.largest * part);
    }
    const int places = file.add(kind.type, "VEC3", values, kind.normalized ? ", \"normalized\": true" : "");
    std::string scale;
    for (int axis = 0; axis < 3; ++axis)
      scale += (axis > 0 ? ", " : "") + std::to_string(1e6 * kind.scale * 0.5 * kExtent[axis]) + "e-6";
    expect_box(file.read(R"("extensionsRequired": ["KHR_mesh_quantization"], )" + kScene +
                         R"("nodes": [{"mesh": 0, "scale": [)" + scale +
                         R"(]}], "meshes": [{"primitives": [{"attributes": {"POSITION": )" + std::to_string(places) +
                         R"(}, "indices": 0}]}])"),
               std::to_string(kind.type) + (kind.normalized ? " normalized" : ""));
  }
}

// Joints and weights of the eight corners, both with the first joint or, at x > 0, the second.
std::string skinned(GltfFile& file, const std::vector<double>& weights, int weight_type = kFloat) {
  std::vector<int> joints;
  for (int k = 0; k < 8; ++k) joints.insert(joints.end(), {0, 1, 0, 0});
  const int joint = file.add(kUnsignedByte, "VEC4", joints);
  const int weight = file.add(weight_type, "VEC4", weights, weight_type == kFloat ? "" : ", \"normalized\": true");
  return R"("meshes": [{"primitives": [{"attributes": {"POSITION": 1, "JOINTS_0": )" + std::to_string(joint) +
         R"(, "WEIGHTS_0": )" + std::to_string(weight) + R"(}, "indices": 0}]}])";
}

std::vector<double> all_with_the_first_joint(double full) {
  std::vector<double> weights;
  for (int k = 0; k < 8; ++k) weights.insert(weights.end(), {full, 0, 0, 0});
  return weights;
}

TEST(GltfMesh, ASkinnedMeshIsWhereItsJointsAreAndNotWhereItsNodeIs) {
  for (const bool bytes : {false, true}) {
    GltfFile file;
    const std::string mesh = skinned(file, all_with_the_first_joint(bytes ? 255 : 1), bytes ? kUnsignedByte : kFloat);
    expect_box(file.read(kScene + R"("nodes": [{"mesh": 0, "skin": 0, "scale": [10, 10, 10]}, {}, {}],
                         "skins": [{"joints": [1, 2]}], )" +
                         mesh),
               "scale of the node");
    const auto moved = file.read(kScene + R"("nodes": [{"mesh": 0, "skin": 0, "children": [1]},
        {"translation": [1, 2, 3]}, {}], "skins": [{"joints": [1, 2]}], )" +
                                 mesh);
    expect_box(moved, "place of the joint");
    EXPECT_NEAR(moved->nodes.col(1).mean(), 2, 1e-6);
  }
}

// Bind matrices are the identity where they are absent, so viewers show the mesh at the joint's scale; the mesh as it
// was modelled has another size, and exporters leave both behind.
TEST(GltfMesh, AScaledJointWithoutBindMatricesIsRefused) {
  GltfFile file;
  const std::string mesh = skinned(file, all_with_the_first_joint(1));
  const auto read = file.read(kScene + R"("nodes": [{"mesh": 0, "skin": 0}, {"scale": [0.5, 0.5, 0.5]}, {}],
                              "skins": [{"joints": [1, 2]}], )" +
                              mesh);
  const std::string sentence = refusal(read);
  EXPECT_NE(sentence.find("skins[0].inverseBindMatrices"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("scaled"), std::string::npos) << sentence;
}

TEST(GltfMesh, InverseBindMatricesUndoThePlaceOfJoints) {
  GltfFile file;
  const std::string mesh = skinned(file, all_with_the_first_joint(1));
  // By columns: half the size, and back from (0.5, 1, 1.5).
  const int matrices =
      file.add(kFloat, "MAT4", std::vector<double>{0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, -0.5, -1, -1.5, 1,  //
                                                   1,   0, 0, 0, 0, 1,   0, 0, 0, 0, 1,   0, 0,    0,  0,    1});
  const auto read = file.read(kScene + R"("nodes": [{"mesh": 0, "skin": 0}, {"translation": [1, 2, 3],
      "scale": [2, 2, 2]}, {}], "skins": [{"joints": [1, 2], "inverseBindMatrices": )" +
                              std::to_string(matrices) + "}], " + mesh);
  expect_box(read, "bind pose");
  EXPECT_LT(read->nodes.colwise().mean().norm(), 1e-6);
}

// The end at x > 0 goes with the second joint, which lies 0.1 m further on; or by half.
TEST(GltfMesh, PointsGoWithTheirJointsByTheirWeights) {
  for (const double share : {1.0, 0.5}) {
    GltfFile file;
    std::vector<double> weights;
    // Weights of a file need not add up to 1.
    for (int k = 0; k < 8; ++k) {
      const double second = k & 1 ? share : 0;
      weights.insert(weights.end(), {0.8 * (1 - second), 0.8 * second, 0, 0});
    }
    const auto read = file.read(kScene + R"("nodes": [{"mesh": 0, "skin": 0}, {}, {"translation": [0.1, 0, 0]}],
                                "skins": [{"joints": [1, 2]}], )" +
                                skinned(file, weights));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_NEAR(test::extent_of(*read)[0], 0.2 + 0.1 * share, 1e-6);
    EXPECT_NEAR(test::volume_of(*read), (0.2 + 0.1 * share) * 0.04 * 0.02, 1e-8);
  }
}

TEST(GltfMesh, ASkinThatContradictsItselfIsRefused) {
  GltfFile file;
  const std::string mesh = skinned(file, all_with_the_first_joint(1));
  const std::string node = kScene + R"("nodes": [{"mesh": 0, "skin": 0}, {}, {}], )";
  EXPECT_NE(refusal(file.read(node + R"("skins": [{"joints": [1]}], )" + mesh)).find("JOINTS_0"), std::string::npos);
  EXPECT_NE(refusal(file.read(node + R"("skins": [{"joints": [1, 7]}], )" + mesh)).find("skins[0].joints[1]"),
            std::string::npos);
  EXPECT_NE(refusal(file.read(node + mesh)).find("nodes[0].skin"), std::string::npos);
  EXPECT_NE(refusal(file.read(node + R"("skins": [{"joints": [1]}], )" + kMesh)).find("JOINTS_0"), std::string::npos);
  EXPECT_NE(
      refusal(file.read(node + R"("skins": [{"joints": [1, 2], "inverseBindMatrices": 1}], )" + mesh)).find("MAT4"),
      std::string::npos);
}

TEST(GltfMesh, MorphTargetsAreAppliedWithTheirWeights) {
  std::vector<double> shift(24, 0);
  std::vector<double> of_end;
  std::vector<int> end;
  for (int k = 1; k < 8; k += 2) {
    shift[3 * k] = 0.1;
    end.push_back(k);
    of_end.insert(of_end.end(), {0.1, 0, 0});
  }
  for (const bool sparse : {false, true}) {
    GltfFile file;
    const int target = sparse ? file.add_sparse("VEC3", 8, end, of_end) : file.add(kFloat, "VEC3", shift);
    const auto length = [&](const std::string& of_node, const std::string& of_mesh) {
      const auto read = file.read(kScene + R"("nodes": [{"mesh": 0)" + of_node + R"(}], "meshes": [{)" + of_mesh +
                                  R"("primitives": [{"attributes": {"POSITION": 1}, "indices": 0,
                                  "targets": [{"POSITION": )" +
                                  std::to_string(target) + R"(}, {}]}]}])");
      return read ? test::extent_of(*read)[0] : -1;
    };
    EXPECT_NEAR(length("", ""), 0.2, 1e-6) << "weights are 0 where none are given";
    EXPECT_NEAR(length("", R"("weights": [1, 1], )"), 0.3, 1e-6);
    EXPECT_NEAR(length(R"(, "weights": [0.5, 0])", R"("weights": [1, 1], )"), 0.25, 1e-6) << "the node's come first";
  }
}

TEST(GltfMesh, WhatAFileRequiresIsReadOrRefusedByName) {
  const GltfFile file;
  const std::string rest = kScene + R"("nodes": [{"mesh": 0}], )" + kMesh;
  EXPECT_NE(refusal(file.read(R"("extensionsRequired": ["KHR_draco_mesh_compression"], )" + rest))
                .find("KHR_draco_mesh_compression"),
            std::string::npos);
  expect_box(file.read(R"("extensionsUsed": ["EXT_unheard_of"], )" + rest), "optional");
  expect_box(file.read(R"("extensionsRequired": ["KHR_materials_unlit", "KHR_texture_transform"], )" + rest),
             "colours");
}

TEST(GltfMesh, AFileWithoutScenesIsAllOfItsNodes) {
  const GltfFile file;
  const std::string pair = R"("nodes": [{"children": [1], "scale": [2, 2, 2]}, {"mesh": 0}], )" + kMesh;
  expect_box(file.read(pair), "roots", 2);
  expect_box(file.read(kMesh), "no nodes");
  std::vector<std::string> notes;
  expect_box(
      file.read(R"("scene": 1, "scenes": [{"nodes": [0]}, {"nodes": [1]}], "nodes": [{"mesh": 0, "scale": [3, 3, 3]},
                       {"mesh": 0}], )" +
                    kMesh,
                &notes),
      "the second scene");
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("2 scenes"), std::string::npos);
  EXPECT_NE(refusal(file.read(kScene + R"("nodes": [{"children": [1]}, {"children": [0], "mesh": 0}], )" + kMesh))
                .find("nodes"),
            std::string::npos);
}

TEST(GltfMesh, MirroredNodesStayTurnedOutward) {
  const GltfFile file;
  expect_box(file.read(kScene + R"("nodes": [{"mesh": 0, "scale": [-1, 1, 1]}], )" + kMesh), "mirrored");
}

// Two fans about opposite corners are a box, and so is a strip around it with two lids (Evans et al. 1996, by hand).
TEST(GltfMesh, StripsAndFansAreTriangles) {
  GltfFile file;
  const int one = file.add(kUnsignedByte, "SCALAR", std::vector<int>{0, 2, 3, 1, 5, 4, 6, 2});
  const int other = file.add(kUnsignedShort, "SCALAR", std::vector<int>{7, 6, 4, 5, 1, 3, 2, 6});
  const std::string primitive = R"({"attributes": {"POSITION": 1}, "mode": 6, "indices": )";
  expect_box(file.read(R"("meshes": [{"primitives": [)" + primitive + std::to_string(one) + "}, " + primitive +
                       std::to_string(other) + R"(}, {"attributes": {"POSITION": 1}, "mode": 1}]}])"),
             "fans");
  const int strip = file.add(kUnsignedByte, "SCALAR", std::vector<int>{0, 2, 1, 3, 5, 7, 4, 6, 0, 2});
  const int sides = file.add(kUnsignedByte, "SCALAR", std::vector<int>{0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7});
  expect_box(file.read(R"("meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "mode": 5, "indices": )" +
                       std::to_string(strip) + R"(}, {"attributes": {"POSITION": 1}, "indices": )" +
                       std::to_string(sides) + "}]}]"),
             "strip");
}

// Through links, too.
TEST(GltfMesh, BuffersLieInTheFolderOfTheFile) {
  const TemporaryFolder folder;
  const GltfFile file;
  fs::create_directories(folder / "inner/deeper");
  static_cast<void>(folder.write("numbers.bin", file.numbers()));
  static_cast<void>(folder.write("inner/deeper/numbers.bin", file.numbers()));
  fs::create_symlink("../numbers.bin", folder / "inner/link.bin");
  for (const char* inside : {"deeper/numbers.bin", "./deeper/../deeper/numbers.bin", "deeper%2Fnumbers.bin"})
    expect_box(mesh::read_surface(folder.write("inner/body.gltf", file.text(kMesh, inside))), inside);
  for (const char* outside : {"../numbers.bin", "%2e%2e/numbers.bin", "deeper/../../numbers.bin", "link.bin"}) {
    const std::string why = refusal(mesh::read_surface(folder.write("inner/body.gltf", file.text(kMesh, outside))));
    EXPECT_NE(why.find("folder"), std::string::npos) << outside << ": " << why;
  }
}

TEST(GltfMesh, NumbersThatLeadNowhereAreRefused) {
  GltfFile file;
  const int far = file.add(kUnsignedByte, "SCALAR", std::vector<int>{0, 1, 8});
  EXPECT_NE(refusal(file.read(R"("meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": )" +
                              std::to_string(far) + "}]}]"))
                .find("indices"),
            std::string::npos);
  EXPECT_NE(refusal(file.read(R"("nodes": [{"mesh": 1}], )" + kMesh)).find("nodes[0].mesh"), std::string::npos);
  EXPECT_NE(refusal(file.read(R"("nodes": [{"mesh": 0, "rotation": [0, 0, 0, 0]}], )" + kMesh)).find("quaternion"),
            std::string::npos);
  const int outside = file.add_sparse("VEC3", 8, {9}, {0, 0, 0});
  EXPECT_NE(refusal(file.read(R"("meshes": [{"primitives": [{"attributes": {"POSITION": )" + std::to_string(outside) +
                              R"(}, "indices": 0}]}])"))
                .find("sparse"),
            std::string::npos);
}

}  // namespace
}  // namespace ringdown
