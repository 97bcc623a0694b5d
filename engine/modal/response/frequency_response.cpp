#include "engine/modal/response/frequency_response.h"

#include "engine/base/rotation.h"
#include "engine/modal/damping.h"
#include "engine/modal/radiation_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

namespace ringdown::modal {
namespace {

using Complex = std::complex<double>;
constexpr Complex kI{0, 1};

// A place on the triangles, with a direction of length 1.
struct Found {
  SurfacePoint at;
  Vec3 point_m, direction;
};

Result<Found> find(const Bank& bank, const SurfaceIndex& surface, const Place& place) {
  if (!is_finite(place.point_m)) return fail(ErrorKind::bad_input, "a place is not three finite numbers");
  const double size = length(place.direction);
  if (!(size > 0 && size < 1e300)) return fail(ErrorKind::bad_input, "a direction has no length");
  Found found{.at = surface.nearest(place.point_m), .direction = (1 / size) * place.direction};
  if (found.at.distance_m > surface.size_m()) {
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(),
                  "the place (%.4g %.4g %.4g) m lies %.3g m off the object, which measures %.3g m", place.point_m.x,
                  place.point_m.y, place.point_m.z, found.at.distance_m, surface.size_m());
    return fail(ErrorKind::bad_input, text.data());
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f& p = bank.positions[found.at.points[k]];
    found.point_m = found.point_m + found.at.weights[k] * Vec3{p[0], p[1], p[2]};
  }
  return found;
}

Result<void> check_frequencies(std::span<const double> frequencies_hz) {
  for (const double hz : frequencies_hz) {
    if (!(hz > 0 && hz < 1e12)) return fail(ErrorKind::bad_input, "a frequency is not above 0 Hz");
  }
  return {};
}

// phi . direction of each mode at the place.
std::vector<double> shares_at(const Bank& bank, const Found& place) {
  std::vector<double> shares(bank.mode_count());
  for (std::size_t m = 0; m < shares.size(); ++m) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& phi = bank.shape(m, place.at.points[k]);
      shares[m] += place.at.weights[k] * dot({phi[0], phi[1], phi[2]}, place.direction);
    }
  }
  return shares;
}

// The displacement of each mode per modal force.
Complex modal_receptance(const Bank& bank, std::size_t m, double omega) {
  const double lambda = undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
  return 1.0 / Complex(lambda - omega * omega, 2 * omega * bank.decay_per_s[m]);
}

// Returns omega^2 times the receptance of a free body that moves as a whole [1/kg]; 0 for a held body.
double rigid_accelerance(const Bank& bank, const Found& from, const Found& to) {
  if (bank.held || !bank.mass || !(bank.mass->mass_kg > 0)) return 0;
  const MassProperties& mass = *bank.mass;
  const Matrix3 axes = to_matrix(Rotation::from_xyzw(mass.orientation));
  const auto turned = [&](const Found& place) {  // the moment of a unit force, in principal axes
    const Vec3 moment = cross(place.point_m - mass.center_of_mass_m, place.direction);
    const auto along = [&](int k) { return axes[0][k] * moment.x + axes[1][k] * moment.y + axes[2][k] * moment.z; };
    return Vec3{along(0), along(1), along(2)};
  };
  const Vec3 a = turned(from), b = turned(to);
  const auto share = [](double x, double y, double inertia) { return inertia > 0 ? x * y / inertia : 0; };
  return dot(from.direction, to.direction) / mass.mass_kg + share(a.x, b.x, mass.inertia_kg_m2.x) +
         share(a.y, b.y, mass.inertia_kg_m2.y) + share(a.z, b.z, mass.inertia_kg_m2.z);
}

double residual_between(const Residual& residual, const std::vector<float>& matrix, const Found& from,
                        const Found& to) {
  const std::array<double, 3> d{from.direction.x, from.direction.y, from.direction.z},
      e{to.direction.x, to.direction.y, to.direction.z};
  double sum = 0;
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t q = 0; q < 3; ++q) {
      for (std::size_t i = 0; i < 9; ++i) {
        const double share = from.at.weights[p] * d[i / 3] * to.at.weights[q] * e[i % 3];
        sum += share *
               static_cast<double>(matrix[residual.index(3 * from.at.points[p] + i / 3, 3 * to.at.points[q] + i % 3)]);
      }
    }
  }
  return sum;
}

Result<void> check_radiation(const Bank& bank) {
  if (bank.radiation) return {};
  return fail(ErrorKind::refused, "the bank has no radiation maps; bake it again with `ringdown bake --radiation`");
}

// The ratio of a mode's far field at another frequency to that at its own.
double level_at(const Bank& bank, std::size_t m, double omega) {
  return level_ratio(bank.radiation->maps.modes[m], omega / bank.radiation->air.sound_speed_m_s);
}

}  // namespace

