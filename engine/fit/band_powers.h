// A sound's power in cells of a third of an octave by 10 ms, and how far two sounds lie apart there. [any]
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

inline constexpr double kCell_s = 0.01;
inline constexpr double kMaxSilence_s = 0.25;  // looked at before an onset: longer ago another blow may have been

// Centres of the third-octave bands from 80 Hz to 16 kHz that lie below half the sample rate [Hz].
std::vector<double> band_centres_hz(double sample_rate_hz);

// Where a band begins and ends [Hz].
double band_low_hz(double centre_hz);
double band_high_hz(double centre_hz);

// Mean squares, in units of the samples squared: power(b, c) is that of band b in cell c, which begins c * kCell_s
// after the onset. Each is taken under a Hann window of two cells, centred on its cell.
struct BandPowers {
  std::vector<double> centre_hz;
  std::size_t cells = 0;
  std::vector<double> values;  // bands x cells
  [[nodiscard]] std::size_t bands() const { return centre_hz.size(); }
  [[nodiscard]] double power(std::size_t band, std::size_t cell) const { return values[band * cells + cell]; }
};

// Cells from sample `onset` on, as many as lie wholly in the samples; what is missing before the first counts as
// silence.
BandPowers band_powers(std::span<const double> samples, double sample_rate_hz, std::size_t onset);

// The level of a mean square [dB].
inline double power_db(double power) { return 10 * std::log10(std::max(power, 1e-300)); }

// The noise of each band, as mean square: of the 50 to 250 ms before the onset, or else of the quietest
// tenth of the cells after it. Never less than 80 dB below the loudest cell.
std::vector<double> band_noise(std::span<const double> samples, double sample_rate_hz, std::size_t onset);

inline constexpr double kCellOverNoise = 4;  // power over the noise: 6 dB

// For each cell whether it is heard: it stands kCellOverNoise over the noise.
std::vector<bool> heard_cells(const BandPowers& powers, std::span<const double> noise);

// The same, but only where a neighbour in time is heard, too, or the cell is the first. By chance alone one cell of
// noise in fifty is heard, but hardly two together: what a fit should follow.
std::vector<bool> sure_cells(const BandPowers& powers, std::span<const double> noise);

// How far a model lies from a recording [dB]: the root mean square of the differences of level over all cells that are
// heard in the recording, after the one gain of the model that makes it least. The noise is added to the model. NAN
// without such a cell.
double distance_db(const BandPowers& recorded, const BandPowers& model, std::span<const double> noise);

// The same over other cells of `recorded`, the model as loud as it is.
double distance_as_played_db(const BandPowers& recorded, const BandPowers& model, std::span<const double> noise,
                             const std::vector<bool>& cells);

}  // namespace ringdown::fit
