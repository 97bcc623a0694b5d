// Files that are dropped onto the window, and the banks that ringdown-bake makes of them.
#include "clients/viewer/mesh_baker.h"

#include "engine/base/process/child_process.h"
#include "engine/modal/bank_file.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

namespace ringdown::viewer {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

// A tetrahedron of 10 cm; with `holes`, without one of its sides.
std::string tetrahedron(bool holes) {
  const std::string text = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
  return holes ? "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" : text + "f 2 3 4\n";
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class MeshBakerTest : public testing::Test {
 protected:
  // Waits until nothing is baked any more. Returns the banks.
  std::vector<fs::path> wait(MeshBaker& baker) {
    std::vector<fs::path> banks;
    for (int tries = 0; tries < 60000; ++tries) {
      for (const fs::path& bank : baker.take_banks()) banks.push_back(bank);
      bool all_failed = true;
      for (const auto& job : baker.jobs()) all_failed = all_failed && !job.failure.empty();
      if (all_failed) break;
      std::this_thread::sleep_for(5ms);
    }
    for (const fs::path& bank : baker.take_banks()) banks.push_back(bank);
    return banks;
  }
  test::TemporaryFolder folder_;
  fs::path banks_ = folder_.path();
};

TEST_F(MeshBakerTest, MeshesBecomeBanksInTheirMaterialAndFaultyOnesSayWhy) {
  MeshBaker baker(find_beside("ringdown-bake"), banks_);
  baker.add(folder_.write("sheet.obj", tetrahedron(true)), "steel");
  baker.add(folder_.write("stone.obj", tetrahedron(false)), "granite");
  const auto banks = wait(baker);
  ASSERT_EQ(banks.size(), 1u);
  EXPECT_EQ(banks[0].parent_path(), banks_);
  EXPECT_TRUE(banks[0].filename().string().starts_with("stone-granite-")) << banks[0];
  const auto bank = modal::read_bank(banks[0]);
  ASSERT_TRUE(bank) << bank.error().message;
  ASSERT_TRUE(bank->material);
  EXPECT_EQ(bank->material->name, "granite");
  const auto failed = baker.jobs();
  ASSERT_EQ(failed.size(), 1u);
  EXPECT_EQ(failed[0].file.filename(), "sheet.obj");
  EXPECT_GT(failed[0].failure.size(), 20u) << failed[0].failure;
  baker.remove(0);
  EXPECT_TRUE(baker.jobs().empty());
}

// The stand-in for ringdown-bake copies the file to its bank.
TEST_F(MeshBakerTest, FilesOfOneNameHaveBanksOfTheirOwnAndTheSameFileFindsItsOwn) {
  const fs::path copies = folder_.write("copies", "#!/bin/sh\ncp \"$1\" \"$3\"\n");
  fs::permissions(copies, fs::perms::owner_all);
  for (const char* folder : {"old", "new"}) fs::create_directory(folder_.path() / folder);
  const std::vector<fs::path> files = {folder_.write("old/mug.obj", "old"), folder_.write("new/mug.obj", "new"),
                                       folder_.write("new/mug.stl", "another format")};
  MeshBaker baker(copies, banks_);
  for (const fs::path& file : files) baker.add(file, "steel");
  const auto banks = wait(baker);
  ASSERT_EQ(banks.size(), files.size());
  for (std::size_t i = 0; i < files.size(); ++i) EXPECT_EQ(text_of(banks[i]), text_of(files[i])) << files[i];
  baker.add(folder_.path() / "old" / ".." / "new" / "mug.obj", "steel");
  baker.add(files[1], "brass");
  const auto again = wait(baker);
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again[0], banks[1]) << "another way to write the path";
  EXPECT_NE(again[1], banks[1]) << "another material";
}

TEST_F(MeshBakerTest, WithoutRingdownBakeTheSentenceSaysSo) {
  MeshBaker baker(fail(ErrorKind::refused, "there is no ringdown-bake"), banks_);
  baker.add("mug.stl", "steel");
  EXPECT_TRUE(wait(baker).empty());
  ASSERT_EQ(baker.jobs().size(), 1u);
  EXPECT_EQ(baker.jobs()[0].failure, "there is no ringdown-bake");
}

// The stand-in shows progress until it is ended, as a large mesh does.
TEST_F(MeshBakerTest, ProgressIsShownAndABakeCanBeCancelled) {
  const fs::path slow = folder_.write("slow", "#!/bin/sh\necho '0.25 finding modes'\nexec sleep 1000\n");
  fs::permissions(slow, fs::perms::owner_all);
  MeshBaker baker(slow, banks_);
  baker.add("mug.stl", "steel");
  const auto shows = [&] {
    const auto jobs = baker.jobs();
    return jobs.size() == 1 && jobs[0].stage == "finding modes" && jobs[0].fraction == 0.25;
  };
  for (int tries = 0; tries < 60000 && !shows(); ++tries) std::this_thread::sleep_for(1ms);
  ASSERT_TRUE(shows());
  baker.add("cup.stl", "steel");
  EXPECT_EQ(baker.jobs()[1].stage, "waits");
  baker.remove(0);
  for (int tries = 0; tries < 60000 && !shows(); ++tries) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(shows()) << "the next one runs";
  EXPECT_EQ(baker.jobs()[0].file, "cup.stl");
}

TEST(DroppedFile, IsKnownByItsName) {
  for (const auto& [name, kind] : {std::pair{"a/mug.STL", Dropped::mesh},
                                   {"mug.step", Dropped::mesh},
                                   {"mug.msh", Dropped::mesh},
                                   {"mug.toml", Dropped::object},
                                   {"scenes/demo.toml", Dropped::scene},
                                   {"room.gltf", Dropped::scene},
                                   {"bell.glb", Dropped::bank},
                                   {"song.wav", Dropped::unknown},
                                   {"text", Dropped::unknown}}) {
    EXPECT_EQ(kind_of_drop(name), kind) << name;
  }
}

}  // namespace
}  // namespace ringdown::viewer
