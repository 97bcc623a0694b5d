// Contacts of an animation from a simulation that meets its frames, against closed forms.
#include "engine/scene/foley/shooting.h"
#include "engine/scene/motion_path.h"
#include "engine/scene/ode/simulation.h"
#include "engine/scene/solid.h"
#include "tests/scene/box_bank.h"
#include "tests/scene/keyframes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

namespace ringdown::scene::guide_test {
namespace {

constexpr double kFrame_s = 1.0 / 24;

Shooter shooter_at(Vec3 place, Vec3 velocity, Vec3 target) {
  return {.start = {place, {}, velocity, {}}, .target = {target, {}}, .reach_m = 0.05, .trust = 1e-3};
}

// Two balls of a radius of 5 cm on one line, whose motion is the closed form of one collision.
TEST(Shooting, TwoBallsThatMeetGetTheirVelocities) {
  constexpr double kOne_kg = 0.2, kTwo_kg = 0.5, kE = 0.6, kU = 2.0, kV = -0.7, kGap_m = 0.05;
  const auto end_of = [](double u, double v) {
    const double meet_s = kGap_m / (u - v), impulse_ns = kOne_kg * kTwo_kg / (kOne_kg + kTwo_kg) * (1 + kE) * (u - v);
    const double rest_s = std::max(kFrame_s - meet_s, 0.0);
    return std::pair(u * kFrame_s - impulse_ns / kOne_kg * rest_s,
                     0.1 + kGap_m + v * kFrame_s + impulse_ns / kTwo_kg * rest_s);
  };
  const auto [one_m, two_m] = end_of(kU, kV);
  Shooting shooting({shooter_at({0, 0, 1}, {1.99, 0, 0}, {one_m, 0, 1}),
                     shooter_at({0.1 + kGap_m, 0, 1}, {-0.69, 0, 0}, {two_m, 0, 1})},
                    kFrame_s, [&](std::span<const Shooter> bodies) {
                      const Vec3 u = bodies[0].start.velocity_m_s, v = bodies[1].start.velocity_m_s;
                      const auto [one, two] = end_of(u.x, v.x);
                      Shot shot{.pairs = {{0, 1}}};
                      shot.ends = {{{one, u.y * kFrame_s, 1 + u.z * kFrame_s}, {}, {}, {}},
                                   {{two, v.y * kFrame_s, 1 + v.z * kFrame_s}, {}, {}, {}}};
                      return shot;
                    });
  shooting.aim();
  EXPECT_NEAR(shooting.bodies()[0].start.velocity_m_s.x, kU, 1e-3);
  EXPECT_NEAR(shooting.bodies()[1].start.velocity_m_s.x, kV, 1e-3);
  EXPECT_LT(shooting.bodies()[0].miss_m, 1e-4);
  EXPECT_EQ(shooting.bodies()[0].island, shooting.bodies()[1].island);
}

// A ball bounces once, whose velocity is known badly, but trusted. The frame tells it better.
TEST(Shooting, TargetsAreMetExactlyWhateverTheStartIsTrusted) {
  constexpr double kE = 0.7, kFall_m_s = 2;
  const auto end_of = [](double speed) {
    const double hit_s = 0.03 / speed;
    return kE * speed * (kFrame_s - hit_s);
  };
  Shooter body = shooter_at({0, 0, 0.03}, {0, 0, -1.99}, {0, 0, end_of(kFall_m_s)});
  body.trust = 0.2;
  Shooting shooting({body}, kFrame_s, [&](std::span<const Shooter> bodies) {
    const Vec3 v = bodies[0].start.velocity_m_s;
    Shot shot;
    shot.ends = {{{v.x * kFrame_s, v.y * kFrame_s, end_of(-v.z)}, {}, {}, {}}};
    return shot;
  });
  shooting.aim();
  EXPECT_NEAR(shooting.bodies()[0].start.velocity_m_s.z, -kFall_m_s, 1e-6);
  EXPECT_LT(shooting.bodies()[0].miss_m, 1e-8);
}

// A pile of slanted boxes falls over. The solver is the iterative one, whose order is random.
TEST(SimulationMemory, ATimeThatIsSimulatedAgainGoesAlike) {
  constexpr std::uint64_t kRemembered = 300, kEnd = 400;
  SceneDescription scene = test::scene_of({}, 0.2);
  scene.step_s = 0.0005;
  BodyDescription box = test::body_of("", ShapeType::box, {});
  box.shape.size_m = {0.1, 0.08, 0.03};
  box.density_kg_m3 = 1000;
  const Solid solid = make_solid(box, nullptr).value();
  Simulation simulation(scene);
  simulation.add_static(kFirstStatic, scene.statics[0]);
  for (BodyId id = 0; id < 12; ++id) {
    const Motion start{{0.004 * id, 0, 0.02 + 0.032 * id}, about({0, 1, 0}, 0.1 + 0.02 * id), {}, {}};
    simulation.put_body(id, solid, start, box.surface, false);
  }
  // Runs from the step kRemembered on, and corrects all bodies there to the motions that they have.
  const auto run = [&](bool corrected) {
    std::vector<Motion> ends(12);
    for (std::uint64_t step = kRemembered; step < kEnd; ++step) {
      simulation.number_step(step);
      simulation.step();
      for (const MovedBody& moved : simulation.moved()) {
        ends[moved.id] = moved.motion;
        if (corrected && step == kRemembered) simulation.correct(moved.id, moved.motion);
      }
    }
    return ends;
  };
  for (std::uint64_t step = 0; step < kRemembered; ++step) simulation.step();
  const auto memory = simulation.memory();
  const std::vector<Motion> once = run(false);
  for (const bool corrected : {false, true}) {
    simulation.recall(*memory);
    const std::vector<Motion> again = run(corrected);
    for (std::size_t id = 0; id < 12; ++id)
      EXPECT_LT(length(again[id].position_m - once[id].position_m), 1e-9) << id << corrected;
  }
}

// The motion of a body between plates at heights 0 and `gap_m`, in closed form: its height and its blows.
struct Bounces {
  double gap_m, e;
  std::vector<double> times_s = {}, speeds_m_s = {};

