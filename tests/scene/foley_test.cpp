// Contacts recovered from keyframed motion, against closed forms and against scenes that Ringdown simulates itself.
#include "engine/scene/motion_path.h"
#include "engine/scene/world.h"
#include "tests/scene/box_bank.h"
#include "tests/scene/keyframes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::scene::foley_test {
namespace {

test::Comparison compare_preset(const std::string& name, double fps, double duration_s = 0) {
  test::Preset preset = test::preset_scene(name);
  if (duration_s > 0) preset.scene.duration_s = duration_s;
  const test::Played truth = test::simulate(preset.scene, preset.objects, fps);
  const auto result = test::compare(truth.contacts, test::play(truth.animated, preset.objects), fps);
  std::printf("%s at %.0f frames a second: %s\n", name.c_str(), fps, test::sentence_of(result).c_str());
  return result;
}

constexpr double kG = 9.81;

SoundingObject ball_of(const std::string& name, std::uint32_t number, double mass_kg) {
  return test::sounding(name, number, test::box_bank({0.1, 0.1, 0.1}, mass_kg));
}

// A ball of a radius of 5 cm whose centre follows `place`, in keyframes.
BodyDescription moving_ball(const std::string& name, double fps, double length_s,
                            const std::function<Vec3(double)>& place) {
  BodyDescription body = test::body_of(name, ShapeType::sphere, place(0));
  body.shape.radius_m = 0.05;
  body.shape.center_m = Vec3{};
  body.fixed = true;
  auto path = std::make_shared<MotionPath>(MotionPath{.every_s = 1 / fps, .once = true});
  for (int k = 0; k <= static_cast<int>(length_s * fps); ++k) path->poses.push_back({place(k / fps), {}});
  body.path = path;
  return body;
}

std::vector<HeardContact> blows_of(SceneDescription scene, const std::vector<SoundingObject>& objects) {
  scene.foley.emplace();
  std::vector<HeardContact> blows = test::play(scene, objects);
  std::erase_if(blows, [](const HeardContact& contact) { return contact.kind != HeardContact::blow; });
  return blows;
}

// The height of a ball's lowest point that falls from `height_m` and bounces with the restitution `e`, and its
// landings.
struct Bounces {
  double height_m, e;
  std::vector<double> times_s = {}, speeds_m_s = {};

  explicit Bounces(double height, double restitution) : height_m(height), e(restitution) {
    double speed = std::sqrt(2 * kG * height_m), time = speed / kG;
    for (int k = 0; k < 5; ++k) {
      times_s.push_back(time);
      speeds_m_s.push_back(speed);
      speed *= e;
      time += 2 * speed / kG;
    }
  }
  [[nodiscard]] double at(double time_s) const {
    if (time_s < times_s[0]) return height_m - 0.5 * kG * time_s * time_s;
    std::size_t k = 0;
    while (k + 1 < times_s.size() && times_s[k + 1] <= time_s) ++k;
    const double t = time_s - times_s[k];
    return e * speeds_m_s[k] * t - 0.5 * kG * t * t;
  }
};

TEST(Foley, BouncesOfABallHaveTheMomentsAndImpulsesOfTheClosedForm) {
  const Bounces truth(0.8, 0.75);
  constexpr double kMass_kg = 0.3;
  for (const double fps : {24.0, 30.0, 59.94}) {
    const auto scene = test::scene_of({moving_ball("ball", fps, truth.times_s[3] + 0.1, [&](double t) {
      return Vec3{0.1, 0, 0.05 + truth.at(t)};
    })});
    const auto blows = blows_of(scene, {ball_of("ball", 0, kMass_kg)});
    ASSERT_EQ(blows.size(), 4u) << fps;
    for (std::size_t k = 0; k < blows.size(); ++k) {
      const double impulse_ns = kMass_kg * 1.75 * truth.speeds_m_s[k];
      EXPECT_NEAR(blows[k].time_s, truth.times_s[k], 1e-4) << fps << " " << k;
      EXPECT_NEAR(length(blows[k].push), impulse_ns, 0.005 * impulse_ns) << fps << " " << k;
      EXPECT_NEAR(blows[k].speed_m_s, truth.speeds_m_s[k], 0.02 * truth.speeds_m_s[k]) << fps << " " << k;
      EXPECT_NEAR(blows[k].point_m.z, 0, 0.002);
    }
  }
}

TEST(Foley, TwoBallsThatMeetGetOppositeImpulsesOfTheClosedForm) {
  constexpr double kMeet_s = 0.517, kOne_kg = 0.2, kTwo_kg = 0.5, kE = 0.6, kU = 2.0, kV = -0.7;
  // Momentum and restitution give the speeds afterwards.
  const double impulse_ns = kOne_kg * kTwo_kg / (kOne_kg + kTwo_kg) * (1 + kE) * (kU - kV);
  const auto along = [&](double speed, double mass_kg, double sign, double offset) {
    return [=](double t) {
      const double after = speed + sign * impulse_ns / mass_kg, since = t - kMeet_s;
      return Vec3{offset + (since < 0 ? speed : after) * since, 0, 1};
    };
  };
  SceneDescription scene = test::scene_of({moving_ball("one", 24, 1.2, along(kU, kOne_kg, -1, -0.05)),
                                           moving_ball("two", 24, 1.2, along(kV, kTwo_kg, 1, 0.05))});
  scene.gravity_m_s2 = {};
  const auto blows = blows_of(scene, {ball_of("one", 0, kOne_kg), ball_of("two", 1, kTwo_kg)});
  ASSERT_EQ(blows.size(), 1u);
  EXPECT_NEAR(blows[0].time_s, kMeet_s, 1e-4);
  EXPECT_NEAR(blows[0].push.x, -impulse_ns, 0.005 * impulse_ns);
  EXPECT_NEAR(length(blows[0].push), impulse_ns, 0.005 * impulse_ns);
  EXPECT_NEAR(blows[0].speed_m_s, kU - kV, 0.02);
  EXPECT_LT(length(blows[0].point_m - Vec3{0, 0, 1}), 0.003);
}

TEST(Foley, AGapOfMillimetresAndJitterDoNotRattle) {
  // The ball rests 2 mm above the floor, as solvers with margins leave it, and trembles by 5 micrometres.
  std::uint64_t state = 1;
  const auto noise = [&state] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return 5e-6 * (static_cast<double>(state >> 11) / 4503599627370496.0 - 1);
  };
  const auto scene = test::scene_of({moving_ball("ball", 30, 3, [&](double) {
    return Vec3{noise(), noise(), 0.052 + noise()};
  })});
  EXPECT_TRUE(blows_of(scene, {ball_of("ball", 0, 0.3)}).empty());
}

