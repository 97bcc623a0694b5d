// Where a daemon can be reached, as the kernel tells it.
#include "tests/integration/daemon_fixture.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <sstream>

namespace ringdown::test {
namespace {

// 127.0.0.1 and ::1, as /proc/net/udp and /proc/net/udp6 write them.
constexpr const char *kLoopback4 = "0100007F", *kLoopback6 = "00000000000000000000000001000000";

bool has_ipv6() {
  std::ifstream interfaces("/proc/net/if_inet6");
  for (std::string line; std::getline(interfaces, line);) {
    if (line.starts_with("00000000000000000000000000000001")) return true;
  }
  return false;
}

// The addresses of so many doors that are open on the loopback.
std::multiset<std::string> loopback(int doors) {
  std::multiset<std::string> addresses;
  for (int door = 0; door < doors; ++door) {
    addresses.insert(kLoopback4);
    if (has_ipv6()) addresses.insert(kLoopback6);
  }
  return addresses;
}

// The numbers by which the kernel knows the sockets that a process holds.
std::set<std::string> sockets_of(pid_t process) {
  std::set<std::string> inodes;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/fd")) {
    std::error_code closed_meanwhile;
    const std::string target = std::filesystem::read_symlink(entry.path(), closed_meanwhile).string();
    if (target.starts_with("socket:[")) inodes.insert(target.substr(8, target.size() - 9));
  }
  return inodes;
}

// The local addresses of all its Internet sockets, of either protocol and either version.
std::multiset<std::string> addresses_of(pid_t process) {
  const auto inodes = sockets_of(process);
  std::multiset<std::string> addresses;
  for (const char* table : {"udp", "udp6", "tcp", "tcp6"}) {
    std::ifstream lines("/proc/" + std::to_string(process) + "/net/" + table);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream fields(line);
      std::array<std::string, 10> field;
      for (std::string& text : field) fields >> text;
      if (inodes.contains(field[9])) addresses.insert(field[1].substr(0, field[1].find(':')));
    }
  }
  return addresses;
}

std::multiset<std::string> addresses(const std::vector<std::string>& options) {
  std::vector<std::string> arguments = {"--settings", "none", "--driver", "null"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  Daemon daemon(arguments);
  EXPECT_TRUE(daemon.ready()) << daemon.process().output();
  static_cast<void>(daemon.ask({"/version", {}}));  // all it opens is open
  return addresses_of(daemon.process().id());
}

TEST(Listening, TheDaemonListensOnLoopbackOnly) { EXPECT_EQ(addresses({}), loopback(1)); }

TEST(Listening, TheDaemonWithEveryDoorOpenListensOnLoopbackOnly) {
  EXPECT_EQ(addresses({"--tcp", "0", "--query", "0"}), loopback(3));
}

TEST(Listening, TheDaemonListensElsewhereWhenAsked) {
  EXPECT_TRUE(addresses({"--address", "0.0.0.0"}).contains("00000000")) << "or the tests above could not fail";
}

}  // namespace
}  // namespace ringdown::test
