// Impacts, slides and rolls that are recovered from keyframes, against those of the simulation that the keyframes were
// recorded from: the table of docs/use/film.md.
//
//   foley_truth                             every scene at 24, 30 and 60 frames a second
//   foley_truth [--each] SCENE [FPS ...]    one scene; with --each, every impact as well
//   foley_truth --step S --noise M --bounce X ...   plays with another step, with poses M metres inexact, or with
//                                           restitutions times X
//   foley_truth --cost                      time and memory for a minute of 50 bodies at 30 frames a second
#include "engine/scene/motion_path.h"
#include "engine/scene/rotation.h"
#include "tests/scene/keyframes.h"

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <sys/resource.h>
#include <string>
#include <vector>

namespace {

using namespace ringdown;

// What a file may lose of the scene that it was recorded from.
struct Losses {
  double step_s = 0;   // the scene's step: this one in its place; 0: none
  double noise_m = 0;  // largest error of each coordinate of each pose
  double bounce = 1;   // factor of each restitution
};

// A glTF file has numbers of 32 bits.
Pose in_file(const Pose& pose) {
  const auto at = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  const auto& [p, r] = pose;
  return {{at(p.x), at(p.y), at(p.z)}, normalized(Rotation::from_xyzw(at(r.x), at(r.y), at(r.z), at(r.w)))};
}

void lose(scene::SceneDescription& animated, const Losses& losses) {
  if (losses.step_s > 0) animated.step_s = losses.step_s;
  scene::Random random(1);
  for (scene::BodyDescription& body : animated.bodies) {
    body.surface.restitution *= losses.bounce;
    if (!body.path) continue;
    auto path = std::make_shared<scene::MotionPath>(*body.path);
    for (Pose& pose : path->poses) {
      if (losses.noise_m > 0) pose.position_m = pose.position_m + losses.noise_m * random.next_vec3();
      pose = in_file(pose);
    }
    body.path = path;
  }
}

void add_row(const std::string& name, double fps, bool each, const Losses& losses) {
  const test::Preset preset = test::preset_scene(name);
  test::Played truth = test::simulate(preset.scene, preset.objects, fps);
  lose(truth.animated, losses);
  const std::clock_t begin = std::clock();
  const auto recovered = test::play(truth.animated, preset.objects);
  const double took_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const test::Comparison c = test::compare(truth.contacts, recovered, fps, each);
  std::printf(
      "| %s | %.0f | %zu of %zu | %zu (%zu) | %.1f ms | %.1f ms | %.2f dB | %zu groups, %.1f dB | %zu of %zu |\n",
      name.c_str(), fps, c.found, c.alone, c.false_ones, c.pushes, c.time_ms, c.worst_ms, c.impulse_db, c.groups,
      c.group_db, c.ends_found, c.ends);
  std::fprintf(stderr, "%s at %.0f: %.1f s of processor time\n", name.c_str(), fps, took_s);
}

// Fifty boxes fall into a tray, one after the other, and lie there in a heap.
scene::SceneDescription tray() {
  scene::SceneDescription made;
  made.duration_s = 60;
  made.statics.push_back({.name = "floor"});
  for (int side = 0; side < 4; ++side) {
    const double sign = side % 2 == 0 ? 1 : -1;
    const bool along = side < 2;
    made.statics.push_back({.name = "wall-" + std::to_string(side),
                            .type = scene::StaticType::box,
                            .size_m = along ? Vec3{0.02, 0.44, 0.2} : Vec3{0.44, 0.02, 0.2},
                            .position_m = along ? Vec3{0.21 * sign, 0, 0.1} : Vec3{0, 0.21 * sign, 0.1}});
  }
  for (int k = 0; k < 50; ++k) {
    scene::BodyDescription box{.name = "box-" + std::to_string(k), .density_kg_m3 = 2500};
    box.shape = {.type = scene::ShapeType::box, .size_m = {0.04, 0.05, 0.06}};
    box.position_m = {0.11 * ((k * 7) % 3 - 1), 0.11 * ((k * 5) % 3 - 1), 0.5};
    box.spin_rad_s = {3.0 + k % 4, -2.0 + k % 5, 1};
    box.start_s = 1.1 * k;
    made.bodies.push_back(box);
  }
  return made;
}

int cost() {
  const test::Played truth = test::simulate(tray(), {}, 30);
  const std::clock_t begin = std::clock();
  const auto world = scene::World::create(truth.animated, {}, 48000);
  const double took_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf(
      "a minute of 50 bodies at 30 frames a second: contacts in %.1f s of processor time, the process has %.0f MiB at "
      "most\n",
      took_s, static_cast<double>(usage.ru_maxrss) / 1024);
  return world ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> scenes;
  std::vector<double> rates;
  bool each = false;
  Losses losses;
  for (int k = 1; k < count; ++k) {
    const std::string text = arguments[k];
    double* loss = text == "--step" ? &losses.step_s : text == "--noise" ? &losses.noise_m : nullptr;
    if (text == "--bounce") loss = &losses.bounce;
    if (loss && k + 1 < count) {
      *loss = std::strtod(arguments[++k], nullptr);
      continue;
    }
    char* end = nullptr;
    const double rate = std::strtod(text.c_str(), &end);
    if (text == "--cost") return cost();
    if (text == "--each") {
      each = true;
    } else if (*end == '\0' && rate > 0) {
      rates.push_back(rate);
    } else {
      scenes.push_back(text);
    }
  }
  if (scenes.empty()) scenes = {"demo", "cutlery", "marble-rain", "dominoes"};
  if (rates.empty()) rates = {24, 30, 60};
  std::printf(
      "| scene | frames a second | found | false (pushes) | 90 %% of the times within | all within | impulse, median "
      "error | "
      "dense blows | ends of slides |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : scenes) {
    for (const double rate : rates) add_row(scene, rate, each, losses);
  }
  return 0;
}
