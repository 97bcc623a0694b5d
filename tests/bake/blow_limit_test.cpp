// Blows that thin objects are spared, and the kernel of modes that exchange energy.
#include "engine/synth/kernels/coupled_kernel.h"
#include "engine/synth/meters.h"
#include "engine/synth/modes/blow_limit.h"
#include "engine/synth/modes/coupled_modes.h"
#include "engine/synth/modes/glide.h"
#include "tests/bake/struck_plate.h"
#include "tests/synth/fake_clock.h"
#include "tests/synth/player.h"

#include <cstdlib>
#include <random>
#include <utility>

namespace ringdown::synth::test {
namespace {

verb::StrikeVertex blow(double impulse_ns) {
  return {.vertex = 0, .impulse_ns = {0, 0, impulse_ns}, .contact_time_s = 0};
}

// What part of a blow is left.
double share_of(double impulse_ns, MixerCounters* counters = nullptr) {
  const auto amplitude = [&](bool nonlinear) {
    Voice voice(map_of(steel_plate(), nonlinear), modal::MaterialScale{}, kRate_hz);
    EXPECT_TRUE(voice.strike(blow(impulse_ns), counters));
    return voice.peak_level(0);  // pitch does not change it
  };
  return amplitude(true) / amplitude(false);
}

TEST(BlowLimit, BlowsBelowThreeThicknessesArePlayedWhole) {
  MixerCounters counters;
  EXPECT_EQ(share_of(0.36, &counters), 1);
  EXPECT_EQ(counters.limited.load(), 0u);
}

// The equations say how far a plate bends under what is left of a blow.
TEST(BlowLimit, HarderOnesBendThePlateByThreeThicknesses) {
  double last = 0;
  for (const double impulse_ns : {1.5, 5.0, 50.0}) {
    MixerCounters counters;
    const double share = share_of(impulse_ns, &counters);
    EXPECT_EQ(counters.limited.load(), 1u) << impulse_ns;
    double peak_m = 0;
    static_cast<void>(integrated(steel_plate(), share * impulse_ns, peak_m));
    std::printf("%g N s: %.3f of it is left, which bends the plate by %.2f thicknesses\n", impulse_ns, share,
                peak_m / kThickness_m);
    EXPECT_NEAR(peak_m / kThickness_m, 3, 0.3);
    if (last > 0) {
      EXPECT_NEAR(share * impulse_ns, last, 0.01 * last) << "the same is left of all";
    }
    last = share * impulse_ns;
  }
}

TEST(BlowLimit, WhatRingsCountsExchangingEnergyOrNot) {
  for (const int coupled : {0, kModes}) {
    Voice voice(map_of(steel_plate(), true, coupled), modal::MaterialScale{}, kRate_hz);
    MixerCounters counters;
    for (int i = 0; i < 40; ++i) {
      EXPECT_TRUE(voice.strike(blow(0.36), &counters));
      std::array<double, kChunkFrames> out{};
      EXPECT_TRUE(voice.render(out.data(), out.size(), 1e-12));
      EXPECT_EQ(voice.coupling.running(), coupled > 0);
    }
    EXPECT_GT(counters.limited.load(), 5u);
    double squares = 0;
    std::array<float, kMaxGlidingModes> of{};
    voice.coupling.add_squares(of.data());
    for (std::size_t m = 0; m < kModes; ++m) squares += of[m] * voice.table().glide->bend[m];
    if (coupled > 0) {
      EXPECT_GT(squares, std::pow(kMaxThicknesses / kCrest, 2)) << "stiffened ones bend less";
    }
  }
}

TEST(CoupledForces, AreTheGradientOfTheEnergyForAnyNumberOfModes) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  for (const std::size_t stride : {16u, 32u, 48u, 64u, 80u, 304u}) {
    constexpr std::size_t kCount = 5;
    auto bending = aligned_zeros<float>(kCount * stride * stride), curving = aligned_zeros<float>(kCount * stride);
    auto q = aligned_zeros<float>(stride), gradient = aligned_zeros<float>(stride);
    for (std::size_t k = 0; k < kCount; ++k) {
      for (std::size_t i = 0; i < stride; ++i) {
        curving[k * stride + i] = normal(random);
        for (std::size_t j = 0; j <= i; ++j)
          bending[(k * stride + i) * stride + j] = bending[(k * stride + j) * stride + i] = normal(random);
      }
    }
    for (std::size_t i = 0; i < stride; ++i) q[i] = normal(random);
    const double energy = coupled_forces({bending.get(), curving.get(), kCount, stride}, q.get(), gradient.get());
    double wanted_energy = 0, error = 0, size = 0;
    std::vector<double> wanted(stride);
    for (std::size_t k = 0; k < kCount; ++k) {
      double t = 0, g = 0;
      std::vector<double> hq(stride);
      for (std::size_t i = 0; i < stride; ++i) {
        for (std::size_t j = 0; j < stride; ++j) hq[i] += double{bending[(k * stride + i) * stride + j]} * double{q[j]};
        t += hq[i] * double{q[i]};
        g += double{curving[k * stride + i]} * double{q[i]};
      }
      wanted_energy += g * t + 0.5 * t * t;
      for (std::size_t i = 0; i < stride; ++i) wanted[i] += 2 * (t + g) * hq[i] + t * double{curving[k * stride + i]};
    }
    for (std::size_t i = 0; i < stride; ++i) {
      error += std::pow(double{gradient[i]} - wanted[i], 2);
      size += wanted[i] * wanted[i];
    }
    EXPECT_NEAR(energy, wanted_energy, 1e-4 * std::abs(wanted_energy)) << stride;
    EXPECT_LT(std::sqrt(error / size), 1e-5) << stride;
  }
}

TEST(CoupledModes, AreAsManyAsTheMixerAllows) {
  const auto map = map_of(steel_plate(), true, kModes);
  const auto modes_of = [&](std::size_t max) {
    return ModeTable(map, modal::MaterialScale{}, kRate_hz, {}, {}, {.max_coupled = max}).coupled->columns.size();
  };
  EXPECT_EQ(modes_of(64), std::size_t{kModes});
  EXPECT_EQ(modes_of(6), 6u);
}

// A plate whose modes exchange energy, in a mixer whose clock makes a chunk of them take `load` of its time.
struct Busy {
  explicit Busy(double load) {
    set(player.mixer, &MixerSettings::clock, kFake);
    set(player.mixer, &MixerSettings::budget, 0.8);
    auto voice = std::make_unique<Voice>(map_of(steel_plate(), true, kModes), modal::MaterialScale{}, kRate_hz);
    fake_unit_ns = load * kChunkFrames * 1e9 / kRate_hz / voice->coupling.units(kChunkFrames);
    EXPECT_TRUE(player.mixer.install(0, std::move(voice), Mixer::Install::replace));
  }
  // For how many chunks after a blow they exchanged energy; and whether a mode was muted.
  std::pair<int, bool> strike() {
    const Mixer& mixer = player.mixer;
    for (int block = 0; block < 100; ++block) player.render(kChunkFrames, kChunkFrames);
    player.push({.frame = mixer.counters().frames.load(),
                 .verb = verb::StrikeVertex{.vertex = 0, .impulse_ns = {0, 0, 0.1}, .contact_time_s = 0}});
    int coupled = 0;
    bool muted = false;
    for (int block = 0; block < 200; ++block) {
      player.render(kChunkFrames, kChunkFrames);
      coupled += mixer.counters().coupled_voices.load() > 0 ? 1 : 0;
      muted = muted || (block > 50 && mixer.counters().muted_modes.load() > 0);
    }
    return {coupled, muted};
  }
  Player player;
};

TEST(CoupledModes, TakeTimeOnlyWhereThereIsTime) {
  EXPECT_EQ(Busy(0.3).strike(), std::pair(200, false));
  Busy busy(1.5);
  EXPECT_LT(busy.strike().first, 10) << "what they cost is not known before";
  EXPECT_EQ(busy.strike(), std::pair(0, false)) << "they glide instead, and nothing else is lost";
}

}  // namespace
}  // namespace ringdown::synth::test
