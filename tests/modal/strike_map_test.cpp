#include "engine/modal/strike_map.h"

#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <random>

namespace ringdown::modal {
namespace {

using namespace ringdown::test;  // NOLINT: the synthetic banks

std::vector<double> excited(const StrikeMap& map, Vec3 point, Vec3 impulse) {
  std::vector<double> amplitudes(map.bank().mode_count(), 99.0);
  map.excite(point, impulse, amplitudes);
  return amplitudes;
}

double phi_dot_j(const Bank& bank, std::size_t mode, std::size_t point, Vec3 j) {
  const Vec3f& phi = bank.shape(mode, point);
  return phi[0] * j.x + phi[1] * j.y + phi[2] * j.z;
}

TEST(StrikeMap, AStrikeAtAVertexIsTheShapeTimesTheImpulse) {
  const StrikeMap map(shared(random_bank(1, 33, 50)));
  const Bank& bank = map.bank();
  const Vec3 j{0.3, -0.7, 0.2};
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    std::vector<double> by_vertex(bank.mode_count());
    map.excite_vertex(p, j, by_vertex);
    const Vec3f& at = bank.positions[p];
    const auto by_point = excited(map, {at[0], at[1], at[2]}, j);
    for (std::size_t m = 0; m < bank.mode_count(); ++m) {
      EXPECT_NEAR(by_vertex[m], phi_dot_j(bank, m, p, j), 1e-12);
      EXPECT_NEAR(by_point[m], by_vertex[m], 1e-6);
    }
  }
}

TEST(StrikeMap, AStrikeInsideATriangleInterpolatesLinearly) {
  const StrikeMap map(shared(random_bank(2, 10, 60)));
  const Bank& bank = map.bank();
  const auto& [a, b, c] = bank.triangles[20];
  const auto corner = [&bank](std::uint32_t p) {
    return Vec3{bank.positions[p][0], bank.positions[p][1], bank.positions[p][2]};
  };
  const Vec3 inside = 0.2 * corner(a) + (0.3 * corner(b) + 0.5 * corner(c)), j{1, 2, 3};
  const auto amplitudes = excited(map, inside, j);
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    EXPECT_NEAR(amplitudes[m],
                0.2 * phi_dot_j(bank, m, a, j) + 0.3 * phi_dot_j(bank, m, b, j) + 0.5 * phi_dot_j(bank, m, c, j), 1e-6);
  }
}

TEST(StrikeMap, AStrikeIsLinearInTheImpulse) {
  const StrikeMap map(shared(random_bank(3, 20, 60)));
  const Vec3 point{0.05, 0.07, -0.02}, j1{1, 0.5, -2}, j2{-0.3, 4, 1};
  const auto one = excited(map, point, j1), two = excited(map, point, j2), both = excited(map, point, 2.0 * j1 + j2);
  for (std::size_t m = 0; m < one.size(); ++m) EXPECT_NEAR(both[m], 2 * one[m] + two[m], 1e-12);
}

// Struck at p along u and heard at q along v is struck at q along v and heard at p along u: sum over modes of
// (phi(p).u)(phi(q).v) exchanges p and q.
TEST(StrikeMap, AStrikeIsReciprocal) {
  const StrikeMap map(shared(random_bank(4, 50, 80)));
  const Bank& bank = map.bank();
  const Vec3 u{0.6, 0.8, 0}, v{0, -0.6, 0.8};
  const std::size_t p = 7, q = 61;
  std::vector<double> at_p(bank.mode_count()), at_q(bank.mode_count());
  map.excite_vertex(p, u, at_p);
  map.excite_vertex(q, v, at_q);
  double p_to_q = 0, q_to_p = 0;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    p_to_q += at_p[m] * phi_dot_j(bank, m, q, v);
    q_to_p += at_q[m] * phi_dot_j(bank, m, p, u);
  }
  EXPECT_NEAR(p_to_q, q_to_p, 1e-12 * std::abs(p_to_q) + 1e-12);
}

// A free bar struck in the middle: antisymmetric modes stay silent; struck at the end, every mode rings alike.
TEST(StrikeMap, AStrikeFollowsTheNodesOfABar) {
  const StrikeMap map(shared(bar_bank(6)));
  const auto middle = excited(map, {0.15, 0, 0}, {0, 0, 1}), end = excited(map, {0, 0, 0}, {0, 0, 1});
  const double mass = map.bank().mass->mass_kg;
  for (std::size_t m = 0; m < 6; ++m) {
    EXPECT_NEAR(middle[m] * static_cast<double>(m % 2), 0, 1e-6) << m;
    EXPECT_NEAR(std::abs(end[m]), 2 / std::sqrt(mass), 1e-5);
  }
}

}  // namespace
}  // namespace ringdown::modal
