// An object of 2000 modes that ring for hours at gain 0: with it there are so many that moments sum the slow modes of
// all objects.
#pragma once

#include "tests/synth/player.h"

#include <utility>

namespace ringdown::synth::test {

inline constexpr ObjectNumber kCompany = 1000;

inline void keep_company(Mixer& mixer) {
  static const Map kMap = [] {
    modal::Bank bank = random_bank(77, 2000, 12);
    std::ranges::fill(bank.decay_per_s, 2e-4);
    return map_of(std::move(bank));
  }();
  ASSERT_TRUE(mixer.install(kCompany, voice_of(kMap, mixer.sample_rate_hz()), Mixer::Install::replace));
  ASSERT_TRUE(mixer.push(Producer::control, gain_at(0, kCompany, 0)));
  ASSERT_TRUE(mixer.push(Producer::control, vertex_strike_at(1000, kCompany, 0, {1, 1, 1})));
}

}  // namespace ringdown::synth::test
