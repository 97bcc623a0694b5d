// A crack that takes its time, against the integration of a piece that the crack's falling traction drives.
#include "engine/modal/fracture/breaking.h"
#include "tests/modal/fracture/runge_kutta.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace ringdown::modal {
namespace {

using Complex = std::complex<double>;

MassProperties unit_mass(double x_m) {
  return {.mass_kg = 1, .center_of_mass_m = {x_m, 0, 0}, .inertia_kg_m2 = {1, 1, 1}};
}

// The body's only mode is handed over to one mode of one piece.
BasicPiece<double> one_mode_piece(double frequency_hz, double p, double delay_s = 0) {
  BasicPiece<double> piece{.mass = unit_mass(0), .modes = {{frequency_hz, 0}}, .delay_s = delay_s};
  piece.handover = {.rows = 7, .columns = 7, .values = std::vector<double>(49, 0.0)};
  piece.handover.values[48] = p;
  return piece;
}

// How much of the traction still acts.
double traction_left(double t, double crack_time_s) {
  if (t <= -crack_time_s / 2) return 1;
  if (t >= crack_time_s / 2) return 0;
  return 0.5 * (1 - std::sin(std::numbers::pi * t / crack_time_s));
}

struct CrackCase {
  double body_hz, piece_hz, crack_time_s;
};
const std::vector<CrackCase> kCracks = {{700, 9000, 5e-5},    {700, 9000, 1e-4},    {8700, 9000, 1e-4},
                                        {12000, 3000, 1e-4},  {300, 15000, 1e-4},   {2999.999, 3000, 2e-4},
                                        {3000, 3000.5, 5e-5}, {19000, 19500, 3e-4}, {1000, 6000, 2e-4}};

// r'' + w_k^2 r = T_kj q_j(t) g(t) from r = P q_j, with T_kj = (w_k^2 - w_j^2) P. The piece is followed as the
// difference y = r - P q_j from the unbroken body, y'' = -w_k^2 y - (1 - g) T_kj q_j, which begins at rest.
Complex integrated(const CrackCase& crack, double p, Complex a) {
  const double wj = 2 * std::numbers::pi * crack.body_hz, wk = 2 * std::numbers::pi * crack.piece_hz;
  const double half = crack.crack_time_s / 2, traction = (wk * wk - wj * wj) * p;
  const auto q = [&](double t) { return (a * std::polar(1.0, wj * t)).real(); };
  const auto end =
      test::runge_kutta(std::array<double, 2>{0, 0}, -half, half, 20000, [&](double t, const std::array<double, 2>& y) {
        return std::array<double, 2>{y[1],
                                     -wk * wk * y[0] - (1 - traction_left(t, crack.crack_time_s)) * traction * q(t)};
      });
  const Complex at_end = a * std::polar(1.0, wj * half);
  const double r = end[0] + p * at_end.real(), v = end[1] + p * (Complex(0, wj) * at_end).real();
  return Complex(r, -v / wk) * std::polar(1.0, -wk * half);
}

TEST(SlowCracks, APieceRingsAsItsFallingTractionLetsIt) {
  const Complex a(0.3, 0.8);
  for (const CrackCase& crack : kCracks) {
    const double p = 0.4 * std::min(1.0, crack.body_hz / crack.piece_hz);  // so little that no energy is made
    const std::vector<BasicPiece<double>> pieces = {one_mode_piece(crack.piece_hz, p)};
    const std::vector<DampedMode> modes = {{crack.body_hz, 0}};
    const BasicBreaking<double> breaking(modes, unit_mass(0), pieces, crack.crack_time_s);
    ModalState body = at_rest(modes, unit_mass(0));
    body.amplitudes[0] = a;
    const Broken broken = breaking(body, 0);
    EXPECT_EQ(broken.limit, 1);
    const Complex truth = integrated(crack, p, a);
    EXPECT_LT(std::abs(broken.pieces[0].amplitudes[0] - truth), 1e-9 * p * std::abs(a))
        << crack.body_hz << " " << crack.piece_hz << " " << crack.crack_time_s;
  }
}

// The rigid motion of two pieces that fly apart: r'' = T q g, T = -w_j^2 P.
TEST(SlowCracks, PiecesFlyAsTheirFallingTractionLetsThem) {
  for (const double crack_time_s : {0.0, 5e-5, 2e-4}) {
    const double wj = 2 * std::numbers::pi * 2000, p = 0.3;
    std::vector<BasicPiece<double>> pieces;
    for (const double sign : {1.0, -1.0}) {
      BasicPiece<double>& piece = pieces.emplace_back();
      piece.mass = unit_mass(sign);
      piece.handover = {.rows = 6, .columns = 7, .values = std::vector<double>(42, 0.0)};
      piece.handover.values[6] = sign * p;  // along x
    }
    MassProperties whole{.mass_kg = 2, .inertia_kg_m2 = {2, 4, 4}};
    const std::vector<DampedMode> modes = {{2000, 0}};
    ModalState body = at_rest(modes, whole);
    body.amplitudes[0] = Complex(-0.4, 0.3) / wj;
    const auto q = [&](double t) { return (body.amplitudes[0] * std::polar(1.0, wj * t)).real(); };
    const double half = crack_time_s / 2;
    const double before = p * (Complex(0, wj) * body.amplitudes[0] * std::polar(1.0, -wj * half)).real();
    const auto end = test::runge_kutta(std::array<double, 1>{before}, -half, half, 4000, [&](double t, const auto&) {
      return std::array<double, 1>{-wj * wj * p * q(t) * traction_left(t, crack_time_s)};
    });
    const Broken broken = BasicBreaking<double>(modes, whole, pieces, crack_time_s)(body, 0);
    EXPECT_NEAR(broken.pieces[0].velocity_m_s.x, end[0], 1e-10) << crack_time_s;
    EXPECT_NEAR(broken.pieces[1].velocity_m_s.x, -end[0], 1e-10) << crack_time_s;
  }
}

TEST(SlowCracks, ALatePieceTakesOverALaterState) {
  const std::vector<DampedMode> modes = {{900, 40}};
  const std::vector<BasicPiece<double>> late = {one_mode_piece(4000, 0.05, 3e-4)},
                                        prompt = {one_mode_piece(4000, 0.05)};
  ModalState body = at_rest(modes, unit_mass(0));
  body.amplitudes[0] = {0.3, -0.1};
  const Broken found = BasicBreaking<double>(modes, unit_mass(0), late, 5e-5)(body, 0);
  advance(body, 3e-4);
  const Broken truth = BasicBreaking<double>(modes, unit_mass(0), prompt, 5e-5)(body, 0);
  EXPECT_LT(std::abs(found.pieces[0].amplitudes[0] - truth.pieces[0].amplitudes[0]), 1e-14);
}

}  // namespace
}  // namespace ringdown::modal
