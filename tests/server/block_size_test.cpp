// Preset scenes in blocks of different sizes: the events are the same ones, and so is the sound.
#include "protocol/schema.h"
#include "server/session/offline.h"
#include "server/session/session.h"
#include "tests/support/signal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::session {
namespace {

using synth::Frame;
using test::Samples;

constexpr double kRate_hz = 48000;

// All but the one with 151 pieces, which would take a minute: BreakingScene breaks a plate in blocks of these sizes.
std::vector<std::string> preset_scenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(RINGDOWN_SOURCE_DIR "/presets/scenes")) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  }
  std::erase(names, "bull");
  std::ranges::sort(names);
  return names;
}

std::filesystem::path scene_file(const std::string& name) {
  return std::filesystem::path(RINGDOWN_SOURCE_DIR "/presets/scenes") / (name + ".toml");
}

class BlockSize : public testing::TestWithParam<std::string> {};

std::vector<synth::Event> events_in_blocks(const std::string& scene, Frame block) {
  std::vector<synth::Event> events;
  Session session(kRate_hz);
  session.scene().send_to([&events](const scene::StepReport& report) {
    events.insert(events.end(), report.events.begin(), report.events.end());
    return std::size_t{0};
  });
  EXPECT_TRUE(session.scene().load(scene_file(scene), 0));
  const auto end = static_cast<Frame>(std::min(session.scene().duration_s(), 4.0) * kRate_hz);
  for (Frame at = 0; at < end; at += block) session.scene().advance_to(std::min(at + block, end), std::nullopt);
  return events;
}

bool same(const synth::Event& a, const synth::Event& b) {
  return a.frame == b.frame && a.object == b.object &&
         protocol::format(protocol::request_for(a, {})) == protocol::format(protocol::request_for(b, {}));
}

TEST_P(BlockSize, TheEventsOfASceneAreTheSameInBlocksOfAnySize) {
  const auto reference = events_in_blocks(GetParam(), 256);
  EXPECT_GT(reference.size(), 5u);
  for (const Frame block : {1, 255, 8192}) {
    const auto events = events_in_blocks(GetParam(), block);
    EXPECT_TRUE(std::ranges::equal(events, reference, same)) << "blocks of " << block;
  }
}

// These two are full of contacts that slide and stop.
TEST(SceneSound, DoesNotDependOnTheBlockSize) {
  for (const auto& [name, seconds] : {std::pair("dominoes", 1.2), {"cutlery", 3.2}}) {
    Samples reference;
    for (const std::size_t block : {256u, 64u, 255u, 8192u}) {
      const auto recording = render_offline({.scene = scene_file(name), .seconds = seconds, .block_frames = block},
                                            [](double) { return true; });
      ASSERT_TRUE(recording) << recording.error().message;
      const Samples heard(recording->left.begin(), recording->left.end());
      if (reference.empty()) reference = heard;
      EXPECT_LT(test::relative_error_db(heard, reference), -100) << name << " in blocks of " << block;
    }
    EXPECT_GT(test::peak(reference), 0.01);
  }
}

// A plate that is struck, turns and drifts before a listener, in blocks whose ends fall anywhere.
TEST(SceneSound, OfATurningPlateDoesNotDependOnTheBlockSize) {
  const auto render = [](std::size_t block) {
    const auto recording = render_offline({.scene = scene_file("turning-plate"), .seconds = 1.5, .block_frames = block},
                                          [](double) { return true; });
    EXPECT_TRUE(recording);
    return Samples(recording->left.begin(), recording->left.end());
  };
  const Samples reference = render(256);
  EXPECT_GT(test::peak(reference), 0.01);
  for (const std::size_t block : {1u, 64u, 93u, 255u, 1024u, 8192u}) {
    EXPECT_LT(test::relative_error_db(render(block), reference), -100) << "in blocks of " << block;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, BlockSize, testing::ValuesIn(preset_scenes()), [](const auto& scene) {
  std::string name = scene.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace ringdown::session
