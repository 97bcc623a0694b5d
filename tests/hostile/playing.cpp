#include "tests/hostile/playing.h"

#include "engine/modal/bank_file.h"
#include "tests/fuzz/targets.h"
#include "tests/hostile/banks.h"
#include "tests/support/synthetic_bank.h"

#include <fstream>

namespace ringdown::hostile {
namespace {

constexpr const char* kScene = R"(
[[object]]
name = "ball"
bank = "ball.glb"

[[static]]
shape = "plane"
normal = [0, 0, 1]

[[body]]
name = "ball"
object = "ball"
shape = "sphere"
radius_m = 0.05
position_m = [0, 0, 0.5]
)";

void write(const modal::Bank& bank, const char* path) {
  fuzz::expect(modal::write_bank(bank, path).has_value(), "a bank is written");
}

}  // namespace

Stage::Stage() {
  std::filesystem::current_path(folder());
  Random random(1, 0, 0);
  modal::Bank ball = test::random_bank(1, 20, 40), plate = test::random_bank(2, 40, 40);
  ball.mass = plate.mass = modal::MassProperties{.mass_kg = 1, .inertia_kg_m2 = {1e-3, 1e-3, 1e-3}};
  write(ball, "ball.glb");
  write(plate, "plate.glb");
  write(bending_bank(random, 24, 0.3), "gong.glb");
  std::ofstream("scene.toml") << kScene;
  std::ofstream("nothing.glb") << "glTF";
  std::ofstream("nothing.toml") << "= 1";
}

Names names() {
  return {.objects = {"gong", "plate", "ball", "a", "b", "c"},
          .files = {"ball.glb", "plate.glb", "gong.glb", "scene.toml", "nothing.glb", "nothing.toml", "none.glb"}};
}

std::vector<wire::Message> keep_playing() {
  return {{"/load", {std::string("gong"), std::string("gong.glb")}},
          {"/load", {std::string("plate"), std::string("plate.glb")}},
          {"/scene/load", {std::string("scene.toml")}},
          {"/scene/pause", {0}}};
}

std::vector<wire::Message> play_on(Random& random) {
  const auto place = [&random] { return random.uniform(-0.1, 0.1); };
  return {{"/object/gong/strike", {place(), place(), place(), 0.0, 0.0, random.uniform(0.1, 3), 0.002}},
          {"/object/plate/bow", {place(), place(), place(), 0.0, 1.0, 0.0, 0.2, 1.0}},
          {"/scene/spawn/sphere", {std::string("ball"), place(), place(), random.uniform(0.1, 1)}}};
}

}  // namespace ringdown::hostile
