#include "engine/base/atomic_file.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace ringdown {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  static std::string content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), {}));
  }

  test::TemporaryFolder folder_;
};

TEST_F(AtomicFile, AWrittenFileHoldsTheNewTextAndNoTemporaryFileRemains) {
  const fs::path path = folder_ / "a.txt";
  ASSERT_TRUE(write_file_atomically(path, std::string_view("one")));
  ASSERT_TRUE(write_file_atomically(path, std::string_view("two, longer")));
  EXPECT_EQ(content(path), "two, longer");
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFile, AWrittenFileIsReadableByOtherUsers) {
  const fs::path path = folder_ / "a.txt";
  ASSERT_TRUE(write_file_atomically(path, std::string_view("one")));
  EXPECT_EQ(fs::status(path).permissions(), static_cast<fs::perms>(0644));
}

// A reader that opened the old file goes on reading the old file.
TEST_F(AtomicFile, WritingDoesNotChangeTheFileThatAReaderHasOpen) {
  const fs::path path = folder_ / "a.txt";
  ASSERT_TRUE(write_file_atomically(path, std::string_view("old")));
  std::ifstream reader(path);
  ASSERT_TRUE(write_file_atomically(path, std::string_view("new")));
  std::string word;
  reader >> word;
  EXPECT_EQ(word, "old");
}

TEST_F(AtomicFile, WritingIntoAMissingFolderFailsAndNamesThePath) {
  const auto outcome = write_file_atomically(folder_ / "nowhere" / "a.txt", std::string_view("x"));
  ASSERT_FALSE(outcome);
  EXPECT_NE(outcome.error().message.find("nowhere/a.txt"), std::string::npos) << outcome.error().message;
}

// rename() over a folder fails after the temporary file was written: it must be cleaned up.
TEST_F(AtomicFile, TheTemporaryFileIsRemovedWhenRenamingFails) {
  const fs::path path = folder_ / "a";
  fs::create_directories(path / "full");
  ASSERT_FALSE(write_file_atomically(path, std::string_view("x")));
  EXPECT_TRUE(fs::is_directory(path / "full"));
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFile, AFileIsReadUpToTheLimitAndRefusedOneByteAbove) {
  const fs::path path = folder_ / "a.txt";
  ASSERT_TRUE(write_file_atomically(path, std::string_view("12345")));
  EXPECT_EQ(read_whole_file(path, 5).value(), "12345");
  const auto refused = read_whole_file(path, 4);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("5 bytes"), std::string::npos) << refused.error().message;
}

TEST_F(AtomicFile, AFileBelowAFolderIsReadAndNoneOutsideOfIt) {
  fs::create_directories(folder_ / "inside/deep");
  fs::create_directories(folder_ / "inside-too");
  for (const char* name : {"inside/a", "inside/deep/b", "inside-too/c", "d"}) std::ofstream(folder_ / name) << name;
  fs::create_symlink("deep/b", folder_ / "inside/link");
  fs::create_symlink("../d", folder_ / "inside/leads-out");
  fs::create_symlink("..", folder_ / "inside/up");
  fs::create_symlink("inside", folder_ / "alias");
  const auto read = [&](const char* name) { return read_file_below(folder_ / "inside", name, 100); };
  EXPECT_EQ(read("a").value_or(""), "inside/a");
  EXPECT_EQ(read("deep/../deep/b").value_or(""), "inside/deep/b");
  EXPECT_EQ(read("link").value_or(""), "inside/deep/b");
  EXPECT_EQ(read_file_below(folder_ / "alias", "a", 100).value_or(""), "inside/a");
  for (const char* name : {"../d", "deep/../../d", "leads-out", "up/d", "../inside-too/c", "/etc/passwd"}) {
    const auto outside = read(name);
    ASSERT_FALSE(outside) << name;
    EXPECT_NE(outside.error().message.find("outside of the folder"), std::string::npos) << outside.error().message;
  }
}

TEST_F(AtomicFile, ReadingWhatIsNotARegularFileFails) {
  EXPECT_FALSE(read_whole_file(folder_.path(), 100));
  EXPECT_FALSE(read_whole_file(folder_ / "absent", 100));
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_FALSE(read_whole_file(pipe, 100)) << "and it must not wait for a writer";
}

}  // namespace
}  // namespace ringdown
