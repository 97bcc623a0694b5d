// The same scene in two physics engines, ODE and Bullet: what is heard of it, against each other and against mechanics.
#include "clients/bullet/bullet_world.h"
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace ringdown::bullet {
namespace {

using scene::BodyDescription;
using scene::SceneDescription;
using scene::ShapeType;
using synth::Event;
using test::body_of;
using test::box_bank;
using test::scene_of;
using test::Struck;

constexpr double kG = 9.81, kOdeRate_hz = 48000;
constexpr Vec3 kSize{0.1, 0.1, 0.1};

std::vector<Event> by_ode(const SceneDescription& scene, const modal::Bank& bank, double seconds) {
  scene::World world = test::world_of(scene, {test::sounding("a", 0, bank)});
  return test::run_all(world, seconds);
}

std::vector<Event> by_bullet(const SceneDescription& scene, const modal::Bank& bank, double seconds) {
  auto world = BulletWorld::create(scene, std::vector{std::make_shared<const modal::Bank>(bank)});
  if (!world) throw std::runtime_error(world.error().message);  // the test reports it
  std::vector<Event> all;
  while (world->time_s() < seconds) {
    const auto events = world->step().events;
    all.insert(all.end(), events.begin(), events.end());
  }
  return all;
}

const synth::verb::Contact& contact_of(const Event& event) { return event.verb.get<synth::verb::Contact>(); }

// The strikes of one moment.
struct Blow {
  double time_s = 0, contact_time_s = 0;
  Vec3 impulse_ns;
  std::vector<Vec3> points_m;
};

std::vector<Blow> blows(const std::vector<Event>& events, double rate_hz) {
  std::vector<Blow> found;
  for (const Struck& strike : test::only<synth::verb::Strike>(events)) {
    const double time_s = static_cast<double>(strike.frame) / rate_hz;
    if (found.empty() || time_s - found.back().time_s > 1e-4) found.push_back({time_s, strike.contact_time_s, {}, {}});
    found.back().impulse_ns = found.back().impulse_ns + strike.impulse_ns;
    found.back().points_m.push_back(strike.point_m);
  }
  return found;
}

struct Drop {
  ShapeType shape;
  double mass_kg, height_m, restitution, step_s;

  [[nodiscard]] SceneDescription scene() const {
    const double rest = shape == ShapeType::sphere ? 0.05 * std::sqrt(3.0) : 0.05;
    SceneDescription scene = scene_of({body_of("a", shape, {0, 0, rest + height_m})}, restitution);
    scene.step_s = step_s;
    return scene;
  }
  [[nodiscard]] double impulse_ns() const { return mass_kg * (1 + restitution) * std::sqrt(2 * kG * height_m); }
  [[nodiscard]] std::vector<Blow> in_ode(double seconds) const {
    return blows(by_ode(scene(), box_bank(kSize, mass_kg), seconds), kOdeRate_hz);
  }
  [[nodiscard]] std::vector<Blow> in_bullet(double seconds) const {
    return blows(by_bullet(scene(), box_bank(kSize, mass_kg), seconds), kFrameRate_hz);
  }
};

void PrintTo(const Drop& drop, std::ostream* out) {
  *out << "shape " << static_cast<int>(drop.shape) << ", " << drop.mass_kg << " kg from " << drop.height_m
       << " m, restitution " << drop.restitution << ", step " << drop.step_s << " s";
}

double nearest(const std::vector<Vec3>& points, Vec3 to) {
  double min = 1e300;
  for (const Vec3& point : points) min = std::min(min, length(point - to));
  return min;
}

class SameDrop : public testing::TestWithParam<Drop> {};

TEST_P(SameDrop, TheFirstBlowOfADropIsTheClosedFormsInBothEngines) {
  const Drop& drop = GetParam();
  const double fall_s = std::sqrt(2 * drop.height_m / kG), expected = drop.impulse_ns();
  const auto ode = drop.in_ode(fall_s + 2 * drop.step_s), bullet = drop.in_bullet(fall_s + 2 * drop.step_s);
  ASSERT_EQ(ode.size(), 1u);
  ASSERT_EQ(bullet.size(), 1u);
  EXPECT_NEAR(bullet[0].impulse_ns.z, expected, 0.02 * expected);
  EXPECT_NEAR(bullet[0].impulse_ns.z, ode[0].impulse_ns.z, 0.015 * expected);
  EXPECT_LT(std::hypot(bullet[0].impulse_ns.x, bullet[0].impulse_ns.y), 0.001 * expected);
  EXPECT_NEAR(bullet[0].time_s, fall_s, 1e-4);
  EXPECT_NEAR(bullet[0].contact_time_s, ode[0].contact_time_s, 0.01 * ode[0].contact_time_s);
  RecordProperty("bullet_percent", std::to_string(100 * (bullet[0].impulse_ns.z / expected - 1)));
  RecordProperty("ode_percent", std::to_string(100 * (ode[0].impulse_ns.z / expected - 1)));
}

// At the usual step. At a finer one ODE's soft contacts take more of a heavy body's bounce (description.h).
TEST_P(SameDrop, TheFirstBouncesAreTheSameInBothEngines) {
  Drop drop = GetParam();
  drop.step_s = 1.0 / 500;
  const double step_of_gravity_ns = drop.mass_kg * kG * drop.step_s;
  const auto ode = drop.in_ode(3), bullet = drop.in_bullet(3);
  const std::size_t bounces = drop.restitution == 0 ? 1 : 3;
  // A step that finds a touch late by t has let the body in by v t, and it takes t/e to come out again.
  const double late_s = drop.step_s * (1 + (bounces > 1 ? 1 / drop.restitution : 0));
  ASSERT_GE(ode.size(), bounces);
  ASSERT_GE(bullet.size(), bounces);
  EXPECT_NEAR(static_cast<double>(ode.size()), static_cast<double>(bullet.size()), 1);
  for (std::size_t k = 0; k < bounces; ++k) {
    const double strength = ode[k].impulse_ns.z;
    EXPECT_NEAR(bullet[k].time_s, ode[k].time_s, late_s) << k;
    EXPECT_NEAR(bullet[k].impulse_ns.z, strength, 0.02 * strength + step_of_gravity_ns) << k;
    ASSERT_EQ(bullet[k].points_m.size(), ode[k].points_m.size()) << k;
    for (const Vec3& point : bullet[k].points_m) EXPECT_LT(nearest(ode[k].points_m, point), 5e-4) << k;
    for (const Vec3& point : ode[k].points_m) EXPECT_LT(nearest(bullet[k].points_m, point), 5e-4) << k;
  }
}

// Between two blows the body flies up and down: its speeds before and after follow from the times alone.
TEST_P(SameDrop, AnImpulseIsTheChangeOfMomentumBetweenTwoFlights) {
  const Drop& drop = GetParam();
  const auto heard = drop.in_bullet(3);
  if (drop.restitution == 0) {
    EXPECT_EQ(heard.size(), 1u) << "it stays down";
    return;
  }
  ASSERT_GE(heard.size(), 3u);
  const double expected = drop.mass_kg * kG * (heard[2].time_s - heard[0].time_s) / 2;
  EXPECT_NEAR(heard[1].impulse_ns.z, expected, 0.01 * expected + drop.mass_kg * kG * drop.step_s);
}

INSTANTIATE_TEST_SUITE_P(
    Heights, SameDrop,
    testing::Values(Drop{ShapeType::sphere, 1, 0.5, 0.5, 1.0 / 4000}, Drop{ShapeType::sphere, 1, 0.5, 0.5, 1.0 / 500},
                    Drop{ShapeType::sphere, 0.01, 0.1, 0.8, 1.0 / 1000},
                    Drop{ShapeType::sphere, 20, 1, 0.3, 1.0 / 4000}, Drop{ShapeType::sphere, 1, 0.2, 0, 1.0 / 500},
                    Drop{ShapeType::sphere, 1, 0.2, 1, 1.0 / 500}, Drop{ShapeType::box, 1, 0.5, 0.5, 1.0 / 4000},
                    Drop{ShapeType::box, 5, 0.3, 0.4, 1.0 / 500}, Drop{ShapeType::convex, 1, 0.5, 0.5, 1.0 / 4000},
                    Drop{ShapeType::convex, 2, 0.5, 0.5, 1.0 / 500}));

// A block that lands on a corner, away from its centre of mass and off its axes of inertia. With r from the centre of
// mass to the corner and K = 1/m + (r x) I^-1 (r x)^T, what it approaches by is reversed: without friction
// J_z = (1 + e) v / K_zz, and where it cannot slide J = K^-1 (0, 0, (1 + e) v).
struct Corner {
  scene::Matrix3 to_world, axes;  // object -> world; principal axes -> object
  modal::Bank bank;
  SceneDescription scene;
  double restitution = 0.5;

  Corner(ShapeType shape, double friction) {
    const Vec3 center{0.3, -0.2, 0.1};
    const scene::Rotation turned = scene::about({1, -2, 0.5}, 0.6);
    bank = box_bank({0.2, 0.14, 0.1}, 2, center);
    bank.mass->orientation = {turned.x, turned.y, turned.z, turned.w};
    BodyDescription body = body_of("a", shape, {0, 0, 0.7});
    body.rotation = scene::about({1, 2, 0.3}, 0.6);
    scene = scene_of({body}, restitution);
    scene.step_s = 1.0 / 2000;
    for (scene::FrictionSurface* surface : {&scene.bodies[0].surface, &scene.statics[0].surface}) {
      surface->friction = friction;
      surface->rolling_m = 0;
    }
    to_world = scene::to_matrix(body.rotation);
    axes = scene::to_matrix(turned);
  }

  // What the corner gains in velocity when it receives the impulse j there.
  [[nodiscard]] Vec3 gain(Vec3 j, Vec3 arm) const {
    const Vec3 moments = bank.mass->inertia_kg_m2;
    const Vec3 twist = scene::transpose(axes) * (scene::transpose(to_world) * cross(arm, j));
    const Vec3 spin = to_world * (axes * Vec3{twist.x / moments.x, twist.y / moments.y, twist.z / moments.z});
    return (1 / bank.mass->mass_kg) * j + cross(spin, arm);
  }

  // The impulse on the corner, and what it should change of the corner's velocity, both in the world.
  struct Landing {
    Vec3 impulse_ns, arm_m;
    double change_m_s = 0;
  };
  [[nodiscard]] Landing landing(const std::vector<Event>& events, double rate_hz) const {
    const Struck strike = test::only<synth::verb::Strike>(events).front();
    const double fall_s = static_cast<double>(strike.frame) / rate_hz;
    return {to_world * strike.impulse_ns, to_world * (strike.point_m - bank.mass->center_of_mass_m),
            (1 + restitution) * kG * fall_s};
  }
};

void expect_frictionless(const Corner& corner, const std::vector<Event>& events, double rate_hz) {
  ASSERT_FALSE(events.empty());
  const auto [impulse, arm, change] = corner.landing(events, rate_hz);
  EXPECT_LT(std::hypot(impulse.x, impulse.y), 1e-6 * impulse.z);
  EXPECT_NEAR(corner.gain(impulse, arm).z, change, 0.01 * change);
}

void expect_sticking(const Corner& corner, const std::vector<Event>& events, double rate_hz) {
  ASSERT_FALSE(events.empty());
  const auto [impulse, arm, change] = corner.landing(events, rate_hz);
  EXPECT_LT(length(corner.gain(impulse, arm) - Vec3{0, 0, change}), 0.01 * change);
}

TEST(SameCorner, ABodySlidesOrSticksAsMechanicsSaysInBothEngines) {
  for (const ShapeType shape : {ShapeType::box, ShapeType::convex}) {
    SCOPED_TRACE(static_cast<int>(shape));
    const Corner smooth(shape, 0), rough(shape, 5);
    expect_frictionless(smooth, by_ode(smooth.scene, smooth.bank, 0.5), kOdeRate_hz);
    expect_frictionless(smooth, by_bullet(smooth.scene, smooth.bank, 0.5), kFrameRate_hz);
    expect_sticking(rough, by_ode(rough.scene, rough.bank, 0.5), kOdeRate_hz);
    expect_sticking(rough, by_bullet(rough.scene, rough.bank, 0.5), kFrameRate_hz);
    const auto in_ode = by_ode(rough.scene, rough.bank, 0.5), in_bullet = by_bullet(rough.scene, rough.bank, 0.5);
    const auto point_of = [](const std::vector<Event>& events) {
      return test::only<synth::verb::Strike>(events).front().point_m;
    };
    EXPECT_LT(length(point_of(in_ode) - point_of(in_bullet)), 5e-4);
    EXPECT_NEAR(static_cast<double>(in_ode.front().frame) / kOdeRate_hz,
                static_cast<double>(in_bullet.front().frame) / kFrameRate_hz, 1e-4);
  }
}

TEST(SameSlide, SlidingIsReportedWithWeightFrictionAndSpeedInBothEngines) {
  constexpr double kMass = 2, kFriction = 0.3;
  BodyDescription body = body_of("a", ShapeType::box, {0, 0, 0.05});
  body.velocity_m_s = {1.5, 1, 0};
  SceneDescription scene = scene_of({body}, 0);
  scene.bodies[0].surface.friction = scene.statics[0].surface.friction = kFriction;
  scene.step_s = 0.001;
  const modal::Bank bank = box_bank({0.2, 0.2, 0.1}, kMass);
  const auto ode = by_ode(scene, bank, 1), bullet = by_bullet(scene, bank, 1);
  EXPECT_NEAR(static_cast<double>(bullet.size()), static_cast<double>(ode.size()), 2);
  ASSERT_GT(bullet.size(), 100u);
  const double start_m_s = std::hypot(1.5, 1);
  for (std::size_t k = 2; k + 3 < bullet.size(); ++k) {
    ASSERT_TRUE(bullet[k].verb.holds<synth::verb::Contact>()) << k;
    const synth::Contact& contact = contact_of(bullet[k]).contact;
    EXPECT_NEAR(contact.force_n.z, kMass * kG, 0.02 * kMass * kG) << k;
    EXPECT_NEAR(std::hypot(contact.force_n.x, contact.force_n.y), kFriction * contact.force_n.z, 0.1) << k;
    const double slip_m_s = start_m_s - kFriction * kG * static_cast<double>(bullet[k].frame) / kFrameRate_hz;
    EXPECT_NEAR(contact.slip_m_s, slip_m_s, 0.02) << k;
  }
  EXPECT_EQ(contact_of(bullet.back()).contact.force_n, (Vec3{})) << "it rests";
}

TEST(SameRoll, RollingIsReportedWithItsSpeedInBothEngines) {
  BodyDescription body = body_of("a", ShapeType::sphere, {0, 0, 0.05});
  body.shape.radius_m = 0.05;
  body.density_kg_m3 = 2500;
  body.velocity_m_s = {1, 0, 0};
  body.spin_rad_s = {0, 20, 0};
  SceneDescription scene = scene_of({body});
  const auto ode = by_ode(scene, box_bank(kSize, 1), 1), bullet = by_bullet(scene, box_bank(kSize, 1), 1);
  EXPECT_NEAR(static_cast<double>(bullet.size()), static_cast<double>(ode.size()), 2);
  ASSERT_GT(bullet.size(), 200u);
  for (std::size_t k = 2; k < bullet.size(); ++k) {
    EXPECT_NEAR(contact_of(bullet[k]).contact.roll_m_s, 1, 0.02) << k;
    EXPECT_LT(contact_of(bullet[k]).contact.slip_m_s, 0.01) << k;
    EXPECT_NEAR(length(contact_of(bullet[k]).point_m), 0.05, 1e-3) << k;
  }
}

TEST(Bullet, BodiesThatHaveSettledSendNoEvents) {
  for (const ShapeType shape : {ShapeType::box, ShapeType::convex, ShapeType::sphere}) {
    for (const double step_s : {1.0 / 1000, 1.0 / 500, 1.0 / 250}) {
      BodyDescription body = body_of("a", shape, {0, 0, 0.3});
      body.rotation = scene::about({1, 2, 3}, 0.4);
      SceneDescription scene = scene_of({body});
      scene.step_s = step_s;
      const auto events = by_bullet(scene, box_bank(kSize, 1), 6);
      ASSERT_GT(events.size(), 2u);
      EXPECT_LT(static_cast<double>(events.back().frame) / kFrameRate_hz, 3)
          << static_cast<int>(shape) << ", " << step_s;
    }
  }
}

TEST(Bullet, BothBodiesOfAContactRingWithOppositeImpulses) {
  BodyDescription left = body_of("a", ShapeType::sphere, {-0.5, 0, 1});
  left.velocity_m_s = {2, 0, 0};
  BodyDescription right = body_of("b", ShapeType::sphere, {0.5, 0, 1});
  right.rotation = scene::about({0, 0, 1}, 1);
  SceneDescription scene = scene_of({left, right}, 0.6);
  scene.gravity_m_s2 = {};
  const std::vector banks{std::make_shared<const modal::Bank>(box_bank(kSize, 1)),
                          std::make_shared<const modal::Bank>(box_bank(kSize, 3))};
  auto world = BulletWorld::create(scene, banks);
  ASSERT_TRUE(world) << world.error().message;
  std::vector<Event> all;
  while (world->time_s() < 1) {
    const auto events = world->step().events;
    all.insert(all.end(), events.begin(), events.end());
  }
  const auto strikes = test::only<synth::verb::Strike>(all);
  ASSERT_EQ(strikes.size(), 2u);
  const Vec3 on_left = test::total_impulse(strikes, 0);
  const Vec3 on_right = scene::to_matrix(right.rotation) * test::total_impulse(strikes, 1);
  EXPECT_LT(length(on_left + on_right), 1e-9);
  const double expected = (1 + 0.6) * 2 / (1.0 / 1 + 1.0 / 3);  // the reduced mass's change of momentum
  EXPECT_NEAR(-on_left.x, expected, 0.01 * expected);
}

TEST(Bullet, BodiesEnterAtTheirTime) {
  Drop drop{ShapeType::sphere, 1, 0.5, 0.5, 1.0 / 500};
  SceneDescription scene = drop.scene();
  scene.bodies[0].start_s = 0.25;
  const auto late = blows(by_bullet(scene, box_bank(kSize, 1), 2), kFrameRate_hz), early = drop.in_bullet(1);
  ASSERT_FALSE(late.empty() || early.empty());
  EXPECT_NEAR(late.front().time_s - early.front().time_s, 0.25, 1e-5);
}

TEST(Bullet, TheSameSceneGivesTheSameEventsBitForBit) {
  const Corner corner(ShapeType::convex, 0.5);
  const auto first = by_bullet(corner.scene, corner.bank, 2), second = by_bullet(corner.scene, corner.bank, 2);
  ASSERT_GT(first.size(), 3u);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t k = 0; k < first.size(); ++k) EXPECT_TRUE(test::same_bits(first[k], second[k])) << k;
}

std::string refusal(const SceneDescription& scene) {
  const auto world = BulletWorld::create(scene, std::vector{std::make_shared<const modal::Bank>(box_bank(kSize, 1))});
  return world ? "" : world.error().message;
}

TEST(Bullet, SceneFeaturesThatBulletLacksAreNamed) {
  const SceneDescription plain = scene_of({body_of("a", ShapeType::box, {0, 0, 1})});
  EXPECT_EQ(refusal(plain), "");
  SceneDescription scene = plain;
  scene.joints.push_back({.name = "string", .body = "a"});
  EXPECT_NE(refusal(scene).find("joint 'string'"), std::string::npos) << refusal(scene);
  scene = plain;
  scene.emitters.push_back({.name = "rain", .body = body_of("a", ShapeType::box, {0, 0, 1})});
  EXPECT_NE(refusal(scene).find("emitter 'rain'"), std::string::npos) << refusal(scene);
  scene = plain;
  scene.bodies[0].scatter_m = 0.1;
  EXPECT_NE(refusal(scene).find("scatter_m"), std::string::npos) << refusal(scene);
  scene = plain;
  scene.bodies[0].shape.type = ShapeType::trimesh;
  EXPECT_NE(refusal(scene).find("trimesh"), std::string::npos) << refusal(scene);
  scene = plain;
  scene.step_s = -1;
  EXPECT_NE(refusal(scene).find("step_s"), std::string::npos) << refusal(scene);
}

}  // namespace
}  // namespace ringdown::bullet
