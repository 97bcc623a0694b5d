#include "tests/support/signal.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace ringdown::test {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
using Four = std::array<double, 4>;

// Solves the 4 x 4 system a x = b by elimination with row pivoting.
Four solve(std::array<Four, 4> a, Four b) {
  for (std::size_t column = 0; column < 4; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < 4; ++row) {
      if (std::abs(a[row][column]) > std::abs(a[pivot][column])) pivot = row;
    }
    std::swap(a[column], a[pivot]);
    std::swap(b[column], b[pivot]);
    if (a[column][column] == 0) return {};
    for (std::size_t row = column + 1; row < 4; ++row) {
      const double factor = a[row][column] / a[column][column];
      for (std::size_t k = column; k < 4; ++k) a[row][k] -= factor * a[column][k];
      b[row] -= factor * b[column];
    }
  }
  Four x{};
  for (std::size_t row = 4; row-- > 0;) {
    double sum = b[row];
    for (std::size_t k = row + 1; k < 4; ++k) sum -= a[row][k] * x[k];
    x[row] = sum / a[row][row];
  }
  return x;
}

double energy(std::span<const double> samples) {
  double sum = 0;
  for (const double s : samples) sum += s * s;
  return sum;
}

// Frequency from the highest bin, sharpened by a parabola through the logarithms of its neighbours.
double peak_frequency(std::span<const double> samples, double sample_rate_hz) {
  const Spectrum s = spectrum(samples, sample_rate_hz);
  const auto& level = s.magnitude;
  const auto top = std::max_element(level.begin() + 1, level.end() - 1) - level.begin();
  const auto log_at = [&](std::ptrdiff_t k) { return std::log(std::max(level[static_cast<std::size_t>(k)], 1e-300)); };
  const double below = log_at(top - 1), at = log_at(top), above = log_at(top + 1);
  const double curvature = below - 2 * at + above;
  const double shift = curvature < 0 ? std::clamp(0.5 * (below - above) / curvature, -0.5, 0.5) : 0.0;
  return (static_cast<double>(top) + shift) * s.bin_hz;
}

// One step for unknowns (omega, decay, sine, cosine), all per sample; returns the sum of squared residuals before it.
double gauss_newton_step(std::span<const double> samples, Four& unknowns) {
  const auto [omega, decay, sine, cosine] = unknowns;
  std::array<Four, 4> normal{};
  Four right{};
  double residual_energy = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const auto t = static_cast<double>(n);
    const double e = std::exp(-decay * t), s = e * std::sin(omega * t), c = e * std::cos(omega * t);
    const double model = sine * s + cosine * c;
    const Four slope = {t * (sine * c - cosine * s), -t * model, s, c};
    const double residual = samples[n] - model;
    residual_energy += residual * residual;
    for (std::size_t i = 0; i < 4; ++i) {
      right[i] += slope[i] * residual;
      for (std::size_t k = 0; k < 4; ++k) normal[i][k] += slope[i] * slope[k];
    }
  }
  Four scale{};  // to unit diagonal: the four unknowns differ by many orders of magnitude
  for (std::size_t i = 0; i < 4; ++i) scale[i] = 1 / std::sqrt(std::max(normal[i][i], 1e-300));
  for (std::size_t i = 0; i < 4; ++i) {
    right[i] *= scale[i];
    for (std::size_t k = 0; k < 4; ++k) normal[i][k] *= scale[i] * scale[k];
  }
  const Four step = solve(normal, right);
  for (std::size_t i = 0; i < 4; ++i) unknowns[i] += scale[i] * step[i];
  return residual_energy;
}

// Sine and cosine weights for a fixed frequency and decay: the linear part of the problem.
void fit_weights(std::span<const double> samples, Four& unknowns) {
  double ss = 0, sc = 0, cc = 0, ys = 0, yc = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const auto t = static_cast<double>(n);
    const double e = std::exp(-unknowns[1] * t), s = e * std::sin(unknowns[0] * t), c = e * std::cos(unknowns[0] * t);
    ss += s * s, sc += s * c, cc += c * c, ys += s * samples[n], yc += c * samples[n];
  }
  const double determinant = ss * cc - sc * sc;
  unknowns[2] = (ys * cc - yc * sc) / determinant;
  unknowns[3] = (yc * ss - ys * sc) / determinant;
}

}  // namespace

