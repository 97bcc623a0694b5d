#include "engine/fit/sinusoids.h"

#include "engine/dense/decompositions.h"
#include "engine/modal/damping.h"

#include <Eigen/Core>

#include <cmath>
#include <complex>
#include <numbers>

// The least-squares problem has a cosine and a sine for each mode. The products of all columns are geometric sums,
// known in closed form, so the normal matrix costs modes^2 and not samples times modes^2; only the right-hand side
// needs the samples. Columns are scaled to length 1, and a small ridge keeps modes that nearly coincide from getting
// huge opposite amplitudes.
namespace ringdown::fit {
namespace {

using Complex = std::complex<double>;

// The mode's complex exponent per sample.
Complex exponent(const Mode& mode, double rate) {
  return Complex(-mode.decay_per_s, modal::hz_to_rad_per_s(mode.frequency_hz)) / rate;
}

Complex exp_minus_one(Complex w) {
  const double half = std::sin(0.5 * w.imag());
  return {std::expm1(w.real()) * std::cos(w.imag()) - 2 * half * half, std::exp(w.real()) * std::sin(w.imag())};
}

// The sum of exp(w n) over n = 0 ... count - 1.
Complex geometric_sum(Complex w, double count) {
  const Complex below = exp_minus_one(w);
  return std::abs(below) < 1e-14 ? Complex(count) : exp_minus_one(w * count) / below;
}

// Products of all columns exp(-d t) cos(w t), then all exp(-d t) sin(w t), in closed form.
Eigen::MatrixXd gram_matrix(std::span<const Mode> modes, double rate, std::size_t samples) {
  const auto count = static_cast<Eigen::Index>(modes.size());
  const auto length = static_cast<double>(samples);
  Eigen::MatrixXd gram(2 * count, 2 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Complex a = exponent(modes[i], rate), b = exponent(modes[j], rate);
      const Complex sum = geometric_sum(a + b, length), difference = geometric_sum(a + std::conj(b), length);
      gram(i, j) = 0.5 * (difference + sum).real();
      gram(count + i, count + j) = 0.5 * (difference - sum).real();
      gram(count + i, j) = 0.5 * (sum + difference).imag();
      gram(count + j, i) = 0.5 * (sum - difference).imag();
    }
  }
  return gram;
}

constexpr std::size_t kRun = 512;  // samples between exact powers

// Sum over n of samples[n] exp(w n).
Complex projection(std::span<const double> samples, Complex w) {
  const Complex ratio = std::exp(w);
  Complex sum = 0;
  for (std::size_t first = 0; first < samples.size(); first += kRun) {
    double re = std::exp(w * static_cast<double>(first)).real(), im = std::exp(w * static_cast<double>(first)).imag();
    if (re * re + im * im < 1e-30) break;
    double real = 0, imaginary = 0;
    for (const double sample : samples.subspan(first, std::min(kRun, samples.size() - first))) {
      real += sample * re;
      imaginary += sample * im;
      const double turned = re * ratio.real() - im * ratio.imag();
      im = re * ratio.imag() + im * ratio.real();
      re = turned;
    }
    sum += Complex(real, imaginary);
  }
  return sum;
}

}  // namespace

void fit_amplitudes(std::span<const double> samples, double sample_rate_hz, std::span<Mode> modes) {
  if (modes.empty()) return;
  const auto count = static_cast<Eigen::Index>(modes.size());
  Eigen::MatrixXd gram = gram_matrix(modes, sample_rate_hz, samples.size());
  Eigen::VectorXd right(2 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Complex sum = projection(samples, exponent(modes[i], sample_rate_hz));
    right[i] = sum.real();
    right[count + i] = sum.imag();
  }
  const Eigen::VectorXd scale = gram.diagonal().array().max(1e-300).sqrt().inverse();
  gram = (scale.asDiagonal() * gram * scale.asDiagonal()).eval();
  gram.diagonal().array() += 1e-12;
  const Eigen::VectorXd solution = scale.asDiagonal() * dense::solve_symmetric(gram, scale.asDiagonal() * right);
  for (Eigen::Index i = 0; i < count; ++i) {
    modes[i].amplitude = std::hypot(solution[i], solution[count + i]);
    modes[i].phase_rad = std::atan2(solution[i], solution[count + i]);
  }
}

std::vector<double> synthesise(std::span<const Mode> modes, double sample_rate_hz, std::size_t samples,
                               double offset_s) {
  std::vector<double> sum(samples);
  for (const Mode& mode : modes) {
    const Complex w = exponent(mode, sample_rate_hz), ratio = std::exp(w);
    const Complex begin = std::polar(mode.amplitude, mode.phase_rad) * std::exp(w * (offset_s * sample_rate_hz));
    for (std::size_t first = 0; first < samples; first += kRun) {
      const Complex anchor = begin * std::exp(w * static_cast<double>(first));
      double re = anchor.real(), im = anchor.imag();
      for (std::size_t n = first; n < std::min(samples, first + kRun); ++n) {
        sum[n] += im;
        const double turned = re * ratio.real() - im * ratio.imag();
        im = re * ratio.imag() + im * ratio.real();
        re = turned;
      }
    }
  }
  return sum;
}

void move_time(std::span<Mode> modes, double seconds) {
  for (Mode& mode : modes) {
    mode.amplitude *= std::exp(-mode.decay_per_s * seconds);
    mode.phase_rad =
        std::remainder(mode.phase_rad + modal::hz_to_rad_per_s(mode.frequency_hz) * seconds, 2 * std::numbers::pi);
  }
}

}  // namespace ringdown::fit
