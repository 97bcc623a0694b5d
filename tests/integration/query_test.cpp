// What strangers may send to a daemon's OSCQuery port: none of it costs memory or keeps others from their answers.
#include "engine/modal/bank_file.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/support/http_client.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <memory>
#include <random>
#include <thread>

namespace ringdown::test {
namespace {

constexpr long kMayGrow_kb = 16 * 1024;

// A daemon with OSCQuery, and by how much its memory has grown at most.
class QueriedDaemon {
 public:
  explicit QueriedDaemon(const std::vector<std::string>& options = {}) : daemon_(arguments(options)) {
    if (!daemon_.ready()) return;
    const std::string output = daemon_.process().output(), announcement = "OSCQuery on http://127.0.0.1:";
    port_ = static_cast<std::uint16_t>(std::stoi(output.substr(output.find(announcement) + announcement.size())));
    EXPECT_TRUE(answers());  // what the first answer needs is there
    daemon_.process().forget_peak();
    before_kb_ = daemon_.process().memory_kb("VmRSS:");
  }

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] bool answers() const { return http_get(port_, "/?HOST_INFO").status == 200; }
  [[nodiscard]] testing::AssertionResult kept_its_memory() {
    const long peak_kb = daemon_.process().memory_kb("VmHWM:");
    if (peak_kb > 0 && peak_kb - before_kb_ <= kMayGrow_kb) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "from " << before_kb_ << " kB to " << peak_kb << " kB (0: it has ended)\n"
                                       << daemon_.process().output();
  }

 private:
  static std::vector<std::string> arguments(const std::vector<std::string>& options) {
    std::vector<std::string> all = {"--settings", "none", "--driver", "null", "--query", "0"};
    all.insert(all.end(), options.begin(), options.end());
    return all;
  }

  Daemon daemon_;
  std::uint16_t port_ = 0;
  long before_kb_ = 0;
};

std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

TEST(Query, RangesAreNotLookedAt) {
  QueriedDaemon daemon;
  const std::string ranges = "Range: bytes=" + repeated("0-,", 2000) + "0-\r\n";
  for (int i = 0; i < 10; ++i) {
    const HttpAnswer answer = http_get(daemon.port(), "/", ranges);
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.body, http_get(daemon.port(), "/").body);
  }
  EXPECT_TRUE(daemon.kept_its_memory());
}

TEST(Query, HeaderLinesWithoutEndAreCutOff) {
  QueriedDaemon daemon;
  const std::string lines = repeated("A: b\r\n", 10000);
  for (int i = 0; i < 4; ++i) {
    HttpConnection connection(daemon.port());
    connection.send("GET / HTTP/1.1\r\nHost: x\r\n");
    for (int sent = 0; sent < 1000 && connection.send(lines);) ++sent;  // 60 MB
    EXPECT_FALSE(connection.open());
    EXPECT_TRUE(daemon.kept_its_memory());
  }
  EXPECT_TRUE(daemon.answers());
}

TEST(Query, ARequestWithTooLongALineHeaderOrBodyIsRefused) {
  QueriedDaemon daemon;
  const std::string long_text(1 << 20, 'a'), huge_body(std::size_t{64} << 20, 'a');
  EXPECT_EQ(http_get(daemon.port(), "/" + long_text).status / 100, 4);
  EXPECT_EQ(http_get(daemon.port(), "/", "X: " + long_text + "\r\n").status / 100, 4);
  EXPECT_EQ(http_get(daemon.port(), "/", "Content-Length: 4\r\n").status, 413);
  HttpConnection uploads(daemon.port());
  uploads.send("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 67108864\r\n\r\n");
  EXPECT_FALSE(uploads.send(huge_body));
  EXPECT_TRUE(daemon.kept_its_memory());
  EXPECT_TRUE(daemon.answers());
}

// Each sends a byte now and then and comes back when it is cut off, so that none of them is merely silent.
TEST(Query, TenThousandMutatedRequestsCostNoMemory) {
  QueriedDaemon daemon;
  std::mt19937 random(7);
  const std::string good =
      "GET /object?CONTENTS HTTP/1.1\r\nHost: x\r\nRange: bytes=0-4\r\nContent-Length: 0\r\n\r\n"
      "HEAD / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n1\r\na\r\n0\r\n\r\n";
  for (int i = 0; i < 10000; ++i) {
    std::string request = good;
    for (auto changes = 1 + random() % 4; changes > 0; --changes) {
      const std::size_t at = random() % request.size(), count = random() % (request.size() - at);
      switch (random() % 3) {
        case 0:
          request[at] = static_cast<char>(random());
          break;
        case 1:
          request.insert(at, request.substr(at, count));
          break;
        default:
          request.erase(at, std::min(count, request.size() - 1));
      }
    }
    HttpConnection connection(daemon.port(), INADDR_LOOPBACK + static_cast<std::uint32_t>(i));
    connection.send(request);
    if (i % 64 == 0) {
      EXPECT_TRUE(daemon.answers());
    }
  }
  EXPECT_TRUE(daemon.kept_its_memory());
}

TEST(Query, ClientsThatNeverEndTheirRequestsBlockNoQuery) {
  QueriedDaemon daemon;
  std::atomic<int> rounds = 0;
  std::jthread slow([&daemon, &rounds](const std::stop_token& stop) {
    std::array<std::unique_ptr<HttpConnection>, 39> clients;
    while (!stop.stop_requested()) {
      for (auto& client : clients) {
        if (client && client->send("a")) continue;
        client = std::make_unique<HttpConnection>(daemon.port());
        client->send("GET / HTTP/1.1\r\nX: ");
      }
      ++rounds;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  ASSERT_TRUE(becomes_true([&rounds] { return rounds > 0; }));
  while (rounds < 10) ASSERT_TRUE(daemon.answers());
  EXPECT_TRUE(daemon.kept_its_memory());
}

TEST(Query, ClientsThatAreSilentOrSlowAreCutOff) {
  QueriedDaemon daemon;
  HttpConnection silent(daemon.port()), slow(daemon.port());
  silent.send("GET / HTTP/1.1\r\nX: ");
  slow.send("GET / HTTP/1.1\r\nX: ");
  EXPECT_TRUE(becomes_true([&slow] { return !slow.send("a"); }));
  static_cast<void>(silent.receive());  // ends when the daemon closes
}

TEST(Query, ClientsThatReadNoAnswersCostNoMemoryAndBlockNoQuery) {
  const TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(single_mode_bank(300, 1), folder / "bank.glb"));
  std::vector<std::string> options;
  for (int i = 0; i < 1024; ++i) {
    const std::string name = std::string(60, 'n') + std::to_string(1000 + i);
    options.insert(options.end(), {"--object", name + "=" + (folder / "bank.glb").string()});
  }
  QueriedDaemon daemon(options);
  std::deque<HttpConnection> clients;
  for (int i = 0; i < 64; ++i) {
    clients.emplace_back(daemon.port()).send(repeated("GET / HTTP/1.1\r\nHost: x\r\n\r\n", 100));
  }
  const HttpAnswer answer = http_get(daemon.port(), "/object");
  EXPECT_EQ(answer.status, 200);
  EXPECT_GT(answer.body.size(), std::size_t{4} << 20) << "or the clients would have had little to leave unread";
  EXPECT_TRUE(daemon.kept_its_memory());
}

}  // namespace
}  // namespace ringdown::test
