// Events and blocks of the library on an audio thread: nothing in them allocates, locks or calls the system.
#include "tests/support/realtime_guard.h"

#include "engine/base/realtime.h"
#include "tests/library/mixer_of_banks.h"

#include <gtest/gtest.h>

namespace ringdown::test::realtime_test {
namespace {

TEST(LibraryOnTheAudioThread, NeitherEventsNorBlocksAllocateLockOrCallTheSystem) {
  MixerOfBanks mixer(4);
  const std::array<double, 3> point{0, 0, 0.1}, impulse{0.01, 0, 0.02};
  const std::array<double, 4> turned{1, 0, 0, 0};
  std::array<float, 64> left, right;
  ringdown_contact_args contact;
  ringdown_contact_args_init(&contact, sizeof contact);
  contact.point_m[2] = 0.1, contact.force_n[2] = 1, contact.slip_m_s = 0.3;
  ringdown_bow_args bow;
  ringdown_bow_args_init(&bow, sizeof bow);
  bow.point_m[2] = 0.1, bow.direction[0] = 1, bow.speed_m_s = 0.2, bow.force_n = 0.5;
  ringdown_mallet_args mallet;
  ringdown_mallet_args_init(&mallet, sizeof mallet);
  mallet.point_m[2] = 0.1, mallet.velocity_m_s[2] = -1;
  ringdown_couple_args coupling;
  ringdown_couple_args_init(&coupling, sizeof coupling);
  coupling.direction[2] = 1, coupling.weight_n = 1;
  bool good = true;
  ringdown_error error;
  // RealtimeSanitizer watches it as code of the audio thread, the guard where that is not there.
  TRUST_REALTIME_BEGIN
  const auto play = [&](int block) REALTIME {
    const std::int64_t frame = ringdown_now(mixer.get()) + block % 64;
    const auto object = static_cast<std::uint32_t>(block % 4);
    good = good && ringdown_strike(mixer.get(), frame, object, point.data(), impulse.data(), 0.001, &error) == 0;
    good = good && ringdown_strike_vertex(mixer.get(), frame, object, 3, impulse.data(), 0, &error) == 0;
    good = good && ringdown_click(mixer.get(), frame, object, impulse.data(), 0.001, &error) == 0;
    good = good && ringdown_contact(mixer.get(), frame, object, &contact, &error) == 0;
    if (block % 20 == 0) good = good && ringdown_bow(mixer.get(), frame, object, &bow, &error) == 0;
    if (block % 20 == 7) good = good && ringdown_mallet(mixer.get(), frame, object, &mallet, &error) == 0;
    coupling.other = (object + 1) % 4;
    if (block % 20 == 14) good = good && ringdown_couple(mixer.get(), frame, object, &coupling, &error) == 0;
    good = good && ringdown_ring(mixer.get(), frame, object, 0, 2, 0.01, &error) == 0;
    good = good && ringdown_gain(mixer.get(), frame, object, 0.5, 0.01, &error) == 0;
    good = good && ringdown_pan(mixer.get(), frame, object, -0.5, &error) == 0;
    good = good && ringdown_pose(mixer.get(), frame, object, point.data(), turned.data(), &error) == 0;
    good = good && ringdown_listener(mixer.get(), frame, impulse.data(), turned.data(), &error) == 0;
    if (block % 50 == 0) good = good && ringdown_clear(mixer.get(), frame, object, 0.01, &error) == 0;
    ringdown_render(mixer.get(), left.data(), right.data(), left.size());
  };
  TRUST_REALTIME_END
  const RealtimeScope watch;
  for (int block = 0; block < 2000; ++block) play(block);
  EXPECT_TRUE(good) << error.sentence;
  EXPECT_EQ(watch.seen().total(), 0u) << watch.seen().first;
}

}  // namespace
}  // namespace ringdown::test::realtime_test
