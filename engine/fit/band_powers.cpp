#include "engine/fit/band_powers.h"

#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

// A cell's spectrum is that of 20 ms under a Hann window, padded to bins of about 12 Hz. A band sums the bins between
// its edges; of a bin on an edge it takes the part inside the band. Below 300 Hz bands are narrower than the resolution
// of 20 ms, so neighbours share their sound, but this blurs both compared sounds equally.
namespace ringdown::fit {
namespace {

constexpr double kBin_hz = 12;  // at most

class CellSpectrum {
 public:
  explicit CellSpectrum(double rate)
      : rate_(rate), centres_(band_centres_hz(rate)), window_(static_cast<std::size_t>(2 * kCell_s * rate)) {
    for (std::size_t n = 0; n < window_.size(); ++n) {
      const double turn = (static_cast<double>(n) + 0.5) / static_cast<double>(window_.size());
      window_[n] = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * turn);
      square_sum_ += window_[n] * window_[n];
    }
    std::size_t size = 1;
    while (size < window_.size() || rate / static_cast<double>(size) > kBin_hz) size *= 2;
    padded_.resize(size);
  }
  [[nodiscard]] const std::vector<double>& centres() const { return centres_; }

  // Writes the mean squares of the bands over two cells from sample `first` on, which may be negative.
  void take(std::span<const double> samples, std::ptrdiff_t first, double* powers, std::size_t stride) {
    std::ranges::fill(padded_, 0.0);
    for (std::size_t n = 0; n < window_.size(); ++n) {
      const std::ptrdiff_t at = first + static_cast<std::ptrdiff_t>(n);
      if (at >= 0 && at < std::ssize(samples)) padded_[n] = window_[n] * samples[static_cast<std::size_t>(at)];
    }
    fft_.fwd(spectrum_, padded_);
    const double bin = rate_ / static_cast<double>(padded_.size());
    const double scale = 2 / (static_cast<double>(padded_.size()) * square_sum_);
    for (std::size_t b = 0; b < centres_.size(); ++b) {
      const double low = band_low_hz(centres_[b]) / bin, high = band_high_hz(centres_[b]) / bin;
      double sum = 0;
      for (auto k = static_cast<std::size_t>(low + 0.5); static_cast<double>(k) - 0.5 < high && k < padded_.size() / 2;
           ++k) {
        const double inside =
            std::min(static_cast<double>(k) + 0.5, high) - std::max(static_cast<double>(k) - 0.5, low);
        sum += std::max(inside, 0.0) * std::norm(spectrum_[k]);
      }
      powers[b * stride] = scale * sum;
    }
  }

 private:
  double rate_;
  std::vector<double> centres_, window_, padded_;
  double square_sum_ = 0;
  Eigen::FFT<double> fft_;
  std::vector<std::complex<double>> spectrum_;
};

struct ComparedCell {
  double recorded_db, model, noise;
  [[nodiscard]] double off_db(double gain) const { return recorded_db - power_db(gain * model + noise); }
  // The derivative of the model's level by the gain's level.
  [[nodiscard]] double slope(double gain) const { return model > 0 ? gain * model / (gain * model + noise) : 0; }
};

std::vector<ComparedCell> compared(const BandPowers& recorded, const BandPowers& model, std::span<const double> noise,
                                   const std::vector<bool>& cells) {
  std::vector<ComparedCell> all;
  for (std::size_t b = 0; b < recorded.bands(); ++b) {
    for (std::size_t c = 0; c < std::min(recorded.cells, model.cells); ++c) {
      if (!cells[b * recorded.cells + c]) continue;
      all.push_back({power_db(recorded.power(b, c)), model.power(b, c), noise[b]});
    }
  }
  return all;
}

std::size_t samples_of_cell(double rate) { return static_cast<std::size_t>(kCell_s * rate); }

}  // namespace

std::vector<double> band_centres_hz(double sample_rate_hz) {
  std::vector<double> centres;
  for (int third = -11; third <= 12; ++third) {  // thirds of an octave from 1 kHz: 79.4 Hz to 15.8 kHz (IEC 61260-1)
    const double centre = 1000 * std::pow(10, third / 10.0);
    if (band_high_hz(centre) < 0.49 * sample_rate_hz) centres.push_back(centre);
  }
  return centres;
}

double band_low_hz(double centre_hz) { return centre_hz * std::pow(10, -0.05); }
double band_high_hz(double centre_hz) { return centre_hz * std::pow(10, 0.05); }

