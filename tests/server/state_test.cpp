// The state file: what is written is read back, and a daemon restored from it is the one that was saved.
#include "server/session/state.h"

#include "engine/modal/bank_file.h"
#include "server/session/file_roots.h"
#include "server/session/session.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <unistd.h>

namespace ringdown::server {
namespace {

class StateTest : public testing::Test {
 protected:
  StateTest() {
    for (const auto& path : {bank_, folder_ / "b.glb"}) {
      EXPECT_TRUE(modal::write_bank(test::single_mode_bank(440, 2), path));
    }
  }

  std::string refusal(const std::string& text) const {
    const auto state = session::parse_state(text, folder_ / "s.toml");
    return state ? "nothing" : state.error().message;
  }

  test::TemporaryFolder folder_;
  std::filesystem::path bank_ = folder_ / "a \"b\" \\ \t.glb";
};

struct Daemon {
  session::Session session{48000};
};

TEST_F(StateTest, TheListenerComesBack) {
  Daemon one, other;
  EXPECT_FALSE(session::state_of(one.session).listener) << "there has never been one";
  const Pose pose{{1, -2, 0.5}, normalized(Rotation::from_xyzw(0.1, 0.2, -0.3, 0.9))};
  ASSERT_TRUE(one.session.play(protocol::SetListener{{pose}}, 0));
  ASSERT_TRUE(one.session.play(protocol::SetListenerAir{{-5, 80}}, 0));
  const auto come_back = [&] {
    const auto state = session::parse_state(to_toml(session::state_of(one.session)), folder_ / "s.toml");
    EXPECT_TRUE(state) << state.error().message;
    EXPECT_TRUE(restore(*state, other.session, 0));
    return session::state_of(other.session).listener.value_or(session::ListenerMemory::Listener{});
  };
  const auto on = come_back();
  EXPECT_TRUE(on.on);
  EXPECT_EQ(on.pose.position_m, pose.position_m);
  EXPECT_NEAR(on.pose.rotation.z, pose.rotation.z, 1e-12);
  EXPECT_EQ(on.temperature_c, -5);
  EXPECT_EQ(on.humidity_percent, 80);
  EXPECT_TRUE(other.session.rack().listener().on());
  ASSERT_TRUE(one.session.play(protocol::ListenerOff{}, 0));
  EXPECT_FALSE(come_back().on);
  EXPECT_FALSE(other.session.rack().listener().on());
  EXPECT_NE(refusal("[listener]\nrotation = [1, 0, 0, 1]\n").find("a quaternion of length 1"), std::string::npos);
}

TEST_F(StateTest, ASavedStateComesBackInAnotherDaemon) {
  std::ofstream(folder_ / "fall.toml") << R"(
[[object]]
name = "bell"
bank = "b.glb"
gain = 0.1
group = "glass"
[[static]]
name = "floor"
shape = "plane"
[[body]]
name = "ball"
object = "bell"
shape = "sphere"
radius_m = 0.05
density_kg_m3 = 1000
position_m = [0, 0, 1]
)";
  Daemon one, other;
  const auto perform = [&](const auto& request) { ASSERT_TRUE(one.session.perform(request, 0)); };
  perform(protocol::SceneLoad{(folder_ / "fall.toml").string()});
  perform(protocol::ScenePause{true});
  perform(protocol::LoadObject{"plain", bank_.string()});
  perform(protocol::SetMaterial{{.name = "bell"}, {1, 0.1, 2, 1.0 / 3, 0.7}});
  perform(protocol::SetGroup{{.name = "bell"}, "metal"});
  perform(protocol::SetMute{{.name = "bell"}});
  perform(protocol::SetSolo{{.name = "plain"}});
  perform(protocol::Hold{{.name = "bell"}, {{0.1, 0, 0}, {0, 0, 1}, 5}, 3});
  perform(protocol::Hold{{.name = "bell"}, {{0.2, 0, 0}, {}, 7}, modal::kFirstSceneDamper});  // as the scene's own
  perform(protocol::Excite{{.name = "bell"}, 3, {0.1, 0.2, 0.3}, {0, 0, -1e-7}});
  ASSERT_TRUE(one.session.play(protocol::SetGain{{.name = "bell"}, {0.7, 2}}, 0));
  ASSERT_TRUE(one.session.play(protocol::SetPan{{.name = "bell"}, {-0.3}}, 0));

