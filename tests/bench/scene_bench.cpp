// What a step of a scene costs, against its bodies and their contacts, all sounding:
//
//   flying    they turn in the air, nothing touches
//   rolling   balls on a floor, one contact each, for ever
//   sliding   boxes on a floor without friction, four contacts each, for ever
//   asleep    the same boxes at rest
//   one_awake one ball rolls among boxes that sleep
//
// `contacts` is how many contact points there are, `real_time` how many times faster than real time a step of 2 ms is,
// which is a scene's default.
#include "tests/scene/box_bank.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <utility>

namespace {

using namespace ringdown;
using scene::BodyDescription;
using scene::SceneDescription;
using scene::ShapeType;
using scene::World;

constexpr double kEdge_m = 0.05, kPitch_m = 0.2;
constexpr int kWarmUp = 20;

BodyDescription on_grid(ShapeType type, int number, double height_m) {
  BodyDescription body = test::body_of("thing", type, {kPitch_m * (number % 32), kPitch_m * (number / 32), height_m});
  body.name += std::to_string(number);
  body.shape.radius_m = type == ShapeType::sphere ? kEdge_m / 2 : 0;
  body.surface.rolling_m = 0;
  return body;
}

World world_of(std::vector<BodyDescription> bodies, Vec3 gravity_m_s2 = {0, 0, -9.81}) {
  SceneDescription scene = test::scene_of(std::move(bodies), 0);
  scene.gravity_m_s2 = gravity_m_s2;
  scene.objects.resize(1);
  scene.objects[0].name = "thing";
  return test::world_of(scene, {test::sounding("thing", 0, test::box_bank({kEdge_m, kEdge_m, kEdge_m}, 0.3))});
}

World flying(int count) {
  std::vector<BodyDescription> bodies;
  for (int k = 0; k < count; ++k) {
    bodies.push_back(on_grid(ShapeType::sphere, k, 1));
    bodies.back().spin_rad_s = {0, 0, 10};
  }
  return world_of(std::move(bodies), {});
}

World rolling(int count) {
  std::vector<BodyDescription> bodies;
  for (int k = 0; k < count; ++k) {
    bodies.push_back(on_grid(ShapeType::sphere, k, kEdge_m / 2));
    bodies.back().velocity_m_s = {0.5, 0, 0};
    bodies.back().spin_rad_s = {0, 0.5 / (kEdge_m / 2), 0};
  }
  return world_of(std::move(bodies));
}

std::vector<BodyDescription> boxes(int count, double velocity_m_s) {
  std::vector<BodyDescription> bodies;
  for (int k = 0; k < count; ++k) {
    bodies.push_back(on_grid(ShapeType::box, k, kEdge_m / 2 - 1e-5));
    bodies.back().velocity_m_s = {velocity_m_s, 0, 0};
    bodies.back().surface.friction = 0;
  }
  return bodies;
}

void step(benchmark::State& state, World world, double contacts, int warm_up = kWarmUp) {
  for (int k = 0; k < warm_up; ++k) world.step();
  std::size_t events = 0;
  for (auto _ : state) events += world.step().events.size();
  state.counters["contacts"] = contacts;
  state.counters["events_per_step"] =
      benchmark::Counter(static_cast<double>(events), benchmark::Counter::kAvgIterations);
  state.counters["real_time"] =
      benchmark::Counter(world.step_s() * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

int count(const benchmark::State& state) { return static_cast<int>(state.range(0)); }

void BM_flying(benchmark::State& state) { step(state, flying(count(state)), 0); }
void BM_rolling(benchmark::State& state) { step(state, rolling(count(state)), count(state)); }
void BM_sliding(benchmark::State& state) { step(state, world_of(boxes(count(state), 0.5)), 4.0 * count(state)); }
void BM_asleep(benchmark::State& state) { step(state, world_of(boxes(count(state), 0)), 0, 600); }

void BM_one_awake(benchmark::State& state) {
  std::vector<BodyDescription> bodies = boxes(count(state) - 1, 0);
  bodies.push_back(on_grid(ShapeType::sphere, 0, kEdge_m / 2));
  bodies.back().name = "ball";
  bodies.back().position_m.y = -1;
  bodies.back().velocity_m_s = {0.1, 0, 0};
  bodies.back().spin_rad_s = {0, 0.1 / (kEdge_m / 2), 0};
  step(state, world_of(std::move(bodies)), 1, 600);
}

#define RINGDOWN_SIZES Arg(1)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond)->MinTime(0.2)
BENCHMARK(BM_flying)->RINGDOWN_SIZES;
BENCHMARK(BM_rolling)->RINGDOWN_SIZES;
BENCHMARK(BM_sliding)->RINGDOWN_SIZES;
BENCHMARK(BM_asleep)->RINGDOWN_SIZES;
BENCHMARK(BM_one_awake)->RINGDOWN_SIZES;

}  // namespace
