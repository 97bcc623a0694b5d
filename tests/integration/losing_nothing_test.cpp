// What ringdownd was told to write is written, however it ends, and no log, disk or signal keeps it from answering.
#include "engine/modal/bank_file.h"
#include "protocol/wire/score.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/integration/jack_fixture.h"
#include "tests/integration/sound_file.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;
using protocol::Done;
using protocol::Fail;
namespace fs = std::filesystem;

class LosingNothing : public testing::Test {
 protected:
  void SetUp() override {
    std::signal(SIGHUP, SIG_DFL);  // under nohup it is ignored, and a daemon goes on ignoring it
    ASSERT_TRUE(modal::write_bank(single_mode_bank(300, 5), folder_ / "bell.glb"));
  }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string bell() const { return "bell=" + path("bell.glb"); }

  static void strike(Daemon& daemon, int times) {
    for (int i = 0; i < times; ++i) daemon.send(JackTest::strike("bell", 0.01 * (i + 1)));
  }
  static bool sync(Daemon& daemon) {
    const auto synced = ask_for<protocol::Synced>(daemon, {"/sync", {7}});
    return synced && synced->id == 7;
  }

  // How many strikes a score has; none where there is no score.
  static std::optional<std::size_t> strikes_in(const fs::path& score) {
    const auto events = wire::read_score(score);
    if (!events) return std::nullopt;
    return static_cast<std::size_t>(std::ranges::count_if(
        *events, [](const wire::ScoreEvent& event) { return event.message.address == "/object/bell/strike"; }));
  }

  // A daemon started by a shell command, with `what` before the program's name.
  [[nodiscard]] std::vector<std::string> shell(const std::string& before, const std::string& options) const {
    return {"sh", "-c", before + " exec " + program("ringdownd") + " --driver null --object " + bell() + " " + options};
  }

  TemporaryFolder folder_;
};

// Whether the daemon at this port answers, soon or late.
bool answers(std::uint16_t port) {
  auto socket = wire::OscSocket::bind();
  return socket && becomes_true([&] {
           static_cast<void>(socket->send_to({.port = port}, wire::encode(wire::Message{"/status", {}})));
           wire::Datagram datagram;
           return socket->receive(datagram, 200ms);
         });
}

std::string free_port() {
  const auto socket = wire::OscSocket::bind();
  return std::to_string(socket->port());
}

class FullPipe {
 public:
  explicit FullPipe(const fs::path& path) {
    EXPECT_EQ(::mkfifo(path.c_str(), 0600), 0);
    descriptor_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    const std::string page(4096, '.');
    while (::write(descriptor_, page.data(), page.size()) > 0) continue;
  }
  ~FullPipe() { ::close(descriptor_); }
  FullPipe(const FullPipe&) = delete;
  FullPipe& operator=(const FullPipe&) = delete;

  // What stands in it now, without the dots that filled it.
  std::string drain() const {
    std::string text;
    char piece[4096];
    for (ssize_t got = 0; (got = ::read(descriptor_, piece, sizeof piece)) > 0;) {
      text.append(piece, static_cast<std::size_t>(got));
    }
    return text.substr(std::min(text.find_first_not_of('.'), text.size()));
  }

 private:
  int descriptor_ = -1;
};

TEST_F(LosingNothing, ALogThatNobodyReadsKeepsNobodyFromAnsweringOrEnding) {
  const std::string port = free_port();
  const FullPipe pipe(folder_ / "log");
  Process daemon(shell("", "--port " + port + " 2>" + path("log")));
  ASSERT_TRUE(answers(static_cast<std::uint16_t>(std::stoi(port))));
  std::string text = pipe.drain();
  EXPECT_TRUE(
      becomes_true([&] { return (text += pipe.drain()).find("left out, because the log was not read") != text.npos; }));
  daemon.send_signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
  text += pipe.drain();
  EXPECT_NE(text.find("stopping"), std::string::npos) << text;
}

