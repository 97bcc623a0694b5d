// The part of a blow's sound that rings too shortly to have modes, as a burst of noise of a few numbers: its level in
// each third of an octave, and how fast it decays in every two of them. [any]
//
//   const Burst burst = fit_burst(sound, 48000, onset, played);
//   const std::vector<Mode> modes = burst_modes(burst);
//
// The burst is played as a crowd of short modes, drawn from these numbers alone, and no bank needs more than modes: it
// is struck, scaled and filtered by the contact as they are [after Ren, Yeh & Lin, ACM Trans. Graphics 32(1), 2013, who
// keep the residual itself].
#pragma once

#include "engine/fit/sinusoids.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

inline constexpr std::size_t kBandsOfDecay = 2;  // neighbouring bands that share a decay
inline constexpr std::size_t kMaxBurstNumbers = 40;

struct Burst {
  std::vector<double> centre_hz;    // of bands, as band_centres_hz() has them
  std::vector<double> level;        // rms of the band at the onset, in units of the samples; 0: the band is silent
  std::vector<double> decay_per_s;  // of amplitude, of each kBandsOfDecay bands

  [[nodiscard]] bool silent() const;
  [[nodiscard]] std::size_t numbers() const { return level.size() + decay_per_s.size(); }
};

// The same modes for the same burst, phases 0 or pi.
std::vector<Mode> burst_modes(const Burst& burst);

// The modes as a bank plays them, whose sines begin at phase 0: only the sign of their beginning is kept.
std::vector<Mode> as_played(std::span<const Mode> modes);

// The burst that brings `played` nearest to the recording, in cells of a third of an octave by 10 ms, in which the
// recording stands above its noise. Silent where the modes leave no more than noise. `recording`: from its beginning to
// where its sound ends; `onset`: the sample at which modes begin.
Burst fit_burst(std::span<const double> recording, double sample_rate_hz, std::size_t onset,
                std::span<const Mode> played);

// The mean square, under the window of cell c (band_powers.h), of what has one of 1 at the onset and decays as exp(-d
// t).
double decayed_power(double decay_per_s, std::size_t cell);

// Modes as a sound of so many samples that is silent before `onset`.
std::vector<double> played_from(std::span<const Mode> modes, double sample_rate_hz, std::size_t onset,
                                std::size_t samples);

}  // namespace ringdown::fit
