// The state file: what is written is read back, and a daemon restored from it is the one that was saved.
#include "server/state.h"

#include "engine/modal/bank_file.h"
#include "server/file_roots.h"
#include "server/recorder.h"
#include "server/session.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <unistd.h>

namespace ringdown::server {
namespace {

class StateTest : public testing::Test {
 protected:
  StateTest() : folder_(std::filesystem::temp_directory_path() / ("ringdown-state-" + std::to_string(::getpid()))) {
    std::filesystem::create_directory(folder_);
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(440, 2), bank_));
  }
  ~StateTest() override { std::filesystem::remove_all(folder_); }

  std::string refusal(const std::string& text) const {
    const auto state = parse_state(text, folder_ / "s.toml");
    return state ? "nothing" : state.error().message;
  }

  std::filesystem::path folder_, bank_ = folder_ / "a \"b\" \\ \t.glb";
};

struct Daemon {
  Session session{48000};
  Recorder recorder{session.rack()};
};

TEST_F(StateTest, WhatWasSavedComesBackInAnotherDaemon) {
  Daemon one, other;
  const auto perform = [&](const protocol::Request& request) { ASSERT_TRUE(one.session.perform(request, 0)); };
  perform(protocol::LoadObject{"bell", bank_.string()});
  perform(protocol::LoadObject{"plain", bank_.string()});
  perform(protocol::SetMaterial{{.name = "bell"}, {1, 0.1, 2, 1.0 / 3}});
  perform(protocol::SetGroup{{.name = "bell"}, "metal"});
  perform(protocol::Excite{{.name = "bell"}, 3, {0.1, 0.2, 0.3}, {0, 0, -1e-7}});
  ASSERT_TRUE(one.session.play(protocol::SetGain{{.name = "bell"}, 0.7, 2}, 0));
  ASSERT_TRUE(one.session.play(protocol::SetPan{{.name = "bell"}, -0.3}, 0));

  const auto file = folder_ / "state.toml";
  ASSERT_TRUE(write_state(state_of(one.session.rack(), one.recorder), file));
  EXPECT_TRUE(FileRoots().writable(file, kStateKind)) << "a state may replace a state";
  const auto state = read_state(file);
  ASSERT_TRUE(state) << state.error().message;
  const auto restored = restore(*state, other.session.rack());
  ASSERT_TRUE(restored) << restored.error().message;

  const auto bell = other.session.rack().find({.name = "bell"});
  ASSERT_TRUE(bell);
  EXPECT_EQ(*bell->bank, bank_);
  EXPECT_EQ(bell->group, "metal");
  EXPECT_EQ(bell->material, (modal::MaterialScale{1, 0.1, 2, 1.0 / 3}));
  EXPECT_EQ(other.recorder.level(bell->number).gain, 0.7);
  EXPECT_EQ(other.recorder.level(bell->number).pan, -0.3);
  const auto& input = other.session.rack().excitations()[2];
  ASSERT_TRUE(input);
  EXPECT_EQ(input->object, bell->number);
  EXPECT_EQ(input->point_m, (Vec3{0.1, 0.2, 0.3}));
  EXPECT_EQ(input->force_n, (Vec3{0, 0, -1e-7}));
  const auto plain = other.session.rack().find({.name = "plain"});
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->material, modal::MaterialScale{});
  EXPECT_EQ(plain->group, "");
  EXPECT_EQ(to_toml(state_of(other.session.rack(), other.recorder)), to_toml(*state)) << "saved again, it is the same";
}

TEST_F(StateTest, AWrongFileIsRefusedWithItsLine) {
  EXPECT_NE(refusal("[[object]]\nname = 'bell'\n").find("bank"), std::string::npos);
  EXPECT_NE(refusal("[[object]]\nname = 'bell'\nbank = 'b'\ngain = 101\n").find("s.toml:4"), std::string::npos);
  EXPECT_NE(refusal("[[object]]\nname = 'two words'\nbank = 'b'\n").find("s.toml:2"), std::string::npos);
  EXPECT_NE(refusal("[[object]]\nname = 'a'\nbank = 'b'\nmaterial = { stiffness = 0 }\n").find("stiffness"),
            std::string::npos);
  EXPECT_NE(refusal("[[object]]\nname = 'a'\nbank = 'b'\ncolour = 'red'\n").find("colour"), std::string::npos);
  const std::string place = "object = 'a'\npoint_m = [0, 0, 0]\nforce_n = [0, 0, 1]\n";
  EXPECT_EQ(refusal("[[input]]\ninput = 4\n" + place), "nothing");
  EXPECT_NE(refusal("[[input]]\ninput = 5\n" + place).find("s.toml:2"), std::string::npos);
}

TEST_F(StateTest, AnInputOfAnObjectThatIsNotThereIsRefused) {
  Daemon daemon;
  const State state{.inputs = {{1, "drum", {}, {0, 0, 1}}}};
  const auto restored = restore(state, daemon.session.rack());
  ASSERT_FALSE(restored);
  EXPECT_NE(restored.error().message.find("drum"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::server
