// ringdownd as a program: what it answers, refuses, and how it ends. No JACK needed.
#include "engine/modal/bank_file.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/integration/sound_file.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>

namespace ringdown::test {
namespace {

using protocol::Done;
using protocol::Fail;
using wire::Message;

// A JACK server that certainly is not there.
const Process::Environment kNoJack = {{"JACK_DEFAULT_SERVER", "ringdown-test-nobody"}, {"JACK_NO_START_SERVER", "1"}};

class DaemonTest : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"low.glb", "high.glb"}) {
      const double pitch_hz = name[0] == 'l' ? 300 : 1200;
      ASSERT_TRUE(modal::write_bank(single_mode_bank(pitch_hz, 0.1), folder_ / name));
    }
  }

  [[nodiscard]] std::string bank(const std::string& name) const { return (folder_ / name).string(); }

  template <class Reply>
  Reply expect(Daemon& daemon, const Message& message) {
    const auto reply = daemon.ask(message);
    EXPECT_TRUE(reply) << "no answer to " << message.address;
    const auto* expected = reply ? reply->get_if<Reply>() : nullptr;
    if (expected) return *expected;
    if (reply) ADD_FAILURE() << message.address << " was answered by " << protocol::format(*reply).address;
    if (const auto* refusal = reply ? reply->get_if<Fail>() : nullptr) ADD_FAILURE() << refusal->sentence;
    return {};
  }

  TemporaryFolder folder_;
};

TEST_F(DaemonTest, TheDaemonLoadsStrikesRetunesAndFreesObjectsByNameAndNumber) {
  Daemon daemon({"--driver", "null", "--object", "low=" + bank("low.glb")});
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const auto loaded = expect<Done>(daemon, {"/load", {"high", bank("high.glb")}});
  ASSERT_TRUE(loaded.number);
  const std::string by_number = "/object/" + std::to_string(*loaded.number);

  daemon.send({by_number + "/strike", {1.f, 0.f, 0.f, 0.f, 0.f, 0.5f}});
  daemon.send({"/object/low/strike_vertex", {0, 0.f, 0.f, 0.5f}});
  daemon.send({"/object/low/gain", {0.5f}});
  daemon.send({"/object/low/pan", {-1.f}});
  expect<Done>(daemon, {"/object/low/material", {1.f, 1.f, 1.f, 4.f}});
  EXPECT_EQ(expect<protocol::Synced>(daemon, {"/sync", {7}}).id, 7);
  protocol::StatusReply status;
  EXPECT_TRUE(becomes_true([&] {
    status = expect<protocol::StatusReply>(daemon, {"/status", {}});
    return status.sounding_objects == 2;
  }));
  EXPECT_EQ(status.objects, 2);
  EXPECT_EQ(status.sample_rate_hz, 48000);

  expect<Done>(daemon, {by_number + "/free", {}});
  EXPECT_EQ(expect<protocol::StatusReply>(daemon, {"/status", {}}).objects, 1);
  EXPECT_NE(expect<Fail>(daemon, {by_number + "/free", {}}).sentence.find("object"), std::string::npos);
}

TEST_F(DaemonTest, EveryRefusalByTheDaemonNamesWhatIsWrong) {
  Daemon daemon({"--driver", "null", "--object", "low=" + bank("low.glb")});
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const std::vector<std::pair<Message, std::string>> refused = {
      {{"/object/nobody/strike", {0.f, 0.f, 0.f, 0.f, 0.f, 1.f}}, "nobody"},
      {{"/object/low/strike", {0.f, 0.f, 0.f, 0.f, 0.f}}, "jz"},
      {{"/object/low/strike", {0.f, 0.f, NAN, 0.f, 0.f, 1.f}}, "z"},
      {{"/object/low/strike_vertex", {99, 0.f, 0.f, 1.f}}, "vertex"},
      {{"/object/low/gain", {-1.f}}, "gain"},
      {{"/object/low/material", {1.f, 1.f, 0.f, 1.f}}, "density"},
      {{"/load", {"new", bank("missing.glb")}}, "missing.glb"},
      {{"/load", {"bad name", bank("low.glb")}}, "name"},
      {{"/scene/load", {bank("missing.toml")}}, "missing.toml"},
      {{"/scene/pause", {}}, "no scene"},
      {{"/no/such/address", {}}, "/no/such/address"},
  };
  for (const auto& [message, word] : refused) {
    const auto refusal = expect<Fail>(daemon, message);
    EXPECT_NE(refusal.sentence.find(word), std::string::npos) << message.address << ": " << refusal.sentence;
  }
}

