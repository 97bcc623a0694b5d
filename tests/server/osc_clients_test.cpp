// The senders in clients/, oscsend and the `ringdown` program against a daemon of the test's own: a socket that answers
// /sync and keeps what arrives. What is sent must arrive, and parse.
#include "clients/cli/pitch.h"
#include "protocol/bulk.h"
#include "protocol/help.h"
#include "protocol/schema.h"
#include "server/osc_codec.h"
#include "server/osc_socket.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace ringdown::server {
namespace {

using protocol::Message;
using protocol::Request;
using protocol::Strike;

const std::string kRingdown = RINGDOWN_BIN_DIR "/ringdown";

struct Outcome {
  int exit_code = 0;
  std::string output;  // stdout and stderr
};

Outcome run(const std::string& command) {
  std::FILE* const pipe = ::popen((command + " 2>&1 </dev/null").c_str(), "r");
  Outcome outcome;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) outcome.output.push_back(static_cast<char>(c));
  outcome.exit_code = WEXITSTATUS(::pclose(pipe));
  return outcome;
}

bool is_installed(const std::string& tool) { return run("command -v " + tool).exit_code == 0; }

// Listens until it is destroyed.
class FakeDaemon {
 public:
  // `answer` replies to each request that is no /sync; nullopt is silence.
  using Answer = std::function<std::optional<protocol::Reply>(const Message&)>;
  explicit FakeDaemon(Answer answer = [](const Message&) { return std::nullopt; })
      : answer_(std::move(answer)), thread_([this] { listen(); }) {}
  ~FakeDaemon() {
    stopping_ = true;
    socket_.wake();
    thread_.join();
  }

  [[nodiscard]] std::string port() const { return std::to_string(socket_.port()); }
  [[nodiscard]] std::string url() const { return "osc.udp://127.0.0.1:" + port(); }

  // Waits until `count` messages have arrived; ends early when they do not come.
  std::vector<TimedMessage> received(std::size_t count) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < deadline) {
      {
        const std::lock_guard lock(mutex_);
        if (received_.size() >= count) return received_;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    const std::lock_guard lock(mutex_);
    return received_;
  }

 private:
  void listen() {
    Datagram datagram;
    while (!stopping_) {
      if (!socket_.receive(datagram, std::chrono::seconds(1))) continue;
      const auto messages = decode_packet(datagram.bytes);
      ASSERT_TRUE(messages) << messages.error().message;
      for (const TimedMessage& timed : *messages) handle(timed, datagram.from);
    }
  }

  void handle(const TimedMessage& timed, Endpoint from) {
    const auto request = protocol::parse(timed.message);
    if (request && std::holds_alternative<protocol::Sync>(*request) && timed.message.arguments.size() == 1) {
      const protocol::Reply synced = protocol::Synced{std::get<protocol::Sync>(*request).id};
      ASSERT_TRUE(socket_.send_to(from, encode(protocol::format(synced))));
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      received_.push_back(timed);
    }
    if (const auto reply = answer_(timed.message)) {
      ASSERT_TRUE(socket_.send_to(from, encode(protocol::format(*reply))));
    }
  }

  OscSocket socket_ = std::move(*OscSocket::bind());
  Answer answer_;
  std::atomic<bool> stopping_ = false;
  std::mutex mutex_;
  std::vector<TimedMessage> received_;
  std::thread thread_;
};

Strike strike_in(const TimedMessage& timed) {
  const auto request = protocol::parse(timed.message);
  EXPECT_TRUE(request) << request.error().message;
  const auto* strike = request ? std::get_if<Strike>(&*request) : nullptr;
  EXPECT_TRUE(strike) << timed.message.address;
  return strike ? *strike : Strike{};
}

void expect_example_blow(const TimedMessage& timed) {
  const Strike strike = strike_in(timed);
  EXPECT_EQ(strike.object.name, "bell");
  EXPECT_NEAR(length(strike.point_m - Vec3{0.05, 0, 0.02}), 0, 1e-8);
  EXPECT_NEAR(length(strike.impulse_ns - Vec3{-0.02, 0, 0}), 0, 1e-8);
}

TEST(OscClients, EveryExampleOfTheManualWorksWithOscsend) {
  if (!is_installed("oscsend")) GTEST_SKIP() << "oscsend (liblo-tools) is not installed";
  for (const protocol::AddressSpec& spec : protocol::addresses()) {
    if (spec.address == "/sync") continue;  // the test's daemon answers it itself
    std::string command = protocol::oscsend_command(spec);
    if (command.empty()) continue;  // a blob
    FakeDaemon daemon;
    command.replace(command.find("7770"), 4, daemon.port());
    ASSERT_EQ(run(command).exit_code, 0) << command;
    const auto received = daemon.received(1);
    ASSERT_EQ(received.size(), 1u) << command;
    const auto request = protocol::parse(received[0].message);
    ASSERT_TRUE(request) << command << ": " << request.error().message;
    const auto example = protocol::parse(spec.example);
    EXPECT_EQ(request->index(), example->index());
    EXPECT_EQ(received[0].message.address, spec.example.address);
    EXPECT_EQ(received[0].message.arguments.size(), spec.example.arguments.size());
  }
}

