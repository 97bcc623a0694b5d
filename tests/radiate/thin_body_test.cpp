// Thin walls: closed forms, Rayleigh's integral, and sources inside of presets.
#include "engine/modal/bank_file.h"
#include "engine/radiate/skin.h"
#include "tests/radiate/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ringdown::thin_body_test {
namespace {

constexpr double kPi = std::numbers::pi;

double wavenumber_of(double frequency_hz) { return 2 * kPi * frequency_hz / modal::Air{}.sound_speed_m_s; }

// A thin disc of radius a that oscillates along its axis has the dipole moment 8/3 a^3 of the flow around it (Lamb,
// Hydrodynamics, article 102): F = k 8/3 a^3 cos / (4 pi).
TEST(RadiatingDisc, OscillatingAlongItsAxisIsTheKnownDipoleAtLowFrequencies) {
  const mesh::TriangleMesh surface = disc(14, 0.01);
  radiate::Body body{.surface = surface, .flow = {}, .frequency_hz = {}};
  const std::vector<double> kas = {0.02, 0.1, 0.2};
  for (const double ka : kas) body.frequency_hz.push_back(ka * modal::Air{}.sound_speed_m_s / (2 * kPi));
  body.flow = sample(
      surface, 3, [](int, const auto&, const Eigen::Vector3d& normal) { return normal[2]; }, 0.1);
  const auto radiation = radiate::solve(body, {}, {.threads = 1, .max_unknowns = 2000, .range_octaves = 0});
  ASSERT_TRUE(radiation) << radiation.error().message;
  for (std::size_t i = 0; i < kas.size(); ++i) {
    const double expected = kas[i] * 8 / 3 / (4 * kPi) / std::sqrt(3.0);
    EXPECT_NEAR(20 * std::log10(modal::rms(radiation->maps.modes[i]) / expected), 0, 0.3) << "ka " << kas[i];
  }
}

// A plate whose two faces move outward alike has no flow through its own plane: each half of space sees a plate in a
// baffle, for which Rayleigh's integral is exact. Resonances of the air inside of the plate lie in the band.
TEST(RadiatingPlate, WithBothFacesMovingOutwardRadiatesAsRayleighsIntegralSays) {
  const double width = 0.2, height = 0.15, thickness = 0.002;
  const mesh::TriangleMesh surface = box({width, height, thickness}, 0.01);
  struct Mode {
    int across, up;
    double frequency_hz;
  };
  const std::vector<Mode> modes = {{1, 1, 200}, {1, 1, 858}, {2, 1, 1500}, {3, 2, 1716}, {3, 1, 5000}, {5, 4, 9000}};
  const auto shape = [&](const Mode& mode, double x, double y) {
    return std::sin(mode.across * kPi * (x / width + 0.5)) * std::sin(mode.up * kPi * (y / height + 0.5));
  };
  radiate::Body body{.surface = surface, .flow = {}, .frequency_hz = {}};
  for (const Mode& mode : modes) body.frequency_hz.push_back(mode.frequency_hz);
  body.flow = sample(
      surface, static_cast<int>(modes.size()),
      [&](int m, const Eigen::Vector3d& at, const Eigen::Vector3d& normal) {
        return std::abs(normal[2]) > 0.5 ? shape(modes[m], at[0], at[1]) : 0.0;
      },
      0.004);
  const auto radiation = radiate::solve(body, {}, {.threads = 1, .max_unknowns = 2000, .range_octaves = 0});
  ASSERT_TRUE(radiation) << radiation.error().message;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const double k = wavenumber_of(modes[m].frequency_hz);
    constexpr int kSteps = 60, kDirections = 1500;
    double squares = 0;
    for (int d = 0; d < kDirections; ++d) {
      const double z = (d + 0.5) / kDirections, phi = d * 2.399963229728653, r = std::sqrt(1 - z * z);
      std::complex<double> sum = 0;
      for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; ++j) {
          const double x = width * ((i + 0.5) / kSteps - 0.5), y = height * ((j + 0.5) / kSteps - 0.5);
          sum += shape(modes[m], x, y) * std::polar(1.0, -k * r * (x * std::cos(phi) + y * std::sin(phi)));
        }
      }
      squares += std::norm(sum * (width / kSteps) * (height / kSteps) / (2 * kPi)) / kDirections;
    }
    EXPECT_NEAR(20 * std::log10(modal::rms(radiation->maps.modes[m]) / std::sqrt(squares)), 0, 0.5)
        << modes[m].frequency_hz << " Hz";
  }
}

// Above coincidence a plate loses rho c / (density h) times 1 / sqrt(1 - (bending wavenumber / k)^2) through both
// faces.
TEST(RadiatingPlate, BendingAboveCoincidenceIsDampedByTheAirAsTheInfinitePlate) {
  const double width = 0.3, height = 0.25, thickness = 0.002, density = 2700;
  const mesh::TriangleMesh surface = box({width, height, thickness}, 0.01);
  const int across = 5, up = 4;
  const double bending = std::hypot(across * kPi / width, up * kPi / height), k = 1.6 * bending;
  const double amplitude = 2 / std::sqrt(density * thickness * width * height);  // mass-normalised
  radiate::Body body{.surface = surface, .flow = {}, .frequency_hz = {k * modal::Air{}.sound_speed_m_s / (2 * kPi)}};
  body.flow = sample(
      surface, 1,
      [&](int, const Eigen::Vector3d& at, const Eigen::Vector3d& normal) {
        return normal[2] * amplitude * std::sin(across * kPi * (at[0] / width + 0.5)) *
               std::sin(up * kPi * (at[1] / height + 0.5));
      },
      0.004);
  const auto radiation = radiate::solve(body, {}, {.threads = 1, .max_unknowns = 2000, .range_octaves = 0});
  ASSERT_TRUE(radiation) << radiation.error().message;
  const modal::Air air;
  const double expected =
      air.density_kg_m3 * air.sound_speed_m_s / (density * thickness) / std::sqrt(1 - 1 / (1.6 * 1.6));
  EXPECT_NEAR(radiation->modes[0].decay_per_s / expected, 1, 0.1);
}

