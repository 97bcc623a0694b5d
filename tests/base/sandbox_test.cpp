#include "engine/base/process/sandbox.h"

#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <functional>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace ringdown {
namespace {

using test::TemporaryFolder;

constexpr int kHeld = 0, kBroken = 1;

// Runs `attempt` in a process of its own whose sandbox lets it read `readable`; true when it returns true.
bool holds_in_sandbox(const std::filesystem::path& readable, const std::function<bool()>& attempt) {
  const pid_t id = ::fork();
  if (id == 0) {
    close_sandbox({readable});
    ::_exit(attempt() ? kHeld : kBroken);
  }
  int status = 0;
  ::waitpid(id, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == kHeld;
}

bool can_open(const std::filesystem::path& path, int flags) {
  const int file = ::open(path.c_str(), flags, 0600);
  if (file >= 0) ::close(file);
  return file >= 0;
}

// Each with the error that refuses it.
TEST(Sandbox, NoProgramNoProcessNoNetworkAndNoWritingWithSeccomp) {
  if (!sandbox_of_kernel().calls) GTEST_SKIP() << "this kernel has no seccomp filters";
  const TemporaryFolder folder;
  const auto file = folder.write("mine.txt", "text");
  const std::pair<const char*, std::function<bool()>> attempts[] = {
      {"program", [] { return ::execl("/bin/true", "true", nullptr) < 0 && errno == EPERM; }},
      {"process", [] { return ::fork() < 0 && errno == EPERM; }},
      {"socket", [] { return ::socket(AF_INET, SOCK_STREAM, 0) < 0 && errno == EPERM; }},
      {"signal", [] { return ::kill(::getppid(), 0) < 0 && errno == EPERM; }},
      {"new file", [&] { return !can_open(folder / "new.txt", O_WRONLY | O_CREAT); }},
      {"old file", [&] { return !can_open(file, O_RDWR); }},
      {"emptied", [&] { return !can_open(file, O_RDONLY | O_TRUNC) && ::truncate(file.c_str(), 0) < 0; }},
      {"removed", [&] { return ::unlink(file.c_str()) < 0 && errno == EPERM; }},
      {"renamed", [&] { return ::rename(file.c_str(), (folder / "b").c_str()) < 0 && errno == EPERM; }},
      {"folder", [&] { return ::mkdir((folder / "c").c_str(), 0700) < 0 && errno == EPERM; }},
  };
  for (const auto& [what, attempt] : attempts) EXPECT_TRUE(holds_in_sandbox(folder.path(), attempt)) << what;
  EXPECT_FALSE(holds_in_sandbox(folder.path(), [] { return false; })) << "the test can fail";
}

TEST(Sandbox, ThreadsAndOpenFilesGoOn) {
  const TemporaryFolder folder;
  const int file = ::open((folder / "open.txt").c_str(), O_RDWR | O_CREAT, 0600);
  EXPECT_TRUE(holds_in_sandbox(folder.path(), [file] {
    bool written = false;
    std::thread([&] { written = ::write(file, "text", 4) == 4; }).join();
    return written;
  }));
  ::close(file);
}

TEST(Sandbox, OnlyTheGivenFolderCanBeReadWithLandlock) {
  if (!sandbox_of_kernel().files) GTEST_SKIP() << "this kernel has no Landlock";
  const TemporaryFolder folder, other;
  const auto inside = folder.write("in.txt", "text"), outside = other.write("out.txt", "text");
  std::filesystem::create_symlink(outside, folder / "link.txt");
  EXPECT_TRUE(holds_in_sandbox(folder.path(), [&] { return can_open(inside, O_RDONLY); }));
  EXPECT_TRUE(holds_in_sandbox(folder.path(), [&] { return !can_open(outside, O_RDONLY) && errno == EACCES; }));
  EXPECT_TRUE(holds_in_sandbox(folder.path(), [&] { return !can_open(folder / "link.txt", O_RDONLY); }));
  EXPECT_TRUE(holds_in_sandbox(folder.path(), [&] { return !can_open("/etc/passwd", O_RDONLY); }));
  EXPECT_TRUE(holds_in_sandbox(inside, [&] { return can_open(inside, O_RDONLY); })) << "a file alone";
}

}  // namespace
}  // namespace ringdown
