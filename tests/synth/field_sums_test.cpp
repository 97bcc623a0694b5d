// What is heard in many channels is summed on a grid of frequencies: against closed forms, and against the sums of
// moments that the same objects take in a mixer without ambisonic channels.
#include "engine/synth/kernels/field_sums.h"

#include "tests/synth/player.h"

#include <hwy/highway.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <utility>

namespace ringdown::synth::test::field {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(FrequencyGrid, LinesSoundAsTheirModeDoesAtAnyPitchAndDecay) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const double edge = i % 4 == 0 ? 1e-3 : 1;  // near 0 and near Nyquist, too
    const double omega = i % 8 == 0 ? kPi * (1 - edge * share(random)) : kPi * edge * share(random);
    const std::complex<double> s(-0.4 * share(random) / kMomentScale, omega);
    const std::array<float, 2 * kGridReach> weights = grid_weights(s);
    for (std::size_t j = 0; j < kChunkFrames; ++j) {
      std::complex<double> sum = 0;
      for (std::size_t line = band_of(s); line < band_of(s) + kGridReach; ++line) {
        const std::size_t place = line % kGridReach;
        const double phase = (static_cast<double>(line) - 3.5) * kPi / kChunkFrames * static_cast<double>(j);
        sum += std::complex<double>(weights[place], weights[kGridReach + place]) * std::polar(1.0, phase);
      }
      ASSERT_LT(std::abs(frequency_grid().psi[j] * sum - std::exp(s * static_cast<double>(j))), 1.5e-6) << s << j;
    }
  }
}

constexpr std::size_t kHeard = 9600, kMany = 24;

// What the objects are made of. Some modes of the last one die too fast for moments.
struct Band {
  std::vector<Map> maps;
  explicit Band(std::size_t modes) {
    for (std::uint32_t o = 0; o < kMany; ++o) {
      modal::Bank bank = random_bank(o, modes, 20);
      for (std::size_t m = 0; m < bank.mode_count() && o + 1 == kMany; m += 3) bank.decay_per_s[m] = 900;
      bank.mass.reset();
      if (bank.radiation) bank.radiation->maps.origin_m = {};
      maps.push_back(map_of(std::move(bank)));
    }
  }
};

// 2 m around a listener, who hears every object turn and every other one go round.
Pose on_circle(std::size_t object, double t) {
  const double place = 2.4 * static_cast<double>(object), turns = object % 2 == 0 ? 1.5 * t : 0;
  const Vec3 toward{std::cos(place + turns) * std::cos(place), std::sin(place + turns) * std::cos(place),
                    std::sin(place)};
  return {2.0 * toward, Rotation::from_xyzw(0, std::sin(place + t), 0, std::cos(place + t))};
}

constexpr Frame kPoseEvery = 800;  // 60 a second

// Plays the band at places around a listener, or panned, each object on a bus of its own, and calls
// `take(mixer, done, frames)` for each block.
template <class Take>
void play(Mixer& mixer, const Band& band, bool placed, std::size_t block, const Take& take) {
  const auto push = [&](const Event& event) { ASSERT_TRUE(mixer.push(Producer::control, event)); };
  if (placed) push({.verb = verb::Listener{}});
  for (ObjectNumber o = 0; o < kMany; ++o) {
    ASSERT_TRUE(mixer.install(o, std::make_unique<Voice>(mixer.table_for(band.maps[o], {})), Mixer::Install::replace));
    ASSERT_TRUE(mixer.assign(o, o));
    if (o % 3 == 0) push(gain_at(0, o, 0.7));
    if (!placed) push(pan_at(0, o, std::sin(o)));
  }
  Frame next = 0;
  for (std::size_t done = 0; done < kHeard;) {
    for (; placed && next < static_cast<Frame>(done) + 3 * kPoseEvery; next += kPoseEvery) {
      for (ObjectNumber o = 0; o < kMany; ++o) {
        const Pose pose = on_circle(o, static_cast<double>(next) / kRate);
        push({.frame = next, .object = o, .verb = verb::Pose{{pose.position_m, pose.rotation}}});
      }
    }
    if (done == 0) {
      for (ObjectNumber o = 0; o < kMany; ++o) push(vertex_strike_at(300 + 61 * o, o, o % 8, {0.01, 0.02, 0.03}));
    }
    const std::size_t now = std::min(block, kHeard - done);
    take(mixer, done, now);
    done += now;
  }
}

using Channels = std::array<std::vector<float>, kMaxAmbisonicChannels>;
struct Sound {
  std::vector<float> left = std::vector<float>(kHeard), right = left;
  Channels field;
  std::array<std::vector<float>, kMany> buses;
};

Sound render(const Band& band, bool placed, std::size_t block, const MixerSettings& settings) {
  Sound sound;
  sound.field.fill(sound.left);
  sound.buses.fill(sound.left);
  Mixer mixer(kRate, settings);
  play(mixer, band, placed, block, [&](Mixer& playing, std::size_t done, std::size_t now) {
    Outputs outputs(&sound.left[done], &sound.right[done]);
    for (std::size_t o = 0; o < kMany; ++o) outputs.listen_to_bus(o, &sound.buses[o][done]);
    for (std::size_t c = 0; c < sound.field.size() && settings.ambisonic_order; ++c) {
      outputs.listen_to_ambisonics(c, &sound.field[c][done]);
    }
    playing.render(outputs, now);
  });
  return sound;
}

