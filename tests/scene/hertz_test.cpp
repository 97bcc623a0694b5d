// Contact times against Hertz's law integrated step by step, and against hand-computed masses.
#include "engine/scene/contact/hertz.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ringdown::scene::hertz_test {
namespace {

constexpr Elastic kSteel{2e11, 0.3}, kRubber{1e8, 0.49};

// How long m d'' = -4/3 E* sqrt(R) d^1.5 takes from d = 0 back to it.
double integrated_time(double mass, double radius, double modulus, double speed) {
  const double k = 4.0 / 3 * modulus * std::sqrt(radius) / mass;
  const double h = 1e-5 * std::pow(mass * mass / (radius * modulus * modulus * speed), 0.2);
  double depth = 0, velocity = speed, time = 0;
  do {
    velocity -= 0.5 * h * k * std::pow(std::max(depth, 0.0), 1.5);
    depth += h * velocity;
    velocity -= 0.5 * h * k * std::pow(std::max(depth, 0.0), 1.5);
    time += h;
  } while (depth > 0);
  return time;
}

TEST(Hertz, HertzsTimeIsThatOfHisForce) {
  for (const double mass : {0.001, 0.3}) {
    for (const double speed : {0.1, 3.0}) {
      const double modulus = contact_modulus(kSteel, kSteel);
      EXPECT_NEAR(hertz_time(1 / mass, 0.01, modulus, speed) / integrated_time(mass, 0.01, modulus, speed), 1, 0.001);
    }
  }
}

TEST(Hertz, ModulusOfTwoSteelsIsHalfAPlaneStrainModulus) {
  EXPECT_NEAR(contact_modulus(kSteel, kSteel), 2e11 / (1 - 0.09) / 2, 1);
  EXPECT_NEAR(contact_modulus(kSteel, kRubber) / (1e8 / (1 - 0.49 * 0.49)), 1, 0.001) << "the soft one decides";
}

TEST(Hertz, RadiiOfSpheresFacesAndEdgesAreThoseOfTheirCurvature) {
  const Curvature ball{Curvature::sphere, 0.02}, small{Curvature::sphere, 0.005}, plane{Curvature::flat, 0};
  const Curvature sharp{Curvature::edged, 0.001}, blunt{Curvature::edged, 0.003};
  EXPECT_DOUBLE_EQ(relative_radius(ball, small), 0.004);
  EXPECT_EQ(relative_radius(ball, plane), 0.02);
  EXPECT_EQ(relative_radius(sharp, ball), 0.02) << "a ball meets faces";
  EXPECT_EQ(relative_radius(plane, blunt), 0.003);
  EXPECT_EQ(relative_radius(sharp, blunt), 0.001);
}

TEST(Hertz, ARodStruckAtItsEndFeelsAQuarterOfItsMass) {
  // 1/m + (l/2)^2 / (m l^2 / 12) = 4/m, whichever way the rod lies.
  const double mass = 2, size = 0.6, moment = mass * size * size / 12;
  RigidMass rod{mass, {}, {{{1e-6, 0, 0}, {0, moment, 0}, {0, 0, moment}}}};
  EXPECT_NEAR(inverse_effective_mass(rod, to_matrix({}), {size / 2, 0, 0}, {0, 0, 1}), 4 / mass, 1e-12);
  EXPECT_NEAR(inverse_effective_mass(rod, to_matrix({}), {size / 2, 0, 0}, {1, 0, 0}), 1 / mass, 1e-12);
  const Rotation turn = about({1, 2, -1}, 0.8);
  const Matrix3 r = to_matrix(turn);
  EXPECT_NEAR(inverse_effective_mass(rod, r, r * Vec3{size / 2, 0, 0}, r * Vec3{0, 0, 1}), 4 / mass, 1e-9);
}

// The contact time of a ball of steel (or what `surface` says) that falls on a plane of steel.
double landing_time(double radius, double height, const FrictionSurface& surface) {
  BodyDescription ball = test::body_of("ball", ShapeType::sphere, {0, 0, radius + height});
  ball.shape.radius_m = radius;
  ball.density_kg_m3 = 7800;
  SceneDescription scene = test::scene_of({ball});
  scene.bodies[0].surface = surface;
  scene.statics[0].surface.young_pa = 2e11;
  scene.statics[0].surface.poisson = 0.3;
  scene.step_s = 1.0 / 4000;
  World world = test::world_of(scene, {test::sounding("ball", 0, test::box_bank({0.01, 0.01, 0.01}, 1))});
  const auto strikes = test::run(world, std::sqrt(2 * height / 9.81) + 0.01);
  return strikes.empty() ? 0 : strikes.front().contact_time_s;
}

FrictionSurface of(const Elastic& material) {
  FrictionSurface surface;
  surface.young_pa = material.young_pa;
  surface.poisson = material.poisson;
  return surface;
}

TEST(ContactTime, TheContactTimeOfASteelBallOnSteelIsHertzs) {
  for (const double radius : {0.005, 0.02}) {
    for (const double height : {0.05, 0.8}) {
      const double mass = 7800 * 4.0 / 3 * std::numbers::pi * std::pow(radius, 3), speed = std::sqrt(2 * 9.81 * height);
      const double expected = integrated_time(mass, radius, 2e11 / (1 - 0.09) / 2, speed);
      EXPECT_NEAR(landing_time(radius, height, of(kSteel)) / expected, 1, 0.005) << radius << ' ' << height;
    }
  }
}

TEST(ContactTime, SoftHeavyAndSlowContactsAreLonger) {
  const double steel = landing_time(0.01, 0.2, of(kSteel));
  EXPECT_NEAR(steel, 5.5e-5, 1e-5);
  EXPECT_GT(landing_time(0.01, 0.2, of(kRubber)), 8 * steel);
  EXPECT_NEAR(landing_time(0.03, 0.2, of(kSteel)) / steel, 3, 0.03)
      << "m^2 / R grows with the fifth power of the radius";
  EXPECT_NEAR(landing_time(0.01, 0.2 / 1024, of(kSteel)) / steel, 2, 0.05) << "a 32nd of the speed";
}

TEST(ContactTime, AContactTimeGivenOnASurfaceStandsAgainstHertz) {
  FrictionSurface surface = of(kRubber);
  surface.contact_time_s = 0.0001;
  EXPECT_EQ(landing_time(0.01, 0.2, surface), 0.0001);
}

TEST(ContactTime, ABanksMaterialCountsForTheContactTime) {
  const auto time_of = [](double young_pa, double stiffness) {
    modal::Bank bank = test::box_bank({0.1, 0.1, 0.1}, 1);
    bank.material = modal::Material{"any", young_pa, 0.3, 1000, {}};
    SceneDescription scene = test::scene_of({test::body_of("a", ShapeType::sphere, {0, 0, 0.3})});
    scene.objects[0].material.stiffness = stiffness;
    World world = test::world_of(scene, {test::sounding("a", 0, bank)});
    return test::run(world, 0.4).at(0).contact_time_s;
  };
  EXPECT_GT(time_of(1e8, 1), 3 * time_of(2e11, 1));
  EXPECT_EQ(time_of(1e9, 4), time_of(4e9, 1)) << "scaled as the scene scales the material";
}

}  // namespace
}  // namespace ringdown::scene::hertz_test