TEST_F(LosingNothing, AFullLogKeepsNobodyFromEnding) {
  const std::string port = free_port();
  const FullPipe pipe(folder_ / "log");
  Process daemon(shell("", "--port " + port + " 2>" + path("log")));
  ASSERT_TRUE(answers(static_cast<std::uint16_t>(std::stoi(port))));
  daemon.send_signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
}

TEST_F(LosingNothing, ARecordingIsWrittenHoweverTheDaemonEnds) {
  for (const int signal : {0, SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGXCPU}) {
    const fs::path score = folder_ / ("session" + std::to_string(signal) + ".osc");
    Daemon daemon({"--driver", "null", "--object", bell(), "--root", folder_.path().string()});
    ASSERT_TRUE(daemon.ready()) << daemon.process().output();
    ASSERT_TRUE(done(daemon, {"/record/start", {score.string()}}));
    strike(daemon, 10);
    ASSERT_TRUE(sync(daemon));
    if (signal == 0) {
      daemon.send({"/quit", {}});
    } else {
      daemon.process().send_signal(signal);
    }
    EXPECT_EQ(daemon.process().wait(), 0) << daemon.process().output();
    EXPECT_EQ(strikes_in(score), 10u) << "signal " << signal;
  }
}

TEST_F(LosingNothing, AHangUpThatIsIgnoredAtTheStartStaysIgnored) {
  const std::string port = free_port();
  Process daemon(shell("trap '' HUP;", "--port " + port));
  ASSERT_TRUE(answers(static_cast<std::uint16_t>(std::stoi(port)))) << daemon.output();
  daemon.send_signal(SIGHUP);
  ASSERT_FALSE(daemon.wait(300ms)) << daemon.output();
  EXPECT_TRUE(answers(static_cast<std::uint16_t>(std::stoi(port))));
  daemon.send_signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
}

TEST_F(LosingNothing, AStrikeThatSyncHasConfirmedIsInTheScore) {
  for (const char* merge : {"0", "0.01"}) {
    Daemon daemon({"--driver", "null", "--merge", merge, "--object", bell(), "--root", folder_.path().string()});
    ASSERT_TRUE(daemon.ready()) << daemon.process().output();
    const fs::path score = folder_ / (std::string("merge") + merge + ".osc");
    for (int round = 0; round < 5; ++round) {
      const auto before = JackTest::status(daemon);
      ASSERT_TRUE(done(daemon, {"/record/start", {score.string()}}));
      strike(daemon, 40);
      ASSERT_TRUE(sync(daemon));
      ASSERT_TRUE(done(daemon, {"/record/stop", {}}));
      const auto after = JackTest::status(daemon);
      ASSERT_TRUE(before && after);
      const auto merged = static_cast<std::size_t>(after->merged_events - before->merged_events);
      EXPECT_EQ(strikes_in(score), 40u - merged) << "round " << round << ", --merge " << merge;
    }
  }
}

TEST_F(LosingNothing, ARecordingThatCannotBeWrittenGoesOnAndIsWrittenElsewhere) {
  fs::create_directory(folder_ / "gone");
  Daemon daemon({"--driver", "null", "--object", bell(), "--root", folder_.path().string()});
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const auto too_long = daemon.ask({"/record/start", {path(std::string(248, 'n') + ".osc")}});
  ASSERT_TRUE(too_long && too_long->holds<Fail>()) << "what cannot be written is refused at the start";
  ASSERT_TRUE(done(daemon, {"/record/start", {path("gone/a.osc")}}));
  strike(daemon, 10);
  ASSERT_TRUE(sync(daemon));
  fs::remove_all(folder_ / "gone");
  const auto refused = daemon.ask({"/record/stop", {}});
  ASSERT_TRUE(refused && refused->holds<Fail>());
  EXPECT_NE(refused->get<Fail>().sentence.find("the recording continues"), std::string::npos)
      << refused->get<Fail>().sentence;
  const auto outside = daemon.ask({"/record/stop", {"/tmp/ringdown-outside.osc"}});
  EXPECT_TRUE(outside && outside->holds<Fail>()) << "a path from a message stays in the roots";
  strike(daemon, 5);
  ASSERT_TRUE(done(daemon, {"/record/stop", {path("b.osc")}}));
  EXPECT_EQ(strikes_in(folder_ / "b.osc"), 15u);
}

