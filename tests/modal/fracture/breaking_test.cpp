// Bodies that break, against conservation laws and the motion of their points.
#include "engine/modal/fracture/breaking.h"
#include "engine/modal/fracture/strength.h"
#include "tests/modal/fracture/jointed_truss.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

namespace ringdown::modal {
namespace {

using test::JointedTruss;
using test::Truss;

constexpr std::size_t kAll = 1000;

ModalState random_state(const Truss& whole, std::size_t modes, std::mt19937& random) {
  std::normal_distribution<double> number;
  ModalState state =
      at_rest({whole.modes.begin(), whole.modes.begin() + static_cast<std::ptrdiff_t>(modes)}, whole.mass);
  for (std::size_t j = 0; j < modes; ++j) {
    const double size = std::exp(2 * number(random)) / std::sqrt(undamped_lambda(state.modes[j]));
    state.amplitudes[j] = size * std::complex<double>(number(random), number(random));
  }
  state.velocity_m_s = {number(random), number(random), number(random)};
  state.spin_rad_s = {number(random), number(random), number(random)};
  return state;
}

// The displacements and velocities of all points, 3n each.
struct Motion {
  Eigen::VectorXd displacement, velocity;
};
Motion motion_of_points(const Truss& truss, const std::vector<DampedMode>& modes,
                        const std::vector<std::complex<double>>& amplitudes, Vec3 velocity, Vec3 spin) {
  Motion motion{Eigen::VectorXd::Zero(truss.motions.rows()), Eigen::VectorXd::Zero(truss.motions.rows())};
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const auto [q, v] = motion_of(modes[k], amplitudes[k]);
    motion.displacement += q * truss.motions.col(6 + static_cast<Eigen::Index>(k));
    motion.velocity += v * truss.motions.col(6 + static_cast<Eigen::Index>(k));
  }
  for (Eigen::Index p = 0; p < truss.places.rows(); ++p) {
    const Eigen::Vector3d arm = truss.places.row(p).transpose() - test::eigen(truss.mass.center_of_mass_m);
    motion.velocity.segment<3>(3 * p) += test::eigen(velocity) + test::eigen(spin).cross(arm);
  }
  return motion;
}

struct Balance {
  double kinetic = 0, strain = 0;
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();  // about the frame's origin
  double momentum_size = 0, angular_size = 0;                                             // sums of magnitudes
};
void add(Balance& balance, const Truss& truss, const Motion& motion) {
  const Eigen::VectorXd masses = test::unknown_masses(truss);
  balance.kinetic += motion.velocity.dot(masses.cwiseProduct(motion.velocity)) / 2;
  balance.strain += motion.displacement.dot(truss.stiffness * motion.displacement) / 2;
  for (Eigen::Index p = 0; p < truss.places.rows(); ++p) {
    const Eigen::Vector3d momentum = truss.masses[p] * motion.velocity.segment<3>(3 * p);
    const Eigen::Vector3d angular = Eigen::Vector3d(truss.places.row(p).transpose()).cross(momentum);
    balance.momentum += momentum;
    balance.angular += angular;
    balance.momentum_size += momentum.norm();
    balance.angular_size += angular.norm();
  }
}

Balance balance_of(const Truss& whole, const ModalState& state) {
  Balance balance;
  add(balance, whole, motion_of_points(whole, state.modes, state.amplitudes, state.velocity_m_s, state.spin_rad_s));
  return balance;
}

template <class Real>
Balance balance_of(const JointedTruss& body, const std::vector<BasicPiece<Real>>& pieces, const Broken& broken) {
  Balance balance;
  for (std::size_t s = 0; s < pieces.size(); ++s) {
    const PieceMotion& piece = broken.pieces[s];
    add(balance, body.pieces[s],
        motion_of_points(body.pieces[s], pieces[s].modes, piece.amplitudes, piece.velocity_m_s, piece.spin_rad_s));
  }
  return balance;
}

TEST(Breaking, AllMotionsOfAllPiecesTogetherHoldEveryMotionOfTheBody) {
  const JointedTruss body = test::jointed_truss(1);
  const Eigen::Index all = body.whole.motions.cols();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(all, all);
  for (const Truss& piece : body.pieces) {
    const Eigen::MatrixXd p = test::handover(body.whole, piece);
    sum += p.transpose() * p;
    // The body's rigid motions give no elastic motion.
    EXPECT_LT(p.bottomLeftCorner(p.rows() - 6, 6).cwiseAbs().maxCoeff(), 1e-10);
  }
  EXPECT_LT((sum - Eigen::MatrixXd::Identity(all, all)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Breaking, WithAllModesEveryPointGoesOnAsItMoved) {
  std::mt19937 random(2);
  for (const double damping : {0.0, 0.02}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const JointedTruss body = test::jointed_truss(seed, damping);
      const std::size_t modes = body.whole.modes.size();
      const auto pieces = test::pieces_of<double>(body, kAll, modes);
      const ModalState state = random_state(body.whole, modes, random);
      const Broken broken = BasicBreaking<double>(state.modes, state.mass, pieces, 0)(state, 0);
      const Motion before =
          motion_of_points(body.whole, state.modes, state.amplitudes, state.velocity_m_s, state.spin_rad_s);
      for (std::size_t s = 0; s < pieces.size(); ++s) {
        const PieceMotion& piece = broken.pieces[s];
        const Motion after =
            motion_of_points(body.pieces[s], pieces[s].modes, piece.amplitudes, piece.velocity_m_s, piece.spin_rad_s);
        for (std::size_t i = 0; i < body.pieces[s].points.size(); ++i) {
          const Eigen::Index here = 3 * static_cast<Eigen::Index>(i), there = 3 * body.pieces[s].points[i];
          EXPECT_LT((after.velocity.segment<3>(here) - before.velocity.segment<3>(there)).norm(),
                    1e-9 * before.velocity.norm());
        }
      }
      const Balance whole = balance_of(body.whole, state), sum = balance_of(body, pieces, broken);
      EXPECT_NEAR(sum.kinetic, whole.kinetic, 1e-9 * whole.kinetic);
      EXPECT_NEAR(sum.strain, whole.strain, 1e-9 * whole.strain);
      EXPECT_LT((sum.momentum - whole.momentum).norm(), 1e-10 * whole.momentum_size);
      EXPECT_LT((sum.angular - whole.angular).norm(), 1e-10 * whole.angular_size);
      EXPECT_NEAR(broken.limit, 1, 1e-9);
      EXPECT_NEAR(broken.flight_j + broken.ringing_j, broken.before_j, 1e-9 * broken.before_j);
    }
  }
}

TEST(Breaking, TheRigidColumnsAgreeWithTheMotionOfARigidBody) {
  const JointedTruss body = test::jointed_truss(3);
  const auto pieces = test::pieces_of<double>(body, 5, 7);
  std::mt19937 random(3);
  ModalState state = random_state(body.whole, 7, random);
  for (auto& a : state.amplitudes) a = 0;
  const Broken broken = BasicBreaking<double>(state.modes, state.mass, pieces, 0)(state, 0);
  EXPECT_EQ(broken.before_j, 0);
  Eigen::VectorXd rigid(6);  // coordinates of the body's six rigid motions
  rigid.head<3>() = std::sqrt(state.mass.mass_kg) * test::eigen(state.velocity_m_s);
  const auto axes_of = [](const MassProperties& mass) {
    return Eigen::Quaterniond(mass.orientation[3], mass.orientation[0], mass.orientation[1], mass.orientation[2])
        .toRotationMatrix();
  };
  rigid.tail<3>() = test::eigen(state.mass.inertia_kg_m2).cwiseSqrt().asDiagonal() *
                    (axes_of(state.mass).transpose() * test::eigen(state.spin_rad_s));
  for (std::size_t s = 0; s < pieces.size(); ++s) {
    const Eigen::VectorXd row = test::handover(body.whole, body.pieces[s]).topLeftCorner(6, 6) * rigid;
    const MassProperties& mass = pieces[s].mass;
    const Eigen::Vector3d spin =
        axes_of(mass) * Eigen::Vector3d(row.tail<3>().cwiseQuotient(test::eigen(mass.inertia_kg_m2).cwiseSqrt()));
    EXPECT_LT((row.head<3>() / std::sqrt(mass.mass_kg) - test::eigen(broken.pieces[s].velocity_m_s)).norm(), 1e-9);
    EXPECT_LT((spin - test::eigen(broken.pieces[s].spin_rad_s)).norm(), 1e-9);
    for (const auto& z : broken.pieces[s].amplitudes) EXPECT_EQ(z, 0.0);
  }
}

TEST(Breaking, TakingEnergyForTheCrackKeepsMomentumAndAngularMomentum) {
  std::mt19937 random(4);
  const JointedTruss body = test::jointed_truss(4, 0.001);
  auto pieces = test::pieces_of<float>(body, 6, 20);
  for (std::size_t s = 0; s < pieces.size(); ++s) pieces[s].delay_s = 2e-5 * static_cast<double>(s);
  const ModalState some = random_state(body.whole, 20, random);
  for (const double crack_time_s : {0.0, 3e-5}) {
    const Breaking breaking(some.modes, some.mass, pieces, crack_time_s);
    for (const double share : {0.0, 0.2, 0.99, 1.0, 3.0}) {
      const ModalState state = random_state(body.whole, 20, random);
      const double energy = modal_energy(state).total_j();
      const Broken broken = breaking(state, share * energy);
      const Balance whole = balance_of(body.whole, state), sum = balance_of(body, pieces, broken);
      EXPECT_LT((sum.momentum - whole.momentum).norm(), 1e-10 * whole.momentum_size);
      EXPECT_LT((sum.angular - whole.angular).norm(), 1e-10 * whole.angular_size);
      EXPECT_LE(sum.kinetic + sum.strain, whole.kinetic + whole.strain - std::min(share, 1.0) * energy + 1e-9 * energy);
      EXPECT_NEAR(broken.crack_j, std::min(share, 1.0) * energy, 1e-12 * energy);
      if (share < 1) continue;
      const double rigid = rigid_energy_j(state.mass, state.velocity_m_s, state.spin_rad_s);
      EXPECT_NEAR(sum.kinetic + sum.strain, rigid, 1e-9 * rigid);
    }
  }
}

TEST(Breaking, EnergyNeverRises) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  int broken_bodies = 0, limited_by_time = 0, limited_by_delay = 0;
  double largest_instant = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const JointedTruss body = test::jointed_truss(seed, seed % 2 ? 0 : 0.01);
    const auto modes = static_cast<std::size_t>(1 + share(random) * 38.99),
               own = static_cast<std::size_t>(share(random) * 15.99);
    auto pieces = test::pieces_of<float>(body, own, modes);
    const bool instant = seed % 3 == 0, delayed = seed % 3 == 1;
    if (delayed) {
      for (auto& piece : pieces) piece.delay_s = share(random) * 2e-4;
    }
    const ModalState some = random_state(body.whole, modes, random);
    const Breaking breaking(some.modes, some.mass, pieces, instant ? 0 : share(random) * 5e-4);
    for (int i = 0; i < 200; ++i, ++broken_bodies) {
      const ModalState state = random_state(body.whole, modes, random);
      const double energy = modal_energy(state).total_j(), crack = share(random) * 1.5 * energy;
      const Broken free = breaking(state, 0), broken = breaking(state, crack);
      const Balance whole = balance_of(body.whole, state), sum = balance_of(body, pieces, broken);
      EXPECT_LE(sum.kinetic + sum.strain,
                whole.kinetic + whole.strain - std::min(crack, energy) + 1e-9 * (whole.kinetic + whole.strain));
      EXPECT_LE(broken.flight_j + broken.ringing_j, (energy - broken.crack_j) * (1 + 1e-12));
      // Of a sudden break this holds by itself, to the rounding of the handover.
      if (instant) largest_instant = std::max(largest_instant, 1 / free.limit);
      if (!instant && free.limit < 1) ++(delayed ? limited_by_delay : limited_by_time);
    }
  }
  EXPECT_EQ(broken_bodies, 10000);
  EXPECT_LT(largest_instant, 1 + 1e-5);
  std::printf("%d breaks; the limit acted in %d with slow cracks and %d with delays as well\n", broken_bodies,
              limited_by_time, limited_by_delay);
}

