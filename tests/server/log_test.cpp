// The log never waits: with pipes, terminals and sockets that nobody reads, and when they are read again.
#include "server/log.h"

#include "server/refusal_log.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <functional>
#include <sstream>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;

struct Ends {
  int written = -1, read = -1;
};

// Ends of what a standard error may be. Writing to `written` waits when nobody reads `read`.
struct Opened {
  const char* name;
  std::function<Ends()> open;
};

Ends pipe_ends() {
  int ends[2];
  return ::pipe(ends) == 0 ? Ends{ends[1], ends[0]} : Ends{};
}

Ends socket_ends() {
  int ends[2];
  return ::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0 ? Ends{ends[1], ends[0]} : Ends{};
}

Ends terminal_ends() {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0 || ::grantpt(master) != 0 || ::unlockpt(master) != 0) return {};
  return {::open(::ptsname(master), O_RDWR | O_NOCTTY), master};
}

class LogTest : public testing::TestWithParam<Opened> {
 protected:
  LogTest() { EXPECT_GE(ends_.written, 0); }
  ~LogTest() override {
    ::close(ends_.written);
    ::close(ends_.read);
  }

  // All that can be read now.
  std::string drain() const {
    ::fcntl(ends_.read, F_SETFL, ::fcntl(ends_.read, F_GETFL) | O_NONBLOCK);
    std::string text;
    char piece[4096];
    for (ssize_t got = 0; (got = ::read(ends_.read, piece, sizeof piece)) > 0;) {
      text.append(piece, static_cast<std::size_t>(got));
    }
    std::erase(text, '\r');  // a terminal adds it
    return text;
  }

  Ends ends_ = GetParam().open();
};

std::string line(int number) { return "line " + std::to_string(number) + " of many, each of them about so long\n"; }

// A write that waited would hang the test.
TEST_P(LogTest, LinesThatNobodyReadsAreDroppedAndCountedAndEachOtherIsWhole) {
  constexpr int kLines = 20000;
  LineWriter writer(ends_.written);
  for (int i = 0; i < kLines; ++i) writer.write(line(i));
  std::string text = drain();
  writer.report_dropped();
  writer.write(line(kLines));
  text += drain();
  int expected = 0, reports = 0;
  std::istringstream lines(text);
  for (std::string read; std::getline(lines, read);) {
    if (const auto at = read.find(" lines were left out, because the log was not read"); at != std::string::npos) {
      expected += std::stoi(read.substr(0, at));
      ++reports;
    } else {
      ASSERT_EQ(read + "\n", line(expected++));
    }
  }
  EXPECT_EQ(expected, kLines + 1) << "each is there or counted";
  EXPECT_GT(reports, 0);
}

TEST_P(LogTest, TheLastLineWaitsForRoomButNotForEver) {
  LineWriter writer(ends_.written);
  for (int i = 0; i < 20000; ++i) writer.write(line(i));
  writer.write("nobody reads this\n", 20ms);
  std::string text;
  std::thread reader([&] {
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (text.find("the end\n") == std::string::npos && std::chrono::steady_clock::now() < end) {
      text += drain();
      std::this_thread::sleep_for(1ms);
    }
  });
  writer.write("the end\n", 60s);
  reader.join();
  EXPECT_NE(text.find("lines were left out"), std::string::npos);
  EXPECT_NE(text.find("the end\n"), std::string::npos);
  EXPECT_EQ(text.find("nobody reads this"), std::string::npos);
}

// The shell that started us shares the terminal and the pipe.
TEST_P(LogTest, WhatWasOpenedStaysBlockingForItsOtherUsers) {
  const LineWriter writer(ends_.written);
  EXPECT_EQ(::fcntl(ends_.written, F_GETFL) & O_NONBLOCK, 0);
}

INSTANTIATE_TEST_SUITE_P(To, LogTest,
                         testing::Values(Opened{"pipe", pipe_ends}, Opened{"socket", socket_ends},
                                         Opened{"terminal", terminal_ends}),
                         [](const auto& opened) { return std::string(opened.param.name); });

TEST(RefusalLog, AFloodOfOneSentenceIsOneLineASecondAndACount) {
  RefusalLog::Clock::time_point now{1h};
  std::vector<std::string> lines;
  RefusalLog log([&](const std::string& written) { lines.push_back(written); }, [&] { return now; });
  for (int i = 0; i < 1000; ++i) {
    log.add("10.0.0.1:" + std::to_string(i), "not OSC");
    now += 1ms;
  }
  EXPECT_EQ(lines, (std::vector<std::string>{"10.0.0.1:0: not OSC"}));
  log.report();
  EXPECT_EQ(lines, (std::vector<std::string>{"10.0.0.1:0: not OSC", "not OSC (999 times more)"}));
  now += 5s;
  log.report();
  EXPECT_EQ(lines.size(), 2u) << "nothing happened since";
  log.add("10.0.0.2:7", "not OSC");
  EXPECT_EQ(lines.back(), "10.0.0.2:7: not OSC") << "and later it is news again";
}

TEST(RefusalLog, AFloodOfDifferentSentencesIsBoundedAndCounted) {
  RefusalLog::Clock::time_point now{1h};
  std::vector<std::string> lines;
  RefusalLog log([&](const std::string& written) { lines.push_back(written); }, [&] { return now; });
  for (int i = 0; i < 1000; ++i) log.add("10.0.0.1:9", "bad " + std::to_string(i));
  EXPECT_EQ(lines.size(), RefusalLog::kMaxPerSecond);
  now += 1s;
  log.report();
  EXPECT_EQ(lines.back(), "980 refusals with other sentences were not logged");
}

}  // namespace
}  // namespace ringdown::server