TEST_F(DaemonTest, TheDaemonAnswersVersionAndStopsOnQuit) {
  Daemon daemon({"--driver", "null"});
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  EXPECT_EQ(expect<protocol::VersionReply>(daemon, {"/version", {}}).program, "ringdownd");
  expect<Done>(daemon, {"/quit", {}});
  EXPECT_EQ(daemon.process().wait(), 0);
}

TEST_F(DaemonTest, TheDaemonStopsCleanlyOnBothSignals) {
  for (const int signal : {SIGINT, SIGTERM}) {
    Daemon daemon({"--driver", "null", "--object", "low=" + bank("low.glb")});
    ASSERT_TRUE(daemon.ready()) << daemon.process().output();
    daemon.process().send_signal(signal);
    EXPECT_EQ(daemon.process().wait(), 0) << daemon.process().output();
  }
}

TEST_F(DaemonTest, NoJackServerABusyPortAndABadBankHaveTheirOwnExitCodes) {
  const Outcome no_jack = run({program("ringdownd"), "--port", "0"}, kNoJack);
  EXPECT_EQ(no_jack.exit_code, 4);
  EXPECT_NE(no_jack.output.find("no JACK server"), std::string::npos) << no_jack.output;
  EXPECT_EQ(std::count(no_jack.output.begin(), no_jack.output.end(), '\n'), 1) << no_jack.output;

  Daemon first({"--driver", "null"});
  const Outcome busy = run({program("ringdownd"), "--driver", "null", "--port", std::to_string(first.port())});
  EXPECT_EQ(busy.exit_code, 5);
  EXPECT_NE(busy.output.find(std::to_string(first.port())), std::string::npos) << busy.output;

  std::ofstream(folder_ / "broken.glb") << "this is no bank";
  const Outcome broken =
      run({program("ringdownd"), "--driver", "null", "--port", "0", "--object", "x=" + bank("broken.glb")});
  EXPECT_EQ(broken.exit_code, 3);
  EXPECT_NE(broken.output.find("broken.glb"), std::string::npos) << broken.output;

  EXPECT_EQ(run({program("ringdownd"), "--object", "no-equals-sign"}).exit_code, 2);
  EXPECT_EQ(run({program("ringdownd"), "--help"}).exit_code, 0);
}

TEST_F(DaemonTest, ASceneIsSentToAnotherDaemonAsOsc) {
  std::ofstream(folder_ / "drop.toml") << R"(
[[object]]
name = "ball"
bank = "low.glb"
[[static]]
name = "floor"
shape = "plane"
[[body]]
name = "ball"
object = "ball"
shape = "sphere"
radius_m = 0.05
density_kg_m3 = 1000
position_m = [0, 0, 0.2]
)";
  Daemon listener({"--driver", "null", "--object", "ball=" + bank("low.glb")});
  ASSERT_TRUE(listener.ready());
  Daemon sender({"--driver", "null", "--scene", (folder_ / "drop.toml").string(), "--scene-to",
                 "osc.udp://127.0.0.1:" + std::to_string(listener.port())});
  ASSERT_TRUE(sender.ready()) << sender.process().output();
  EXPECT_TRUE(becomes_true([&] {
    return expect<protocol::StatusReply>(listener, {"/status", {}}).sounding_objects == 1;
  }));
  EXPECT_EQ(expect<protocol::StatusReply>(sender, {"/status", {}}).sounding_objects, 0);
}

TEST_F(DaemonTest, TheWavDriverWritesTheSceneToAFile) {
  std::ofstream(folder_ / "still.toml") << "[[object]]\nname = \"ball\"\nbank = \"low.glb\"\n";
  const auto file = folder_ / "out.wav";
  const Outcome written = run({program("ringdownd"), "--driver", "wav", "--scene", (folder_ / "still.toml").string(),
                               "--seconds", "0.5", "-o", file.string()});
  EXPECT_EQ(written.exit_code, 0) << written.output;
  EXPECT_GT(std::filesystem::file_size(file), 24000u * 8);
  const Outcome recorded = run({program("ringdownd"), "--driver", "wav", "--scene", (folder_ / "still.toml").string(),
                                "--record", (folder_ / "score.osc").string(), "-o", file.string()});
  EXPECT_EQ(recorded.exit_code, 2);
  EXPECT_NE(recorded.output.find("--record"), std::string::npos) << recorded.output;
  const Outcome missing = run({program("ringdownd"), "--driver", "wav", "--scene", bank("missing.toml")});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_NE(missing.output.find("missing.toml"), std::string::npos) << missing.output;
}

