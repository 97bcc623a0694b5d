// Bristles against closed forms: the stick-slip period of one mode on a belt, a block that slides to a stop.
#include "engine/contact/network.h"
#include "tests/contact/modal_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace ringdown::contact {
namespace {

TEST(Friction, OneModeOnABeltSticksAndSlipsInTheClosedFormsPeriod) {
  const double step = 1.0 / 48000;
  for (const double pitch_hz : {65.0, 110.0}) {
    for (const double belt : {0.8, 1.2}) {
      const double omega = 2 * std::numbers::pi * pitch_hz, kg = 0.01, stiffness = omega * omega * kg;
      const double load = 2 * stiffness * 0.002 * 110 / pitch_hz;
      ModalBody body(step);
      body.add(omega, 0, {1 / std::sqrt(kg)});
      body.kick(0, belt * std::sqrt(kg));  // it begins stuck: at rest it would slide for ever
      const double compliance = body.compliance(0, 0);
      Contact contact{.load_n = load,
                      .friction = FrictionLaw{.static_coefficient = 0.4,
                                              .sliding_coefficient = 0.2,
                                              .stribeck_m_s = 4e-3,
                                              .bristle_n_m = 2 / compliance,
                                              .bristle_ns_m = 0.3 * step / compliance,
                                              .stick_share = 0.9},
                      .directions = 1};
      Network network;
      ASSERT_TRUE(network.add(contact));
      network.set_compliance(0, 0, body.compliance(0, 0));
      std::vector<double> starts;  // of slipping
      bool slips = false;
      for (int n = 0; n < 96000; ++n) {
        double free = belt * step - body.free_change(0), force = 0;
        network.step({&free, 1}, step, {&force, 1});
        body.step({force});
        const double slip = belt - body.velocity(0);
        if (!slips && slip > 0.5 * belt) starts.push_back(n);
        slips = slip > (slips ? 0.25 : 0.5) * belt;
      }
      ASSERT_GT(starts.size(), 20u);
      const std::size_t half = starts.size() / 2;
      const double period = (starts.back() - starts[half]) * step / static_cast<double>(starts.size() - 1 - half);
      const double jump = (0.4 - 0.2) * load / stiffness;
      const double expected = 2 * jump / belt + 2 / omega * (std::numbers::pi - std::atan(jump * omega / belt));
      EXPECT_NEAR(period, expected, 0.005 * expected) << pitch_hz << " Hz, " << belt << " m/s";
      RecordProperty(
          "period_" + std::to_string(static_cast<int>(pitch_hz)) + "_" + std::to_string(static_cast<int>(100 * belt)),
          std::to_string(period / expected));
    }
  }
}

// A block thrown along a floor: v^2 / (2 mu g) far, in a straight line whatever the direction.
TEST(Friction, BlockSlidesToAStopWhereCoulombSays) {
  const double step = 1.0 / 48000, kg = 0.2, mu = 0.3, speed = 0.5;
  for (const double angle : {0.0, 0.7, 2.0}) {
    ModalBody x(step), y(step);
    x.add_mass(kg), y.add_mass(kg);
    x.kick(0, speed * std::cos(angle) * std::sqrt(kg)), y.kick(0, speed * std::sin(angle) * std::sqrt(kg));
    Contact contact{
        .load_n = 9.81 * kg,
        .friction =
            FrictionLaw{.static_coefficient = mu, .sliding_coefficient = mu, .bristle_n_m = 1e6, .bristle_ns_m = 200},
        .directions = 2};
    Network network;
    ASSERT_TRUE(network.add(contact));
    network.set_compliance(0, 0, x.compliance(0, 0));
    network.set_compliance(1, 1, y.compliance(0, 0));
    for (int n = 0; n < 48000; ++n) {
      const double free[2] = {-x.free_change(0), -y.free_change(0)};
      double force[2] = {};
      network.step(free, step, force);
      x.step({force[0]}), y.step({force[1]});
    }
    const double far = speed * speed / (2 * mu * 9.81);
    EXPECT_NEAR(x.displacement(0), far * std::cos(angle), 0.002 * far) << angle;
    EXPECT_NEAR(y.displacement(0), far * std::sin(angle), 0.002 * far) << angle;
    EXPECT_LT(std::hypot(x.velocity(0), y.velocity(0)), 1e-6);
  }
}

// What rests under a load that trembles below the limit must not creep.
TEST(Friction, WhatSticksDoesNotCreep) {
  const double step = 1.0 / 48000, kg = 0.1;
  ModalBody mass(step);
  mass.add_mass(kg);
  Contact contact{
      .load_n = 1,
      .friction =
          FrictionLaw{.static_coefficient = 0.4, .sliding_coefficient = 0.35, .bristle_n_m = 2e5, .bristle_ns_m = 100},
      .directions = 1};
  Network network;
  ASSERT_TRUE(network.add(contact));
  network.set_compliance(0, 0, mass.compliance(0, 0));
  double early = 0;
  for (int n = 0; n < 96000; ++n) {
    const double push = std::min(1.0, n / 4800.0) * (0.15 + 0.05 * std::sin(2 * std::numbers::pi * 50 * n * step));
    double free = -mass.free_change(0) - mass.compliance(0, 0) * push, force = 0;
    network.step({&free, 1}, step, {&force, 1});
    mass.step({force + push});
    if (n == 9600) early = mass.displacement(0);
  }
  EXPECT_LT(std::abs(mass.displacement(0) - early), 1e-6);
  EXPECT_NEAR(mass.displacement(0), 0.15 / 2e5, 0.3e-6);
}

}  // namespace
}  // namespace ringdown::contact
