// The impulses of a body that touches only what cannot move, against the conditions that have exactly one solution.
#include "engine/scene/fixed_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace ringdown::scene::fixed_contacts_test {
namespace {

constexpr double kSoftness = 5e-5;

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double number(double low, double high) { return low + (high - low) * random_() / std::mt19937::max(); }
  Vec3 unit() {
    const Vec3 v{number(-1, 1), number(-1, 1), number(-1, 1)};
    return (1 / length(v)) * v;
  }

 private:
  std::mt19937 random_;
};

struct Case {
  FreeBody body;
  std::vector<FixedContact> contacts;
};

// A box on its four lower corners, or any points with normals of any direction; with or without friction.
Case draw(unsigned seed) {
  Draw draw(seed);
  const double mass = draw.number(0.01, 10), edge = draw.number(0.01, 0.5);
  const double moment = mass * edge * edge / 6;
  Case one{{1 / mass, {}, 2 * draw.unit(), 5 * draw.unit()}, {}};
  for (int k = 0; k < 3; ++k) one.body.inverse_inertia[k][k] = draw.number(0.5, 1) / moment;
  const bool flat = seed % 2 == 0;
  const double friction = seed % 3 == 0 ? 0 : draw.number(0.05, 1.5);
  const std::size_t count = flat ? 4 : 1 + seed % kMaxFixedContacts;
  for (std::size_t k = 0; k < count; ++k) {
    FixedContact& contact = one.contacts.emplace_back();
    contact.arm_m =
        flat ? Vec3{(k & 1 ? 0.5 : -0.5) * edge, (k & 2 ? 0.5 : -0.5) * edge, -0.5 * edge} : 0.5 * edge * draw.unit();
    contact.normal = flat ? Vec3{0, 0, 1} : draw.unit();
    contact.along = any_across(contact.normal);
    contact.wanted_m_s = draw.number(0, 1) < 0.5 ? 0 : draw.number(-0.1, 2);
    contact.friction = friction;
  }
  return one;
}

// The velocity of a contact's point at the end, and how much the contact gives way.
Vec3 speed_at(const Case& one, const std::vector<Vec3>& impulses, std::size_t at) {
  Vec3 velocity = one.body.velocity_m_s, spin = one.body.spin_rad_s;
  for (std::size_t k = 0; k < impulses.size(); ++k) {
    velocity = velocity + one.body.inverse_mass * impulses[k];
    spin = spin + one.body.inverse_inertia * cross(one.contacts[k].arm_m, impulses[k]);
  }
  return velocity + cross(spin, one.contacts[at].arm_m) + kSoftness * impulses[at];
}

std::vector<Vec3> solve(const Case& one, bool lands, bool& solved) {
  std::vector<Vec3> impulses(one.contacts.size());
  solved = solve_fixed_contacts(one.body, one.contacts, kSoftness, lands, impulses);
  return impulses;
}

// `bounds` are those of friction, which the solution must keep within `slack` of itself.
void expect_solution(const Case& one, const std::vector<Vec3>& impulses, const std::vector<double>& bounds,
                     double slack) {
  for (std::size_t k = 0; k < impulses.size(); ++k) {
    const FixedContact& contact = one.contacts[k];
    const Vec3 end = speed_at(one, impulses, k);
    const double push = dot(impulses[k], contact.normal), over = dot(end, contact.normal) - contact.wanted_m_s;
    EXPECT_GE(push, -1e-14);
    EXPECT_GE(over, -1e-8);
    EXPECT_LT(std::min(push * one.body.inverse_mass, over), 1e-8) << "pushes only what would come too near";
    for (const Vec3 way : {contact.along, cross(contact.normal, contact.along)}) {
      const double hold = dot(impulses[k], way), slip = dot(end, way);
      EXPECT_LE(std::abs(hold), bounds[k] * (1 + slack) + 1e-9);
      if (contact.friction == 0) continue;
      const bool full = std::abs(hold) >= bounds[k] * (1 - slack) - 1e-9;
      if (full && std::abs(slip) > 1e-8) {
        EXPECT_LE(hold * slip, 1e-9) << "friction acts against the sliding";
      } else {
        EXPECT_LT(std::abs(slip), 1e-8) << "what does not slide is held";
      }
    }
  }
}

TEST(FixedContacts, ImpulsesPushAndHoldAsCoulombSaysWithTheFrictionlessLoad) {
  int solutions = 0;
  for (unsigned seed = 1; seed <= 600; ++seed) {
    const Case one = draw(seed);
    Case smooth = one;
    for (FixedContact& contact : smooth.contacts) contact.friction = 0;
    bool solved = false, solved_smooth = false;
    const auto impulses = solve(one, false, solved), loads = solve(smooth, false, solved_smooth);
    if (!solved || !solved_smooth) continue;
    ++solutions;
    std::vector<double> bounds;
    for (std::size_t k = 0; k < loads.size(); ++k) {
      bounds.push_back(one.contacts[k].friction * dot(loads[k], one.contacts[k].normal));
    }
    SCOPED_TRACE(seed);
    expect_solution(one, impulses, bounds, 1e-9);
  }
  EXPECT_GE(solutions, 595) << "the rest is left to ODE";
}

// The normal impulse falls by up to 20 times what friction grows, or grows with it, and pulls at nothing.
TEST(FixedContacts, TheBoundOfFrictionIsFoundWhereTheLastSolutionsBoundWouldSwing) {
  for (const double slope : {-20.0, -3.0, -1.0, -0.3, 0.0, 0.5, 0.95}) {
    const auto asked = [slope](double bound) { return std::max(2 + slope * bound, 0.0); };
    FrictionBound bound;
    bound.meet(asked(0));
    for (int round = 0; round < kMaxFrictionRounds && bound.meet(asked(bound.value())) > 0; ++round) continue;
    EXPECT_NEAR(bound.value(), 2 / (1 - slope), 1e-3 * bound.value()) << slope;
  }
}

// Of one point, friction settles on the load that there is with it.
TEST(FixedContacts, ABodyThatLandsOnACornerHasFrictionInProportionToItsOwnLoad) {
  int settled = 0, cases = 0;
  for (unsigned seed = 1; seed <= 600; ++seed) {
    Case one = draw(6 * seed + 1);
    one.contacts.resize(1);
    one.contacts.front().friction = std::min(one.contacts.front().friction, 0.5);
    bool solved = false;
    const auto impulses = solve(one, true, solved);
    ASSERT_TRUE(solved);
    const double load = dot(impulses[0], one.contacts[0].normal);
    if (load == 0) continue;
    ++cases;
    const Vec3 hold = impulses[0] - load * one.contacts[0].normal, slip = speed_at(one, impulses, 0);
    const auto across = [&](Vec3 v) {
      return std::max(std::abs(dot(v, one.contacts[0].along)),
                      std::abs(dot(v, cross(one.contacts[0].normal, one.contacts[0].along))));
    };
    const double bound = one.contacts[0].friction * load;
    const bool slides = across(slip - dot(slip, one.contacts[0].normal) * one.contacts[0].normal) > 1e-8;
    const bool agrees = across(hold) <= bound * (1 + 2 * kFrictionAgrees) &&
                        (!slides || across(hold) >= bound * (1 - 2 * kFrictionAgrees));
    settled += agrees ? 1 : 0;
  }
  EXPECT_GT(cases, 200);
  EXPECT_GE(settled, cases * 0.99) << "of " << cases;
}

}  // namespace
}  // namespace ringdown::scene::fixed_contacts_test
