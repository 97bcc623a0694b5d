#include "engine/fit/burst.h"

#include "engine/fit/band_powers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

// For each pair of bands, the fit searches the decay and the two levels for which the logarithm of the power of modes
// and burst together is nearest to the recording's. The power of a decaying noise in each cell is known in closed form,
// except for the power that spills into neighbouring bands. Therefore the burst is played and measured, and its levels
// are corrected, a few times.
namespace ringdown::fit {
namespace {

constexpr double kSlowestBurst_per_s = 12, kFastestBurst_per_s = 1500;  // T60 from half a second to 5 ms
constexpr int kDecays = 40;
constexpr double kLevelStep_db = 1, kLowestLevel_db = -45, kHighestLevel_db = 12;
constexpr double kMaxCells = 60;      // after the onset; nothing later than 0.6 s is a burst
constexpr double kWorth_db = 0.5;     // minimum gain of distance in a pair of bands; otherwise the burst is left out
constexpr double kBurstCycles = 0.5;  // minimum of frequency over decay; below, a band's sound is all in its neighbours
constexpr int kCorrections = 4;
constexpr double kModeSpacing_hz = 60;
constexpr std::size_t kMinOfBand = 2, kMaxOfBand = 40;  // modes of a band

// Numbers in [0, 1) that are equal on every machine: a linear congruential generator's upper bits [Knuth, TAOCP 2,
// 3.3.4].
class Draw {
 public:
  double next() {
    state_ = 6364136223846793005u * state_ + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_ = 20130201;
};

struct Target {
  BandPowers recorded, modes;
  std::vector<double> noise;
  std::vector<bool> sure;
  std::size_t cells = 0;  // number of cells to fit
  [[nodiscard]] bool counts(std::size_t b, std::size_t c) const { return sure[b * recorded.cells + c]; }
};

// The sum over a band's cells of the squared level difference, for a burst with this power and these shares of the
// cells. Where the recording is below the noise, the burst must be, too.
double misfit(const Target& target, std::size_t b, double power, const std::vector<double>& share) {
  double sum = 0;
  for (std::size_t c = 0; c < target.cells; ++c) {
    const double model = target.modes.power(b, c) + power * share[c] + target.noise[b];
    const double quiet = kCellOverNoise * target.noise[b];
    if (!target.counts(b, c) && (power * share[c] < target.noise[b] || model < quiet)) continue;
    sum += std::pow(power_db(target.counts(b, c) ? target.recorded.power(b, c) : quiet) - power_db(model), 2);
  }
  return sum;
}

struct Choice {
  double misfit = 0, power = 0;
};

// The best power of a band for a decay.
Choice best_power(const Target& target, std::size_t b, const std::vector<double>& share) {
  double loudest = 0;
  for (std::size_t c = 0; c < target.cells; ++c) loudest = std::max(loudest, target.recorded.power(b, c));
  Choice best{misfit(target, b, 0, share), 0};
  for (double level = kLowestLevel_db; level <= kHighestLevel_db; level += kLevelStep_db) {
    const double power = loudest * std::pow(10, level / 10) / std::max(share[0], 1e-12);
    const double found = misfit(target, b, power, share);
    if (found < best.misfit) best = {found, power};
  }
  return best;
}

std::size_t counted(const Target& target, std::size_t b) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < target.cells; ++c) count += target.counts(b, c) ? 1 : 0;
  return count;
}

void fit_pair(const Target& target, std::size_t pair, Burst& burst) {
  const std::size_t first = pair * kBandsOfDecay, last = std::min(first + kBandsOfDecay, burst.level.size());
  const std::vector<double> nothing(target.cells, 0.0);
  double without = 0, best = INFINITY;
  std::size_t cells = 0;
  for (std::size_t b = first; b < last; ++b) {
    without += misfit(target, b, 0, nothing);
    cells += counted(target, b);
  }
  if (cells == 0) return;
  std::array<double, kBandsOfDecay> powers{};
  for (int i = 0; i <= kDecays; ++i) {
    const double decay =
        kSlowestBurst_per_s * std::pow(kFastestBurst_per_s / kSlowestBurst_per_s, static_cast<double>(i) / kDecays);
    if (decay * kBurstCycles > burst.centre_hz[first]) break;
    std::vector<double> share(target.cells);
    for (std::size_t c = 0; c < target.cells; ++c) share[c] = decayed_power(decay, c);
    std::array<Choice, kBandsOfDecay> choices{};
    double sum = 0;
    for (std::size_t b = first; b < last; ++b) {
      choices[b - first] = best_power(target, b, share);
      sum += choices[b - first].misfit;
    }
    if (sum < best) {
      best = sum;
      burst.decay_per_s[pair] = decay;
      for (std::size_t b = first; b < last; ++b) powers[b - first] = choices[b - first].power;
    }
  }
  const double count = static_cast<double>(cells);
  if (std::sqrt(without / count) - std::sqrt(best / count) < kWorth_db) return;
  for (std::size_t b = first; b < last; ++b) burst.level[b] = std::sqrt(powers[b - first]);
}

// Corrects each level by the level error of modes and burst together in the cells where the burst is heard.
void correct_levels(const Target& target, const BandPowers& model, const BandPowers& alone, Burst& burst) {
  constexpr double kMax_db = 6, kPart = 0.7;
  for (std::size_t b = 0; b < burst.level.size(); ++b) {
    if (burst.level[b] == 0) continue;
    double sum = 0, weight = 0;
    for (std::size_t c = 0; c < target.cells; ++c) {
      if (!target.counts(b, c)) continue;
      const double heard = alone.power(b, c) / (model.power(b, c) + target.noise[b]);
      const double w = std::min(heard, 1.0);
      sum += w * (power_db(target.recorded.power(b, c)) - power_db(model.power(b, c) + target.noise[b]));
      weight += w;
    }
    if (weight > 0.1) burst.level[b] *= std::pow(10, std::clamp(kPart * sum / weight, -kMax_db, kMax_db) / 20);
  }
}

// Raises all levels until the burst has the energy that the modes lack. The fitted levels are too low because the mean
// of the logarithm of a noise's power lies up to 2.5 dB below the logarithm of its mean.
void match_energy(const Target& target, const BandPowers& alone, Burst& burst) {
  constexpr double kMax = 2;  // 3 dB
  double wanted = 0, played = 0;
  for (std::size_t b = 0; b < burst.level.size(); ++b) {
    for (std::size_t c = 0; c < target.cells && burst.level[b] > 0; ++c) {
      if (!target.counts(b, c)) continue;
      wanted += target.recorded.power(b, c) - target.modes.power(b, c);
      played += alone.power(b, c);
    }
  }
  if (!(played > 0)) return;
  const double gain = std::sqrt(std::clamp(wanted / played, 1.0, kMax));
  for (double& level : burst.level) level *= gain;
}

}  // namespace

