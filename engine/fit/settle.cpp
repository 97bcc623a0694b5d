#include "engine/fit/settle.h"

#include "engine/fit/band_powers.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

// In each of a few rounds the modes are played together, and the level error is measured in each cell. A straight line
// over time is fitted to the errors of the cells in a mode's band, weighted by the mode's share in each cell. The line
// gives the corrections of the mode's level and decay; half of them are applied, because neighbouring modes are
// corrected, too. The result of the round nearest to the recording is kept. Finally the sign of a mode that beats with
// others at the wrong time is turned if this brings the whole nearer.
namespace ringdown::fit {
namespace {

constexpr int kSettleRounds = 12;
constexpr double kNear_db = 2;        // error of a mode's cells; modes with less stay as they are
constexpr double kNearBeside_db = 1;  // error of all cells, with the burst, that is small enough
constexpr int kKeepRounds = 2;
constexpr double kHalf = 0.5;
constexpr double kMaxLevel_db = 6;            // largest change in a round
constexpr double kMaxDecay = 1.5;             // largest factor of a decay in a round
constexpr double kSettledDecay_per_s = 2000;  // largest decay after settling
constexpr double kPerNeper_db = 8.685889638;

std::size_t band_of(const BandPowers& powers, double frequency_hz) {
  std::size_t b = 0;
  while (b + 1 < powers.bands() && frequency_hz > band_high_hz(powers.centre_hz[b])) ++b;
  return b;
}

// A weighted straight line through the errors of cells.
struct Line {
  double w = 0, wt = 0, wtt = 0, we = 0, wte = 0, wee = 0;
  void add(double weight, double t, double e) {
    w += weight;
    wt += weight * t;
    wtt += weight * t * t;
    we += weight * e;
    wte += weight * t * e;
    wee += weight * e * e;
  }
  [[nodiscard]] double rms() const { return w > 0 ? std::sqrt(wee / w) : 0; }
  // slope() is 0 if there are too few cells. start() is the value at t = 0.
  [[nodiscard]] double slope() const {
    const double determinant = w * wtt - wt * wt;
    return w > 1.5 && determinant > 1e-3 * w * wtt ? (w * wte - wt * we) / determinant : 0;
  }
  [[nodiscard]] double start() const { return w > 0 ? (we - slope() * wt) / w : 0; }
};

struct Recorded {
  BandPowers powers;
  std::vector<double> noise;
  std::vector<bool> sure;

  Recorded(std::span<const double> samples, double rate, std::size_t onset, std::vector<double> noise_of_bands)
      : powers(band_powers(samples, rate, onset)), noise(std::move(noise_of_bands)), sure(sure_cells(powers, noise)) {}
  [[nodiscard]] double off_db(const BandPowers& model) const {
    return distance_as_played_db(powers, model, noise, sure);
  }
};

void settle_mode(const Recorded& recorded, const BandPowers& model, Mode& mode) {
  const std::size_t b = band_of(model, mode.frequency_hz);
  Line line;
  const double noise = recorded.noise[b];
  for (std::size_t c = 0; c < std::min(recorded.powers.cells, model.cells); ++c) {
    const bool sure = recorded.sure[b * recorded.powers.cells + c];
    const double own = 0.5 * mode.amplitude * mode.amplitude * decayed_power(mode.decay_per_s, c);
    const double played = model.power(b, c) + noise, wanted = recorded.powers.power(b, c);
    if (own < 0.01 * played || (!sure && played < kCellOverNoise * noise)) continue;
    const double t = kCell_s * (static_cast<double>(c) + 0.5);
    line.add(std::min(own / played, 1.0), t, power_db(std::max(wanted, noise)) - power_db(played));
  }
  if (line.rms() < kNear_db) return;
  const double level = std::clamp(kHalf * line.start(), -kMaxLevel_db, kMaxLevel_db);
  mode.amplitude *= std::pow(10, level / 20);
  const double decay = mode.decay_per_s - kHalf * line.slope() / kPerNeper_db;
  mode.decay_per_s =
      std::min(std::clamp(decay, mode.decay_per_s / kMaxDecay, mode.decay_per_s * kMaxDecay), kSettledDecay_per_s);
}

// Turns the signs of the loudest modes, one after the other, where this brings the sum nearer to the recording.
void turn_signs(const Recorded& recorded, double rate, std::size_t onset, std::size_t samples, std::vector<Mode>& modes,
                double nearest) {
  constexpr std::size_t kMaxTurned = 40;
  constexpr double kGain_db = 0.02;
  std::vector<std::size_t> order(modes.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, std::greater{},
                    [&](std::size_t m) { return std::pow(modes[m].amplitude, 2) / modes[m].decay_per_s; });
  order.resize(std::min(order.size(), kMaxTurned));
  std::vector<double> sum = played_from(modes, rate, onset, samples);
  for (const std::size_t m : order) {
    const std::vector<double> own = played_from({&modes[m], 1}, rate, onset, samples);
    std::vector<double> turned = sum;
    for (std::size_t n = onset; n < samples; ++n) turned[n] -= 2 * own[n];
    const double distance = recorded.off_db(band_powers(turned, rate, onset));
    if (!(distance < nearest - kGain_db)) continue;
    nearest = distance;
    sum = std::move(turned);
    modes[m].phase_rad = modes[m].phase_rad == 0 ? std::numbers::pi : 0;
  }
}

// Tries other levels and decays of short modes, and to omit them, in the presence of the fixed sound `beside`, and
// keeps what brings the sum nearer to the recording. Only the beginning is examined, because short modes sound only
// there.
void vary(std::span<const double> recording, double rate, std::size_t onset, std::span<const double> beside,
          std::vector<Mode>& modes) {
  constexpr double kLook_s = 0.5, kShort_per_s = 12, kGain_db = 0.01;
  constexpr std::size_t kMaxVaried = 60;
  constexpr int kSweeps = 3;
  constexpr std::array<std::array<double, 2>, 7> kTries = {
      {{0, 1}, {0.7, 1}, {1.4, 1}, {1, 1.4}, {1, 0.7}, {-1, 1}, {0.8, 1.8}}};  // factors of amplitude and decay
  const std::size_t samples = std::min(recording.size(), onset + static_cast<std::size_t>(kLook_s * rate));
  const Recorded recorded(recording.first(samples), rate, onset, band_noise(recording, rate, onset));
  std::vector<std::size_t> order;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    if (modes[m].decay_per_s > kShort_per_s) order.push_back(m);
  }
  std::ranges::sort(order, std::greater{}, [&](std::size_t m) { return modes[m].amplitude; });
  order.resize(std::min(order.size(), kMaxVaried));
  std::vector<double> sum = played_from(modes, rate, onset, samples);
  for (std::size_t n = 0; n < samples && n < beside.size(); ++n) sum[n] += beside[n];
  const auto off = [&](const std::vector<double>& sound) { return recorded.off_db(band_powers(sound, rate, onset)); };
  double nearest = off(sum);
  for (int sweep = 0; sweep < kSweeps && nearest > kNearBeside_db; ++sweep) {
    for (const std::size_t m : order) {
      const std::vector<double> own = played_from({&modes[m], 1}, rate, onset, samples);
      std::optional<Mode> better;
      std::vector<double> best_sum;
      for (const auto& [level, faster] : kTries) {
        Mode other = modes[m];
        other.amplitude *= std::abs(level);
        other.decay_per_s = std::min(other.decay_per_s * faster, kSettledDecay_per_s);
        if (level < 0) other.phase_rad = other.phase_rad == 0 ? std::numbers::pi : 0;
        std::vector<double> changed = sum;
        const std::vector<double> next = played_from({&other, 1}, rate, onset, samples);
        for (std::size_t n = onset; n < samples; ++n) changed[n] += next[n] - own[n];
        const double distance = off(changed);
        if (distance < nearest - kGain_db) {
          nearest = distance;
          better = other;
          best_sum = std::move(changed);
        }
      }
      if (better) {
        modes[m] = *better;
        sum = std::move(best_sum);
      }
    }
  }
  std::erase_if(modes, [](const Mode& mode) { return mode.amplitude == 0; });
}

}  // namespace

