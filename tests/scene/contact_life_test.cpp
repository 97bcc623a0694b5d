// The rules of a contact's life, without any physics: what is fed is what a physics engine would find.
#include "engine/scene/contact/contact_life.h"
#include "engine/scene/rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace ringdown::scene::contact_life_test {
namespace {

constexpr double kStep_s = 0.001, kRepeat_s = 0.01;
constexpr BodyPair kPair{1, 2};

// Presses with 3 N and slides at this speed.
PairContact sliding(double slip_m_s) {
  return {.pair = kPair, .impulse_ns = {0, 0, 3 * kStep_s}, .normal = {0, 0, 1}, .slide_m_s = {slip_m_s, 0, 0}};
}

// Feeds one step; returns how many reports it gave, of which `last` keeps the last.
std::size_t step(ContactLives& lives, const std::optional<PairContact>& contact, double& now_s, ContactReport& last) {
  if (contact) lives.add(*contact, now_s);
  const auto reports = lives.advance(now_s);
  if (!reports.empty()) last = reports.back();
  now_s += kStep_s;
  return reports.size();
}

TEST(Blows, AContactIsOneBlowAtItsBeginningAndNoneWhileItChatters) {
  ContactLives lives(kRepeat_s, kStep_s);
  EXPECT_TRUE(lives.strikes(kPair, 1, 0));
  EXPECT_TRUE(lives.strikes({1, 3}, 1, 0.004)) << "another pair";
  for (int k = 1; k < 100; ++k) EXPECT_FALSE(lives.strikes(kPair, 1, 0.008 * k)) << "a blow every 8 ms is chatter";
  EXPECT_TRUE(lives.strikes(kPair, 1, 0.008 * 99 + kRepeat_s)) << "exactly the repeat time later";
}

TEST(Blows, AMuchFasterBlowIsHeardAtOnce) {
  ContactLives lives(kRepeat_s, kStep_s);
  EXPECT_TRUE(lives.strikes(kPair, 0.1, 0));
  EXPECT_FALSE(lives.strikes(kPair, 0.2, 0.002));
  EXPECT_TRUE(lives.strikes(kPair, 0.21, 0.004));
  EXPECT_FALSE(lives.strikes(kPair, 0.4, 0.006));
}

TEST(Lasting, ALastingContactIsToldEveryFourMillisecondsWithItsMeanForceAndEndsOnce) {
  ContactLives lives(kRepeat_s, kStep_s);
  ContactReport last;
  double now_s = 0;
  std::size_t told = 0;
  for (int k = 0; k < 100; ++k) told += step(lives, sliding(0.2), now_s, last);
  EXPECT_EQ(told, 25u);
  EXPECT_FALSE(last.ends);
  EXPECT_NEAR(last.force_n.z, 3, 1e-12);
  EXPECT_NEAR(last.slip_m_s, 0.2, 1e-12);
  EXPECT_EQ(last.roll_m_s, 0);
  told = 0;
  for (int k = 0; k < 100; ++k) told += step(lives, {}, now_s, last);
  EXPECT_EQ(told, 1u);
  EXPECT_TRUE(last.ends);
  EXPECT_EQ(lives.size(), 0u) << "what is over is forgotten";
}

TEST(Lasting, RestIsSilentAndDoesNotFlicker) {
  ContactLives lives(kRepeat_s, kStep_s);
  ContactReport last;
  double now_s = 0;
  std::size_t told = 0;
  for (int k = 0; k < 100; ++k) told += step(lives, sliding(0.9 * kMinContactSpeed_m_s), now_s, last);
  EXPECT_EQ(told, 0u) << "too slow to begin";
  for (int k = 0; k < 8; ++k) told += step(lives, sliding(1.1 * kMinContactSpeed_m_s), now_s, last);
  for (int k = 0; k < 8; ++k) told += step(lives, sliding(0.9 * kMinContactSpeed_m_s), now_s, last);
  EXPECT_EQ(told, 4u) << "but fast enough to go on";
  EXPECT_FALSE(last.ends);
  for (int k = 0; k < 40; ++k) told += step(lives, sliding(0.4 * kMinContactSpeed_m_s), now_s, last);
  EXPECT_EQ(told, 5u);
  EXPECT_TRUE(last.ends);
}

TEST(Lasting, ChatterIsOneLastingContactOfTheMeanForce) {
  ContactLives lives(kRepeat_s, kStep_s);
  ContactReport last;
  double now_s = 0;
  int begun = 0, ended = 0;
  for (int k = 0; k < 400; ++k) {
    PairContact contact = sliding(0.2);
    contact.impulse_ns.z *= 2;
    if (step(lives, k % 2 ? std::optional(contact) : std::nullopt, now_s, last) == 0) continue;
    begun += last.begins;
    ended += last.ends;
    EXPECT_NEAR(last.force_n.z, 3, 1e-9) << "6 N half of the time";
  }
  EXPECT_EQ(begun, 1);
  EXPECT_EQ(ended, 0);
}

// A ball of this radius on a plane, both seen from the world: it moves at `velocity` and spins at `spin`.
double roll_of_ball(double radius, double velocity, double spin) {
  ContactLives lives(kRepeat_s, kStep_s);
  ContactReport last;
  double now_s = 0;
  for (int k = 0; k < 80; ++k) {
    PairContact contact = sliding(std::abs(velocity - radius * spin));
    contact.point_m = {velocity * now_s, 0, 0};
    contact.first = {.position_m = {velocity * now_s, 0, radius},
                     .rotation = about({0, 1, 0}, spin * now_s),
                     .velocity_m_s = {velocity, 0, 0},
                     .spin_rad_s = {0, spin, 0}};
    contact.max_roll_m_s = radius * std::abs(spin);
    step(lives, contact, now_s, last);
  }
  return last.roll_m_s;
}

TEST(Lasting, RollSpeedIsHowFastTheContactTravelsOverBothSurfaces) {
  EXPECT_NEAR(roll_of_ball(0.02, 0.6, 30), 0.6, 0.001) << "pure rolling";
  EXPECT_NEAR(roll_of_ball(0.02, 0.6, 0), 0, 1e-9) << "sliding: the contact stays where it is on the ball";
  EXPECT_NEAR(roll_of_ball(0.02, 0, 30), 0, 1e-9) << "spinning on the spot: it stays where it is on the plane";
  EXPECT_NEAR(roll_of_ball(0.02, 0.6, 10), 0.2, 0.001) << "skidding";
}

}  // namespace
}  // namespace ringdown::scene::contact_life_test