double decayed_power(double decay_per_s, std::size_t cell) {
  constexpr int kSteps = 40;
  double sum = 0, whole = 0;
  for (int n = 0; n < kSteps; ++n) {
    const double turn = (n + 0.5) / kSteps;
    const double window = std::pow(std::sin(std::numbers::pi * turn), 4);  // Hann's, squared
    const double t = kCell_s * (static_cast<double>(cell) - 0.5 + 2 * turn);
    if (t >= 0) sum += window * std::exp(-2 * decay_per_s * t);
    whole += window;
  }
  return sum / whole;
}

bool Burst::silent() const {
  return std::ranges::all_of(level, [](double x) { return x == 0; });
}

std::vector<Mode> burst_modes(const Burst& burst) {
  std::vector<Mode> modes;
  Draw draw;
  for (std::size_t b = 0; b < burst.level.size(); ++b) {
    const double low = band_low_hz(burst.centre_hz[b]), width = band_high_hz(burst.centre_hz[b]) - low;
    const auto count = std::clamp(static_cast<std::size_t>(width / kModeSpacing_hz), kMinOfBand, kMaxOfBand);
    const double step = width / static_cast<double>(count);
    for (std::size_t n = 0; n < count; ++n) {
      const double place = (static_cast<double>(n) + draw.next()) * step, sign = draw.next();
      if (burst.level[b] == 0) continue;
      modes.push_back({.frequency_hz = low + place,
                       .decay_per_s = burst.decay_per_s[b / kBandsOfDecay],
                       .amplitude = burst.level[b] * std::sqrt(2 / static_cast<double>(count)),
                       .phase_rad = sign < 0.5 ? 0 : std::numbers::pi});
    }
  }
  return modes;
}

std::vector<Mode> as_played(std::span<const Mode> modes) {
  std::vector<Mode> played(modes.begin(), modes.end());
  for (Mode& mode : played) mode.phase_rad = std::cos(mode.phase_rad) >= 0 ? 0 : std::numbers::pi;
  return played;
}

std::vector<double> played_from(std::span<const Mode> modes, double sample_rate_hz, std::size_t onset,
                                std::size_t samples) {
  std::vector<double> sound(std::min(onset, samples));
  const std::vector<double> ringing = synthesise(modes, sample_rate_hz, samples - sound.size());
  sound.insert(sound.end(), ringing.begin(), ringing.end());
  return sound;
}

Burst fit_burst(std::span<const double> recording, double sample_rate_hz, std::size_t onset,
                std::span<const Mode> played) {
  Target target{.recorded = band_powers(recording, sample_rate_hz, onset),
                .noise = band_noise(recording, sample_rate_hz, onset)};
  const std::vector<double> of_modes = played_from(played, sample_rate_hz, onset, recording.size());
  target.sure = sure_cells(target.recorded, target.noise);
  target.modes = band_powers(of_modes, sample_rate_hz, onset);
  target.cells = std::min(target.recorded.cells, static_cast<std::size_t>(kMaxCells));
  Burst burst{.centre_hz = target.recorded.centre_hz,
              .level = std::vector<double>(target.recorded.bands()),
              .decay_per_s = std::vector<double>((target.recorded.bands() + kBandsOfDecay - 1) / kBandsOfDecay)};
  for (std::size_t pair = 0; pair < burst.decay_per_s.size(); ++pair) fit_pair(target, pair, burst);
  const std::size_t samples =
      std::min(recording.size(), onset + static_cast<std::size_t>(kMaxCells * kCell_s * sample_rate_hz));
  for (int round = 0; round <= kCorrections && !burst.silent(); ++round) {
    const std::vector<double> alone = played_from(burst_modes(burst), sample_rate_hz, onset, samples);
    const BandPowers of_burst = band_powers(alone, sample_rate_hz, onset);
    target.cells = std::min(target.cells, of_burst.cells);
    if (round == kCorrections) {
      match_energy(target, of_burst, burst);
      break;
    }
    std::vector<double> together(of_modes.begin(), of_modes.begin() + static_cast<std::ptrdiff_t>(alone.size()));
    for (std::size_t n = 0; n < alone.size(); ++n) together[n] += alone[n];
    correct_levels(target, band_powers(together, sample_rate_hz, onset), of_burst, burst);
  }
  return burst;
}

}  // namespace ringdown::fit
