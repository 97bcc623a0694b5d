// Contacts recovered from keyframed motion, against closed forms and against scenes that Ringdown simulates itself.
#include "engine/modal/bank_file.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/world.h"
#include "tests/scene/box_bank.h"
#include "tests/scene/keyframes.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::scene::foley_test {
namespace {

const std::filesystem::path kPresets = std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets";

test::Comparison compare_preset(const std::string& name, double fps, bool verbose) {
  auto scene = read_scene(kPresets / "scenes" / (name + ".toml"), kPresets);
  std::vector<SoundingObject> objects;
  for (const ObjectDescription& object : scene->objects) {
    auto bank = modal::read_bank(object.bank);
    objects.push_back(test::sounding(object.name, static_cast<std::uint32_t>(objects.size()), std::move(*bank)));
  }
  const test::Played truth = test::simulate(*scene, objects, fps);
  const auto result = test::compare(truth.contacts, test::play(truth.animated, objects), fps, verbose);
  std::printf("%s at %.0f frames a second: found %zu of %zu, %zu false, 90%% within %.2f ms, all within %.2f ms, "
              "median %.2f dB; %zu groups, median %.2f dB\n",
              name.c_str(), fps, result.found, result.alone, result.false_ones, result.time_ms, result.worst_ms,
              result.impulse_db, result.groups, result.group_db);
  return result;
}

TEST(FoleyTry, Preset) {
  compare_preset(std::getenv("SCENE"), std::atof(std::getenv("FPS")), true);
}

}  // namespace
}  // namespace ringdown::scene::foley_test