TEST(Breaking, FloatsAreAsGoodAsTheirRounding) {
  std::mt19937 random(6);
  const JointedTruss body = test::jointed_truss(6, 0.003);
  const ModalState state = random_state(body.whole, 30, random);
  const Broken exact =
      BasicBreaking<double>(state.modes, state.mass, test::pieces_of<double>(body, kAll, 30), 4e-5)(state, 1e-3);
  const Broken rounded = Breaking(state.modes, state.mass, test::pieces_of<float>(body, kAll, 30), 4e-5)(state, 1e-3);
  EXPECT_NEAR(rounded.ringing_j, exact.ringing_j, 1e-5 * exact.ringing_j);
  for (std::size_t s = 0; s < exact.pieces.size(); ++s) {
    EXPECT_LT(length(exact.pieces[s].velocity_m_s - rounded.pieces[s].velocity_m_s),
              1e-5 * length(exact.pieces[s].velocity_m_s));
    double difference = 0, size = 0;
    for (std::size_t k = 0; k < exact.pieces[s].amplitudes.size(); ++k) {
      difference += std::norm(exact.pieces[s].amplitudes[k] - rounded.pieces[s].amplitudes[k]);
      size += std::norm(exact.pieces[s].amplitudes[k]);
    }
    EXPECT_LT(difference, 1e-10 * size);
  }
}