// Where the objects are heard from at the edges of chunks: the tracks that the mixer follows, by themselves.
struct Tracks {
  std::array<PoseTrack, kMany> tracks;
  Frame next = 0;
  AmbisonicGains gains(std::size_t object, Frame at) {
    const Vec3 way = tracks[object].at(at, kRate).pose.position_m;
    return encode((1 / length(way)) * way);
  }
  void begin_chunk(Frame begin) {
    for (; next < begin + 3 * kPoseEvery; next += kPoseEvery) {
      for (std::size_t o = 0; o < kMany; ++o) {
        tracks[o].add(next, on_circle(o, static_cast<double>(next) / kRate), begin, kRate);
      }
    }
    for (PoseTrack& track : tracks) track.advance(begin, kRate);
  }
};

// The field as it should be: what each object sounds by itself, in a mixer without ambisonic channels, times its
// harmonics, which go in straight lines for each cell, whatever the blocks.
std::array<Samples, kMaxAmbisonicChannels> exact_field(const Sound& plain, bool placed) {
  std::array<Samples, kMaxAmbisonicChannels> exact;
  exact.fill(Samples(kHeard, 0.0));
  Tracks tracks;
  for (std::size_t begin = 0; begin < kHeard;) {
    const std::size_t end = std::min(begin + kChunkFrames, kHeard);
    if (placed) tracks.begin_chunk(static_cast<Frame>(begin));
    for (std::size_t o = 0; o < kMany; ++o) {
      const double azimuth = -kPi / 6 * std::sin(static_cast<double>(o));
      AmbisonicGains from = encode({std::cos(azimuth), std::sin(azimuth), 0}), to = from;
      if (placed) from = tracks.gains(o, static_cast<Frame>(begin)), to = tracks.gains(o, static_cast<Frame>(end));
      for (std::size_t n = begin; n < end; ++n) {
        const double way = static_cast<double>(n - begin) / static_cast<double>(end - begin);
        for (std::size_t c = 0; c < from.size(); ++c) {
          exact[c][n] += (from[c] + way * (to[c] - from[c])) * static_cast<double>(plain.buses[o][n]);
        }
      }
    }
    begin = end;
  }
  return exact;
}

struct How {
  bool placed;
  std::size_t block;
};
class Field : public testing::TestWithParam<How> {};
INSTANTIATE_TEST_SUITE_P(StandingAndMoving, Field, testing::Values(How{false, 128}, How{true, 128}, How{true, 93}));

TEST_P(Field, EachChannelIsTheSumOfTheObjectsSoundsTimesTheirHarmonics) {
  const auto [placed, block] = GetParam();
  const Band band(60);
  const Sound plain = render(band, placed, block, {});
  const Sound heard = render(band, placed, block, {.ambisonic_order = kMaxAmbisonicOrder});
  const auto exact = exact_field(plain, placed);
  for (std::size_t c = 0; c < exact.size(); ++c) {
    if (!placed && peak(exact[c]) == 0) continue;  // odd across the horizon
    EXPECT_LT(relative_error_db(to_doubles(heard.field[c]), exact[c]), -110) << c;
  }
  EXPECT_LT(relative_error_db(to_doubles(heard.left), to_doubles(plain.left)), -110);
  EXPECT_LT(relative_error_db(to_doubles(heard.right), to_doubles(plain.right)), -110);
  for (std::size_t o = 0; o < kMany; ++o) {
    EXPECT_LT(relative_error_db(to_doubles(heard.buses[o]), to_doubles(plain.buses[o])), -110) << o;
  }
}

TEST(Field, EveryInstructionSetHearsTheSame) {
  const Band band(60);
  const Sound usual = render(band, true, 128, {.ambisonic_order = kMaxAmbisonicOrder});
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    const Sound heard = render(band, true, 128, {.ambisonic_order = kMaxAmbisonicOrder});
    for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
      EXPECT_LT(relative_error_db(to_doubles(heard.field[c]), to_doubles(usual.field[c])), -110)
          << c << " " << hwy::TargetName(rest & -rest);
    }
    EXPECT_LT(relative_error_db(to_doubles(heard.left), to_doubles(usual.left)), -110);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(Field, ThreadsAddUpToWhatOneThreadHears) {
  const Band band(200);
  const Sound alone = render(band, true, 128, {.ambisonic_order = kMaxAmbisonicOrder});
  const Sound together = render(band, true, 128, {.ambisonic_order = kMaxAmbisonicOrder, .threads = 3});
  for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
    EXPECT_LT(relative_error_db(to_doubles(together.field[c]), to_doubles(alone.field[c])), -120) << c;
  }
  EXPECT_LT(relative_error_db(to_doubles(together.left), to_doubles(alone.left)), -120);
  EXPECT_LT(relative_error_db(to_doubles(together.buses[kMany / 2]), to_doubles(alone.buses[kMany / 2])), -120);
}

}  // namespace
}  // namespace ringdown::synth::test::field