  const auto file = folder_ / "state.toml";
  ASSERT_TRUE(session::write_state(session::state_of(one.session), file));
  EXPECT_TRUE(session::FileRoots().writable(file, session::kStateKind)) << "a state may replace a state";
  const auto state = session::read_state(file);
  ASSERT_TRUE(state) << state.error().message;
  const auto restored = restore(*state, other.session, 48000);
  ASSERT_TRUE(restored) << restored.error().message;

  const auto found = other.session.rack().find({.name = "bell"});
  ASSERT_TRUE(found);
  const session::ObjectState* const bell = found->get();
  EXPECT_EQ(bell->bank, folder_ / "b.glb");
  EXPECT_EQ(bell->group, "metal");
  EXPECT_TRUE(bell->mute);
  EXPECT_FALSE(bell->solo);
  EXPECT_EQ(bell->material, (modal::MaterialScale{1, 0.1, 2, 1.0 / 3, 0.7}));
  EXPECT_EQ(bell->dampers, (modal::Dampers{{3, {{0.1, 0, 0}, {0, 0, 1}, 5}}}));
  EXPECT_EQ(bell->gain, 0.7);
  EXPECT_EQ(bell->pan, -0.3);
  const auto& input = other.session.rack().excitations()[2];
  ASSERT_TRUE(input);
  EXPECT_EQ(input->object, bell->number);
  EXPECT_EQ(input->point_m, (Vec3{0.1, 0.2, 0.3}));
  EXPECT_EQ(input->force_n, (Vec3{0, 0, -1e-7}));
  const auto scene = other.session.scene().playing();
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->file, folder_ / "fall.toml");
  EXPECT_TRUE(scene->paused);
  EXPECT_EQ(other.session.scene().body_count(), 1u);
  const auto plain = other.session.rack().find({.name = "plain"});
  ASSERT_TRUE(plain);
  EXPECT_EQ((*plain)->bank, bank_);
  EXPECT_EQ((*plain)->material, modal::MaterialScale{});
  EXPECT_EQ((*plain)->group, "");
  EXPECT_TRUE((*plain)->solo);
  EXPECT_EQ(session::to_toml(session::state_of(other.session)), session::to_toml(*state))
      << "saved again, it is the same";
}

// The scene file says 0.1, from where the scene starts; the state says 0.7.
TEST_F(StateTest, ASavedStateOutlastsWhatTheSceneSays) {
  std::ofstream(folder_ / "still.toml") << "[[object]]\nname = 'bell'\nbank = 'b.glb'\ngain = 0.1\npan = 1\n";
  const session::State state{.objects = {{.name = "bell", .bank = folder_ / "b.glb", .gain = 0.7, .pan = -1}},
                             .scene = session::State::Scene{folder_ / "still.toml"}};
  for (const synth::Frame strike : {100, 72000}) {
    Daemon daemon;
    ASSERT_TRUE(restore(state, daemon.session, 48000));
    std::vector<float> left(96000), right(96000);
    ASSERT_TRUE(daemon.session.play(protocol::Strike{{.name = "bell"}, {{1, 0, 0}, {0, 0, 1}, 0}}, strike));
    daemon.session.rack().mixer().render(left, right);
    const auto heard = test::to_doubles(std::span(left).subspan(static_cast<std::size_t>(strike)));
    session::Session plain{48000};
    ASSERT_TRUE(plain.rack().load("bell", folder_ / "b.glb"));
    ASSERT_TRUE(plain.play(protocol::SetPan{{.name = "bell"}, {-1}}, 0));
    ASSERT_TRUE(plain.play(protocol::Strike{{.name = "bell"}, {{1, 0, 0}, {0, 0, 0.7}, 0}}, strike));
    plain.rack().mixer().render(left, right);
    const auto expected = test::to_doubles(std::span(left).subspan(static_cast<std::size_t>(strike)));
    // 0.01 s of the ramp from gain 1 at the very start
    EXPECT_LT(test::relative_error_db(std::span(heard).subspan(2000), std::span(expected).subspan(2000)), -100);
  }
}

