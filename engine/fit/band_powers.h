// A sound's power in cells of a third of an octave by 10 ms, and the distance of two sounds over these cells. [any]
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

inline constexpr double kCell_s = 0.01;
inline constexpr double kMaxSilence_s = 0.25;  // examined before an onset; another blow may lie further back

// Centres of the third-octave bands from 80 Hz to 16 kHz that lie below half the sample rate [Hz].
std::vector<double> band_centres_hz(double sample_rate_hz);

// The lower and upper edge of a band [Hz].
double band_low_hz(double centre_hz);
double band_high_hz(double centre_hz);

// Mean squares, in units of the samples squared: power(b, c) is the power of band b in cell c, which begins c * kCell_s
// after the onset. Each power is measured under a Hann window of two cells, centred on its cell.
struct BandPowers {
  std::vector<double> centre_hz;
  std::size_t cells = 0;
  std::vector<double> values;  // bands x cells
  [[nodiscard]] std::size_t bands() const { return centre_hz.size(); }
  [[nodiscard]] double power(std::size_t band, std::size_t cell) const { return values[band * cells + cell]; }
};

// Measures all cells from sample `onset` on that lie wholly in the samples. Time before the first sample counts as
// silence.
BandPowers band_powers(std::span<const double> samples, double sample_rate_hz, std::size_t onset);

// The level of a mean square [dB].
inline double power_db(double power) { return 10 * std::log10(std::max(power, 1e-300)); }

// The noise of each band as mean square, measured in the 50 to 250 ms before the onset or else in the quietest tenth of
// the cells after the onset. Never less than 80 dB below the loudest cell.
std::vector<double> band_noise(std::span<const double> samples, double sample_rate_hz, std::size_t onset);

inline constexpr double kCellOverNoise = 4;  // power over the noise: 6 dB

// Returns for each cell whether it is heard: its power is then at least kCellOverNoise times the noise.
std::vector<bool> heard_cells(const BandPowers& powers, std::span<const double> noise);

// The cells that a fit should follow: heard cells with a heard neighbour in time, and a heard first cell. By chance
// alone, one cell of noise in fifty is heard, but hardly two neighbours.
std::vector<bool> sure_cells(const BandPowers& powers, std::span<const double> noise);

// The distance of a model from a recording [dB]: the root mean square of the level differences over all cells that are
// heard in the recording, for the gain of the model that makes this distance smallest. The noise is added to the model.
// NAN if no cell is heard.
double distance_db(const BandPowers& recorded, const BandPowers& model, std::span<const double> noise);

// Returns the distance over the given cells of `recorded`, with a gain of 1 instead of the best one of distance_db().
double distance_as_played_db(const BandPowers& recorded, const BandPowers& model, std::span<const double> noise,
                             const std::vector<bool>& cells);

}  // namespace ringdown::fit
