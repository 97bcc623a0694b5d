#include "engine/base/output_file.h"
#include "engine/base/atomic_file.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <iterator>

namespace ringdown {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(OutputFile, AChainOfLinksLeadsToTheFileThatIsReplaced) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "below");
  fs::create_symlink("below/two", folder / "one");
  fs::create_symlink("../three", folder / "below/two");
  ASSERT_TRUE(write_output(folder / "one", std::string_view("new")));
  EXPECT_EQ(content(folder / "three"), "new");
  EXPECT_TRUE(fs::is_symlink(folder / "one"));
  EXPECT_TRUE(fs::is_symlink(folder / "below/two"));
}

// Messages may come from strangers: what stands at their paths is not followed.
TEST(OutputFile, TheWriterForMessagesReplacesALinkAndNotItsFile) {
  const test::TemporaryFolder folder;
  fs::create_symlink(folder.write("precious", "old"), folder / "link");
  ASSERT_TRUE(write_file_atomically(folder / "link", std::string_view("new")));
  EXPECT_EQ(content(folder / "precious"), "old");
  EXPECT_FALSE(fs::is_symlink(folder / "link"));
}

TEST(OutputFile, ASocketGetsTheBytesAndStays) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "socket";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strcpy(address.sun_path, path.c_str());
  const int listening = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(listening, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(::listen(listening, 1), 0);
  ASSERT_TRUE(write_output(path, std::string_view("bytes")));
  const int accepted = ::accept(listening, nullptr, nullptr);
  char bytes[8] = "";
  EXPECT_EQ(::read(accepted, bytes, sizeof bytes), 5);
  EXPECT_STREQ(bytes, "bytes");
  EXPECT_TRUE(fs::is_socket(path));
  ::close(accepted);
  ::close(listening);
  EXPECT_FALSE(write_output(path, std::string_view("bytes"))) << "nobody listens any more";
  EXPECT_TRUE(fs::is_socket(path));
}

// /dev/stdout may be a socket, which no path opens.
TEST(OutputFile, AnOpenDescriptorIsWrittenToWhateverItIs) {
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  ASSERT_TRUE(write_output("/dev/fd/" + std::to_string(ends[0]), std::string_view("bytes")));
  char bytes[8] = "";
  EXPECT_EQ(::read(ends[1], bytes, sizeof bytes), 5);
  EXPECT_STREQ(bytes, "bytes");
  for (const int end : ends) ::close(end);
}

TEST(OutputFile, LinksInACircleAndMissingFoldersAreFailures) {
  const test::TemporaryFolder folder;
  fs::create_symlink("b", folder / "a");
  fs::create_symlink("a", folder / "b");
  fs::create_symlink("nowhere/file", folder / "c");
  for (const char* name : {"a", "c", "nowhere/file"}) {
    const auto outcome = write_output(folder / name, std::string_view("x"));
    ASSERT_FALSE(outcome) << name;
    EXPECT_NE(outcome.error().message.find("cannot write"), std::string::npos) << outcome.error().message;
  }
}

}  // namespace
}  // namespace ringdown