double DampedSinusoid::amplitude() const { return std::hypot(sine, cosine); }
double DampedSinusoid::t60_s() const { return std::log(1000.0) / decay_per_s; }

DampedSinusoid fit_damped_sinusoid(std::span<const double> samples, double sample_rate_hz) {
  assert(samples.size() >= 16);
  const std::size_t half = samples.size() / 2;
  const double first = energy(samples.first(half)), second = energy(samples.subspan(half, half));
  const double ratio = first > 0 && second > 0 ? first / second : 1.0;
  Four unknowns = {kTwoPi * peak_frequency(samples, sample_rate_hz) / sample_rate_hz,
                   std::max(0.0, 0.5 * std::log(ratio) / static_cast<double>(half)), 0, 0};
  fit_weights(samples, unknowns);
  Four best = unknowns;
  double best_energy = std::numeric_limits<double>::infinity();
  for (int step = 0; step < 30; ++step) {
    const Four here = unknowns;
    const double residual = gauss_newton_step(samples, unknowns);
    if (!(residual < best_energy)) break;
    best_energy = residual;
    best = here;
  }
  return {best[0] * sample_rate_hz / kTwoPi, best[1] * sample_rate_hz, best[2], best[3]};
}

double relative_error_db(std::span<const double> signal, std::span<const double> reference) {
  const std::size_t count = std::min(signal.size(), reference.size());
  double error = 0, total = 0;
  for (std::size_t n = 0; n < count; ++n) {
    error += (signal[n] - reference[n]) * (signal[n] - reference[n]);
    total += reference[n] * reference[n];
  }
  return 10 * std::log10(error / total);
}

double largest_step(std::span<const double> samples, std::size_t begin, std::size_t end) {
  double largest = 0;
  for (std::size_t n = std::max<std::size_t>(begin, 1); n < std::min(end, samples.size()); ++n) {
    largest = std::max(largest, std::abs(samples[n] - samples[n - 1]));
  }
  return largest;
}

double peak(std::span<const double> samples) {
  double largest = 0;
  for (const double s : samples) largest = std::max(largest, std::abs(s));
  return largest;
}

std::vector<std::complex<double>> fourier(std::vector<std::complex<double>> values) {
  const std::size_t size = values.size();
  assert(std::has_single_bit(size));
  for (std::size_t i = 1, reversed = 0; i < size; ++i) {
    std::size_t bit = size >> 1;
    for (; reversed & bit; bit >>= 1) reversed ^= bit;
    reversed ^= bit;
    if (i < reversed) std::swap(values[i], values[reversed]);
  }
  for (std::size_t length = 2; length <= size; length *= 2) {
    for (std::size_t k = 0; k < length / 2; ++k) {
      const auto turn = std::polar(1.0, -kTwoPi * static_cast<double>(k) / static_cast<double>(length));
      for (std::size_t at = k; at < size; at += length) {
        const auto odd = turn * values[at + length / 2];
        values[at + length / 2] = values[at] - odd;
        values[at] += odd;
      }
    }
  }
  return values;
}

Spectrum spectrum(std::span<const double> samples, double sample_rate_hz) {
  const std::size_t size = std::bit_ceil(std::max<std::size_t>(samples.size(), 16));
  std::vector<std::complex<double>> values(size);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double phase = kTwoPi * (static_cast<double>(n) + 0.5) / static_cast<double>(samples.size());
    values[n] = samples[n] * 0.5 * (1 - std::cos(phase));
  }
  values = fourier(std::move(values));
  Spectrum result{sample_rate_hz / static_cast<double>(size), std::vector<double>(size / 2 + 1)};
  for (std::size_t k = 0; k <= size / 2; ++k) {
    result.magnitude[k] = std::abs(values[k]) * 4 / static_cast<double>(samples.size());
  }
  return result;
}

Samples to_doubles(std::span<const float> samples) { return {samples.begin(), samples.end()}; }

}  // namespace ringdown::test
