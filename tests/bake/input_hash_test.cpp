// What a bank's hash of inputs depends on, and when it cannot be told.
#include "engine/bake/input_hash.h"

#include "engine/mesh/files/geo_language.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <set>

namespace ringdown::bake::input_hash_test {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

std::set<std::string> names_of(const std::optional<std::vector<fs::path>>& files) {
  std::set<std::string> names;
  if (!files) return {"unknown"};
  for (const fs::path& file : *files) names.insert(file.filename());
  return names;
}

TEST(InputHash, TheInputHashKnowsWhatAGeometryReads) {
  const TemporaryFolder folder;
  using Names = std::set<std::string>;
  (void)folder.write("b.geo", "Include \"c.geo\";");
  (void)folder.write("c.geo", "Include \"b.geo\"; // each other");
  (void)folder.write("t.node", "");
  (void)folder.write("t.ele", "");
  const std::tuple<const char*, const char*, Names> cases[] = {
      {"a.geo", "Box(1) = {0, 0, 0, 1, 1, 1};", {"a.geo"}},
      {"a.geo", "Include \"b.geo\";", {"a.geo", "b.geo", "c.geo"}},
      {"a.geo", "merge \"part.step\"; // Include \"no.geo\"", {"a.geo", "part.step"}},
      {"a.geo", "/* SystemCall \"date\"; */ v() = ShapeFromFile(\"x.brep\");", {"a.geo", "x.brep"}},
      {"a.geo", "grandness = 3; Printf(\"Rand and Include \");", {"a.geo"}},
      {"a.geo", "Include Sprintf(\"%g.geo\", 3);", {"unknown"}},
      {"a.geo", "x = Rand(1);", {"unknown"}},
      {"a.geo", "SystemCall \"date\";", {"unknown"}},
      {"a.geo", "s = GetEnv(\"HOME\");", {"unknown"}},
      {"a.geo", "/* never ended", {"a.geo"}},
      {"a.geo", "\"never ended", {"a.geo"}},
      {"a.inp", "*NODE\n*Include, Input=\"nodes.inp\"\n", {"a.inp"}},  // refused by its reader
      {"a.gltf", R"({"buffers":[{"uri":"a.bin"}],"images":[{"uri" : "data:x"}]})", {"a.gltf", "a.bin"}},
      {"a.gltf", R"({"buffers":[{"uri":"a%20b.bin"}]})", {"unknown"}},
      {"t.node", "", {"t.node", "t.ele"}},
      {"t.ele", "", {"t.ele", "t.node"}},
      {"a.bdf", "INCLUDE 'b.bdf'", {"unknown"}},
      {"a.nas", "GRID", {"a.nas"}},
      {"a.msh", "Include \"b.geo\"", {"a.msh"}},
  };
  for (const auto& [name, text, files] : cases) {
    (void)folder.write(name, text);
    EXPECT_EQ(names_of(files_of_geometry(folder / name)), files) << text;
  }
}

TEST(InputHash, TheInputHashFollowsAThousandFilesAndNoMore) {
  const TemporaryFolder folder;
  std::string text;
  for (std::size_t n = 1; n < mesh::kMaxGeoFiles; ++n) text += "Merge \"" + std::to_string(n) + ".step\";\n";
  const auto files = files_of_geometry(folder.write("a.geo", text));
  ASSERT_TRUE(files);
  EXPECT_EQ(files->size(), mesh::kMaxGeoFiles);
  EXPECT_FALSE(files_of_geometry(folder.write("a.geo", text + "Merge \"one more.step\";\n")));
}

TEST(InputHash, TheInputHashDependsOnContentAndNotOnPlace) {
  const TemporaryFolder folder;
  const auto hash = [&](const std::string& place, const std::string& geometry,
                        const std::vector<std::string>& options) {
    fs::create_directories(folder / place);
    (void)folder.write(place + "/o.toml", "material = \"m\"");
    (void)folder.write(place + "/g.geo", geometry);
    (void)folder.write(place + "/m.toml", "");
    return input_hash(
        {folder / (place + "/o.toml"), folder / (place + "/g.geo"), folder / (place + "/m.toml"), options});
  };
  const auto first = hash("a", "x = 1;", {"--keep", "4"});
  ASSERT_TRUE(first);
  EXPECT_EQ(first->size(), 32u);
  EXPECT_EQ(hash("b", "x = 1;", {"--keep", "4"}), first);
  EXPECT_NE(hash("b", "x = 2;", {"--keep", "4"}), first);
  EXPECT_NE(hash("b", "x = 1;", {"--keep", "5"}), first);
  EXPECT_NE(hash("b", "x = 1;", {}), first);
  EXPECT_FALSE(input_hash({folder / "a/o.toml", folder / "a/none.geo", folder / "a/m.toml", {}}));
  EXPECT_FALSE(input_hash({folder / "a/o.toml", folder / "a/g.geo", folder / "a/none.toml", {}}));
}

// Another program computed the hash, Python's xxhash: XXH3-128 of the number 3 in 4 bytes, the text "0.1.0" and those
// of the files and options, each after its length in 8 bytes. The version of the programs is no part of it. Whoever
// raises kBakesUnchangedSince computes it anew.
TEST(InputHash, TheInputHashOutlivesVersionsWhoseBakesAreTheSame) {
  const TemporaryFolder folder;
  const fs::path object = folder.write("o.toml", "material = \"m\"");
  EXPECT_EQ(input_hash({object, folder.write("g.geo", "x = 1;"), folder.write("m.toml", ""), {"--keep", "4"}}),
            "66e267c7615c7e740a8cdd6b108643b0");
}

}  // namespace
}  // namespace ringdown::bake::input_hash_test
