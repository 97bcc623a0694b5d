// Buses: what an object sends to them, what they cost when nobody listens, and that the mix does not care.
#include "tests/synth/player.h"

#include <array>

namespace ringdown::synth::test {
namespace {

constexpr std::size_t kFrames = 2000;

// What is heard of a mixer on the mix and on the first buses.
struct Heard {
  std::vector<float> left = std::vector<float>(kFrames), right = left;
  std::array<std::vector<float>, 4> buses{left, left, left, left};
};

struct Listening {
  bool mix = true;
  std::size_t buses = 4;
};

Heard listen(Mixer& mixer, std::size_t block, Listening to = {}) {
  Heard heard;
  for (std::size_t done = 0; done < kFrames;) {
    const std::size_t now = std::min(block, kFrames - done);
    Outputs outputs = to.mix ? Outputs(&heard.left[done], &heard.right[done]) : Outputs();
    for (std::size_t b = 0; b < to.buses; ++b) outputs.listen_to_bus(b, &heard.buses[b][done]);
    mixer.render(outputs, now);
    done += now;
  }
  return heard;
}

// Objects of 300 modes, so that moments are summed, or of 5, so that they are not.
std::unique_ptr<Mixer> struck_mixer(std::size_t modes) {
  auto mixer = std::make_unique<Mixer>(kRate);
  for (ObjectNumber object = 0; object < 4; ++object) {
    const Map map = map_of(random_bank(object, modes, 20));
    EXPECT_TRUE(mixer->install(object, voice_of(map), Mixer::Install::replace));
    EXPECT_TRUE(mixer->push(Producer::control, gain_at(0, object, 0.5 + 0.25 * object)));
    EXPECT_TRUE(mixer->push(Producer::control, pan_at(0, object, -1)));
    EXPECT_TRUE(mixer->push(Producer::control, vertex_strike_at(300 + 7 * object, object, 1, {100, 200, 300})));
  }
  return mixer;
}

class Buses : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(FewAndMany, Buses, testing::Values(5, 300));

TEST_P(Buses, BusesOfEachObjectAddUpToTheMix) {
  const auto mixer = struck_mixer(GetParam());
  for (ObjectNumber object = 0; object < 4; ++object) EXPECT_TRUE(mixer->assign(object, object));
  const Heard heard = listen(*mixer, 128);
  double loudest = 0;
  for (const float sample : heard.left) loudest = std::max<double>(loudest, std::abs(sample));
  ASSERT_GT(loudest, 1e-3);
  for (std::size_t n = 0; n < kFrames; ++n) {  // all are panned to the left, at gain 1 there
    double sum = 0;
    for (const auto& bus : heard.buses) sum += bus[n];
    ASSERT_NEAR(heard.left[n], sum, 2e-6 * loudest) << n;
  }
}

TEST_P(Buses, GroupsShareBusesWhichLeaveTheMixAlone) {
  const auto plain = struck_mixer(GetParam()), grouped = struck_mixer(GetParam());
  for (const ObjectNumber object : {0, 2}) EXPECT_TRUE(grouped->assign(object, 3));
  const Heard alone = listen(*plain, 100), together = listen(*grouped, 100);
  EXPECT_EQ(together.left, alone.left);
  EXPECT_EQ(together.right, alone.right);
  EXPECT_GT(peak(Samples(together.buses[3].begin(), together.buses[3].end())), 1e-3);
  for (std::size_t bus = 0; bus < 3; ++bus) EXPECT_EQ(together.buses[bus], std::vector<float>(kFrames, 0.0f));
}

TEST_P(Buses, BusesThatNobodyHearsAreNotRenderedAndTimeGoesOn) {
  const auto heard = struck_mixer(GetParam()), unheard = struck_mixer(GetParam());
  for (const auto* mixer : {&heard, &unheard}) EXPECT_TRUE((*mixer)->assign(1, 0));
  listen(*heard, 128);
  const Heard nothing = listen(*unheard, 128, {.mix = false, .buses = 0});
  EXPECT_EQ(nothing.left, std::vector<float>(kFrames, 0.0f));
  EXPECT_EQ(unheard->counters().peak, 0);
  EXPECT_EQ(unheard->counters().ringing_modes, heard->counters().ringing_modes);
  const Heard later = listen(*heard, 128), first = listen(*unheard, 128);
  for (std::size_t n = 0; n < kFrames; ++n) ASSERT_NEAR(first.left[n], later.left[n], 2e-6) << n;
}

TEST_P(Buses, AnObjectLeavesItsBusWhenToldToOrRemoved) {
  const auto mixer = struck_mixer(GetParam());
  EXPECT_TRUE(mixer->assign(0, 2));
  listen(*mixer, 128);
  EXPECT_TRUE(mixer->assign(0, std::nullopt));
  EXPECT_EQ(listen(*mixer, 128).buses[2], std::vector<float>(kFrames, 0.0f));
  EXPECT_TRUE(mixer->assign(0, 2));
  EXPECT_TRUE(mixer->remove(0));
  listen(*mixer, 128);
  EXPECT_TRUE(mixer->install(0, voice_of(map_of(random_bank(0, GetParam(), 20))), Mixer::Install::replace));
  EXPECT_TRUE(mixer->push(Producer::control, vertex_strike_at(0, 0, 1, {100, 200, 300})));
  EXPECT_EQ(listen(*mixer, 128).buses[2], std::vector<float>(kFrames, 0.0f));
}

TEST(Bus, TheLastOfAllIsHeard) {
  Mixer mixer(kRate);
  EXPECT_TRUE(mixer.install(0, voice_of(map_of(random_bank(0, 5, 20))), Mixer::Install::replace));
  EXPECT_TRUE(mixer.assign(0, kMaxBuses - 1));
  EXPECT_TRUE(mixer.push(Producer::control, vertex_strike_at(0, 0, 1, {100, 200, 300})));
  std::vector<float> last(64);
  Outputs outputs;
  outputs.listen_to_bus(kMaxBuses - 1, last.data());
  mixer.render(outputs, last.size());
  EXPECT_GT(mixer.counters().peak, 0);
}

}  // namespace
}  // namespace ringdown::synth::test
