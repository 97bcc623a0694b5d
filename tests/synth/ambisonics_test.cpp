// Ambisonic channels, and what a head's ears hear of them.
#include "engine/synth/kernels/ambisonics.h"

#include "engine/synth/output/binaural.h"
#include "tests/synth/player.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace ringdown::synth::test {
namespace {

constexpr std::size_t kHeard = 1500;

// Rendered together: the object's own bus, left and right, and all ambisonic channels.
struct Field {
  std::vector<float> bus = std::vector<float>(kHeard), left = bus, right = bus;
  std::array<std::vector<float>, kMaxAmbisonicChannels> channels;
};

Field listen(Mixer& mixer, std::size_t block) {
  Field field;
  for (auto& channel : field.channels) channel = field.bus;
  for (std::size_t done = 0; done < kHeard;) {
    const std::size_t now = std::min(block, kHeard - done);
    Outputs outputs(&field.left[done], &field.right[done]);
    outputs.listen_to_bus(0, &field.bus[done]);
    for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) outputs.listen_to_ambisonics(c, &field.channels[c][done]);
    mixer.render(outputs, now);
    done += now;
  }
  return field;
}

std::unique_ptr<Mixer> ambisonic_mixer(HeadLoader head = {}) {
  return std::make_unique<Mixer>(kRate, MixerSettings{.ambisonic_order = kMaxAmbisonicOrder, .head = std::move(head)});
}

// Integrals over the sphere by Gauss' two-dimensional product of midpoints, which is good enough for polynomials.
TEST(Ambisonics, HarmonicsAreOrthogonalAndNormalisedAsSn3dSays) {
  constexpr int kRows = 400, kColumns = 64;
  std::array<std::array<double, kMaxAmbisonicChannels>, kMaxAmbisonicChannels> mean{};
  for (int i = 0; i < kRows; ++i) {
    const double z = -1 + (2.0 * i + 1) / kRows, r = std::sqrt(1 - z * z);
    for (int j = 0; j < kColumns; ++j) {
      const double turn = 2 * std::numbers::pi * j / kColumns;
      const AmbisonicGains gains = encode({r * std::cos(turn), r * std::sin(turn), z});
      for (std::size_t a = 0; a < gains.size(); ++a) {
        for (std::size_t b = 0; b < gains.size(); ++b) mean[a][b] += gains[a] * gains[b] / (kRows * kColumns);
      }
    }
  }
  for (std::size_t a = 0; a < kMaxAmbisonicChannels; ++a) {
    const double degree = std::floor(std::sqrt(static_cast<double>(a)));
    for (std::size_t b = 0; b < kMaxAmbisonicChannels; ++b) {
      EXPECT_NEAR(mean[a][b], a == b ? 1 / (2 * degree + 1) : 0, 1e-4) << a << " " << b;
    }
  }
}

// ACN and the axes by the standard's own words: channel 1 points to the left, 2 up, 3 to the front.
TEST(Ambisonics, TheFirstChannelsPointToTheLeftUpAndToTheFront) {
  EXPECT_EQ(encode({0, 1, 0})[1], 1);
  EXPECT_EQ(encode({0, 0, 1})[2], 1);
  EXPECT_EQ(encode({1, 0, 0})[3], 1);
  EXPECT_EQ(encode({0.6, 0, -0.8})[0], 1);
  EXPECT_EQ(encode({0, 0, 1})[6], 1);
  EXPECT_EQ(encode({0, 0, 1})[12], 1);
}

class AmbisonicObject : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(FewAndManyModes, AmbisonicObject, testing::Values(5, 300));

TEST_P(AmbisonicObject, EachChannelHasTheObjectsSoundTimesItsHarmonic) {
  for (const double pan : {-1.0, 0.0, 0.7}) {
    const auto mixer = ambisonic_mixer();
    ASSERT_TRUE(mixer->install(0, voice_of(map_of(random_bank(3, GetParam(), 20))), Mixer::Install::replace));
    ASSERT_TRUE(mixer->assign(0, 0));
    ASSERT_TRUE(mixer->push(Producer::control, pan_at(0, 0, pan)));
    ASSERT_TRUE(mixer->push(Producer::control, vertex_strike_at(700, 0, 1, {100, 200, 300})));
    const Field field = listen(*mixer, 100);
    const double loudest = peak(test::to_doubles(field.bus));
    ASSERT_GT(loudest, 1e-3);
    const double azimuth = -pan * std::numbers::pi / 6;
    const AmbisonicGains gains = encode({std::cos(azimuth), std::sin(azimuth), 0});
    for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
      for (std::size_t n = 0; n < kHeard; ++n) {
        ASSERT_NEAR(field.channels[c][n], gains[c] * field.bus[n], 2e-6 * loudest) << c << " at " << n;
      }
    }
  }
}

