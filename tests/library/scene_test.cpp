// libringdown-scene plays a preset scene as `ringdown render` does.
#include "clients/library/ringdown_scene.h"
#include "server/session/offline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace ringdown::test::scene_test {
namespace {

const std::string kScene = RINGDOWN_SOURCE_DIR "/presets/scenes/dominoes.toml";

TEST(LibraryScene, GivesTheSamplesOfRingdownRender) {
  session::OfflineOptions options;
  options.scene = kScene;
  options.seconds = 2;
  options.block_frames = 256;
  options.mixer.limiter_db = -1;
  const auto expected = session::render_offline(options, [](double) { return true; });
  ASSERT_TRUE(expected);
  ASSERT_GT(expected->peak, 0.01);

  ringdown_error error;
  ringdown_mixer* mixer = nullptr;
  ringdown_scene* scene = nullptr;
  ASSERT_EQ(ringdown_mixer_create(nullptr, &mixer, &error), RINGDOWN_OK) << error.sentence;
  ASSERT_EQ(ringdown_scene_load(mixer, kScene.c_str(), 0, &scene, &error), RINGDOWN_OK) << error.sentence;
  ringdown_scene* second = nullptr;
  EXPECT_EQ(ringdown_scene_load(mixer, kScene.c_str(), 0, &second, &error), RINGDOWN_REFUSED);
  const std::size_t late = ringdown_latency(mixer);
  std::vector<float> left(expected->left.size() + late), right(left.size());
  for (std::size_t begin = 0; begin < left.size(); begin += 256) {
    const std::size_t end = std::min(begin + 256, left.size());
    ringdown_scene_advance(scene, static_cast<std::int64_t>(end));
    ringdown_render(mixer, left.data() + begin, right.data() + begin, end - begin);
    ringdown_collect(mixer);
  }
  EXPECT_TRUE(
      std::equal(expected->left.begin(), expected->left.end(), left.begin() + static_cast<std::ptrdiff_t>(late)));

  std::vector<ringdown_body> bodies(ringdown_scene_bodies(scene));
  ASSERT_GT(bodies.size(), 3u);
  EXPECT_EQ(ringdown_scene_poses(scene, bodies.data(), bodies.size()), bodies.size());
  for (const ringdown_body& body : bodies) {
    double square = 0;
    for (const double part : body.rotation_wxyz) square += part * part;
    EXPECT_NEAR(square, 1, 1e-9);
  }
  // Names of the file find what they name, and nothing else.
  std::uint32_t object = 77, body = 77;
  ASSERT_EQ(ringdown_scene_find_object(scene, "block-2", &object, &error), RINGDOWN_OK) << error.sentence;
  ringdown_bank* bank = nullptr;
  std::uint32_t again = 78;  // an object of that name keeps its number
  ASSERT_EQ(ringdown_bank_open(RINGDOWN_SOURCE_DIR "/presets/banks/block.glb", &bank, &error), RINGDOWN_OK);
  ASSERT_EQ(ringdown_add(mixer, "block-2", bank, &again, &error), RINGDOWN_OK) << error.sentence;
  ringdown_bank_release(bank);
  EXPECT_EQ(object, again);
  ASSERT_EQ(ringdown_scene_find_body(scene, "block-2", &body, &error), RINGDOWN_OK) << error.sentence;
  EXPECT_TRUE(std::ranges::any_of(bodies, [&](const ringdown_body& known) { return known.number == body; }));
  EXPECT_EQ(ringdown_scene_find_object(scene, "nothing", &object, &error), RINGDOWN_BAD_INPUT);
  EXPECT_NE(std::string(error.sentence).find("'nothing'"), std::string::npos) << error.sentence;
  EXPECT_EQ(ringdown_scene_find_body(scene, nullptr, &body, &error), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_scene_find_body(nullptr, "block-2", &body, &error), RINGDOWN_BAD_INPUT);

  const double blow[3] = {0, 0, 0.1}, nowhere[3] = {0, 0, 1.0 / 0.0};
  EXPECT_EQ(ringdown_scene_push(scene, bodies[2].number, blow, &error), RINGDOWN_OK) << error.sentence;
  EXPECT_EQ(ringdown_scene_push(scene, bodies.back().number, nowhere, &error), RINGDOWN_BAD_INPUT);
  EXPECT_EQ(ringdown_scene_push(scene, 100000, blow, &error), RINGDOWN_BAD_INPUT) << error.sentence;
  EXPECT_EQ(ringdown_scene_clear(scene, &error), RINGDOWN_OK);
  EXPECT_EQ(ringdown_scene_bodies(scene), 0u);
  ringdown_scene_destroy(scene);
  ASSERT_EQ(ringdown_scene_load(mixer, kScene.c_str(), ringdown_now(mixer), &scene, &error), RINGDOWN_OK);
  ringdown_scene_destroy(scene);
  EXPECT_EQ(ringdown_scene_load(mixer, "/nonexistent.toml", 0, &scene, &error), RINGDOWN_BAD_INPUT);
  ringdown_mixer_destroy(mixer);
}

}  // namespace
}  // namespace ringdown::test::scene_test
