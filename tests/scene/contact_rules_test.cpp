#include "engine/scene/contact_rules.h"

#include <gtest/gtest.h>

namespace ringdown::scene {
namespace {

TEST(SoftConstraint, FollowsFromSpringDamperAndStep) {
  // By hand: h kp = 0.002 * 1e5 = 200, kd = 300.
  const SoftConstraint soft = soft_constraint(1e5, 300, 0.002);
  EXPECT_DOUBLE_EQ(soft.erp, 0.4);
  EXPECT_DOUBLE_EQ(soft.cfm, 0.002);
}

TEST(SoftConstraint, IsTheImplicitEulerStepOfASpringWithADamper) {
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

TEST(Surface, APairTakesGeometricMeansAndTheLongerContact) {
  const Surface pair = combine({0.9, 0.2, 0.001}, {0.4, 0.8, 0.003});
  EXPECT_DOUBLE_EQ(pair.restitution, 0.6);
  EXPECT_DOUBLE_EQ(pair.friction, 0.4);
  EXPECT_DOUBLE_EQ(pair.contact_time_s, 0.003);
}

TEST(RepeatFilter, APairWaitsForTheMinimumRepeatTime) {
  RepeatFilter filter(0.01);
  EXPECT_TRUE(filter.admit(1, 2, 0));
  EXPECT_TRUE(filter.admit(1, 2, 0)) << "another point of the same blow";
  EXPECT_TRUE(filter.admit(1, 3, 0.004)) << "another pair";
  EXPECT_FALSE(filter.admit(2, 1, 0.008)) << "the same pair the other way round";
  EXPECT_TRUE(filter.admit(1, 2, 5 * 0.002)) << "exactly the repeat time later";
  EXPECT_FALSE(filter.admit(1, 2, 0.018));
}

TEST(RepeatFilter, ForgetsPairsThatAreFreeAgain) {
  RepeatFilter filter(0.01);
  for (std::uint32_t k = 0; k < 1000; ++k) {
    filter.admit(0, k + 1, 0.001 * k);
    filter.forget_old(0.001 * k);
    EXPECT_LE(filter.remembered(), 12u);
  }
}

}  // namespace
}  // namespace ringdown::scene