TEST(OscClients, PythonStrikesNowAndInTimedBundles) {
  if (!is_installed("python3")) GTEST_SKIP() << "python3 is not installed";
  FakeDaemon daemon;
  const Outcome outcome =
      run("python3 " RINGDOWN_SOURCE_DIR "/clients/python/strike.py bell --roll 3 --port " + daemon.port());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const auto received = daemon.received(4);
  ASSERT_EQ(received.size(), 4u);
  expect_example_blow(received[0]);
  expect_example_blow(received[1]);
  EXPECT_EQ(received[0].time, kImmediately);
  for (std::size_t i = 2; i < 4; ++i) {
    EXPECT_NEAR(unix_seconds(received[i].time) - unix_seconds(received[i - 1].time), 0.12, 1e-6);
  }
}

TEST(OscClients, PythonRainsManyBlowsInFewMessages) {
  if (!is_installed("python3")) GTEST_SKIP() << "python3 is not installed";
  FakeDaemon daemon;
  const Outcome outcome =
      run("python3 " RINGDOWN_SOURCE_DIR "/clients/python/strike.py bell --rain 2000 --port " + daemon.port());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const auto received = daemon.received(3);
  ASSERT_EQ(received.size(), 3u);
  std::vector<protocol::BulkStrike> blows;
  for (std::size_t i = 1; i < 3; ++i) {
    const auto request = protocol::parse(received[i].message);
    ASSERT_TRUE(request) << request.error().message;
    const auto some = protocol::decode_strikes(std::get<protocol::StrikeMany>(*request).records);
    ASSERT_TRUE(some) << some.error().message;
    blows.insert(blows.end(), some->begin(), some->end());
  }
  ASSERT_EQ(blows.size(), 2000u);
  for (std::size_t i = 0; i < blows.size(); ++i) {
    EXPECT_EQ(blows[i].object, 0u);
    EXPECT_FALSE(blows[i].vertex);
    EXPECT_NEAR(length(blows[i].point_m - Vec3{0.05, 0, 0.02}), 0, 1e-8);
    EXPECT_NEAR(length(blows[i].impulse_ns - Vec3{-0.001, 0, 0}), 0, 1e-8);
    EXPECT_NEAR(blows[i].delay_s, static_cast<double>(i) / 2000, 1e-7);
  }
}

TEST(OscClients, PythonSaysWhatTheDaemonRefused) {
  if (!is_installed("python3")) GTEST_SKIP() << "python3 is not installed";
  FakeDaemon daemon([](const Message& message) { return protocol::Fail{message.address, "there is no bell"}; });
  const Outcome outcome = run("python3 " RINGDOWN_SOURCE_DIR "/clients/python/strike.py bell --port " + daemon.port());
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_NE(outcome.output.find("there is no bell"), std::string::npos) << outcome.output;
}

TEST(OscClients, PureDataStrikes) {
  if (!is_installed("pd")) GTEST_SKIP() << "pd (puredata-core) is not installed";
  FakeDaemon daemon;
  const Outcome outcome = run("timeout 30 pd -nogui -noaudio -nomidi -stderr -open " RINGDOWN_SOURCE_DIR
                              "/clients/puredata/strike.pd"
                              " -send 'ringdown-port " +
                              daemon.port() + "; strike bang; pd quit'");
  const auto received = daemon.received(1);
  ASSERT_EQ(received.size(), 1u) << outcome.output;
  expect_example_blow(received[0]);
  EXPECT_NEAR(strike_in(received[0]).contact_time_s, 0.0005, 1e-8);
}

TEST(OscClients, SuperColliderStrikes) {
  if (!is_installed("sclang")) GTEST_SKIP() << "sclang (supercollider-language) is not installed";
  FakeDaemon daemon;
  const Outcome outcome = run("QTWEBENGINE_DISABLE_SANDBOX=1 QT_QPA_PLATFORM=offscreen RINGDOWN_PORT=" + daemon.port() +
                              " timeout 60 sclang " RINGDOWN_SOURCE_DIR "/clients/supercollider/strike.scd");
  const auto received = daemon.received(10);
  ASSERT_EQ(received.size(), 10u) << outcome.output;
  expect_example_blow(received[0]);
}

