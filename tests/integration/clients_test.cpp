// The senders in clients/ and common OSC programs, run for real against a daemon under JACK: the blow of each is found
// in what the daemon plays.
#include "engine/modal/bank_file.h"
#include "tests/integration/jack_fixture.h"
#include "tests/integration/jack_recorder.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/tone_samples.h"
#include "tests/support/whole_recording.h"

#include <fstream>

namespace ringdown::test {
namespace {

const std::string kClients = RINGDOWN_SOURCE_DIR "/clients/";
constexpr double kRate = 48000;
constexpr std::size_t kHeard = 4000;  // frames: what is looked at of a blow, less than lies between two of any client

class Clients : public JackTest {
 protected:
  void SetUp() override {
    JackTest::SetUp();
    const auto bell = folder_ / "bell.glb";  // that rings from whichever side it is struck
    ASSERT_TRUE(modal::write_bank(single_mode_bank(kPitch_hz, kDecay_per_s, {1, 1, 1}), bell));
    daemon_.emplace(std::vector<std::string>{"--object", "bell=" + bell.string()}, server_.environment());
    ASSERT_TRUE(daemon_->ready()) << daemon_->process().output();
  }

  [[nodiscard]] std::string port() const { return std::to_string(daemon_->port()); }

  // Runs a client and returns how its first blow begins. Nothing where that is no single tone: a block was lost, or
  // another blow came so soon that the two are one sound, for on a busy machine a client may send at once what it was
  // late with.
  std::optional<DampedSinusoid> take(const std::vector<std::string>& command, const Process::Environment& environment) {
    daemon_->send({"/clear", {}});
    EXPECT_TRUE(becomes_true([&] { return status(*daemon_)->sounding_objects == 0; }));
    JackRecorder recorder(server_.name(), "ear", static_cast<std::size_t>(kRate));
    EXPECT_TRUE(recorder.works() && recorder.connect("ringdown:out_left", "ear:in_1"));
    Process client(command, environment);
    if (!recorder.wait_for(static_cast<std::size_t>(kRate))) {
      ADD_FAILURE() << "nothing was heard of " << command.front() << "\n" << client.output();
      return std::nullopt;
    }
    const Samples heard = recorder.samples(0);
    const std::size_t begin = silence_before(heard);
    if (begin + kHeard > heard.size()) return std::nullopt;
    const auto blow = std::span(heard).subspan(begin, kHeard);
    const DampedSinusoid tone = fit_damped_sinusoid(blow, kRate);
    const bool is_one = relative_error_db(samples_of(tone, kRate, kHeard), blow) < -40;
    return is_one ? std::optional(tone) : std::nullopt;
  }

  // A client's first blow must ring at the bank's pitch, out of silence. A gain that the client moves meanwhile may
  // make the decay seem slower, by `rise_per_s`.
  void expect_blow(const std::vector<std::string>& command, const Process::Environment& environment = {},
                   double rise_per_s = 0) {
    const auto tone = whole_recording([&] { return take(command, environment); });
    ASSERT_TRUE(tone) << "no whole recording of one blow";
    EXPECT_NEAR(tone->frequency_hz, kPitch_hz, 1e-3 * kPitch_hz);
    EXPECT_GE(tone->decay_per_s, 0.9 * (kDecay_per_s - rise_per_s));
    EXPECT_LE(tone->decay_per_s, 1.1 * kDecay_per_s);
  }

  std::optional<Daemon> daemon_;
};

TEST_F(Clients, OscsendIsHeard) {
  if (!installed("oscsend")) GTEST_SKIP() << "oscsend (liblo-tools) is not installed";
  expect_blow({"oscsend", "osc.udp://127.0.0.1:" + port(), "/object/bell/strike", "ffffff", "0.05", "0", "0.02", "0",
               "0", "-0.02"});
}

TEST_F(Clients, PythonIsHeard) {
  if (!installed("python3")) GTEST_SKIP() << "python3 is not installed";
  expect_blow({"python3", kClients + "python/strike.py", "bell", "--port", port()});
}

TEST_F(Clients, PureDataIsHeard) {
  if (!installed("pd")) GTEST_SKIP() << "pd (puredata-core) is not installed";
  expect_blow({"pd", "-nogui", "-noaudio", "-nomidi", "-stderr", "-open", kClients + "puredata/strike.pd", "-send",
               "ringdown-port " + port() + "; strike bang; pd quit"});
}

TEST_F(Clients, SuperColliderIsHeard) {
  if (!installed("sclang")) GTEST_SKIP() << "sclang (supercollider-language) is not installed";
  // It turns the gain up from 1 to 2 in half a second, from some time after the blow on.
  expect_blow({"sclang", kClients + "supercollider/strike.scd"},
              {{"QTWEBENGINE_DISABLE_SANDBOX", "1"},
               {"QT_QPA_PLATFORM", "offscreen"},
               {"XDG_RUNTIME_DIR", folder_.path().string()},
               {"RINGDOWN_PORT", port()}},
              1.9);
}

// The package osc is fetched once, into the build folder.
TEST_F(Clients, NodeIsHeard) {
  if (!installed("node") || !installed("npm")) GTEST_SKIP() << "node and npm are not installed";
  const std::filesystem::path modules = RINGDOWN_BIN_DIR "/../node/node_modules";
  if (!std::filesystem::exists(modules / "osc")) {
    const Outcome fetched = run({"npm", "install", "osc@2.4.5", "--omit=optional", "--ignore-scripts", "--prefix",
                                 modules.parent_path().string()});
    if (fetched.exit_code != 0) GTEST_SKIP() << "npm cannot fetch the package osc\n" << fetched.output;
  }
  expect_blow({"node", kClients + "node/strike.js", "bell"},
              {{"NODE_PATH", modules.string()}, {"RINGDOWN_PORT", port()}});
}

// A ball that bounces in Godot: from its collision callback to the sound.
TEST_F(Clients, GodotIsHeard) {
  if (!installed("godot3-server")) GTEST_SKIP() << "godot3-server is not installed";
  const auto project = folder_ / "godot";
  std::filesystem::copy(kClients + "godot", project);
  expect_blow({"godot3-server", "--path", project.string()},
              {{"HOME", folder_.path().string()}, {"LC_ALL", "en_US"}, {"RINGDOWN_PORT", port()}});
}

// A ball that falls on a floor in Bullet and stays there.
TEST_F(Clients, TheBulletSimulatorIsHeard) {
  if (!std::filesystem::exists(program("ringdown-bullet"))) GTEST_SKIP() << "libbullet-dev is not installed";
  const auto scene = folder_ / "drop.toml";
  std::ofstream(scene) << R"(
[[object]]
name = "bell"
bank = "bell.glb"
[[static]]
name = "floor"
shape = "plane"
[[body]]
name = "ball"
object = "bell"
shape = "sphere"
radius_m = 0.05
density_kg_m3 = 1000
position_m = [0, 0, 0.3]
restitution = 0
[contact]
rest_damping_s_m = 0
)";
  expect_blow({program("ringdown-bullet"), scene.string(), "--seconds", "1", "--to", "osc.udp://127.0.0.1:" + port()});
}

TEST_F(Clients, TheRingdownCommandIsHeard) {
  expect_blow({program("ringdown"), "strike", "bell", "--at", "0.05,0,0.02", "--impulse", "0,0,-0.02", "--to",
               "osc.udp://127.0.0.1:" + port()});
}

}  // namespace
}  // namespace ringdown::test