TEST(Foley, ABodyThatIsPutElsewhereStrikesNothingAndIsNamed) {
  // Out of the air onto the floor from one frame to the next.
  SceneDescription scene = test::scene_of({moving_ball("ball", 24, 2, [](double t) {
    return t < 1 ? Vec3{0, 0, 1.5} : Vec3{0.4, 0, 0.05};
  })});
  EXPECT_TRUE(blows_of(scene, {ball_of("ball", 0, 0.3)}).empty());
  scene.foley.emplace();
  auto world = World::create(scene, std::vector{ball_of("ball", 0, 0.3)}, 48000);
  ASSERT_TRUE(world);
  const auto notices = world->step().notices;
  ASSERT_FALSE(notices.empty());
  EXPECT_NE(notices[0].find("'ball' jumps 1 times"), std::string::npos) << notices[0];
}

// Boxes in keyframes by hand, with a friction that the file does not know: one slides from the beginning, one falls
// first.
TEST(Foley, ASlideOverAFloorIsOneContact) {
  constexpr double kFps = 30, kSpeed_m_s = 1.5, kBrake_m_s2 = 0.3 * kG;
  for (const double height_m : {0.0, 0.02}) {
    const double land_s = std::sqrt(2 * height_m / kG), stop_s = land_s + kSpeed_m_s / kBrake_m_s2;
    BodyDescription sled = test::body_of("sled", ShapeType::box, {0, 0, 0.02 + height_m});
    sled.fixed = true;
    auto path = std::make_shared<MotionPath>(MotionPath{.every_s = 1 / kFps, .once = true});
    for (int k = 0; k < 30; ++k) {
      const double fall_s = std::min(k / kFps, land_s), slide_s = std::clamp(k / kFps, land_s, stop_s) - land_s;
      path->poses.push_back({{kSpeed_m_s * (fall_s + slide_s) - 0.5 * kBrake_m_s2 * slide_s * slide_s, 0,
                              0.02 + height_m - 0.5 * kG * fall_s * fall_s},
                             {}});
    }
    sled.path = path;
    SceneDescription scene = test::scene_of({sled}, 0.0);
    scene.duration_s = 29 / kFps;
    scene.foley.emplace();
    const auto contacts = test::play(scene, {test::sounding("sled", 0, test::box_bank({0.1, 0.1, 0.04}, 0.3))});
    EXPECT_EQ(std::ranges::count(contacts, HeardContact::end, &HeardContact::kind), 1) << height_m;
    const auto first = std::ranges::find(contacts, HeardContact::lasting, &HeardContact::kind);
    ASSERT_NE(first, contacts.end());
    EXPECT_NEAR(first->time_s, land_s, 1 / kFps) << height_m;
    EXPECT_NEAR(contacts.back().time_s, stop_s, 2 / kFps) << height_m;
  }
}

// Contacts recovered from the keyframes of simulated scenes. The limits are the measured figures, rounded up.
TEST(Foley, ImpactsOfTheDemoAreThoseOfItsSimulation) {
  for (const double fps : {24.0, 30.0, 60.0}) {
    const auto demo = compare_preset("demo", fps);
    EXPECT_GE(demo.alone, 12u);
    EXPECT_GE(demo.found, 0.95 * static_cast<double>(demo.alone));
    EXPECT_EQ(demo.false_ones, 0u);
    EXPECT_LE(demo.time_ms, 0.1);
    EXPECT_LE(demo.impulse_db, 0.01);
    EXPECT_LE(demo.group_db, 0.1);
  }
}

// A knife, and then a fork and a knife that fall on it: several pairs strike each other between two frames.
TEST(Foley, ImpactsOfCutleryAreThoseOfItsSimulation) {
  for (const double fps : {24.0, 60.0}) {
    const auto cutlery = compare_preset("cutlery", fps, 3.5);
    EXPECT_GE(cutlery.alone, 10u);
    EXPECT_EQ(cutlery.found, cutlery.alone);
    EXPECT_EQ(cutlery.false_ones, 0u);
    EXPECT_LE(cutlery.worst_ms, 1);
    EXPECT_LE(cutlery.impulse_db, 0.01);
    EXPECT_LE(cutlery.group_db, 0.1);
  }
}

TEST(Foley, ImpactsOfRainingMarblesAreThoseOfTheirSimulation) {
  const auto rain = compare_preset("marble-rain", 24);
  EXPECT_GE(rain.alone, 150u);
  EXPECT_GE(rain.found, 0.95 * static_cast<double>(rain.alone));
  EXPECT_EQ(rain.false_ones, 0u);
  EXPECT_LE(rain.worst_ms, 0.1);
  EXPECT_LE(rain.impulse_db, 0.01);
  EXPECT_LE(rain.group_db, 0.1);
}

}  // namespace
}  // namespace ringdown::scene::foley_test
