// Levels of a liquid that change while an object rings.
#include "engine/modal/bank_file.h"
#include "protocol/schema.h"
#include "server/session/note_map.h"
#include "server/session/recorder.h"
#include "server/session/session.h"
#include "server/session/state.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace ringdown::session {
namespace {

using protocol::ObjectRef;

const ObjectRef kGlass{.name = "glass"};

double pitch_hz(double level_m) { return 440 / std::sqrt(1 + test::kMassPerSquare * level_m * level_m); }

class FillTest : public testing::Test {
 protected:
  FillTest() {
    EXPECT_TRUE(modal::write_bank(test::leveled_bank(440, 2), folder_ / "glass.glb"));
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(440, 2), folder_ / "plain.glb"));
    EXPECT_TRUE(session_.perform(protocol::LoadObject{"glass", (folder_ / "glass.glb").string()}, 0));
  }
  test::Samples render(std::size_t frames) {
    std::vector<float> left(frames), right(frames);
    session_.rack().mixer().render(left, right);
    session_.rack().collect();
    return test::to_doubles(left);
  }
  [[nodiscard]] synth::Frame now() { return session_.rack().mixer().counters().frames; }
  void strike() { ASSERT_TRUE(session_.play(protocol::Strike{kGlass, {{1, 0, 0}, {0, 0, 1}, 0}}, now())); }
  void fill(double level_m, synth::Frame later = 0) {
    const auto filled = session_.perform(protocol::SetFill{kGlass, level_m}, now() + later);
    ASSERT_TRUE(filled) << filled.error().message;
  }
  double heard_hz() { return test::fit_damped_sinusoid(render(9600), 48000).frequency_hz; }

  test::TemporaryFolder folder_;
  Session session_{48000};
};

TEST_F(FillTest, ALevelRetunesWhatRingsAndLaterBlows) {
  strike();
  render(4800);
  fill(0.05);
  EXPECT_NEAR(heard_hz(), pitch_hz(0.05), 0.1);
  fill(0.09);
  EXPECT_NEAR(heard_hz(), pitch_hz(0.09), 0.1);
  ASSERT_TRUE(session_.play(protocol::ClearAll{}, now()));
  render(4800);
  strike();
  EXPECT_NEAR(heard_hz(), pitch_hz(0.09), 0.1);
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"glass", (folder_ / "glass.glb").string()}, 0));
  ASSERT_TRUE(session_.play(protocol::ClearAll{}, now()));
  render(4800);
  strike();
  EXPECT_NEAR(heard_hz(), 440, 0.1) << "a new bank stands as baked";
}

TEST_F(FillTest, ALevelCountsFromItsFrameOn) {
  strike();
  fill(0.1, 9600);
  EXPECT_NEAR(heard_hz(), 440, 0.1);
  EXPECT_NEAR(heard_hz(), pitch_hz(0.1), 0.1);
}

// A step keeps displacement and momentum, so the wave goes on: the change of one sample is no larger than before.
TEST_F(FillTest, ASlowFillingDoesNotClick) {
  strike();
  render(4800);
  const test::Samples still = render(1024);
  double step = 0, before = still.back(), largest = 0;
  for (std::size_t n = 1; n < still.size(); ++n) step = std::max(step, std::abs(still[n] - still[n - 1]));
  for (int k = 1; k <= 50; ++k) {
    fill(0.002 * k);
    for (const double sample : render(480)) {
      largest = std::max(largest, std::abs(sample - before));
      before = sample;
    }
  }
  EXPECT_LT(largest, 1.05 * step);
}

// In an object of twice the size a level lies twice as high.
TEST_F(FillTest, ALevelIsThatOfTheObjectInItsSize) {
  ASSERT_TRUE(session_.perform(protocol::SetMaterial{kGlass, {.size = 2}}, 0));
  strike();
  fill(0.1);
  EXPECT_NEAR(heard_hz(), pitch_hz(0.05) / 2, 0.1);
  EXPECT_NEAR(level_m(**session_.rack().find(kGlass)).value(), 0.1, 1e-12);
}

