// Spheres, whose far field is known for every vibration: spherical Hankel functions.
#include "tests/radiate/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ringdown::sphere_test {
namespace {

constexpr double kPi = std::numbers::pi;

double frequency_of(double ka, double a) { return ka * modal::Air{}.sound_speed_m_s / (2 * kPi * a); }

// The value of real harmonic number n^2 + n + m at a point, by Legendre functions of the standard library.
double harmonic(int n, int m, const Eigen::Vector3d& at) {
  const Eigen::Vector3d d = at.normalized();
  const double phi = std::atan2(d[1], d[0]);
  const double legendre = std::sph_legendre(n, std::abs(m), std::acos(std::clamp(d[2], -1.0, 1.0)));
  const double sign = m % 2 == 0 ? 1 : -1;  // the standard's has the phase of Condon and Shortley
  return m == 0 ? legendre : sign * std::numbers::sqrt2 * legendre * (m > 0 ? std::cos(m * phi) : std::sin(-m * phi));
}

struct Error {
  double power_db = 0, pattern = 0;
};

Error error_of(const modal::FarField& field, int n, int m, std::complex<double> factor) {
  double power = 0, off = std::norm(factor);
  for (const auto& term : field.terms) {
    const std::complex<double> value(term.value);
    power += std::norm(value);
    const bool own = term.harmonic == n * n + n + m;
    off += own ? std::norm(value - factor) - std::norm(factor) : std::norm(value);
  }
  return {10 * std::log10(power / std::norm(factor)), std::sqrt(off / std::norm(factor))};
}

// Down to 50 dB below a pulsating sphere: what is weaker drowns in what the triangles' irregularity makes of the flow.
TEST(RadiatingSphere, VibratingInHarmonicsOfDegreeZeroToEightRadiatesAsHankelFunctionsSay) {
  const double a = 0.1;
  const mesh::TriangleMesh surface = sphere(a, 20);
  int compared = 0;
  for (const double ka : {0.05, 0.3, 2.5, 5.7635, 20.0}) {
    radiate::Body body{.surface = surface, .flow = {}, .frequency_hz = std::vector<double>(9, frequency_of(ka, a))};
    const auto m_of = [](int n) { return n == 0 ? 0 : (5 * n) % (2 * n + 1) - n; };
    body.flow = sample(
        surface, 9, [&](int n, const auto& at, const auto&) { return harmonic(n, m_of(n), at); }, 0.01);
    const auto radiation = radiate::solve(
        body, {},
        {.threads = 1, .panels_per_wave = 4.5, .panels_per_shape = 14, .max_unknowns = 2600, .range_octaves = 0});
    ASSERT_TRUE(radiation) << radiation.error().message;
    for (int n = 0; n <= 8; ++n) {
      if (below_pulsation_db(n, ka) > 50) continue;
      const Error error = error_of(radiation->maps.modes[n], n, m_of(n), sphere_factor(n, ka / a, a));
      EXPECT_LT(std::abs(error.power_db), 0.2) << "n " << n << " ka " << ka;
      EXPECT_LT(error.pattern, 0.02) << "n " << n << " ka " << ka;
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

TEST(RadiatingSphere, PassesTheResonancesOfTheAirInsideWithoutABump) {
  const double a = 0.1;
  const mesh::TriangleMesh surface = sphere(a, 12);
  radiate::Body body{.surface = surface, .flow = {}, .frequency_hz = {}};
  std::vector<std::pair<int, double>> modes;
  for (const double center : {kPi, 4.4934}) {
    for (int step = -4; step <= 4; ++step) {
      for (const int n : {0, 1}) {
        modes.emplace_back(n, center * (1 + 0.004 * step));
        body.frequency_hz.push_back(frequency_of(modes.back().second, a));
      }
    }
  }
  body.flow = sample(
      surface, static_cast<int>(modes.size()),
      [&](int i, const auto& at, const auto&) { return harmonic(modes[i].first, 0, at); }, 0.02);
  const auto radiation = radiate::solve(body, {}, {.threads = 1, .range_octaves = 0});
  ASSERT_TRUE(radiation) << radiation.error().message;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const auto [n, ka] = modes[i];
    const Error error = error_of(radiation->maps.modes[i], n, 0, sphere_factor(n, ka / a, a));
    EXPECT_LT(std::abs(error.power_db), 0.1) << "n " << n << " ka " << ka;
  }
}

// The first skins are coarse, so that there are errors to state.
TEST(RadiatingSphere, IsNoFartherFromHankelFunctionsThanTheErrorThatEachModeStates) {
  const double a = 0.1;
  radiate::Body body{.surface = sphere(a, 16), .flow = {}, .frequency_hz = {}};
  std::vector<std::pair<int, double>> modes;
  for (const double ka : {3.0, 7.0, 11.0}) {
    for (const int n : {0, 2, 4, 6, 8}) {
      if (below_pulsation_db(n, ka) > 40) continue;
      modes.emplace_back(n, ka);
      body.frequency_hz.push_back(frequency_of(ka, a));
    }
  }
  body.flow = sample(
      body.surface, static_cast<int>(modes.size()),
      [&](int i, const auto& at, const auto&) { return harmonic(modes[i].first, modes[i].first / 2, at); }, 0.01);
  const auto radiation = radiate::solve(
      body, {}, {.threads = 1, .panels_per_wave = 2, .panels_per_shape = 4, .max_unknowns = 2000, .range_octaves = 0});
  ASSERT_TRUE(radiation) << radiation.error().message;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const auto [n, ka] = modes[i];
    const Error error = error_of(radiation->maps.modes[i], n, n / 2, sphere_factor(n, ka / a, a));
    EXPECT_LT(std::abs(error.power_db), radiation->modes[i].error_db + 0.02) << "n " << n << " ka " << ka;
    EXPECT_LT(radiation->modes[i].error_db, 0.5) << "n " << n << " ka " << ka;
  }
}

// A cap of 60 degrees around the pole that moves outward alone: a series of Legendre polynomials.
TEST(RadiatingSphere, WithAMovingCapRadiatesAsTheSeriesSays) {
  const double a = 0.1, edge = 0.5;
  const mesh::TriangleMesh surface = sphere(a, 24);
  radiate::Body body{.surface = surface, .flow = {}, .frequency_hz = {}};
  const std::vector<double> kas = {0.2, 1, 3, 8};
  for (const double ka : kas) body.frequency_hz.push_back(frequency_of(ka, a));
  body.flow = sample(
      surface, 4, [&](int, const Eigen::Vector3d& at, const auto&) { return at[2] > edge * a ? 1.0 : 0.0; }, 0.002);
  const auto radiation = radiate::solve(body, {}, {.threads = 1, .panels_per_wave = 5, .range_octaves = 0});
  ASSERT_TRUE(radiation) << radiation.error().message;
  for (std::size_t i = 0; i < kas.size(); ++i) {
    double squares = 0;
    for (int n = 0; n < 40; ++n) {
      const double weight = n == 0 ? (1 - edge) / 2 : (std::legendre(n - 1, edge) - std::legendre(n + 1, edge)) / 2;
      squares += weight * weight * std::norm(sphere_factor(n, kas[i] / a, a)) / (2 * n + 1);
    }
    EXPECT_NEAR(20 * std::log10(modal::rms(radiation->maps.modes[i]) / std::sqrt(squares)), 0, 0.2) << "ka " << kas[i];
  }
}

}  // namespace
}  // namespace ringdown::sphere_test
