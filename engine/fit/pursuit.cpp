#include "engine/fit/pursuit.h"

#include "engine/modal/damping.h"

#include <algorithm>
#include <cmath>
#include <complex>

// Each round projects the remaining sound onto a grid of decays and of frequencies a quarter of a semitone apart. The
// best point is moved to the nearest maximum by steps that are halved. The amplitudes of all atoms so far are then
// fitted together and subtracted for the next round.
namespace ringdown::fit {
namespace {

constexpr double kPerOctave = 24;
constexpr double kDecays_per_s[] = {25, 50, 100, 180, 320, 560, 1000, 1600};
constexpr double kFastestAtom_per_s = 2000;
constexpr double kAtomCycles = 0.5;    // minimum of frequency over decay; below, the sound is a thud without pitch
constexpr double kAtomOverNoise = 30;  // energy of an atom over that of noise on one of its two coordinates
constexpr double kMinPart = 0.01;      // of the remaining sound; an atom that explains less is the sound's own noise
constexpr int kSteps = 12;

struct Atom {
  double frequency_hz = 0, decay_per_s = 0, energy = 0;
};

// The energy that exp(-d t) times a sine and a cosine explain of the samples.
double explained(std::span<const double> samples, double rate, double frequency_hz, double decay_per_s) {
  const std::complex<double> turn =
      std::exp(std::complex<double>(-decay_per_s, modal::hz_to_rad_per_s(frequency_hz)) / rate);
  double re = 1, im = 0, with_cos = 0, with_sin = 0, cc = 0, cs = 0, ss = 0;
  for (const double x : samples) {
    with_cos += x * re;
    with_sin += x * im;
    cc += re * re;
    cs += re * im;
    ss += im * im;
    const double next = re * turn.real() - im * turn.imag();
    im = re * turn.imag() + im * turn.real();
    re = next;
    if (re * re + im * im < 1e-14) break;
  }
  const double determinant = cc * ss - cs * cs;
  if (!(determinant > 1e-9 * cc * cc)) return 0;
  return (with_cos * with_cos * ss - 2 * with_cos * with_sin * cs + with_sin * with_sin * cc) / determinant;
}

Atom best_on_grid(std::span<const double> samples, double rate, const PursuitOptions& options) {
  Atom best;
  for (double f = std::max(options.low_hz, 40.0); f < std::min(options.high_hz, 0.45 * rate);
       f *= std::exp2(1 / kPerOctave)) {
    for (const double d : kDecays_per_s) {
      if (f < kAtomCycles * d) break;
      const double energy = explained(samples, rate, f, d);
      if (energy > best.energy) best = {f, d, energy};
    }
  }
  return best;
}

// Moves to the nearest maximum, by steps along frequency and decay that are halved when neither step helps.
Atom climb(std::span<const double> samples, double rate, Atom atom, const PursuitOptions& options) {
  double of_frequency = std::exp2(0.5 / kPerOctave), of_decay = 1.3;
  for (int step = 0; step < kSteps; ++step) {
    const Atom before = atom;
    for (const auto& [f, d] : {std::pair(of_frequency, 1.0), std::pair(1 / of_frequency, 1.0), std::pair(1.0, of_decay),
                               std::pair(1.0, 1 / of_decay)}) {
      const Atom next{before.frequency_hz * f, before.decay_per_s * d, 0};
      if (next.decay_per_s > kFastestAtom_per_s || next.frequency_hz < kAtomCycles * next.decay_per_s ||
          next.frequency_hz < options.low_hz || next.frequency_hz > std::min(options.high_hz, 0.49 * rate))
        continue;
      const double energy = explained(samples, rate, next.frequency_hz, next.decay_per_s);
      if (energy > atom.energy) atom = {next.frequency_hz, next.decay_per_s, energy};
    }
    if (atom.energy == before.energy) {
      of_frequency = std::sqrt(of_frequency);
      of_decay = std::sqrt(of_decay);
    }
  }
  return atom;
}

double square_sum_of(std::span<const double> x) {
  double sum = 0;
  for (const double sample : x) sum += sample * sample;
  return sum;
}

}  // namespace

std::vector<Mode> pursue(std::span<const double> left, double sample_rate_hz, const PursuitOptions& options) {
  const auto max = std::min(left.size(), static_cast<std::size_t>(kPursuit_s * sample_rate_hz));
  const std::span<const double> sound = left.first(max);
  std::vector<double> rest(sound.begin(), sound.end());
  std::vector<Mode> modes;
  while (modes.size() < options.max_modes) {
    const Atom atom = climb(rest, sample_rate_hz, best_on_grid(rest, sample_rate_hz, options), options);
    if (!(atom.energy > kAtomOverNoise * options.noise) || atom.energy < kMinPart * square_sum_of(rest)) break;
    const double error = std::sqrt(options.noise / atom.energy);  // relative error of the amplitude
    modes.push_back({.frequency_hz = atom.frequency_hz,
                     .decay_per_s = atom.decay_per_s,
                     .frequency_error_hz = modal::rad_per_s_to_hz(error * atom.decay_per_s),
                     .decay_error_per_s = error * atom.decay_per_s,
                     .amplitude_error = error});
    fit_amplitudes(sound, sample_rate_hz, modes);
    const std::vector<double> sum = synthesise(modes, sample_rate_hz, sound.size());
    for (std::size_t n = 0; n < rest.size(); ++n) rest[n] = sound[n] - sum[n];
  }
  return modes;
}

}  // namespace ringdown::fit