TEST_P(AmbisonicObject, ObjectsThatShareTheirStatesAreHeardAsIfTheyDidNot) {
  const Map map = map_of(random_bank(4, GetParam(), 20));
  const auto shared = ambisonic_mixer();
  Field sum;
  for (auto& channel : sum.channels) channel = sum.bus;
  const auto table = voice_of(map)->shared_table();
  for (ObjectNumber object = 0; object < 3; ++object) {
    const auto alone = ambisonic_mixer();
    for (Mixer* const mixer : {shared.get(), alone.get()}) {
      const ObjectNumber number = mixer == alone.get() ? 0 : object;
      auto voice = std::make_unique<Voice>(mixer->table_for(map, {}));
      ASSERT_TRUE(mixer->install(number, std::move(voice), Mixer::Install::replace));
      ASSERT_TRUE(mixer->push(Producer::control, pan_at(0, number, object - 1.0)));
      ASSERT_TRUE(mixer->push(Producer::control, vertex_strike_at(200 + 90 * object, number, object, {1, 200, 300})));
    }
    const Field field = listen(*alone, 128);
    for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
      for (std::size_t n = 0; n < kHeard; ++n) sum.channels[c][n] += field.channels[c][n];
    }
  }
  const Field heard = listen(*shared, 128);
  for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
    const Samples exact = to_doubles(sum.channels[c]);
    if (peak(exact) == 0) {
      EXPECT_EQ(peak(to_doubles(heard.channels[c])), 0) << c << ": odd across the horizon";
    } else {
      EXPECT_LT(relative_error_db(to_doubles(heard.channels[c]), exact), -100) << c;
    }
  }
}

// Filters of noise, 77 taps: for every channel and ear another.
std::shared_ptr<const HeadFilters> noisy_head() {
  auto head = std::make_shared<HeadFilters>();
  head->taps = 77;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(-1, 1);
  for (auto& ear : head->reversed) {
    ear.resize(kMaxAmbisonicChannels * head->taps);
    for (float& tap : ear) tap = any(random);
  }
  return head;
}

TEST(Binaural, EarsHearTheConvolutionWhateverTheBlock) {
  const auto head = noisy_head();
  for (const std::size_t block : {1u, 64u, 255u, 1500u}) {
    const auto mixer = ambisonic_mixer([&](double) { return head; });
    for (ObjectNumber object = 0; object < 2; ++object) {
      ASSERT_TRUE(mixer->install(object, voice_of(map_of(random_bank(object, 40, 200))), Mixer::Install::replace));
      ASSERT_TRUE(mixer->push(Producer::control, pan_at(0, object, object == 0 ? -1 : 0.5)));
      ASSERT_TRUE(mixer->push(Producer::control, vertex_strike_at(300, object, 1, {100, 200, 300})));
    }
    const Field field = listen(*mixer, block);
    for (std::size_t ear = 0; ear < 2; ++ear) {
      Samples exact(kHeard);
      for (std::size_t n = 0; n < kHeard; ++n) {
        for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
          for (std::size_t j = 0; j < head->taps && j <= n; ++j) {
            exact[n] +=
                static_cast<double>(head->reversed[ear][(c + 1) * head->taps - 1 - j]) * field.channels[c][n - j];
          }
        }
      }
      const auto& heard = ear == 0 ? field.left : field.right;
      EXPECT_GT(peak(exact), 1e-3);
      EXPECT_LT(relative_error_db(to_doubles(heard), exact), -110) << block;
    }
  }
}

TEST(Binaural, FiltersRingOutAfterTheLastSoundAndThenThereIsSilence) {
  const auto head = noisy_head();
  const auto mixer = ambisonic_mixer([&](double) { return head; });
  ASSERT_TRUE(mixer->install(0, voice_of(map_of(random_bank(1, 5, 20))), Mixer::Install::replace));
  ASSERT_TRUE(mixer->push(Producer::control, vertex_strike_at(0, 0, 1, {100, 200, 300})));
  std::vector<float> left(4096), right = left;
  mixer->render(std::span(left).first(256), std::span(right).first(256));
  ASSERT_TRUE(mixer->push(Producer::control, Event{.frame = 256, .object = 0, .verb = verb::Clear{}}));
  mixer->render(left, right);
  EXPECT_GT(peak(to_doubles(std::span(left).first(300))), 0);
  EXPECT_EQ(peak(to_doubles(std::span(left).subspan(2048))), 0) << "the fade is 512 frames long, the filters 77";
}

}  // namespace
}  // namespace ringdown::synth::test