// Prints processor-bound times, and asserts none.
TEST(Breaking, CostOfSixtyPieces) {
  std::mt19937 random(7);
  std::normal_distribution<float> number;
  for (const std::size_t own : {std::size_t{40}, std::size_t{4}}) {
    std::vector<DampedMode> modes;
    for (int j = 0; j < 100; ++j) modes.push_back({200.0 + 190 * j, 5});
    const MassProperties mass{.mass_kg = 1, .inertia_kg_m2 = {1, 1, 1}};
    std::vector<Piece> pieces(60);
    for (Piece& piece : pieces) {
      piece.mass = {.mass_kg = 1.0 / 60, .inertia_kg_m2 = {1e-3, 1e-3, 1e-3}};
      piece.mass.center_of_mass_m = {number(random), number(random), number(random)};
      for (std::size_t k = 0; k < own; ++k) piece.modes.push_back({3000.0 + 400 * static_cast<double>(k), 50});
      piece.handover = {.rows = 6 + own, .columns = 106};
      for (std::size_t i = 0; i < piece.handover.rows * 106; ++i)
        piece.handover.values.push_back(0.02f * number(random));
      piece.delay_s = 1e-5;
    }
    ModalState state = at_rest(modes, mass);
    for (auto& a : state.amplitudes) a = {1e-6, -1e-6};
    using Clock = std::chrono::steady_clock;
    const auto begun = Clock::now();
    const Breaking breaking(modes, mass, pieces, 3e-5);
    const std::chrono::duration<double, std::milli> prepared = Clock::now() - begun;
    std::chrono::duration<double, std::milli> min(1e9);
    double energy = 0;
    for (int i = 0; i < 50; ++i) {
      const auto start = Clock::now();
      energy += breaking(state, 1e-6).ringing_j;
      min = std::min<std::chrono::duration<double, std::milli>>(min, Clock::now() - start);
    }
    std::printf("60 pieces x %zu modes x 100: prepared in %.2f ms, broken in %.3f ms\n", own, prepared.count(),
                min.count());
    EXPECT_GT(energy, 0);
  }
}

}  // namespace
}  // namespace ringdown::modal
