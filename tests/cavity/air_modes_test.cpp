// The air in vessels, against closed forms and finite elements.
#include "engine/cavity/air_modes.h"

#include "tests/liquid/turned_vessel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

namespace ringdown::cavity::air_modes_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kAround = 32;
const modal::Air kAir;

using Line = std::vector<std::pair<double, double>>;

// A vessel from its outline in mm. Its polygons have the area of the circles.
radiate::Body vessel(Line line, double side_mm) {
  const double step = 2 * kPi / kAround, wider = std::sqrt(step / std::sin(step));
  for (auto& [r, z] : line) r *= 1e-3 * wider, z *= 1e-3;
  radiate::Body body;
  body.surface = turned(line, 1e-3 * side_mm, kAround);
  body.flow = radiate::flow_of(body.surface, {Eigen::MatrixX3d::Zero(body.surface.nodes.rows(), 3)}, 1e-3 * side_mm);
  return body;
}

// A ball with a straight neck.
constexpr double kBall_mm = 60, kNeck_mm = 10, kLong_mm = 60, kWall_mm = 2;

Line flask() {
  const auto arc = [](double radius, double neck, bool up, Line& line) {
    const double end = std::asin(neck / radius);
    constexpr int kSteps = 24;
    for (int i = 0; i <= kSteps; ++i) {
      const double share = static_cast<double>(up ? i : kSteps - i) / kSteps, angle = kPi - (kPi - end) * share;
      line.emplace_back(share == 0 ? 0 : radius * std::sin(angle), radius * std::cos(angle));
    }
  };
  Line line;
  arc(kBall_mm + kWall_mm, kNeck_mm + kWall_mm, true, line);
  const double top = std::sqrt(kBall_mm * kBall_mm - kNeck_mm * kNeck_mm) + kLong_mm;
  line.emplace_back(kNeck_mm + kWall_mm, top);
  line.emplace_back(kNeck_mm, top);
  arc(kBall_mm, kNeck_mm, false, line);
  return line;
}

// The ends add 0.61 a in the open (Levine & Schwinger) and 0.82 a (1 - 1.13 a/R) in the ball; the air in the neck gives
// way by a third of its volume. Both layers take 1/Q = delta_v L / (a L') + (gamma - 1) delta_t 3/R at least; each end
// of the neck adds a radius to L at most (Ingard, J. Acoust. Soc. Am. 25, 1953, 1037).
TEST(AirModes, FlaskIsAHelmholtzResonator) {
  const radiate::Body body = vessel(flask(), 5);
  const auto modes = air_modes(
      {.body = body, .origin = {0, 0, 0}, .mouth = {0, 0, 0.119}, .lowest_hz = 20, .highest_hz = 1000, .nodes = 600},
      kAir);
  ASSERT_TRUE(modes) << modes.error().message;
  ASSERT_EQ(modes->size(), 1u);
  const AirMode& mode = modes->front();
  constexpr double a = 1e-3 * kNeck_mm, R = 1e-3 * kBall_mm, L = 1e-3 * kLong_mm;
  const double reach = L + 0.61 * a + 0.82 * a * (1 - 1.13 * a / R), area = kPi * a * a;
  const double volume = 4 * kPi / 3 * R * R * R + area * L / 3;
  const double closed_hz = kAir.sound_speed_m_s / (2 * kPi) * std::sqrt(area / (volume * reach));
  std::printf("flask: %.2f Hz, closed form %.2f, Q %.1f, error %.4f\n", mode.rigid_hz, closed_hz, mode.wall_q,
              mode.frequency_error);
  EXPECT_NEAR(mode.rigid_hz / closed_hz, 1, 0.02);
  EXPECT_LT(std::abs(mode.rigid_hz / closed_hz - 1), 0.01 + 2 * mode.frequency_error);
  const double omega = 2 * kPi * closed_hz, viscous = std::sqrt(2 * 1.813e-5 / (kAir.density_kg_m3 * omega));
  const double ball = 0.4 * viscous / std::sqrt(0.71) * 3 / R / 2;
  const double least = viscous * L / (a * reach) + ball, most = viscous * (L + 2 * a) / (a * reach) + ball;
  EXPECT_GT(1 / mode.wall_q, 0.95 * least);
  EXPECT_LT(1 / mode.wall_q, 1.05 * most);
  EXPECT_NEAR(mode.frequency_hz / mode.rigid_hz, 1 - 0.5 / mode.wall_q, 1e-9);
  // The energy of the air in the ball, against the volume that flows; and what a simple source radiates.
  const double k = 2 * kPi * mode.rigid_hz / kAir.sound_speed_m_s;
  EXPECT_NEAR(mode.flux / (k * std::sqrt(volume / kAir.density_kg_m3)), 1, 0.03);
  EXPECT_NEAR(mode.radiation_decay_per_s / (k * kAir.sound_speed_m_s * k * k * k * volume / (8 * kPi)), 1, 0.06);
}