TEST_F(FillTest, AnImpossibleLevelIsRefusedAndChangesNothing) {
  const auto refusal = [&](const char* object, double level_m) {
    const auto filled = session_.perform(protocol::SetFill{{.name = object}, level_m}, 0);
    return filled ? "accepted" : filled.error().message;
  };
  EXPECT_NE(refusal("glass", 0.2).find("above the rim"), std::string::npos);
  EXPECT_NE(refusal("glass", -0.01).find("below the bottom"), std::string::npos);
  EXPECT_NE(refusal("none", 0.1).find("no object"), std::string::npos);
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"plain", (folder_ / "plain.glb").string()}, 0));
  EXPECT_NE(refusal("plain", 0.1).find("levels = 16"), std::string::npos);
  EXPECT_FALSE(level_m(**session_.rack().find(kGlass)));
}

// One file, an object for each note.
TEST_F(FillTest, NotesOfAMapFillTheirObjectsOnceForEachBank) {
  const auto file = folder_.write("notes.toml",
                                  "[[note]]\nnote = 60\nobject = 'glass'\nlevel_m = 0.05\n"
                                  "[[note]]\nnote = 61\nobject = 'other'\nlevel_m = 0.09\n"
                                  "[[note]]\nnote = 62\nobject = 'third'\nlevel_m = 0.2\n");
  Rack& rack = session_.rack();
  Notes notes(rack, read_note_map(file).value());
  EXPECT_TRUE(notes.set_levels(rack).empty()) << "objects may be loaded later";
  EXPECT_NEAR(level_m(**rack.find(kGlass)).value(), 0.05, 1e-9);
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"other", (folder_ / "glass.glb").string()}, 0));
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"third", (folder_ / "glass.glb").string()}, 0));
  fill(0.02);
  const std::vector<std::string> obstacles = notes.set_levels(rack);
  ASSERT_EQ(obstacles.size(), 1u);
  EXPECT_NE(obstacles[0].find("note 62: object third: level: "), std::string::npos) << obstacles[0];
  EXPECT_NEAR(level_m(**rack.find({.name = "other"})).value(), 0.09, 1e-9);
  EXPECT_NEAR(level_m(**rack.find(kGlass)).value(), 0.02, 1e-9) << "what came later stays";
  EXPECT_TRUE(notes.set_levels(rack).empty()) << "said once";
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"glass", (folder_ / "glass.glb").string()}, 0));
  EXPECT_TRUE(notes.set_levels(rack).empty());
  EXPECT_NEAR(level_m(**rack.find(kGlass)).value(), 0.05, 1e-9) << "a new bank";
  strike();
  EXPECT_NEAR(heard_hz(), pitch_hz(0.05), 0.1);
}

TEST_F(FillTest, RecordingsAndStatesKnowTheLevel) {
  std::vector<wire::ScoreEvent> score;
  Recorder recorder(session_.rack(), [&](std::span<const wire::ScoreEvent> events, const std::filesystem::path&) {
    score.assign(events.begin(), events.end());
    return Result<void>();
  });
  fill(0.03);
  ASSERT_TRUE(recorder.start(folder_ / "a.osc", now()));
  fill(0.07);
  ASSERT_TRUE(recorder.stop(now()));
  std::vector<double> levels;
  for (const auto& event : score) {
    const auto request = protocol::parse(event.message);
    if (!request) continue;
    if (const auto* set = request->get_if<protocol::SetFill>()) levels.push_back(set->level_m);
  }
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_NEAR(levels[0], 0.03, 1e-6);
  EXPECT_NEAR(levels[1], 0.07, 1e-6);
  const auto state = parse_state(to_toml(state_of(session_)), folder_ / "state.toml");
  ASSERT_TRUE(state) << state.error().message;
  Session other(48000);
  ASSERT_TRUE(restore(*state, other, 0));
  EXPECT_NEAR(level_m(**other.rack().find(kGlass)).value(), 0.07, 1e-9);
}

}  // namespace
}  // namespace ringdown::session
