// The air in vessels, against closed forms and finite elements.
#include "engine/cavity/air_modes.h"

#include "engine/cavity/graded_tiles.h"
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
// Finite elements of the meridian plane, of the air inside alone, find 117.76 Hz if it ends 0.6133 radii before the
// mouth and 117.56 Hz if it ends 0.65 radii before it, where walls are thicker than nothing.
constexpr double kFlask_hz = 117.7;

TEST(AirModes, FlaskIsAHelmholtzResonator) {
  const radiate::Body body = vessel(flask(), 5);
  const auto modes = air_modes(
      {.body = body, .origin = {0, 0, 0}, .mouth = {0, 0, 0.119}, .lowest_hz = 20, .highest_hz = 1000, .nodes = 400},
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
  EXPECT_NEAR(mode.rigid_hz / kFlask_hz, 1, 0.006);
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
// Hz with Q 2592. Those of the air inside alone find Q 36.2 by the layers at the inner wall, in the same pitch; the rim
// takes what one more radius of the neck would take at most (Ingard), 7 %.
const Line kBottle = {
    {0, 15},         {4.28, 9.79},    {9.03, 5.04},    {14.49, 1.1},    {20.81, -1.11},  {27.4, -0.16},
    {32.85, 3.72},   {37, 9},         {37, 180},       {36.26, 187.67}, {34.56, 195.14}, {32.07, 202.44},
    {29.05, 209.5},  {25.7, 216.41},  {22.21, 223.29}, {18.8, 230.17},  {15.64, 237.19}, {12.98, 244.41},
    {11.06, 251.83}, {10.11, 259.47}, {10.31, 267.16}, {11.66, 274.7},  {14.06, 282},    {15.91, 285},
    {15.91, 300},    {9.62, 300},     {9.99, 282},     {8.84, 278.54},  {7.91, 275.03},  {7.19, 271.47},
    {6.71, 267.89},  {6.46, 264.27},  {6.45, 260.64},  {6.67, 257.02},  {7.13, 253.4},   {7.78, 249.84},
    {8.63, 246.31},  {9.65, 242.82},  {10.8, 239.39},  {12.08, 236},    {13.46, 232.63}, {14.92, 229.31},
    {16.44, 226},    {17.99, 222.73}, {19.57, 219.46}, {21.16, 216.18}, {22.72, 212.93}, {24.25, 209.63},
    {25.74, 206.32}, {27.16, 202.98}, {28.49, 199.6},  {29.71, 196.2},  {30.8, 192.72},  {31.75, 189.22},
    {32.53, 185.67}, {33.12, 182.09}, {33.5, 178.5},   {33.5, 13.5},    {31.4, 8.83},    {28.35, 4.73},
    {23.92, 2.31},   {18.87, 2.71},   {14.3, 5},       {10.27, 8.14},   {6.6, 11.72},    {3.2, 15.56},
    {0, 19.55}};

TEST(AirModes, BottleRingsAsFiniteElementsSay) {
  const radiate::Body body = vessel(kBottle, 7);
  const auto modes = air_modes({.body = body,
                                .origin = {0, 0, 0.1},
                                .mouth = {0, 0, 0.3},
                                .lowest_hz = 20,
                                .highest_hz = 1000,
                                .modes = 1,
                                .nodes = 600},
                               kAir);
  ASSERT_TRUE(modes) << modes.error().message;
  ASSERT_EQ(modes->size(), 1u);
  for (const AirMode& mode : *modes) {
    std::printf("bottle: %.2f Hz, Q %.1f, radiates 1/%.0f, error %.4f\n", mode.rigid_hz, mode.wall_q,
                kPi * mode.rigid_hz / mode.radiation_decay_per_s, mode.frequency_error);
  }
  EXPECT_NEAR((*modes)[0].rigid_hz / 102.56, 1, 0.005);
  EXPECT_LT((*modes)[0].wall_q, 36.2 * 1.01);
  EXPECT_GT((*modes)[0].wall_q, 36.2 / 1.07);
  EXPECT_NEAR(kPi * (*modes)[0].rigid_hz / (*modes)[0].radiation_decay_per_s / 2592, 1, 0.02);
}

TEST(GradedTiles, SidesFollowTheOpening) {
  const radiate::Body body = vessel(flask(), 5);
  const auto original = radiate::Original::of(body);
  ASSERT_TRUE(original) << original.error().message;
  constexpr int kNodes = 1500;
  const auto tiles = graded_tiles(*original, kNodes);
  ASSERT_TRUE(tiles) << tiles.error().message;
  const auto panels = radiate::panels_of(*tiles);  // closed
  ASSERT_TRUE(panels) << panels.error().message;
  EXPECT_NEAR(panels->node_count(), kNodes, 0.3 * kNodes);
  const auto mean_side = [&](double lowest, double highest, double widest) {
    double sum = 0, count = 0;
    for (int t = 0; t < panels->triangle_count(); ++t) {
      const Eigen::Vector3d& at = panels->centers[t];
      if (at.z() < lowest || at.z() > highest || at.head(2).norm() > widest) continue;
      sum += panels->longest_side(t), ++count;
    }
    return sum / count;
  };
  EXPECT_GT(mean_side(-0.06, -0.02, 0.06), 1.7 * mean_side(0.075, 0.11, 0.011));  // the ball's, the neck's inside
  // Where neck and ball meet outside, walls are near each other but do not face each other.
  EXPECT_GT(mean_side(0.057, 0.063, 0.02), 0.7 * mean_side(0.075, 0.11, 0.02));
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
