// Several contacts on bodies that they share, with friction, under random players: the bodies and springs never hold
// more than the players put in.
#include "engine/contact/network.h"
#include "tests/contact/modal_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>
#include <utility>
#include <vector>

namespace ringdown::contact {
namespace {

bool long_form() {
  const char* const stress = std::getenv("RINGDOWN_STRESS");
  return stress && std::strcmp(stress, "long") == 0;
}

// Body 0 is bowed at place 0; bodies 0 and 1 touch at places 1 (normal, two directions along the surface: places 1, 2,
// 3), bodies 1 and 2 at their places 4, 5, 6 and 1, 2, 3.
struct Rig {
  explicit Rig(double step_s, std::mt19937& random) {
    std::uniform_real_distribution<double> any(-1, 1);
    for (int b = 0; b < 3; ++b) {
      ModalBody body(step_s);
      for (int m = 0; m < 20; ++m) {
        std::vector<double> shapes(7);
        for (double& shape : shapes) shape = 3 * any(random);
        body.add(6.283185307 * (150 + 400 * m + 100 * any(random)), 3 + 3 * std::abs(any(random)), shapes);
      }
      bodies.push_back(std::move(body));
    }
  }
  std::vector<ModalBody> bodies;
};

struct Side {
  std::size_t body, place;
};
// Of each freedom: who is pushed by a positive force, and who is pushed back.
const std::vector<std::vector<Side>> kSides = {{{0, 0}},         {{0, 1}, {1, 1}}, {{0, 2}, {1, 2}}, {{0, 3}, {1, 3}},
                                               {{1, 4}, {2, 1}}, {{1, 5}, {2, 2}}, {{1, 6}, {2, 3}}};

double sign_of(std::size_t side) { return side == 0 ? 1 : -1; }

TEST(Network, NeverHoldsMoreThanThePlayersPutIn) {
  const double step = 1.0 / 48000;
  const int rounds = long_form() ? 1000 : 6, steps = 10000;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  double worst = 0, largest = 0;
  for (int round = 0; round < rounds; ++round) {
    Rig rig(step, random);
    const auto coefficient = [&] { return 0.1 + unit(random); };
    const auto friction = [&] {
      const double mu = coefficient();
      return FrictionLaw{.static_coefficient = mu,
                         .sliding_coefficient = mu * unit(random),
                         .stribeck_m_s = std::pow(10, -4 + 4 * unit(random)),
                         .bristle_n_m = std::pow(10, 3 + 5 * unit(random)),
                         .bristle_ns_m = std::pow(10, -1 + 4 * unit(random)),
                         .stick_share = unit(random)};
    };
    const auto impact = [&] {
      return ImpactLaw{.stiffness = std::pow(10, 5 + 6 * unit(random)),
                       .exponent = unit(random) < 0.5 ? 1.5 : 1 + 2 * unit(random),
                       .damping_s_m = unit(random)};
    };
    Contact bow{.load_n = 5 * unit(random), .friction = friction(), .directions = 1};
    Contact first{.impact = impact(), .friction = friction(), .directions = 2};
    Contact second{.impact = impact(), .friction = friction(), .directions = 2};
    first.pressed.place(-1e-6), second.pressed.place(-1e-6);
    Network network;
    for (Contact* contact : {&bow, &first, &second}) ASSERT_TRUE(network.add(*contact));
    for (std::size_t i = 0; i < kSides.size(); ++i) {
      for (std::size_t j = 0; j < kSides.size(); ++j) {
        double sum = 0;
        for (std::size_t si = 0; si < kSides[i].size(); ++si) {
          for (std::size_t sj = 0; sj < kSides[j].size(); ++sj) {
            const Side &a = kSides[i][si], &b = kSides[j][sj];
            if (a.body == b.body) sum += sign_of(si) * sign_of(sj) * rig.bodies[a.body].compliance(a.place, b.place);
          }
        }
        network.set_compliance(i, j, sum);
      }
    }
    const auto energy = [&] {
      double sum = bow.sliding.energy_j(*bow.friction);
      for (const Contact* contact : {&first, &second}) {
        sum += contact->pressed.energy_j() + contact->sliding.energy_j(*contact->friction);
      }
      for (const ModalBody& body : rig.bodies) sum += body.energy();
      return sum;
    };
    double speed = unit(random), work = 0, before = 0;
    for (int n = 0; n < steps; ++n) {
      if (n % 500 == 0) {
        speed = 2 * unit(random) - 1;
        bow.load_n = unit(random) < 0.2 ? 0 : 10 * unit(random);
      }
      std::vector<double> free(kSides.size()), force(kSides.size());
      free[0] = speed * step;
      for (std::size_t i = 0; i < kSides.size(); ++i) {
        for (std::size_t s = 0; s < kSides[i].size(); ++s) {
          const Side& side = kSides[i][s];
          free[i] -= sign_of(s) * rig.bodies[side.body].free_change(side.place);
        }
      }
      network.step(free, step, force);
      std::vector<std::vector<double>> forces(3, std::vector<double>(7));
      for (std::size_t i = 0; i < kSides.size(); ++i) {
        for (std::size_t s = 0; s < kSides[i].size(); ++s) {
          forces[kSides[i][s].body][kSides[i][s].place] += sign_of(s) * force[i];
        }
      }
      for (std::size_t b = 0; b < 3; ++b) rig.bodies[b].step(forces[b]);
      const double now = energy(), done = force[0] * speed * step;
      ASSERT_TRUE(std::isfinite(now)) << round << ", " << n;
      ASSERT_GE(force[1], 0);
      ASSERT_GE(force[4], 0);
      work += std::max(0.0, done);
      worst = std::max(worst, (now - before - done) / (now + before + 1e-12));
      ASSERT_LE(now, work * (1 + 1e-9) + 1e-12) << round << ", " << n;
      before = now;
    }
    largest = std::max(largest, before);
  }
  EXPECT_LT(worst, 1e-12);
  EXPECT_GT(largest, 1e-6);  // something was bowed at all
  RecordProperty("worst", std::to_string(worst * 1e15) + "e-15");
}

}  // namespace
}  // namespace ringdown::contact
