// What somebody at a window sees of a real daemon: its objects' banks and modes, and its scene. What they hear is in
// viewing_sound_test.cpp.
#include "engine/modal/bank_file.h"
#include "protocol/wire/message.h"
#include "tests/integration/jack_fixture.h"
#include "tests/integration/sound_file.h"
#include "tests/support/synthetic_bank.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

namespace ringdown::test {
namespace {

// A ball of water that hangs in the air, where nothing pulls.
constexpr const char* kRoom = R"(
[scene]
gravity_m_s2 = [0, 0, 0]
[[body]]
name = "ball"
shape = "sphere"
radius_m = 0.05
density_kg_m3 = 1000
position_m = [0, 0, 1]
)";
constexpr double kBall_kg = 1000 * 4.0 / 3 * std::numbers::pi * 0.05 * 0.05 * 0.05;

class Viewing : public JackTest {
 protected:
  void SetUp() override {
    JackTest::SetUp();
    modal::Bank bank = single_mode_bank(1210, 4);
    bank.frequency_hz = {1210, 290, 2003};
    bank.decay_per_s = {4, 2, 5};
    bank.radiation->maps.modes.assign(3, even_field(1210));
    bank.shapes.assign(12, {0, 0, 1});
    ASSERT_TRUE(modal::write_bank(bank, folder_ / "bell.glb"));
    std::ofstream(folder_ / "room.toml") << kRoom;
  }