TEST(OscClients, TheGameEngineExampleBounces) {
  FakeDaemon daemon;
  EXPECT_EQ(run(RINGDOWN_BIN_DIR "/game_engine_strike bell " + daemon.port()).exit_code, 0);
  const auto received = daemon.received(5);
  ASSERT_EQ(received.size(), 5u);
  // Restitution 0.6: each impulse is 0.6 of the one before, the first m v (1 + e).
  double expected = -0.02 * 1.98 * 1.6;
  for (const TimedMessage& timed : received) {
    EXPECT_NEAR(strike_in(timed).impulse_ns.z, expected, 1e-6);
    expected *= 0.6;
  }
}

TEST(RingdownStrike, SendsAPointOrAVertex) {
  FakeDaemon daemon;
  const std::string strike = kRingdown + " strike bell --to " + daemon.url();
  const Outcome at = run(strike + " --at 0.05,0,0.02 --impulse -0.02,0,0");
  EXPECT_EQ(at.exit_code, 0) << at.output;
  EXPECT_EQ(at.output, "");
  const Outcome vertex = run(strike + " --vertex 7 --impulse 0,0,-1e-2 --contact-time 0");
  EXPECT_EQ(vertex.exit_code, 0) << vertex.output;
  const auto received = daemon.received(2);
  ASSERT_EQ(received.size(), 2u);
  expect_example_blow(received[0]);
  EXPECT_EQ(received[1].message, (Message{"/object/bell/strike_vertex", {7., 0., 0., -0.01, 0.}}));
}

TEST(RingdownStrike, ARefusalByTheDaemonIsPrinted) {
  FakeDaemon daemon([](const Message& message) { return protocol::Fail{message.address, "there is no bell"}; });
  const Outcome outcome = run(kRingdown + " strike bell --vertex 0 --impulse 1,0,0 --to " + daemon.url());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.output, "ringdown: there is no bell\n");
}

TEST(RingdownStrike, WithoutADaemonItSaysSo) {
  const OscSocket deaf = std::move(*OscSocket::bind());  // a port that nobody answers
  const std::string url = "osc.udp://127.0.0.1:" + std::to_string(deaf.port());
  const Outcome outcome = run(kRingdown + " strike bell --vertex 0 --impulse 1,0,0 --timeout 0.2 --to " + url);
  EXPECT_EQ(outcome.exit_code, 6);
  EXPECT_NE(outcome.output.find("no answer from a daemon at " + url), std::string::npos) << outcome.output;
}

TEST(RingdownStrike, WrongUseIsRefusedBeforeAnythingIsSent) {
  const std::pair<const char*, const char*> wrong[] = {
      {"strike", "object"},
      {"strike bell --impulse 1,0,0", "--at"},
      {"strike bell --at 0,0,0 --vertex 1 --impulse 1,0,0", "--vertex"},
      {"strike bell --at 0,0,0", "--impulse"},
      {"strike bell --at 0,0 --impulse 1,0,0", "--at"},
      {"strike bell --at 0,0,x --impulse 1,0,0", "(z)"},
      {"strike bell --at 0,0,nan --impulse 1,0,0", "(z)"},
      {"strike bell --at 0,0,0 --impulse 1e9,0,0", "(jx)"},
      {"strike bell --vertex 0.5 --impulse 1,0,0", "(vertex)"},
      {"strike 'my bell' --vertex 0 --impulse 1,0,0", "(object)"},
      {"strike bell --vertex 0 --impulse 1,0,0 --contact-time 1", "(contact_time)"},
      {"strike bell --vertex 0 --impulse 1,0,0 --to localhost:7770", "osc.udp://"},
      {"send /stauts", "/status"},
      {"send /object/bell/gain", "(gain)"},
      {"", "subcommand"},
      {"stike", ""},
  };
  for (const auto& [arguments, named] : wrong) {
    const Outcome outcome = run(kRingdown + " " + arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments << ": " << outcome.output;
    EXPECT_NE(outcome.output.find(named), std::string::npos) << arguments << ": " << outcome.output;
  }
}

TEST(RingdownStrike, HelpDescribesTheArgumentsAsTheTableDoes) {
  const std::string help = run(kRingdown + " strike --help").output;
  std::string flat;  // CLI11 breaks lines
  for (const char c : help) {
    if (c != '\n' && !(c == ' ' && flat.ends_with(' '))) flat += c;
  }
  for (const protocol::ArgumentSpec& argument : (*protocol::find_address("/object/0/strike"))->arguments) {
    if (argument.sentence.starts_with("Its ")) continue;  // y and z stand with x
    EXPECT_NE(flat.find(argument.sentence), flat.npos) << argument.name << " in\n" << help;
  }
}

TEST(RingdownSend, PrintsTheAnswer) {
  FakeDaemon daemon([](const Message&) { return protocol::VersionReply{"ringdownd", "9.8", 1}; });
  const Outcome outcome = run(kRingdown + " send /version --to " + daemon.url());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("9.8"), std::string::npos) << outcome.output;
}

