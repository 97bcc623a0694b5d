// Bodies that land aslant, with friction, against the closed form of a rigid impact.
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::test::slanted_test {
namespace {

// What a plane gives a body of mass m and moment of inertia I, all motion in the plane of x and z, at a point r from
// its centre: Coulomb's friction mu, Newton's restitution e. The point comes with the velocity u. The point's change of
// velocity per impulse is K = 1/m + [r_z^2, -r_x r_z; -r_x r_z, r_x^2] / I. The point slides on, or friction stops it.
struct Impact {
  double mass_kg, inertia_kg_m2, mu, e;
  Vec3 r, u;

  [[nodiscard]] Vec3 impulse() const {
    const double xx = 1 / mass_kg + r.z * r.z / inertia_kg_m2, zz = 1 / mass_kg + r.x * r.x / inertia_kg_m2;
    const double xz = -r.x * r.z / inertia_kg_m2;
    const double side = u.x > 0 ? 1 : -1;
    const double z = -(1 + e) * u.z / (zz - side * mu * xz), x = -side * mu * z;
    if (side * (u.x + xx * x + xz * z) >= 0) return {x, 0, z};
    const double determinant = xx * zz - xz * xz;
    return {(-u.x * zz + (1 + e) * u.z * xz) / determinant, 0, (-(1 + e) * u.z * xx + u.x * xz) / determinant};
  }
  // Not where friction would turn round within the impact, nor where Newton's restitution would create energy, as it
  // may with friction (Kane's paradox).
  [[nodiscard]] bool is_sane() const {
    const Vec3 j = impulse();
    const double turn = r.z * j.x - r.x * j.z;
    const double gained_j = dot(j, u) + 0.5 * dot(j, j) / mass_kg + 0.5 * turn * turn / inertia_kg_m2;
    return j.z > 0 && std::abs(j.x) <= mu * j.z * (1 + 1e-9) && gained_j < 0;
  }
};

struct Landing {
  double mass_kg, inertia_kg_m2;
  Vec3 lowest_m;  // from the centre
  scene::BodyDescription body;
};

Landing ball() {
  Landing landing{2, 0.4 * 2 * 0.05 * 0.05, {0, 0, -0.05}, {}};
  landing.body.name = "ball";
  landing.body.shape = {scene::ShapeType::sphere, {}, 0.05};
  landing.body.density_kg_m3 = 2 / (4.0 / 3 * std::numbers::pi * 0.05 * 0.05 * 0.05);
  return landing;
}

Landing box(double angle_deg) {
  constexpr Vec3 kSize_m{0.12, 0.1, 0.06};
  constexpr double kDensity_kg_m3 = 2500;
  const double angle = angle_deg * std::numbers::pi / 180;
  Landing landing;
  landing.mass_kg = kDensity_kg_m3 * kSize_m.x * kSize_m.y * kSize_m.z;
  landing.inertia_kg_m2 = landing.mass_kg / 12 * (kSize_m.x * kSize_m.x + kSize_m.z * kSize_m.z);
  // turned about y by `angle`, the corner at (+x, -z) is the lowest
  const double x = 0.5 * kSize_m.x, z = -0.5 * kSize_m.z;
  landing.lowest_m = {std::cos(angle) * x + std::sin(angle) * z, 0, -std::sin(angle) * x + std::cos(angle) * z};
  landing.body.name = "box";
  landing.body.shape = {scene::ShapeType::box, kSize_m, 0};
  landing.body.density_kg_m3 = kDensity_kg_m3;
  landing.body.rotation = scene::about({0, 1, 0}, angle);
  return landing;
}

// The impulse of a landing without gravity, from the body's change of velocity.
Vec3 impulse_of(const Landing& landing, const Rotation& heading, Vec3 velocity_m_s, double mu, double e) {
  scene::BodyDescription body = landing.body;
  body.rotation = heading * body.rotation;
  body.velocity_m_s = velocity_m_s;
  body.surface.friction = mu;
  body.surface.rolling_m = 0;
  body.position_m = {0, 0, 0.001 - landing.lowest_m.z};
  scene::SceneDescription scene = scene_of({body}, e);
  scene.statics.front().surface.friction = mu;
  scene.statics.front().surface.rolling_m = 0;
  scene.gravity_m_s2 = {0, 0, -1e-6};
  scene::World world = world_of(scene, {});
  for (int step = 0; step < 20; ++step) {
    world.step();
    const Vec3 now = world.bodies().front().velocity_m_s;
    if (length(now - velocity_m_s) > 1e-3) return landing.mass_kg * (now - velocity_m_s);
  }
  return {};
}

void expect_closed_form(const Landing& landing, const std::string& what) {
  double worst = 0;
  int tried = 0;
  for (const double mu : {0.05, 0.2, 0.4, 0.8, 1.3, 2.0}) {
    for (const double e : {0.1, 0.5, 0.9}) {
      for (const double along_m_s : {-6.0, -3.0, -1.0, -0.2, 0.2, 1.0, 3.0, 6.0}) {
        const Vec3 velocity{along_m_s, 0, -2};
        const Impact impact{landing.mass_kg, landing.inertia_kg_m2, mu, e, landing.lowest_m, velocity};
        if (!impact.is_sane()) continue;
        const Rotation heading = scene::about({0, 0, 1}, 0.7 * tried);  // neither friction nor floor has a grain
        const Vec3 expected = rotated(heading, impact.impulse());
        const Vec3 got = impulse_of(landing, heading, rotated(heading, velocity), mu, e);
        const double error = length(got - expected) / length(expected);
        worst = std::max(worst, error);
        ++tried;
        EXPECT_LT(error, 0.02) << what << ", mu " << mu << ", e " << e << ", " << along_m_s
                               << " m/s along: " << length(got) << " instead of " << length(expected) << " N s";
      }
    }
  }
  EXPECT_GT(tried, 30);
  std::printf("%s: %d landings, worst error %.2f %%\n", what.c_str(), tried, 100 * worst);
}

TEST(SlantedLanding, ABallsImpulseIsTheClosedFormsAtAnySpeedAlongAndFriction) { expect_closed_form(ball(), "ball"); }

TEST(SlantedLanding, ABoxsImpulseIsTheClosedFormsAtAnyAngleAndFriction) {
  for (const double angle_deg : {5.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0}) {
    expect_closed_form(box(angle_deg), "box at " + std::to_string(static_cast<int>(angle_deg)) + " degrees");
  }
}

// A box lands aslant on a plate. Two metres away, a box that weighs thirty times as much may land at the same time.
TEST(SlantedLanding, ABodyLandsAlikeWhateverLandsElsewhere) {
  const auto lands = [](bool with_another) {
    std::vector<scene::BodyDescription> bodies;
    const auto add = [&](double x_m, double angle_deg, double times) {
      scene::BodyDescription plate = body_of("", scene::ShapeType::box, {x_m, 0, 0.01});
      plate.shape.size_m = {0.3, 0.3, 0.02};
      const Landing landing = box(angle_deg);
      scene::BodyDescription falls = landing.body;
      falls.position_m = {x_m, 0, 0.022 - landing.lowest_m.z};
      falls.velocity_m_s = {0.2, 0.05, -0.3};
      for (scene::BodyDescription* body : {&plate, &falls}) {
        body->object.clear();
        body->name = "body-" + std::to_string(bodies.size());
        body->density_kg_m3 = 2500 * times;
        bodies.push_back(*body);
      }
    };
    add(0, 20, 1);
    if (with_another) add(2, 35, 30);
    scene::World world = world_of(scene_of(bodies, 0.4), {});
    for (int step = 0; step < 100; ++step) world.step();
    return world.bodies()[1];
  };
  const auto alone = lands(false), beside = lands(true);
  EXPECT_LT(alone.center_m.z, 0.06);  // it has landed
  EXPECT_LT(length(alone.center_m - beside.center_m), 1e-12);
  EXPECT_LT(length(alone.velocity_m_s - beside.velocity_m_s), 1e-11);
}

}  // namespace
}  // namespace ringdown::test::slanted_test