TEST_F(StateTest, AClearedSceneStaysCleared) {
  std::ofstream(folder_ / "ball.toml") << "[[body]]\nname = 'ball'\nshape = 'sphere'\nradius_m = 0.1\n"
                                          "density_kg_m3 = 1000\nposition_m = [0, 0, 1]\n";
  Daemon one, other;
  ASSERT_TRUE(one.session.perform(protocol::SceneLoad{(folder_ / "ball.toml").string()}, 0));
  ASSERT_EQ(one.session.scene().body_count(), 1u);
  ASSERT_TRUE(one.session.perform(protocol::SceneClear{}, 0));
  ASSERT_TRUE(restore(session::state_of(one.session), other.session, 0));
  EXPECT_TRUE(other.session.scene().playing());
  EXPECT_EQ(other.session.scene().body_count(), 0u);
}

TEST_F(StateTest, AWrongStateFileIsRefusedWithItsLine) {
  EXPECT_NE(refusal("[[object]]\nname = 'bell'\n").find("bank"), std::string::npos);
  EXPECT_NE(refusal("[[object]]\nname = 'bell'\nbank = 'b'\ngain = 101\n").find("s.toml:4"), std::string::npos);
  EXPECT_NE(refusal("[[object]]\nname = 'two words'\nbank = 'b'\n").find("s.toml:2"), std::string::npos);
  EXPECT_NE(refusal("[[object]]\nname = 'a'\nbank = 'b'\n[[object.touch]]\npoint_m = [0, 0, 0]\n").find("damping_ns_m"),
            std::string::npos);
  EXPECT_NE(
      refusal(
          "[[object]]\nname = 'a'\nbank = 'b'\n[[object.touch]]\npoint_m = [0, 0, 0]\ndamping_ns_m = 1\nnumber = 8\n")
          .find("number"),
      std::string::npos);
  EXPECT_NE(refusal("[[object]]\nname = 'a'\nbank = 'b'\nmaterial = { size = 101 }\n").find("size"), std::string::npos);
  EXPECT_NE(refusal("[[object]]\nname = 'a'\nbank = 'b'\nmaterial = { stiffness = 0 }\n").find("stiffness"),
            std::string::npos);
  EXPECT_NE(refusal("[[object]]\nname = 'a'\nbank = 'b'\ncolour = 'red'\n").find("colour"), std::string::npos);
  const std::string place = "object = 'a'\npoint_m = [0, 0, 0]\nforce_n = [0, 0, 1]\n";
  EXPECT_EQ(refusal("[[input]]\ninput = 4\n" + place), "nothing");
  EXPECT_NE(refusal("[scene]\npaused = true\n").find("file"), std::string::npos);
  EXPECT_NE(refusal("[scene]\nfile = 's'\npaused = 1\n").find("s.toml:3"), std::string::npos);
  EXPECT_NE(refusal("[[input]]\ninput = 5\n" + place).find("s.toml:2"), std::string::npos);
}

TEST_F(StateTest, AnInputOfAnObjectThatIsNotThereIsRefused) {
  Daemon daemon;
  const session::State state{.inputs = {{1, "drum", {}, {0, 0, 1}}}};
  const auto restored = restore(state, daemon.session, 0);
  ASSERT_FALSE(restored);
  EXPECT_NE(restored.error().message.find("drum"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::server