// What is played lies seconds ahead: what comes too late is not where the score says.
TEST_F(DaemonTest, ARecordedSessionRendersToTheSameSamples) {
  const auto score = folder_ / "session.osc", live = folder_ / "live.wav", replay = folder_ / "replay.wav";
  {
    Daemon daemon({"--driver", "null", "--block", "128", "--object", "low=" + bank("low.glb"), "--object",
                   "high=" + bank("high.glb"), "--record", score.string(), "--capture", live.string()});
    ASSERT_TRUE(daemon.ready()) << daemon.process().output();
    const double start = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count() + 3;
    for (int i = 0; i < 40; ++i) {
      const std::string name = i % 3 ? "low" : "high";
      std::vector<Message> together = {
          protocol::format(protocol::Strike{{.name = name}, {{1, 0, 0.02 * i}, {0, 0, 0.01 * i}, 1e-4 * (i % 7)}}),
          protocol::format(protocol::StrikeVertex{{.name = name}, {1, {0, 0, 0.1}, 0}})};
      if (i % 5 == 0) together.push_back({"/object/*/gain", {0.2f + 0.01f * i, 0.03f}});
      if (i % 7 == 0) together.push_back({"/object/" + name + "/pan", {0.02f * i}});
      if (i == 20) together.push_back({"/object/low/clear", {}});
      daemon.send_bundle(start + 0.0137 * i, together);
    }
    EXPECT_TRUE(becomes_true([&] {
      return expect<protocol::StatusReply>(daemon, {"/status", {}}).sounding_objects == 2;
    }));
    daemon.send({"/quit", {}});
    EXPECT_EQ(daemon.process().wait(), 0) << daemon.process().output();
  }
  const auto render = [&](const std::filesystem::path& to) {
    const Outcome rendered = run({program("ringdown"), "render", "--events", score.string(), "--block", "128", "--fade",
                                  "0", "-o", to.string()});
    EXPECT_EQ(rendered.exit_code, 0) << rendered.output;
    return read_frames(to);
  };
  const auto heard = read_frames(live), again = render(replay), third = render(folder_ / "third.wav");
  EXPECT_EQ(again, third);
  ASSERT_GT(heard.size(), 2 * 48000u);
  ASSERT_LE(heard.size(), again.size()) << "the score also has what was still to sound";
  const Samples begin(again.begin(), again.begin() + static_cast<std::ptrdiff_t>(heard.size()));
  EXPECT_TRUE(heard == begin) << relative_error_db(heard, begin) << " dB";
  EXPECT_GT(peak(heard), 0.001);
}

TEST_F(DaemonTest, FilesOutsideTheDaemonsFoldersStayClosed) {
  std::filesystem::create_directory(folder_ / "open");
  Daemon daemon({"--driver", "null", "--root", (folder_ / "open").string()});
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const auto refused = expect<Fail>(daemon, {"/load", {"x", bank("low.glb")}});
  EXPECT_NE(refused.sentence.find("--root"), std::string::npos) << refused.sentence;
  std::filesystem::copy_file(folder_ / "low.glb", folder_ / "open/low.glb");
  expect<Done>(daemon, {"/load", {"x", (folder_ / "open/low.glb").string()}});
  const auto record = expect<Fail>(daemon, {"/record/start", {bank("stolen.osc")}});
  EXPECT_NE(record.sentence.find("--root"), std::string::npos) << record.sentence;
}

TEST_F(DaemonTest, WithoutAvahiTheDaemonIsNotAnnouncedAndSaysSoOnce) {
  Daemon daemon({"--driver", "null", "--zeroconf"}, {{"DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/nowhere/bus"}});
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  ASSERT_TRUE(daemon.process().wait_for_output("not announced by Zeroconf")) << daemon.process().output();
  EXPECT_TRUE(daemon.ask({"/status", {}})->holds<protocol::StatusReply>());
  daemon.process().send_signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(), 0) << daemon.process().output();
  const std::string output = daemon.process().output();
  EXPECT_EQ(output.find("Zeroconf"), output.rfind("Zeroconf")) << output;
}

}  // namespace
}  // namespace ringdown::test
