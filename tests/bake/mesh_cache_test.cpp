#include "engine/base/content_cache.h"
#include "engine/mesh/body_reader.h"
#include "engine/mesh/gmsh_reader.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>

namespace ringdown::mesh_cache_test {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

const std::string kBox = R"(SetFactory("OpenCASCADE");
DefineConstant[ side = 10, mesh_size = 4 ];
Box(1) = {0, 0, 0, side, 8, 6};
)";

mesh::GmshOptions options() { return {.unit_m = 0.001, .mesh_size_m = 0.004, .order = 2, .parameters = {}}; }

struct Case {
  TemporaryFolder folder;
  fs::path geometry = folder.write("box.geo", kBox), cache_folder = folder.path() / "cache";
  ContentCache cache{cache_folder};

  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(cache_folder), {}));
  }
  [[nodiscard]] fs::path entry() const { return fs::directory_iterator(cache_folder)->path(); }
  [[nodiscard]] mesh::CheckedMesh read(const mesh::GmshOptions& how = options()) const {
    return mesh::BodyReader(geometry, cache_folder).read(how).value().mesh;
  }
};

bool same(const mesh::CheckedMesh& a, const mesh::CheckedMesh& b) {
  return a.mesh.nodes == b.mesh.nodes && a.mesh.elements == b.mesh.elements && a.pieces == b.pieces &&
         a.flipped == b.flipped && a.straightened == b.straightened && a.unused_nodes == b.unused_nodes &&
         a.duplicates == b.duplicates;
}

TEST(MeshCache, TheCacheGivesTheSameMeshBitForBitWithoutMeshing) {
  const Case box;
  const mesh::CheckedMesh fresh = mesh::read_with_gmsh(box.geometry, options()).value();
  EXPECT_TRUE(same(fresh, box.read()));
  ASSERT_EQ(box.entries(), 1u);
  const fs::path witness = box.folder.path() / "witness";
  fs::create_hard_link(box.entry(), witness);
  EXPECT_TRUE(same(fresh, box.read()));
  EXPECT_EQ(fs::hard_link_count(witness), 2u) << "a new mesh would have replaced the entry";
}

TEST(MeshCache, EveryOptionAndTheContentMakeAnotherMesh) {
  const Case box;
  (void)box.read();
  const std::function<void(mesh::GmshOptions&)> changes[] = {[](auto& o) { o.unit_m = 0.002; },
                                                             [](auto& o) { o.mesh_size_m = 0.003; },
                                                             [](auto& o) { o.order = 1; },
                                                             [](auto& o) { o.cavities = true; },
                                                             [](auto& o) { o.force_coarse = true; },
                                                             [](auto& o) { o.quick = true; },
                                                             [](auto& o) { o.parameters["side"] = 11; }};
  std::size_t expected = 1;
  for (const auto& change : changes) {
    mesh::GmshOptions other = options();
    change(other);
    EXPECT_TRUE(same(box.read(other), mesh::read_with_gmsh(box.geometry, other).value()));
    EXPECT_EQ(box.entries(), ++expected);
  }
  std::ofstream(box.geometry, std::ios::app) << "Box(2) = {20, 0, 0, 5, 5, 5};\n";
  EXPECT_EQ(box.read().pieces, 2);
  EXPECT_EQ(box.entries(), ++expected);
}

TEST(MeshCache, TheCacheKeepsNothingThatDependsOnOtherFiles) {
  const Case box;
  const fs::path part = box.folder.write("part.geo", kBox);
  const fs::path whole = box.folder.write("whole.geo", "Include \"part.geo\";\n");
  const auto pieces = [&] { return mesh::BodyReader(whole, box.cache_folder).read(options()).value().mesh.pieces; };
  EXPECT_EQ(pieces(), 1);
  std::ofstream(part, std::ios::app) << "Box(2) = {20, 0, 0, 5, 5, 5};\n";
  EXPECT_EQ(pieces(), 2);
  EXPECT_FALSE(fs::exists(box.cache_folder));
}

TEST(MeshCache, DamagedEntriesAreMadeAgainAndFailuresAreNotKept) {
  const Case box;
  const mesh::CheckedMesh fresh = box.read();
  fs::resize_file(box.entry(), fs::file_size(box.entry()) - 8);
  EXPECT_TRUE(same(fresh, box.read()));
  std::ofstream(box.geometry) << "Box(1) = {;\n";
  EXPECT_FALSE(mesh::BodyReader(box.geometry, box.cache_folder).read(options()));
  EXPECT_EQ(box.entries(), 1u);
  const auto missing = mesh::BodyReader("/nowhere.geo", box.cache_folder).read(options());
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("there is no such file"), std::string::npos);
}

// An entry with a right checksum and wrong content, as an older version might have left.
TEST(MeshCache, AMeshFromTheCacheIsCheckedLikeAnyOther) {
  const Case box;
  const mesh::CheckedMesh fresh = box.read();
  const std::string name = box.entry().filename().string(), digits = name.substr(name.find('-') + 1);
  const ContentHash key{std::stoull(digits.substr(0, 16), nullptr, 16), std::stoull(digits.substr(16), nullptr, 16)};
  const std::string good = box.cache.find("mesh", key).value();
  std::string bad = good;
  bad.replace(bad.size() - 8, 4, "\xff\xff\xff\x7f");  // a node number far out of range
  for (const std::string& content : {bad, good.substr(0, 40), std::string(), good + "more"}) {
    ASSERT_TRUE(box.cache.store("mesh", key, content));
    EXPECT_TRUE(same(fresh, box.read()));
    EXPECT_TRUE(box.cache.find("mesh", key) == good);
  }
}

}  // namespace
}  // namespace ringdown::mesh_cache_test
