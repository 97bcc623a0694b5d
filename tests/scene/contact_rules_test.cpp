#include "engine/scene/contact/contact_rules.h"

#include <gtest/gtest.h>

namespace ringdown::scene::contact_rules_test {
namespace {

TEST(SoftConstraint, ASoftConstraintFollowsFromSpringDamperAndStep) {
  // By hand: h kp = 0.002 * 1e5 = 200, kd = 300.
  const SoftConstraint soft = soft_constraint(1e5, 300, 0.002);
  EXPECT_DOUBLE_EQ(soft.erp, 0.4);
  EXPECT_DOUBLE_EQ(soft.cfm, 0.002);
}

TEST(SoftConstraint, ASoftConstraintIsTheImplicitEulerStepOfASpringWithADamper) {
  // One body of mass m on the spring: v' = v - h/m (kp (x + h v') + kd v'), against the constraint's
  // v' = v + h/m f with v' + cfm f = -(erp / h) x.
  const double m = 2, kp = 4000, kd = 30, h = 0.005, x = 0.01, v = -0.7;
  const double implicit = (v - h / m * kp * x) / (1 + h / m * (h * kp + kd));
  const SoftConstraint soft = soft_constraint(kp, kd, h);
  const double force = (-soft.erp / h * x - v) / (h / m + soft.cfm);
  EXPECT_NEAR(v + h / m * force, implicit, 1e-12);
}

TEST(SoftConstraint, ASpringAloneCorrectsEverythingAndADamperAloneNothing) {
  EXPECT_DOUBLE_EQ(soft_constraint(1e6, 0, 0.01).erp, 1);
  EXPECT_DOUBLE_EQ(soft_constraint(0, 50, 0.01).erp, 0);
}

FrictionSurface surface(double restitution, double friction, std::optional<double> contact_time_s) {
  FrictionSurface made;
  made.restitution = restitution;
  made.friction = friction;
  made.contact_time_s = contact_time_s;
  return made;
}

TEST(Surface, APairOfSurfacesTakesGeometricMeansAndTheLongerContact) {
  const SurfacePair pair = combine(surface(0.9, 0.2, 0.001), surface(0.4, 0.8, 0.003));
  EXPECT_DOUBLE_EQ(pair.restitution, 0.6);
  EXPECT_DOUBLE_EQ(pair.friction, 0.4);
  EXPECT_EQ(pair.contact_time_s, 0.003);
}

TEST(Surface, TheContactTimeOfOneSurfaceIsEnoughAndNoneIsNone) {
  EXPECT_EQ(combine(surface(1, 1, {}), surface(1, 1, 0.0004)).contact_time_s, 0.0004);
  EXPECT_EQ(combine(surface(1, 1, 0.0), surface(1, 1, {})).contact_time_s, 0.0)
      << "an ideal impulse, as it was asked for";
  EXPECT_FALSE(combine(surface(1, 1, {}), surface(1, 1, {})).contact_time_s);
}

TEST(Surface, VariancesOfTexturesAdd) {
  FrictionSurface rough, fine;
  rough.texture = {4e-6, 1e-4, -2};
  fine.texture = {3e-6, 2e-5, -3};
  const synth::Texture sum = combine(rough, fine).texture;
  EXPECT_NEAR(sum.roughness_m, 5e-6, 1e-18);
  EXPECT_NEAR(sum.correlation_m, (16 * 1e-4 + 9 * 2e-5) / 25, 1e-15);
  EXPECT_NEAR(sum.spectral_slope, -(16 * 2.0 + 9 * 3) / 25, 1e-12);
  rough.texture.roughness_m = fine.texture.roughness_m = 0;
  EXPECT_EQ(combine(rough, fine).texture.roughness_m, 0);
}

}  // namespace
}  // namespace ringdown::scene::contact_rules_test
