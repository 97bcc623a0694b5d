// Which files a message may name. Every trick is tried against both ways of guarding.
#include "server/session/file_roots.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace ringdown::session {
namespace {

namespace fs = std::filesystem;

class FileRootsTest : public testing::TestWithParam<FileRoots::Guard> {
 protected:
  FileRootsTest() {
    fs::create_directories(folder_ / "inside/deep");
    fs::create_directories(folder_ / "inside-too");
    std::ofstream(folder_ / "inside/a.glb") << "good";
    std::ofstream(folder_ / "inside/deep/b.glb") << "deep";
    std::ofstream(folder_ / "secret.glb") << "secret";
    std::ofstream(folder_ / "inside-too/c.glb") << "neighbour";
    roots_ = *FileRoots::only({folder_ / "inside"}, GetParam());
  }

  [[nodiscard]] std::string refusal(const fs::path& path) const {
    const auto read = roots_.read(path, 100);
    return read ? "it was read: " + *read : read.error().message;
  }

  test::TemporaryFolder folder_;
  FileRoots roots_;
};

TEST_P(FileRootsTest, AFileBelowTheRootIsRead) {
  EXPECT_EQ(*roots_.read(folder_ / "inside/a.glb", 100), "good");
  EXPECT_EQ(*roots_.read(folder_ / "inside/deep/b.glb", 100), "deep");
  EXPECT_EQ(*roots_.read(folder_ / "inside/deep/../a.glb", 100), "good");
  EXPECT_EQ(*roots_.read(fs::relative(folder_ / "inside/a.glb"), 100), "good");
  fs::create_symlink("a.glb", folder_ / "inside/link.glb");
  EXPECT_EQ(*roots_.read(folder_ / "inside/link.glb", 100), "good");
  fs::create_symlink(folder_ / "inside", folder_ / "alias");
  EXPECT_EQ(*FileRoots::only({folder_ / "alias/"}, GetParam())->read(folder_ / "alias/a.glb", 100), "good");
}

TEST_P(FileRootsTest, AFileOutsideTheRootIsRefusedWhateverThePath) {
  fs::create_symlink(folder_ / "secret.glb", folder_ / "inside/link.glb");
  fs::create_symlink("../secret.glb", folder_ / "inside/relative.glb");
  fs::create_symlink("..", folder_ / "inside/up");
  fs::create_symlink("/", folder_ / "inside/everything");
  const fs::path tries[] = {folder_ / "secret.glb",
                            folder_ / "inside/../secret.glb",
                            folder_ / "inside/deep/../../secret.glb",
                            folder_ / "inside/link.glb",
                            folder_ / "inside/relative.glb",
                            folder_ / "inside/up/secret.glb",
                            folder_ / "inside/everything" / (folder_ / "secret.glb").relative_path(),
                            folder_ / "inside-too/c.glb",
                            "/etc/passwd",
                            "/proc/self/environ"};
  for (const fs::path& path : tries) {
    EXPECT_NE(refusal(path).find("outside the folders"), std::string::npos) << path << ": " << refusal(path);
  }
}

TEST_P(FileRootsTest, OnlyRegularFilesOfBoundedSizeAreRead) {
  ASSERT_EQ(::mkfifo((folder_ / "inside/fifo").c_str(), 0600), 0);
  std::ofstream(folder_ / "inside/at-limit") << std::string(100, 'x');
  std::ofstream(folder_ / "inside/too-large") << std::string(101, 'x');
  fs::create_symlink("/dev/zero", folder_ / "inside/zero");
  fs::create_symlink("loop", folder_ / "inside/loop");
  EXPECT_TRUE(roots_.read(folder_ / "inside/at-limit", 100));
  EXPECT_NE(refusal(folder_ / "inside/too-large").find("limit of 100"), std::string::npos);
  EXPECT_NE(refusal(folder_ / "inside/fifo").find("not a regular file"), std::string::npos);
  EXPECT_NE(refusal(folder_ / "inside/deep").find("not a regular file"), std::string::npos);
  for (const char* name : {"inside/zero", "inside/loop", "inside/missing", "inside", "inside/a.glb/x"}) {
    EXPECT_FALSE(roots_.read(folder_ / name, 100)) << name;
  }
  const auto devices = FileRoots::only({"/dev"}, GetParam());
  EXPECT_NE(devices->read("/dev/zero", 100).error().message.find("not a regular file"), std::string::npos);
}

TEST_P(FileRootsTest, OnlyFilesInsideTheRootAreWritten) {
  fs::create_symlink(folder_ / "secret.glb", folder_ / "inside/link.osc");
  fs::create_symlink("..", folder_ / "inside/up");
  EXPECT_EQ(*roots_.writable(folder_ / "inside/new.osc", kScoreKind), fs::canonical(folder_ / "inside") / "new.osc");
  for (const char* name : {"new.osc", "inside/../new.osc", "inside/up/new.osc", "inside/link.osc", "inside/deep",
                           "inside/missing/new.osc", "inside/"}) {
    EXPECT_FALSE(roots_.writable(folder_ / name, kScoreKind)) << name;
  }
}

TEST_P(FileRootsTest, NothingIsReplacedButAFileOfTheSameKind) {
  const auto write = [this](const char* name, std::string_view content) {
    const fs::path path = folder_ / "inside" / name;
    std::ofstream(path) << content;
    return path;
  };
  const std::string score("\0\0\0\x14#bundle\0", 12), state = "# What ringdownd holds; and so on\n";
  EXPECT_TRUE(roots_.writable(write("score.osc", score), kScoreKind));
  EXPECT_TRUE(roots_.writable(write("empty.osc", ""), kScoreKind));
  EXPECT_TRUE(roots_.writable(write("state.toml", state), kStateKind));
  EXPECT_FALSE(roots_.writable(write("poem.osc", "no score, but longer than one"), kScoreKind));
  EXPECT_FALSE(roots_.writable(write("short.osc", "#"), kScoreKind));
  EXPECT_FALSE(roots_.writable(write("Cargo.toml", "[package]"), kStateKind));
  EXPECT_FALSE(roots_.writable(folder_ / "inside/state.toml", kScoreKind));
  for (const char* name : {".bashrc", ".osc", "new", "new.osc.sh", "a.glb"}) {
    EXPECT_FALSE(roots_.writable(folder_ / "inside" / name, kScoreKind)) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Both, FileRootsTest, testing::Values(FileRoots::Guard::kernel, FileRoots::Guard::path),
                         [](const auto& guard) { return guard.param == FileRoots::Guard::kernel ? "Kernel" : "Path"; });

// Also where every file may be opened, a file opens nothing outside of its own folder.
TEST_P(FileRootsTest, WhatAFileNamesLiesBesideIt) {
  for (const FileRoots& roots : {roots_, FileRoots()}) {
    const fs::path document = folder_ / "inside/room.gltf";
    EXPECT_EQ(roots.read_beside(document, "a.glb", 100).value_or(""), "good");
    EXPECT_EQ(roots.read_beside(document, "deep/b.glb", 100).value_or(""), "deep");
    for (const char* name : {"../secret.glb", "deep/../../secret.glb", "../inside-too/c.glb"})
      EXPECT_FALSE(roots.read_beside(document, name, 100)) << name;
  }
}

TEST(FileRoots, ARootThatIsNotThereIsNamed) {
  const auto roots = FileRoots::only({"/no/such/folder"});
  ASSERT_FALSE(roots);
  EXPECT_NE(roots.error().message.find("/no/such/folder"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::session