mesh::TriangleMesh surface_of(const std::string& preset) {
  const auto bank = modal::read_bank(std::string(RINGDOWN_SOURCE_DIR) + "/presets/banks/" + preset + ".glb");
  EXPECT_TRUE(bank) << bank.error().message;
  mesh::TriangleMesh surface;
  surface.nodes.resize(static_cast<Eigen::Index>(bank->point_count()), 3);
  for (Eigen::Index p = 0; p < surface.nodes.rows(); ++p) {
    for (int c = 0; c < 3; ++c) surface.nodes(p, c) = bank->positions[static_cast<std::size_t>(p)][c];
  }
  surface.triangles.resize(static_cast<Eigen::Index>(bank->triangles.size()), 3);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    for (int c = 0; c < 3; ++c)
      surface.triangles(t, c) = static_cast<std::int32_t>(bank->triangles[static_cast<std::size_t>(t)][c]);
  }
  return surface;
}

// A point source inside sends F = exp(-ik d.y) / (4 pi) through any surface around it. Its flow is complex, so that two
// modes at each frequency carry its real and imaginary part.
void expect_source_inside(const mesh::TriangleMesh& surface, const Eigen::Vector3d& inside, double max_db,
                          const std::string& name) {
  const std::vector<double> frequencies = {300, 3000};
  radiate::Body body{.surface = surface, .flow = {}, .frequency_hz = {}};
  for (const double f : frequencies) body.frequency_hz.insert(body.frequency_hz.end(), {f, f});
  body.flow = sample(
      surface, static_cast<int>(2 * frequencies.size()),
      [&](int m, const Eigen::Vector3d& at, const Eigen::Vector3d& normal) {
        const Eigen::Vector3d away = at - inside;
        const double r = away.norm(), k = wavenumber_of(frequencies[m / 2]);
        const auto flow = std::polar(1 / (4 * kPi * r), k * r) * std::complex<double>(-1 / r, k) * away.dot(normal) / r;
        return m % 2 == 0 ? flow.real() : flow.imag();
      },
      0.02, inside);
  const auto radiation = radiate::solve(body, {}, {.threads = 1, .max_unknowns = 1200, .range_octaves = 0});
  ASSERT_TRUE(radiation) << name << ": " << radiation.error().message;
  for (std::size_t f = 0; f < frequencies.size(); ++f) {
    double power = 0;
    std::map<int, std::complex<double>> sum;
    for (const auto& term : radiation->maps.modes[2 * f].terms) sum[term.harmonic] += std::complex<double>(term.value);
    for (const auto& term : radiation->maps.modes[2 * f + 1].terms) {
      sum[term.harmonic] += std::complex<double>(0, 1) * std::complex<double>(term.value);
    }
    for (const auto& [number, value] : sum) power += std::norm(value);
    EXPECT_NEAR(10 * std::log10(power * 4 * kPi), 0, max_db) << name << ", " << frequencies[f] << " Hz";
  }
}

TEST(SourceInside, OfASolidBlockIsHeardThroughItWithinThreeTenthsOfADecibel) {
  expect_source_inside(box({0.1, 0.06, 0.04}, 0.01), {0.01, 0.005, -0.004}, 0.3, "block");
}

// A vertical line through a closed surface crosses it an odd number of times above a point inside.
TEST(SourceInside, LiesWithinTheWallEvenWhereItBendsMoreSharplyThanTrianglesAreLong) {
  const mesh::TriangleMesh surface = surface_of("gong");
  const radiate::Body body{.surface = surface, .flow = {}, .frequency_hz = {}};
  const auto original = radiate::Original::of(body);
  ASSERT_TRUE(original) << original.error().message;
  const std::vector<Eigen::Vector3d> places = radiate::inner_places(*original);
  ASSERT_EQ(places.size(), 2U);
  for (const Eigen::Vector3d& place : places) {
    int crossings = 0;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
      const auto corner = [&](int i) -> Eigen::Vector3d {
        return surface.nodes.row(surface.triangles(t, i)).transpose() - place;
      };
      const Eigen::Vector3d a = corner(0), b = corner(1), c = corner(2);
      const auto turn = [](const Eigen::Vector3d& p, const Eigen::Vector3d& q) { return p[0] * q[1] - p[1] * q[0]; };
      const double ab = turn(a, b), bc = turn(b, c), ca = turn(c, a), all = ab + bc + ca;
      if (ab * all < 0 || bc * all < 0 || ca * all < 0) continue;
      if ((bc * a[2] + ca * b[2] + ab * c[2]) / all > 0) ++crossings;
    }
    EXPECT_EQ(crossings % 2, 1) << place.transpose();
  }
}

TEST(SourceInside, OfWallsOfTwoMillimetresIsHeardWithinHalfADecibel) {
  for (const std::string preset : {"steel-plate", "hand-bell", "wine-glass", "tuning-fork"}) {
    const mesh::TriangleMesh surface = surface_of(preset);
    const radiate::Body body{.surface = surface, .flow = {}, .frequency_hz = {}};
    const auto original = radiate::Original::of(body);
    ASSERT_TRUE(original) << preset << ": " << original.error().message;
    expect_source_inside(surface, radiate::inner_places(*original).back(), 0.5, preset);
  }
}

}  // namespace
}  // namespace ringdown::thin_body_test