  // The height at a time, if the body falls with `speed` from `height`.
  double height(double height, double speed, double time_s) {
    double at_s = 0, from_m = height, velocity = -speed;
    for (;;) {
      const double wall_m = velocity < 0 ? 0 : gap_m, hit_s = at_s + (wall_m - from_m) / velocity;
      if (hit_s > time_s) return from_m + velocity * (time_s - at_s);
      times_s.push_back(hit_s);
      speeds_m_s.push_back(std::abs(velocity));
      at_s = hit_s;
      from_m = wall_m;
      velocity *= -e;
    }
  }
};

TEST(Shooting, ABallThatBouncesTwiceInAFrameGetsItsVelocity) {
  const auto end_of = [](double speed) { return Bounces{0.06, 0.8}.height(0.03, speed, kFrame_s); };
  Bounces truth{0.06, 0.8};
  const double end_m = truth.height(0.03, 3, kFrame_s);
  ASSERT_EQ(truth.times_s.size(), 2u);
  Shooting shooting({shooter_at({0, 0, 0.03}, {0, 0, -2.98}, {0, 0, end_m})}, kFrame_s,
                    [&](std::span<const Shooter> bodies) {
                      const Vec3 v = bodies[0].start.velocity_m_s;
                      Shot shot;
                      shot.ends = {{{v.x * kFrame_s, v.y * kFrame_s, end_of(-v.z)}, {}, {}, {}}};
                      return shot;
                    });
  shooting.aim();
  EXPECT_NEAR(shooting.bodies()[0].start.velocity_m_s.z, -3, 2e-3);
  EXPECT_LT(shooting.bodies()[0].miss_m, 1e-4);
}

// A cube flies under a plate, without gravity and friction, and bounces between floor and plate: twice from one frame
// to the next.
TEST(Guide, BlowsBetweenTwoPlatesHaveTheMomentsAndImpulsesOfTheClosedForm) {
  constexpr double kE = 0.9, kMass_kg = 0.4, kFall_m_s = 2, kAlong_m_s = 5, kHigh_m = 0.274, kGap_m = 0.03;
  BodyDescription cube = test::body_of("cube", ShapeType::box, {0, 0, 0.05 + kHigh_m});
  cube.fixed = true;
  auto path = std::make_shared<MotionPath>(MotionPath{.every_s = kFrame_s, .once = true});
  for (int k = 0; k < 7; ++k) {
    const double time_s = k * kFrame_s;
    path->poses.push_back(
        {{kAlong_m_s * time_s, 0, 0.05 + Bounces{kGap_m, kE}.height(kHigh_m, kFall_m_s, time_s)}, {}});
  }
  cube.path = path;
  SceneDescription scene = test::scene_of({cube}, kE);
  scene.bodies[0].surface.friction = 0;
  scene.statics.push_back(
      {.name = "plate", .type = StaticType::box, .size_m = {2, 1, 0.1}, .position_m = {1.67, 0, 0.1 + kGap_m + 0.05}});
  scene.statics.back().surface.restitution = kE;
  scene.gravity_m_s2 = {};
  scene.step_s = 0.0005;
  scene.duration_s = 6 * kFrame_s;
  scene.foley.emplace();
  std::vector<HeardContact> blows =
      test::play(scene, {test::sounding("cube", 0, test::box_bank({0.1, 0.1, 0.1}, kMass_kg))});
  std::erase_if(blows, [](const HeardContact& contact) { return contact.kind != HeardContact::blow; });
  Bounces truth{kGap_m, kE};
  truth.height(kHigh_m, kFall_m_s, 5 * kFrame_s);
  ASSERT_EQ(truth.times_s.size(), 4u);
  ASSERT_EQ(static_cast<int>(truth.times_s[0] / kFrame_s), static_cast<int>(truth.times_s[1] / kFrame_s));
  ASSERT_GE(blows.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    const double impulse_ns = kMass_kg * (1 + kE) * truth.speeds_m_s[k];
    EXPECT_NEAR(blows[k].time_s, truth.times_s[k], 1e-3) << k;
    EXPECT_NEAR(length(blows[k].push), impulse_ns, 0.04 * impulse_ns) << k;
  }
}

}  // namespace
}  // namespace ringdown::scene::guide_test