Result<Response> frequency_response(const Bank& bank, const SurfaceIndex& surface, const Place& from, const Place& to,
                                    Motion motion, std::span<const double> frequencies_hz, const Residual* residual) {
  if (auto good = check_frequencies(frequencies_hz); !good) return fail(good);
  const Result<Found> a = find(bank, surface, from), b = find(bank, surface, to);
  if (!a) return fail(a);
  if (!b) return fail(b);
  const std::vector<double> pushed = shares_at(bank, *a), seen = shares_at(bank, *b);
  const double rigid = rigid_accelerance(bank, *a, *b);
  double flexibility = 0, inertia = 0;
  if (residual) {
    flexibility = residual_between(*residual, residual->flexibility, *a, *b);
    inertia = residual_between(*residual, residual->inertia, *a, *b);
  }
  Response response;
  for (const double hz : frequencies_hz) {
    const double omega = hz_to_rad_per_s(hz), square = omega * omega;
    Complex sum = flexibility + square * inertia - rigid / square;
    for (std::size_t m = 0; m < pushed.size(); ++m) sum += pushed[m] * seen[m] * modal_receptance(bank, m, omega);
    response.push_back(motion == Motion::displacement ? sum
                       : motion == Motion::velocity   ? kI * omega * sum
                                                      : -square * sum);
  }
  return response;
}

Result<Response> pressure_response(const Bank& bank, const SurfaceIndex& surface, const Place& from, Vec3 to_m,
                                   std::span<const double> frequencies_hz) {
  if (auto good = check_frequencies(frequencies_hz); !good) return fail(good);
  if (auto good = check_radiation(bank); !good) return fail(good);
  const Result<Found> a = find(bank, surface, from);
  if (!a) return fail(a);
  const auto& [maps, air, errors, reasons] = *bank.radiation;
  const Vec3 way = to_m - maps.origin_m;
  const double distance_m = length(way);
  if (!(distance_m > surface.size_m() / 2 && distance_m < 1e9)) {
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(),
                  "the point in the air lies %.3g m from the object's middle; far fields begin at %.3g m", distance_m,
                  surface.size_m() / 2);
    return fail(ErrorKind::bad_input, text.data());
  }
  const std::vector<double> pushed = shares_at(bank, *a);
  std::array<float, harmonic_count(kMaxHarmonicDegree)> harmonics{};
  int degree = 0;
  for (const FarField& field : maps.modes) degree = std::max(degree, degree_of(field));
  real_harmonics(way, degree, harmonics);
  std::vector<Complex> fields;
  for (const FarField& field : maps.modes) fields.emplace_back(far_field(field, harmonics));
  Response response;
  for (const double hz : frequencies_hz) {
    const double omega = hz_to_rad_per_s(hz), wavenumber = omega / air.sound_speed_m_s;
    Complex sum = 0;
    for (std::size_t m = 0; m < pushed.size(); ++m) {
      sum += pushed[m] * modal_receptance(bank, m, omega) * level_at(bank, m, omega) * std::conj(fields[m]);
    }
    // The conjugate of radiation_map.h's i rho omega v F exp(ikr) / r, with v = i omega times the displacement.
    const Complex wave = -kI * air.density_kg_m3 * omega * std::exp(-kI * wavenumber * distance_m) / distance_m;
    response.push_back(wave * kI * omega * sum);
  }
  return response;
}

Result<std::vector<double>> power_response(const Bank& bank, const SurfaceIndex& surface, const Place& from,
                                           std::span<const double> frequencies_hz) {
  if (auto good = check_frequencies(frequencies_hz); !good) return fail(good);
  if (auto good = check_radiation(bank); !good) return fail(good);
  const Result<Found> a = find(bank, surface, from);
  if (!a) return fail(a);
  const auto& [maps, air, errors, reasons] = *bank.radiation;
  const std::vector<double> pushed = shares_at(bank, *a);
  std::vector<double> powers;
  std::vector<Complex> total(harmonic_count(kMaxHarmonicDegree));
  for (const double hz : frequencies_hz) {
    const double omega = hz_to_rad_per_s(hz);
    std::ranges::fill(total, Complex(0));
    for (std::size_t m = 0; m < pushed.size(); ++m) {
      const Complex velocity = kI * omega * pushed[m] * modal_receptance(bank, m, omega) * level_at(bank, m, omega);
      for (const FarField::Term& term : maps.modes[m].terms)
        total[term.harmonic] += velocity * std::conj(Complex(term.value));
    }
    double square = 0;  // harmonics are orthonormal: the integral of |F v|^2 over the sphere
    for (const Complex& coefficient : total) square += std::norm(coefficient);
    powers.push_back(radiated_power(std::sqrt(square / (4 * std::numbers::pi)), omega, air));
  }
  return powers;
}

Result<std::vector<double>> energy_spectrum(const Bank& bank, const SurfaceIndex& surface, const Place& from,
                                            std::span<const double> frequencies_hz) {
  // An impulse of 1 N s has the spectrum 1 N/Hz. By Parseval the energy is the integral over positive frequencies of
  // twice the mean square of the spectrum, which is four times the mean power of a force of amplitude 1 N.
  auto powers = power_response(bank, surface, from, frequencies_hz);
  if (!powers) return powers;
  for (double& power : *powers) power *= 4;
  return powers;
}

}  // namespace ringdown::modal
