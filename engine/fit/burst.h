// Models the part of a blow's sound that rings too shortly to have modes as a burst of noise, described by a few
// numbers: the level in each third of an octave, and the decay in each pair of these bands. [any]
//
//   const Burst burst = fit_burst(sound, 48000, onset, played);
//   const std::vector<Mode> modes = burst_modes(burst);
//
// The burst is played as a crowd of short modes, drawn from these numbers alone, so a bank needs only modes: they are
// struck, scaled and filtered by the contact like all others [after Ren, Yeh & Lin, ACM Trans. Graphics 32(1), 2013,
// who keep the residual itself].
#pragma once

#include "engine/fit/sinusoids.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

inline constexpr std::size_t kBandsOfDecay = 2;  // neighbouring bands that share a decay
inline constexpr std::size_t kMaxBurstNumbers = 40;

struct Burst {
  std::vector<double> centre_hz;    // centres of bands, from band_centres_hz()
  std::vector<double> level;        // rms of the band at the onset, in units of the samples; 0: the band is silent
  std::vector<double> decay_per_s;  // amplitude decay, one for each kBandsOfDecay bands

  [[nodiscard]] bool silent() const;
  [[nodiscard]] std::size_t numbers() const { return level.size() + decay_per_s.size(); }
};

// Draws the burst's modes, with phases 0 or pi. Equal bursts give equal modes.
std::vector<Mode> burst_modes(const Burst& burst);

// The modes as a bank plays them. Its sines begin at phase 0, so only the sign of a mode at the onset is kept.
std::vector<Mode> as_played(std::span<const Mode> modes);

// Finds the burst that brings `played` nearest to the recording, over the cells of a third of an octave by 10 ms in
// which the recording is louder than its noise. Silent where the modes leave only noise. `recording` ends where its
// sound ends; modes begin at sample `onset`.
Burst fit_burst(std::span<const double> recording, double sample_rate_hz, std::size_t onset,
                std::span<const Mode> played);

// The mean square, under the window of a cell (band_powers.h), of a sound with mean square 1 at the onset whose
// amplitude decays as exp(-d t).
double decayed_power(double decay_per_s, std::size_t cell);

// Plays modes as a sound of `samples` samples that is silent before `onset`.
std::vector<double> played_from(std::span<const Mode> modes, double sample_rate_hz, std::size_t onset,
                                std::size_t samples);

}  // namespace ringdown::fit
