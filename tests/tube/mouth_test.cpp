// The air at the mouth of a tube, against closed forms and finite elements.
#include "engine/tube/mouth.h"

#include "tests/liquid/turned_vessel.h"
#include "tests/radiate/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace ringdown::tube::mouth_test {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kRadius_m = 0.02, kArea_m2 = kPi * kRadius_m * kRadius_m;
const modal::Air kAir;
const MouthPlace kPlace{Vector3d::Zero(), -Vector3d::UnitZ(), kRadius_m, 0.363};

double wavenumber(double frequency_hz) { return 2 * kPi * frequency_hz / kAir.sound_speed_m_s; }

// A sphere that pulsates with velocity 1.
radiate::Body pulsating(double radius_m, const Vector3d& at) {
  radiate::Body body;
  body.surface = sphere(radius_m, 6);
  const Eigen::MatrixX3d outward = body.surface.nodes / radius_m;
  body.flow = radiate::flow_of(body.surface, {outward});
  body.flow.flow *= static_cast<float>(4 * kPi * radius_m * radius_m / body.flow.flow.sum());
  body.surface.nodes.rowwise() += at.transpose();
  body.flow.positions.rowwise() += at.transpose();
  body.frequency_hz = {220};
  return body;
}

// Levine and Schwinger's tube has no lid: a piston overrates the end by 0.05 a.
TEST(Mouth, EndCorrectionIsThatOfAThinTubeInFreeAir) {
  const auto mouth = Mouth::of(pulsating(0.01, {0, 0, 0.6}), kPlace, 1600);
  ASSERT_TRUE(mouth) << mouth.error().message;
  const double k = wavenumber(220);
  const MouthAnswer answer = mouth->at(k, Vector3d::Zero());
  EXPECT_NEAR(-answer.outside.end_m.real() / kRadius_m, kFreeEnd, 0.05);
  EXPECT_LT(answer.end_error_m, 0.01 * kRadius_m);
  EXPECT_NEAR(-answer.outside.end_m.imag() / (k * kArea_m2 / (4 * kPi)), 1, 0.02);
  EXPECT_NEAR(std::abs(answer.field[0]) / (kArea_m2 / (4 * kPi) * std::sqrt(4 * kPi)), 1, 0.01);
}

// The pressure in the mouth by a small source, and that of the mouth where the source is, which its far field tells.
TEST(Mouth, BodyAndLidAreReciprocal) {
  constexpr double kAway_m = 2, kSource_m = 0.02;
  const auto mouth = Mouth::of(pulsating(kSource_m, {0, 0, kAway_m}), kPlace, 1600);
  ASSERT_TRUE(mouth) << mouth.error().message;
  const double k = wavenumber(700);
  const MouthAnswer answer = mouth->at(k, Vector3d::Zero());
  std::vector<float> harmonics(answer.field.size());
  const int degree = static_cast<int>(std::lround(std::sqrt(static_cast<double>(answer.field.size())))) - 1;
  modal::real_harmonics({0, 0, 1}, degree, harmonics);
  std::complex<double> ahead = 0;
  for (std::size_t h = 0; h < harmonics.size(); ++h) ahead += answer.field[h] * static_cast<double>(harmonics[h]);
  const std::complex<double> source = 4 * kPi * kSource_m * kSource_m / std::complex<double>(1, -k * kSource_m);
  const double expected = std::abs(ahead * source) / kAway_m / kArea_m2;
  EXPECT_NEAR(std::abs(answer.from_body[0]) / expected, 1, 0.03);
}

// A disc above the tube, by axisymmetric finite elements of disc, tube and air to an exactly radiating sphere: 225.3
// Hz.
TEST(Mouth, DiscLowersTheTube) {
  constexpr double kGap_m = 0.015, kDisc_m = 0.035, kThick_m = 0.0127, kReference_hz = 225.3;
  radiate::Body body;
  body.surface =
      turned({{0, kGap_m}, {kDisc_m, kGap_m}, {kDisc_m, kGap_m + kThick_m}, {0, kGap_m + kThick_m}}, 0.004, 64);
  Eigen::MatrixX3d up = Eigen::MatrixX3d::Zero(body.surface.nodes.rows(), 3);
  up.col(2).setOnes();
  body.flow = radiate::flow_of(body.surface, {up});
  body.frequency_hz = {220};
  const auto mouth = Mouth::of(body, kPlace, 1600);
  ASSERT_TRUE(mouth) << mouth.error().message;
  const MouthAnswer answer = mouth->at(wavenumber(kReference_hz), Vector3d::Zero());
  const Line line{kRadius_m, kPlace.length};
  const auto mode = tube_mode(line, answer.outside, kAir, 2 * kPi * kReference_hz);
  ASSERT_TRUE(mode);
  EXPECT_NEAR(1200 * std::log2(mode->omega_rad_s.real() / (2 * kPi * kReference_hz)), 0, 5) << "cents";
}

TEST(Mouth, TubeThatCutsTheBodyIsRefused) {
  const auto inside = Mouth::of(pulsating(0.05, {0, 0, 0.01}), kPlace, 400);
  ASSERT_FALSE(inside);
  EXPECT_NE(inside.error().message.find("cut each other"), std::string::npos);
  EXPECT_FALSE(Mouth::of(pulsating(0.005, {0, 0, -0.1}), kPlace, 400)) << "a body in the tube";
}

}  // namespace
}  // namespace ringdown::tube::mouth_test