// The preset's bottle. Finite elements of the meridian plane, with the air around it to infinity, find a pole at 102.56
// Hz with Q 2592, and Q 37 by the layers at the walls.
const Line kBottle = {{0, 15},         {7.17, 6.76},    {13.94, 1.41},   {20.31, -1.03},  {26.28, -0.59},
                      {31.84, 2.76},   {37, 9},         {37, 180},       {35.69, 190.68}, {32.69, 200.81},
                      {28.56, 210.56}, {23.84, 220.09}, {19.08, 229.57}, {14.84, 239.17}, {11.67, 249.04},
                      {10.12, 259.36}, {10.73, 270.29}, {14.06, 282},    {15.91, 285},    {15.91, 300},
                      {9.62, 300},     {9.99, 282},     {7, 270.24},     {6.51, 259.18},  {8.04, 248.69},
                      {11.09, 238.6},  {15.16, 228.78}, {19.76, 219.07}, {24.39, 209.34}, {28.55, 199.43},
                      {31.75, 189.2},  {33.5, 178.5},   {33.5, 13.5},    {29.98, 6.6},    {25.64, 2.87},
                      {20.47, 2.3},    {14.48, 4.89},   {7.65, 10.64},   {0, 19.55}};

TEST(AirModes, BottleRingsAsFiniteElementsSay) {
  const radiate::Body body = vessel(kBottle, 7);
  const auto modes = air_modes({.body = body,
                                .origin = {0, 0, 0.1},
                                .mouth = {0, 0, 0.3},
                                .lowest_hz = 20,
                                .highest_hz = 1000,
                                .modes = 1,
                                .nodes = 1000},
                               kAir);
  ASSERT_TRUE(modes) << modes.error().message;
  ASSERT_EQ(modes->size(), 1u);
  for (const AirMode& mode : *modes) {
    std::printf("bottle: %.2f Hz, Q %.1f, radiates 1/%.0f, error %.4f\n", mode.rigid_hz, mode.wall_q,
                kPi * mode.rigid_hz / mode.radiation_decay_per_s, mode.frequency_error);
  }
  EXPECT_NEAR((*modes)[0].rigid_hz / 102.56, 1, 0.01);
  EXPECT_NEAR((*modes)[0].wall_q / 37, 1, 0.1);
  EXPECT_NEAR(kPi * (*modes)[0].rigid_hz / (*modes)[0].radiation_decay_per_s / 2592, 1, 0.1);
}

TEST(AirModes, ClosedBallHasNone) {
  const radiate::Body body = vessel({{0, -60}, {42, -42}, {60, 0}, {42, 42}, {0, 60}}, 20);
  const auto modes = air_modes(
      {.body = body, .origin = {0, 0, 0}, .mouth = {0, 0, 0.06}, .lowest_hz = 20, .highest_hz = 1500, .nodes = 200},
      kAir);
  ASSERT_TRUE(modes) << modes.error().message;
  EXPECT_TRUE(modes->empty());
}

}  // namespace
}  // namespace ringdown::cavity::air_modes_test