  // Hands every notice on until one is enough.
  static bool follow(Daemon& daemon, const std::function<bool(const protocol::Reply&)>& enough) {
    return becomes_true([&] { return std::ranges::any_of(daemon.packet(), enough); });
  }
};

// Of two modes that begin alike, one of which dies twice as fast, the one is the square of the other at any time. (How
// fast they fall is told to the frame in tests/server/watch_test.cpp.)
TEST_F(Viewing, ToldAmplitudesFallAsTheBankSays) {
  Daemon daemon({"--object", "bell=" + (folder_ / "bell.glb").string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  constexpr double kBegin = 0.5;
  ASSERT_TRUE(done(daemon, {"/notify", {1, 60.f}}));
  ASSERT_TRUE(done(daemon, {"/object/bell/watch", {1}}));
  daemon.send({"/object/bell/ring", {0, 2, static_cast<float>(kBegin)}});

  double worst = 0, lowest = kBegin;
  ASSERT_TRUE(follow(daemon, [&](const protocol::Reply& reply) {
    const auto* modes = reply.get_if<protocol::NotifyModes>();
    if (!modes) return false;
    const auto amplitudes = wire::decode_floats(modes->amplitudes);
    EXPECT_EQ(amplitudes.size(), 3u);
    if (amplitudes.size() != 3 || amplitudes[0] == 0) return false;
    EXPECT_EQ(amplitudes[2], 0);
    EXPECT_LE(amplitudes[0], lowest * (1 + 1e-6));
    lowest = amplitudes[0];
    worst = std::max(worst, std::abs(kBegin * amplitudes[1] / amplitudes[0] / amplitudes[0] - 1));
    return lowest < kBegin / 10;
  }));
  EXPECT_LT(worst, 1e-5);
}

TEST_F(Viewing, ABanksPiecesMakeItsFile) {
  const std::string path = RINGDOWN_SOURCE_DIR "/presets/banks/bronze-bell.glb";
  std::ifstream file(path, std::ios::binary);
  const std::string wanted(std::istreambuf_iterator<char>(file), {});
  Daemon daemon({"--object", "bell=" + path}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const auto bell = ask_for<protocol::ObjectReply>(daemon, {"/object/bell/describe", {}});
  ASSERT_TRUE(bell);
  EXPECT_EQ(bell->bank, path);
  ASSERT_EQ(static_cast<std::size_t>(bell->bank_bytes), wanted.size());
  std::string got;
  while (got.size() < wanted.size()) {
    const auto piece =
        ask_for<protocol::BankReply>(daemon, {"/object/bell/bank", {static_cast<std::int32_t>(got.size())}});
    ASSERT_TRUE(piece && !piece->bytes.empty());
    EXPECT_EQ(piece->version, bell->version);
    ASSERT_EQ(static_cast<std::size_t>(piece->offset), got.size());
    std::ranges::transform(piece->bytes, std::back_inserter(got), [](std::byte b) { return static_cast<char>(b); });
  }
  EXPECT_TRUE(got == wanted);
}

TEST_F(Viewing, TheDemoIsDescribedAsItsFileSays) {
  const std::string path = RINGDOWN_SOURCE_DIR "/presets/scenes/demo.toml";
  Daemon daemon({"--scene", path}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  daemon.send({"/scene/describe", {}});
  std::optional<protocol::SceneReply> head;
  std::map<std::string, protocol::SceneBody> bodies;
  std::vector<protocol::SceneStatic> statics;
  ASSERT_TRUE(follow(daemon, [&](const protocol::Reply& reply) {
    if (const auto* scene = reply.get_if<protocol::SceneReply>()) head = *scene;
    if (const auto* body = reply.get_if<protocol::SceneBody>()) bodies[body->name] = *body;
    if (const auto* still = reply.get_if<protocol::SceneStatic>()) statics.push_back(*still);
    return head && bodies.size() == static_cast<std::size_t>(head->bodies) &&
           statics.size() == static_cast<std::size_t>(head->statics);
  }));
  EXPECT_EQ(head->file, path);
  EXPECT_EQ(head->duration_s, 12);
  EXPECT_EQ(head->field_of_view_degrees, 40);
  EXPECT_NEAR(head->camera_m.x, -2.55, 1e-6);
  EXPECT_NEAR(head->target_m.z, 0.31, 1e-6);
  ASSERT_EQ(bodies.size(), 7u);
  ASSERT_EQ(statics.size(), 1u);
  EXPECT_EQ(statics[0].shape, "plane");
  for (const char* name : {"bell", "bar", "bowl", "glass", "plate"}) {
    EXPECT_EQ(bodies[name].object, name);
    EXPECT_EQ(bodies[name].fixed, std::string(name) == "bell");
    EXPECT_GT(bodies[name].size_m.x * bodies[name].size_m.y * bodies[name].size_m.z, 0);
  }
  EXPECT_EQ(bodies["bell"].shape, "convex");
  EXPECT_EQ(bodies["second-cube"].object, "-");
  EXPECT_EQ(bodies["second-cube"].shape, "box");
  EXPECT_NEAR(bodies["second-cube"].size_m.y, 0.045, 1e-8);
}

TEST_F(Viewing, APushedBodyMovesByItsImpulseOverItsMass) {
  Daemon daemon({"--scene", (folder_ / "room.toml").string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  ASSERT_TRUE(done(daemon, {"/notify", {1, 60.f}}));
  const auto where = [&](const std::function<bool(double, Vec3)>& wanted) {
    double time_s = 0;
    return follow(daemon, [&](const protocol::Reply& reply) {
      if (const auto* scene = reply.get_if<protocol::NotifyScene>()) time_s = scene->time_s;
      const auto* body = reply.get_if<protocol::NotifyBody>();
      return body && wanted(time_s, body->position_m);
    });
  };
  ASSERT_TRUE(where([](double time_s, Vec3 position_m) {
    EXPECT_EQ(position_m, (Vec3{0, 0, 1}));
    return time_s > 0.1;
  }));
  ASSERT_TRUE(done(daemon, {"/scene/push", {0, 0.1f, 0.f, -0.02f}}));
  std::optional<std::pair<double, Vec3>> begin;
  ASSERT_TRUE(where([&](double time_s, Vec3 position_m) {
    if (position_m.x == 0) return false;
    if (!begin) begin = {time_s, position_m};
    const auto& [begin_s, begin_m] = *begin;
    const double elapsed_s = time_s - begin_s;
    if (elapsed_s < 0.5) return false;
    EXPECT_NEAR((position_m.x - begin_m.x) / elapsed_s, 0.1 / kBall_kg, 1e-4);
    EXPECT_NEAR((position_m.y - begin_m.y) / elapsed_s, 0, 1e-4);
    EXPECT_NEAR((position_m.z - begin_m.z) / elapsed_s, -0.02 / kBall_kg, 1e-4);
    return true;
  }));
}

// The choices are made while the object is silent: what rings is cut where the change happened to be taken up. What is
// played lies seconds ahead: what comes too late is not where the score says.
TEST_F(Viewing, ARecordedSessionOfRungAndChosenModesRendersToTheSameSamples) {
  const auto score = folder_ / "session.osc", live = folder_ / "live.wav", replay = folder_ / "replay.wav";
  const std::string bank = (folder_ / "bell.glb").string();
  {
    Daemon daemon({"--driver", "null", "--block", "128", "--object", "bell=" + bank, "--object", "cup=" + bank,
                   "--record", score.string(), "--capture", live.string()});
    ASSERT_TRUE(daemon.ready()) << daemon.process().output();
    ASSERT_TRUE(done(daemon, {"/object/bell/modes", {1, 1}}));
    ASSERT_TRUE(done(daemon, {"/object/cup/modes", {0, 2}}));
    const double start = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count() + 3;
    for (int i = 0; i < 10; ++i) {
      daemon.send_bundle(start + 0.0137 * i,
                         {{"/object/bell/ring", {i % 3, 2, 0.01f * static_cast<float>(i)}}, strike("bell", 0.01 * i)});
    }
    daemon.send_bundle(start + 0.2, {{"/object/cup/ring", {0, 3, 0.1f}}});
    ASSERT_TRUE(becomes_true([&] { return status(daemon)->sounding_objects == 2; }));
    ASSERT_TRUE(done(daemon, {"/quit", {}}));
    EXPECT_EQ(daemon.process().wait(), 0) << daemon.process().output();
  }
  const Outcome rendered = run({program("ringdown"), "render", "--events", score.string(), "--block", "128", "--fade",
                                "0", "-o", replay.string()});
  EXPECT_EQ(rendered.exit_code, 0) << rendered.output;
  const auto heard = read_frames(live);
  auto again = read_frames(replay);
  ASSERT_LE(heard.size(), again.size()) << "the score also has what was still to sound";
  again.resize(heard.size());
  EXPECT_TRUE(heard == again) << heard.size() << " and " << again.size() << " samples, "
                              << relative_error_db(heard, again) << " dB";
  EXPECT_GT(peak(heard), 0.01);
}

}  // namespace
}  // namespace ringdown::test