TEST(RingdownSend, PrintsTheNumberButNotTheAddressThatWasAsked) {
  FakeDaemon daemon([](const Message& message) { return protocol::Done{message.address, 42}; });
  const Outcome outcome = run(kRingdown + " send /load bell a.glb --to " + daemon.url());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("42"), std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find("/load"), std::string::npos) << outcome.output;
}

TEST(RingdownSend, WaitsForItsOwnAnswerAndNotForAnothers) {
  FakeDaemon daemon([](const Message&) { return protocol::Done{"/scene/clear", 1}; });
  const Outcome outcome = run(kRingdown + " send /load bell a.glb --timeout 0.2 --to " + daemon.url());
  EXPECT_EQ(outcome.exit_code, 6) << outcome.output;
}

TEST(RingdownProtocol, MarkdownIsTheCommittedManual) {
  std::ifstream file(RINGDOWN_SOURCE_DIR "/docs/protocol.md");
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(run(kRingdown + " protocol --markdown").output, text.str());
}

// A folder with a copy of the program, and perhaps something else for its sibling.
class BakeFolder : public ::testing::Test {
 protected:
  BakeFolder() { std::filesystem::copy_file(kRingdown, folder_ / "ringdown"); }
  ~BakeFolder() override { std::filesystem::remove_all(folder_); }

  static std::filesystem::path make_folder() {
    std::string name = (std::filesystem::temp_directory_path() / "ringdown-bake-XXXXXX").string();
    return ::mkdtemp(name.data());
  }
  [[nodiscard]] Outcome bake(const std::string& arguments) const {
    return run((folder_ / "ringdown").string() + " bake " + arguments);
  }

  std::filesystem::path folder_ = make_folder();
};

TEST_F(BakeFolder, EveryArgumentReachesTheSiblingUnchanged) {
  const std::filesystem::path sibling = folder_ / "ringdown-bake";
  std::ofstream(sibling) << "#!/bin/sh\nprintf '<%s>' \"$@\"\nexit 7\n";
  std::filesystem::permissions(sibling, std::filesystem::perms::owner_all);
  const Outcome outcome = bake("'a b.toml' -o x.glb --help --modes=3 -- -y ''");
  EXPECT_EQ(outcome.output, "<a b.toml><-o><x.glb><--help><--modes=3><--><-y><>");
  EXPECT_EQ(outcome.exit_code, 7);
  EXPECT_EQ(bake("--help").output, "<--help>");
}

TEST_F(BakeFolder, WithoutTheSiblingOneSentenceSaysSo) {
  const Outcome outcome = bake("a.toml");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.output.find((folder_ / "ringdown-bake").string()), std::string::npos) << outcome.output;
}

TEST(NoteName, FollowsEqualTemperament) {
  EXPECT_EQ(cli::note_name(440), "A4 +0 ct");
  EXPECT_EQ(cli::note_name(261.6256), "C4 +0 ct");  // middle C
  EXPECT_EQ(cli::note_name(246.9417), "B3 +0 ct");  // the octave's number changes at C
  EXPECT_EQ(cli::note_name(27.5), "A0 +0 ct");      // the piano's lowest
  EXPECT_EQ(cli::note_name(20), "D#0 +49 ct");      // 19.445 Hz, and 1200 log2(20 / 19.445) = 48.7
  EXPECT_EQ(cli::note_name(450), "A4 +39 ct");      // 1200 log2(45 / 44) = 38.9
  EXPECT_EQ(cli::note_name(0), "");
}

TEST(RingdownInfo, ListsEveryModeOfABank) {
  const std::string bank = RINGDOWN_SOURCE_DIR "/presets/banks/bronze-bell.glb";
  const Outcome outcome = run(kRingdown + " info " + bank);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  std::istringstream lines(outcome.output);
  std::string line;
  std::getline(lines, line);
  const std::size_t modes = std::stoul(line.substr(line.find(": ") + 2));
  while (std::getline(lines, line) && line.find("frequency Hz") == line.npos) {
  }
  std::size_t rows = 0;
  for (; std::getline(lines, line); ++rows) {
    std::istringstream row(line);
    std::size_t number = 0;
    double frequency = 0, t60 = 0, decay = 0;
    row >> number >> frequency >> t60 >> decay;
    EXPECT_EQ(number, rows);
    EXPECT_NEAR(t60 * decay, std::log(1000.0), 0.01) << line;
    EXPECT_TRUE(frequency >= 20 && frequency <= 20000) << line;
  }
  EXPECT_GT(modes, 0u);
  EXPECT_EQ(rows, modes);
}

TEST(RingdownInfo, AMissingBankIsABadInput) {
  const Outcome outcome = run(kRingdown + " info /nonexistent.glb");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.output.find("/nonexistent.glb"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace ringdown::server