BandPowers band_powers(std::span<const double> samples, double sample_rate_hz, std::size_t onset) {
  CellSpectrum spectrum(sample_rate_hz);
  const std::size_t step = samples_of_cell(sample_rate_hz);
  BandPowers result{.centre_hz = spectrum.centres(),
                    .cells = (samples.size() - std::min(onset, samples.size())) / step};
  result.values.resize(result.bands() * result.cells);
  for (std::size_t c = 0; c < result.cells; ++c) {
    const auto first = static_cast<std::ptrdiff_t>(onset + c * step) - static_cast<std::ptrdiff_t>(step / 2);
    spectrum.take(samples, first, result.values.data() + c, result.cells);
  }
  return result;
}

std::vector<double> band_noise(std::span<const double> samples, double sample_rate_hz, std::size_t onset) {
  constexpr std::size_t kMinCells = 5, kGuard = 2;  // kGuard: reach of a window into neighbouring cells
  constexpr auto kMaxCells = static_cast<std::size_t>(kMaxSilence_s / kCell_s);
  constexpr double kMin = 1e-8;  // 80 dB below the loudest cell, which is inaudible
  const std::size_t step = samples_of_cell(sample_rate_hz);
  const BandPowers after = band_powers(samples, sample_rate_hz, onset);
  const double min = after.values.empty() ? 0 : kMin * *std::ranges::max_element(after.values);
  const bool silence_before = onset / step >= kMinCells + kGuard;
  const std::size_t end = silence_before ? onset - kGuard * step : 0;
  const BandPowers quiet =
      silence_before ? band_powers(samples.first(end).last(std::min(end, kMaxCells * step)), sample_rate_hz, 0) : after;
  std::vector<double> noise(quiet.bands(), min);
  for (std::size_t b = 0; b < quiet.bands() && quiet.cells > 0; ++b) {
    const auto row = quiet.values.begin() + static_cast<std::ptrdiff_t>(b * quiet.cells);
    std::vector<double> powers(row, row + static_cast<std::ptrdiff_t>(quiet.cells));
    std::ranges::sort(powers);
    if (!silence_before) powers.resize(std::max<std::size_t>(1, powers.size() / 10));
    const double sum = std::accumulate(powers.begin(), powers.end(), 0.0);
    noise[b] = std::max(min, sum / static_cast<double>(powers.size()));
  }
  return noise;
}

std::vector<bool> heard_cells(const BandPowers& powers, std::span<const double> noise) {
  std::vector<bool> heard(powers.values.size());
  for (std::size_t b = 0; b < powers.bands(); ++b) {
    for (std::size_t c = 0; c < powers.cells; ++c) {
      heard[b * powers.cells + c] = powers.power(b, c) > kCellOverNoise * noise[b] && powers.power(b, c) > 0;
    }
  }
  return heard;
}

std::vector<bool> sure_cells(const BandPowers& powers, std::span<const double> noise) {
  const std::vector<bool> heard = heard_cells(powers, noise);
  std::vector<bool> sure(heard.size());
  for (std::size_t b = 0; b < powers.bands(); ++b) {
    const std::size_t row = b * powers.cells;
    for (std::size_t c = 0; c < powers.cells; ++c) {
      const bool beside = c == 0 || heard[row + c - 1] || (c + 1 < powers.cells && heard[row + c + 1]);
      sure[row + c] = heard[row + c] && beside;
    }
  }
  return sure;
}

// Finds the gain by Gauss-Newton steps, starting from the gain for which the mean of the differences is 0.
double distance_db(const BandPowers& recorded, const BandPowers& model, std::span<const double> noise) {
  constexpr int kSteps = 8;
  constexpr double kMaxStep_db = 6;
  const std::vector<ComparedCell> cells = compared(recorded, model, noise, heard_cells(recorded, noise));
  if (cells.empty()) return NAN;
  const auto count = static_cast<double>(cells.size());
  double gain_db = 0, nearest = INFINITY;
  for (int step = 0; step <= kSteps; ++step) {
    const double gain = std::pow(10, gain_db / 10);
    double squares = 0, sum = 0, along = 0, slopes = 0;
    for (const ComparedCell& cell : cells) {
      const double off = cell.off_db(gain), slope = cell.slope(gain);
      squares += off * off;
      sum += off;
      along += slope * off;
      slopes += slope * slope;
    }
    nearest = std::min(nearest, std::sqrt(squares / count));
    if (step == 0) {
      gain_db = sum / count;
    } else if (slopes > 0) {
      gain_db += std::clamp(along / slopes, -kMaxStep_db, kMaxStep_db);
    }
  }
  return nearest;
}

double distance_as_played_db(const BandPowers& recorded, const BandPowers& model, std::span<const double> noise,
                             const std::vector<bool>& cells) {
  double squares = 0;
  const std::vector<ComparedCell> all = compared(recorded, model, noise, cells);
  for (const ComparedCell& cell : all) squares += std::pow(cell.off_db(1), 2);
  return all.empty() ? NAN : std::sqrt(squares / static_cast<double>(all.size()));
}

}  // namespace ringdown::fit
