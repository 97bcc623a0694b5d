// Impacts against closed forms: Hertz's contact time, Hunt and Crossley's restitution, statics, conservation of energy.
#include "engine/contact/network.h"
#include "tests/contact/modal_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>

namespace ringdown::contact {
namespace {

struct Bounce {
  double contact_s = 0, restitution = 0, lowest_n = 0;
};

// A mass thrown against a wall, `phase` of a step before it touches.
Bounce throw_mass(const ImpactLaw& law, double kg, double speed_m_s, double step_s, double phase) {
  ModalBody mass(step_s);
  mass.add_mass(kg);
  mass.kick(0, -speed_m_s * std::sqrt(kg));
  Contact contact{.impact = law};
  contact.pressed.place(-(2 + phase) * speed_m_s * step_s);
  Network network;
  static_cast<void>(network.add(contact));
  network.set_compliance(0, 0, mass.compliance(0, 0));
  Bounce bounce{.lowest_n = 1};
  // Flight is exact, so the moments of touching and leaving are known to a fraction of a step.
  double time = 0;
  bool touched = false;
  for (int n = 0; n < 4000; ++n) {
    double free = -mass.free_change(0), force = 0;
    network.step({&free, 1}, step_s, {&force, 1});
    bounce.lowest_n = std::min(bounce.lowest_n, force);
    mass.step({force});
    time += step_s;
    touched = touched || force > 0;
    if (touched && force == 0 && contact.pressed.depth_m() < 0 && mass.velocity(0) > 0) break;
  }
  const double left = time + contact.pressed.depth_m() / mass.velocity(0);
  bounce.restitution = mass.velocity(0) / speed_m_s;
  bounce.contact_s = left - (2 + phase) * step_s;
  return bounce;
}

double hertz_time(const ImpactLaw& law, double kg, double speed) {
  const double depth = std::pow(1.25 * kg * speed * speed / law.stiffness, 0.4);
  return 2.9432751 * depth / speed;
}

TEST(Impact, LastsAsLongAsHertzSaysAtAnyPhase) {
  const double kg = 0.02, speed = 1;
  for (const double samples : {5.0, 8.0, 12.0, 20.0, 50.0}) {
    const double step = 1.0 / 48000;
    ImpactLaw law{.stiffness = 1};
    law.stiffness = std::pow(hertz_time(law, kg, speed) / (samples * step), 2.5);
    double low = 1e9, high = 0;
    for (double phase = 0; phase < 1; phase += 0.1) {
      const Bounce bounce = throw_mass(law, kg, speed, step, phase);
      const double ratio = bounce.contact_s / (samples * step);
      low = std::min(low, ratio), high = std::max(high, ratio);
      EXPECT_NEAR(ratio, 1, 1.1 / (samples * samples)) << samples << " samples, phase " << phase;
      EXPECT_NEAR(bounce.restitution, 1, 1e-3) << samples << " samples, phase " << phase;
      EXPECT_GE(bounce.lowest_n, 0);
    }
    RecordProperty("ratio_" + std::to_string(static_cast<int>(samples)),
                   std::to_string(low) + " " + std::to_string(high));
  }
}

// v / (1 + mu v) integrated from 0, whose values at both ends of an impact agree.
double crossley_integral(double v, double mu) { return v / mu - std::log1p(mu * v) / (mu * mu); }

TEST(Impact, ReturnsWhatHuntAndCrossleySay) {
  const double kg = 0.02, speed = 1, step = 1.0 / 48000;
  for (const double mu : {0.1, 0.3, 0.8}) {
    double low = 0, high = std::min(1.0, 1 / mu - 1e-12);
    for (int i = 0; i < 80; ++i) {
      const double middle = 0.5 * (low + high);
      (crossley_integral(-middle, mu) < crossley_integral(speed, mu) ? low : high) = middle;
    }
    for (const double samples : {5.0, 20.0}) {
      ImpactLaw law{.stiffness = 1};
      law.stiffness = std::pow(hertz_time(law, kg, speed) / (samples * step), 2.5);
      law.damping_s_m = mu;
      for (double phase = 0; phase < 1; phase += 0.25) {
        EXPECT_NEAR(throw_mass(law, kg, speed, step, phase).restitution, low, 0.01) << mu << ", " << samples;
      }
    }
  }
}

TEST(Impact, BouncesAsAskedAtAnySpeed) {
  for (const double bounce : {0.3, 0.6, 0.9}) {
    for (const double speed : {0.01, 0.3, 5.0}) {
      ImpactLaw law{.stiffness = 1};
      law.stiffness = std::pow(hertz_time(law, 0.02, speed) * 48000 / 20, 2.5);
      law.bounce = bounce;
      EXPECT_NEAR(throw_mass(law, 0.02, speed, 1.0 / 48000, 0.3).restitution, bounce, 0.05) << bounce << ", " << speed;
    }
  }
}

TEST(Impact, BodyAtRestLiesAsDeepAsStaticsSays) {
  const double step = 1.0 / 48000, kg = 0.3, weight = 9.81 * kg;
  for (const double stiffness : {1e6, 1e8, 1e10}) {
    ModalBody mass(step);
    mass.add_mass(kg);
    Contact contact{.impact = ImpactLaw{.stiffness = stiffness, .bounce = 0.3}};
    contact.pressed.place(-1e-5);
    Network network;
    ASSERT_TRUE(network.add(contact));
    network.set_compliance(0, 0, mass.compliance(0, 0));
    double force = 0;
    for (int n = 0; n < 480000; ++n) {
      double free = -mass.free_change(0) + mass.compliance(0, 0) * weight;
      network.step({&free, 1}, step, {&force, 1});
      mass.step({force - weight});
    }
    EXPECT_NEAR(contact.pressed.depth_m(), std::pow(weight / stiffness, 2.0 / 3),
                0.01 * std::pow(weight / stiffness, 2.0 / 3));
    EXPECT_NEAR(force, weight, 0.01 * weight);
  }
}

// Two bodies of 60 undamped modes that hit each other; the long form takes a million steps.
TEST(Impact, KeepsEnergyToRounding) {
  const char* const stress = std::getenv("RINGDOWN_STRESS");
  const int steps = stress && std::strcmp(stress, "long") == 0 ? 1000000 : 150000;
  const double step = 1.0 / 48000;
  for (const double stiffness : {1e6, 1e10}) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    ModalBody a(step), b(step);
    for (ModalBody* body : {&a, &b}) {
      for (int m = 0; m < 60; ++m) body->add(6.283185307 * (200 + 300 * m + 100 * any(random)), 0, {2 * any(random)});
    }
    for (std::size_t m = 0; m < 60; ++m) a.kick(m, 0.1 * any(random));
    Contact contact{.impact = ImpactLaw{.stiffness = stiffness}};
    contact.pressed.place(-1e-6);
    Network network;
    ASSERT_TRUE(network.add(contact));
    network.set_compliance(0, 0, a.compliance(0, 0) + b.compliance(0, 0));
    const double begin = a.energy();
    double before = begin, rises = 0, worst = 0, touched = 0;
    for (int n = 0; n < steps; ++n) {
      double free = a.free_change(0) - b.free_change(0), force = 0;
      touched += network.step({&free, 1}, step, {&force, 1}) ? 1 : 0;
      a.step({-force});
      b.step({force});
      const double energy = a.energy() + b.energy() + contact.pressed.energy_j();
      worst = std::max(worst, energy - before);
      rises += std::max(0.0, energy - before);
      before = energy;
    }
    EXPECT_GT(touched, 1e3);
    EXPECT_LT(worst, 1e-14 * begin) << stiffness;
    EXPECT_LT(before - begin, 1e-11 * begin) << stiffness;
    EXPECT_GT(before, 0.8 * begin) << stiffness;  // and what is dropped where spring and depth part is little
    RecordProperty("kept", std::to_string(before / begin) + " rises " + std::to_string(rises / begin * 1e12) + "e-12");
  }
}

}  // namespace
}  // namespace ringdown::contact