std::vector<Mode> settle(std::span<const double> recording, double sample_rate_hz, std::size_t onset,
                         std::span<const Mode> modes) {
  const Recorded recorded(recording, sample_rate_hz, onset, band_noise(recording, sample_rate_hz, onset));
  std::vector<Mode> played = as_played(modes), best = played;
  double nearest = INFINITY;
  for (int round = 0; round < kSettleRounds && recorded.powers.bands() > 0; ++round) {
    const BandPowers model =
        band_powers(played_from(played, sample_rate_hz, onset, recording.size()), sample_rate_hz, onset);
    const double distance = recorded.off_db(model);
    if (!std::isfinite(distance)) return played;
    if (distance < nearest) {
      nearest = distance;
      best = played;
    }
    for (Mode& mode : played) settle_mode(recorded, model, mode);
  }
  if (nearest > kNear_db) turn_signs(recorded, sample_rate_hz, onset, recording.size(), best, nearest);
  return best;
}

Kept keep(std::span<const double> recording, double sample_rate_hz, std::size_t onset, std::span<const Mode> modes,
          bool with_burst) {
  const Recorded recorded(recording, sample_rate_hz, onset, band_noise(recording, sample_rate_hz, onset));
  const auto sound_of = [&](std::span<const Mode> some) {
    return played_from(some, sample_rate_hz, onset, recording.size());
  };
  const auto powers_of = [&](const Kept& all) {
    std::vector<double> model = sound_of(all.modes);
    const std::vector<double> noise = sound_of(all.noise);
    for (std::size_t n = 0; n < model.size(); ++n) model[n] += noise[n];
    return band_powers(model, sample_rate_hz, onset);
  };
  Kept kept{.modes = settle(recording, sample_rate_hz, onset, modes)}, best = kept;
  double nearest = INFINITY;
  const auto remember = [&](const Kept& all) {
    const double off = recorded.off_db(powers_of(all));
    if (off < nearest) {
      nearest = off;
      best = all;
    }
  };
  for (int round = 0; with_burst && round <= kKeepRounds; ++round) {
    if (round > 0) {
      vary(recording, sample_rate_hz, onset, sound_of(kept.noise), kept.modes);
      remember(kept);
    }
    kept.burst = fit_burst(recording, sample_rate_hz, onset, kept.modes);
    kept.noise = burst_modes(kept.burst);
    remember(kept);
    if (nearest < kNearBeside_db) break;
  }
  const BandPowers powers = powers_of(best);
  best.distance_db = distance_db(recorded.powers, powers, recorded.noise);
  best.sure_db = recorded.off_db(powers);
  return best;
}

}  // namespace ringdown::fit
