// What systemd hears of the daemon, on a notify socket of the test's own.
#include "server/service_notice.h"

#include "tests/integration/daemon_fixture.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <utility>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;

// Receives what is said to it, one datagram at a time.
class NotifySocket {
 public:
  explicit NotifySocket(const std::string& path, bool abstract = false) {
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{.sun_family = AF_UNIX};
    std::memcpy(address.sun_path + (abstract ? 1 : 0), path.data(), path.size());
    const auto size = offsetof(sockaddr_un, sun_path) + path.size() + 1;
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), static_cast<socklen_t>(size - !abstract)), 0);
  }
  ~NotifySocket() { ::close(socket_); }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  // The next datagram, or "" when none comes for so long.
  [[nodiscard]] std::string next(std::chrono::microseconds limit) const {
    const timeval time{.tv_sec = limit.count() / 1'000'000, .tv_usec = limit.count() % 1'000'000};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &time, sizeof time);
    char text[256];
    const ssize_t size = ::recv(socket_, text, sizeof text, 0);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : "";
  }

 private:
  int socket_ = -1;
};

class Environment {
 public:
  explicit Environment(Process::Environment variables) : variables_(std::move(variables)) {
    for (const auto& [name, value] : variables_) ::setenv(name.c_str(), value.c_str(), 1);
  }
  ~Environment() {
    for (const auto& [name, value] : variables_) ::unsetenv(name.c_str());
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  Process::Environment variables_;
};

TEST(ServiceNotice, TheServiceIsReadyOnceAndOnlyWhenSoundRuns) {
  const TemporaryFolder folder;
  const NotifySocket socket((folder / "notify").string());
  const Environment environment({{"NOTIFY_SOCKET", (folder / "notify").string()}});
  server::ServiceNotice notice;
  notice.turn(0, 1);
  EXPECT_EQ(socket.next(10ms), "");
  notice.turn(256, 2);
  EXPECT_TRUE(socket.next(60s).starts_with("READY=1\n"));
  notice.turn(512, 3);
  EXPECT_EQ(socket.next(10ms), "") << "no watchdog was asked for";
  notice.stopping();
  EXPECT_TRUE(socket.next(60s).starts_with("STOPPING=1\n"));
}

TEST(ServiceNotice, TheWatchdogHearsOnlyAWorkerThatWorks) {
  const TemporaryFolder folder;
  const NotifySocket socket((folder / "notify").string());
  const Environment environment({{"NOTIFY_SOCKET", (folder / "notify").string()}, {"WATCHDOG_USEC", "2"}});
  server::ServiceNotice notice;  // one microsecond between two messages: every turn may say one
  notice.turn(0, 1);
  EXPECT_EQ(socket.next(60s), "WATCHDOG=1");
  notice.turn(0, 1);
  EXPECT_EQ(socket.next(10ms), "");
  notice.turn(0, 2);
  EXPECT_EQ(socket.next(60s), "WATCHDOG=1");
}

TEST(ServiceNotice, AWatchdogForAnotherProcessIsNotOurs) {
  const TemporaryFolder folder;
  const NotifySocket socket((folder / "notify").string());
  const Environment environment(
      {{"NOTIFY_SOCKET", (folder / "notify").string()}, {"WATCHDOG_USEC", "2"}, {"WATCHDOG_PID", "1"}});
  server::ServiceNotice notice;
  notice.turn(0, 1);
  EXPECT_EQ(socket.next(10ms), "");
}

TEST(ServiceNotice, AbstractNotifySocketsAreHeardAndNoneAtAllIsFine) {
  const std::string name = "ringdown-test-" + std::to_string(::getpid());
  const NotifySocket socket(name, true);
  {
    const Environment environment({{"NOTIFY_SOCKET", "@" + name}});
    server::ServiceNotice().stopping();
  }
  EXPECT_TRUE(socket.next(60s).starts_with("STOPPING=1"));
  server::ServiceNotice silent;
  silent.turn(1, 1);
  silent.stopping();
  EXPECT_EQ(socket.next(10ms), "");
}

TEST(ServiceNotice, TheDaemonSaysWhenSoundRunsThatItLivesAndWhenItStops) {
  const TemporaryFolder folder;
  const std::string path = (folder / "notify").string();
  const NotifySocket socket(path);
  Daemon daemon({"--driver", "null"}, {{"NOTIFY_SOCKET", path}, {"WATCHDOG_USEC", "200000"}});
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  std::string heard;
  const auto hear_until = [&](const std::string& word) {
    while (heard.find(word) == heard.npos) {
      const std::string message = socket.next(60s);
      if (message.empty()) return false;
      heard += message + "\n";
    }
    return true;
  };
  EXPECT_TRUE(hear_until("READY=1")) << heard;
  heard.clear();
  for (int beat = 0; beat < 2; ++beat) {
    EXPECT_TRUE(hear_until("WATCHDOG=1"));
    heard.clear();
  }
  daemon.process().send_signal(SIGTERM);
  EXPECT_TRUE(hear_until("STOPPING=1")) << heard;
  EXPECT_EQ(daemon.process().wait(60s), 0);
}

TEST(ServiceNotice, WithoutAudioTheDaemonNeverSaysReady) {
  const TemporaryFolder folder;
  const std::string path = (folder / "notify").string();
  const NotifySocket socket(path);
  const Outcome outcome =
      run({RINGDOWN_BIN_DIR "/ringdownd", "--port", "0"},
          {{"NOTIFY_SOCKET", path}, {"JACK_DEFAULT_SERVER", "ringdown-test-nobody"}, {"JACK_NO_START_SERVER", "1"}});
  EXPECT_EQ(outcome.exit_code, 4) << outcome.output;
  EXPECT_EQ(socket.next(10ms).find("READY"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::test