TEST_F(LosingNothing, ARecordingWhoseFolderIsGoneAtTheEndIsSavedAmongTheTemporaryFiles) {
  fs::create_directory(folder_ / "gone");
  fs::create_directory(folder_ / "spare");
  Daemon daemon({"--driver", "null", "--object", bell(), "--record", path("gone/a.osc")}, {{"TMPDIR", path("spare")}});
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  strike(daemon, 10);
  ASSERT_TRUE(sync(daemon));
  fs::remove_all(folder_ / "gone");
  daemon.process().send_signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(), 1);
  const fs::path saved = folder_ / "spare" / ("ringdown-recording-" + std::to_string(daemon.process().id()) + ".osc");
  EXPECT_EQ(strikes_in(saved), 10u) << daemon.process().output();
  EXPECT_NE(daemon.process().output().find("the recording is in " + saved.string()), std::string::npos)
      << daemon.process().output();
}

TEST_F(LosingNothing, WhatCannotBeWrittenIsRefusedBeforeItPlays) {
  for (const char* option : {"--record", "--capture"}) {
    const Outcome refused = run({program("ringdownd"), "--driver", "null", "--port", "0", option,
                                 path(std::string("nowhere/take") + (option[2] == 'r' ? ".osc" : ".wav"))});
    EXPECT_EQ(refused.exit_code, 1) << option;
    EXPECT_NE(refused.output.find("nowhere/take"), std::string::npos) << refused.output;
    EXPECT_EQ(refused.output.find("ready"), std::string::npos) << refused.output;
  }
}

// A limit on the size of files stands in for a disk that is full.
TEST_F(LosingNothing, ACaptureKeepsWhatWasWrittenWhenTheDiskIsFull) {
  const std::string port = free_port();
  Process daemon(shell("ulimit -f 512;", "--port " + port + " --capture " + path("take.wav")));
  ASSERT_TRUE(daemon.wait_for_output("take.wav: the disk may be full; it holds the first")) << daemon.output();
  EXPECT_TRUE(answers(static_cast<std::uint16_t>(std::stoi(port)))) << "and the daemon plays on";
  const Samples heard = read_frames(folder_ / "take.wav");
  EXPECT_GT(heard.size(), 40'000u);
  EXPECT_LE(heard.size(), 512 * 512 / 4u);
  daemon.send_signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), 1) << "the capture is not what was asked for";
}

class LosingNothingOfJack : public JackTest {};

TEST_F(LosingNothingOfJack, ACaptureHasWhatJackPlays) {
  const fs::path live = folder_ / "live.wav";
  Daemon daemon({"--object", "tone=" + bank_.string(), "--capture", live.string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  daemon.send(strike("tone"));
  ASSERT_TRUE(becomes_true([&] { return status(daemon)->sounding_objects == 1; }));
  ASSERT_TRUE(becomes_true([&] { return status(daemon)->captured_s > 0.5; }));
  daemon.process().send_signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(), 0) << daemon.process().output();
  const Samples heard = read_left(live);
  EXPECT_GT(heard.size(), 24000u);
  EXPECT_GT(peak(heard), 0.01);
}

TEST_F(LosingNothingOfJack, ANameThatIsTooLongForJackIsRefusedByThatReason) {
  Daemon longest({"--name", std::string(63, 'n')}, server_.environment());
  EXPECT_TRUE(longest.ready()) << longest.process().output();
  const Outcome longer =
      run({program("ringdownd"), "--port", "0", "--name", std::string(64, 'n')}, server_.environment());
  EXPECT_EQ(longer.exit_code, 2);
  EXPECT_NE(longer.output.find("--name: JACK takes names of at most 63 bytes"), std::string::npos) << longer.output;
}

}  // namespace
}  // namespace ringdown::test
