// Faces that meet, against closed forms and a collision that is integrated step by step.
#include "engine/modal/surface_relief.h"
#include "engine/scene/contact/bearing.h"
#include "engine/scene/contact/hertz.h"
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::scene::bearing_test {
namespace {

using test::body_of;
using test::box_bank;
using test::scene_of;
using test::sounding;

constexpr double kModulus_pa = 5e10;

TEST(Bearing, ALightLoadBearsInProportionAndAHeavyOneEverywhere) {
  constexpr double kArea_m2 = 4e-4, kGradient = 1e-3, kPressure_pa = 0.5 * kModulus_pa * kGradient;
  EXPECT_NEAR(bearing_area(kArea_m2, 1, kModulus_pa, kGradient) * kPressure_pa, 1, 1e-3);
  EXPECT_NEAR(bearing_area(kArea_m2, 2, kModulus_pa, kGradient) * kPressure_pa, 2, 2e-3);
  EXPECT_NEAR(bearing_area(kArea_m2, 1e6, kModulus_pa, kGradient), kArea_m2, 1e-12);
  EXPECT_EQ(bearing_area(kArea_m2, 1, kModulus_pa, 0), kArea_m2);
}

// How long a mass presses into a flat punch that grows to bear its largest load, by steps in time.
double integrated_time(double mass_kg, double stiffness_n_m, double approach_m_s) {
  const double step_s = 1e-9;
  double depth_m = 0, speed_m_s = approach_m_s, time_s = 0;
  while (depth_m >= 0) {
    speed_m_s -= step_s * stiffness_n_m * depth_m / mass_kg;
    depth_m += step_s * speed_m_s;
    time_s += step_s;
  }
  return time_s;
}

TEST(Bearing, FlatFacesTouchForHalfAPeriodWhateverTheSpeed) {
  constexpr double kMass_kg = 0.4, kArea_m2 = 1e-4;
  const double stiffness = 2 * kModulus_pa * std::sqrt(kArea_m2 / std::numbers::pi);
  const double time_s = face_impact_time(1 / kMass_kg, kModulus_pa, kArea_m2, 0, 1);
  EXPECT_NEAR(time_s / integrated_time(kMass_kg, stiffness, 1), 1, 1e-3);
  EXPECT_EQ(face_impact_time(1 / kMass_kg, kModulus_pa, kArea_m2, 0, 0.01), time_s);
}

TEST(Bearing, WavyFacesTouchForLongerTheSofterTheyMeet) {
  constexpr double kMass_kg = 0.4, kArea_m2 = 1e-3, kWaviness = 1e-3;
  double before_s = 1;
  for (const double speed_m_s : {0.01, 0.1, 1.0, 10.0}) {
    const double time_s = face_impact_time(1 / kMass_kg, kModulus_pa, kArea_m2, kWaviness, speed_m_s);
    EXPECT_LT(time_s, before_s);
    before_s = time_s;
    // The area that follows from the time bears the largest load.
    const double stiffness = kMass_kg * std::pow(std::numbers::pi / time_s, 2);
    const double area_m2 = std::numbers::pi * std::pow(stiffness / (2 * kModulus_pa), 2);
    const double load_n = speed_m_s * std::sqrt(stiffness * kMass_kg);
    EXPECT_NEAR(area_m2 / bearing_area(kArea_m2, load_n, kModulus_pa, kWaviness), 1, 1e-6) << speed_m_s;
  }
  EXPECT_GE(before_s, face_impact_time(1 / kMass_kg, kModulus_pa, kArea_m2, 0, 1));
}

TEST(Bearing, APatchIsTheHullOfItsPoints) {
  const Rotation turn = about({1, 2, 3}, 0.7);
  std::vector<Vec3> points;
  for (const Vec3 p : {Vec3{0, 0, 0}, {0.2, 0, 0.01}, {0.2, 0.1, 0}, {0, 0.1, 0}, {0.1, 0.05, 0}, {0.05, 0.1, 0}})
    points.push_back(rotated(turn, p));
  EXPECT_NEAR(patch_area(points, rotated(turn, {0, 0, 1})), 0.02, 1e-12);
  EXPECT_NEAR(patch_area(points, rotated(turn, {0, 0, -1})), 0.02, 1e-12);
  points.resize(2);
  EXPECT_EQ(patch_area(points, {0, 0, 1}), 0);
}

// A box of 1 kg that falls flat onto the floor; its strikes' contact times.
std::vector<double> contact_times(double height_m, std::optional<double> waviness, bool tilted = false) {
  constexpr Vec3 kSize{0.2, 0.1, 0.05};
  BodyDescription body = body_of("a", ShapeType::box, {0, 0, 0.025 + height_m});
  if (tilted) body.rotation = about({1, 1, 0}, 0.3), body.position_m.z += 0.1;
  SceneDescription scene = scene_of({body});
  scene.bodies[0].surface.waviness = waviness;
  auto world = World::create(scene, std::vector{sounding("a", 0, box_bank(kSize, 1))}, 48000);
  std::vector<double> times;
  while (world->time_s() < 0.6 && times.empty()) {
    for (const auto& strike : test::only<synth::verb::Strike>(world->step().events)) {
      times.push_back(strike.contact_time_s);
    }
  }
  return times;
}

TEST(Bearing, ABoxThatLandsFlatTouchesAsAPunchAndATiltedOneByHertz) {
  const double modulus = contact_modulus({}, {}), area_m2 = 0.2 * 0.1;
  const double punch_s = std::numbers::pi / std::sqrt(2 * modulus * std::sqrt(area_m2 / std::numbers::pi));
  for (const double height_m : {0.05, 0.3}) {
    const auto flat = contact_times(height_m, 0.0);
    ASSERT_EQ(flat.size(), 4) << "a strike at each corner";
    for (const double time_s : flat) EXPECT_NEAR(time_s / punch_s, 1, 1e-3) << height_m;
    const auto wavy = contact_times(height_m, 1e-2);
    EXPECT_GT(wavy.at(0), 1.5 * punch_s);
    const auto corners = contact_times(height_m, {});
    EXPECT_GT(corners.at(0), 2 * punch_s) << "without a waviness it is that of a corner";
  }
  EXPECT_EQ(contact_times(0.1, 1e-3, true), contact_times(0.1, {}, true)) << "a corner lands";
}

TEST(Bearing, ReliefsAreSmoothedOverWhatBears) {
  ContactSide ball{.curvature = {Curvature::sphere, 0.02}}, floor{.curvature = {Curvature::flat, 0}};
  EXPECT_EQ(filter_widths(ball, floor, 1).relief_m, 0);
  floor.surface.relief = std::make_shared<modal::SurfaceRelief>();
  const FilterWidths light = filter_widths(ball, floor, 1), heavy = filter_widths(ball, floor, 8);
  const double modulus = contact_modulus(ball.elastic, floor.elastic);
  EXPECT_NEAR(light.relief_m, 2 * std::cbrt(3 * 0.02 / (4 * modulus)), 1e-12);
  EXPECT_NEAR(heavy.relief_m / light.relief_m, 2, 1e-9);
  EXPECT_GT(light.finish_m, 0);
  EXPECT_LT(light.finish_m, light.relief_m);
}

}  // namespace
}  // namespace ringdown::scene::bearing_test
