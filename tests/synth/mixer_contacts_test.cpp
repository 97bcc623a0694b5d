// Surfaces that slide or roll on objects: what the force is like, and that it begins, lasts and ends as it is told.
#include "engine/synth/contact/rubbing.h"

#include "tests/support/realtime_guard.h"
#include "tests/synth/player.h"

#include <limits>
#include <random>
#include <utility>

namespace ringdown::synth::test {
namespace {

Contact sliding(double force_n, double speed_m_s) { return {.force_n = {0, 0, force_n}, .slip_m_s = speed_m_s}; }
Contact rolling(double force_n, double speed_m_s) { return {.force_n = {0, 0, force_n}, .roll_m_s = speed_m_s}; }

Event contact_at(Frame frame, ObjectNumber object, const Contact& contact) {
  return {.frame = frame, .object = object, .verb = verb::Contact{{1, 1, 1}, contact}};
}

// The impulses of a contact that stays as it is told, over and over, at the very beginning.
Samples force_of(const Contact& contact, std::size_t frames, double rate = kRate) {
  Rubbing rubbing(contact.number, rate);
  Samples impulses(frames);
  for (std::size_t done = 0; done < frames; done += 64) {
    rubbing.update(static_cast<Frame>(done), contact);
    rubbing.fill(static_cast<Frame>(done), std::min<std::size_t>(64, frames - done), impulses.data() + done);
  }
  return impulses;
}

Map short_lived() {
  modal::Bank bank = random_bank(5, 60, 50);
  std::ranges::fill(bank.decay_per_s, 40.0);
  return map_of(std::move(bank));
}

double rms(std::span<const double> samples) {
  double sum = 0;
  for (const double x : samples) sum += x * x;
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

// Frames from one upward zero crossing to the next, on average.
double mean_period(std::span<const double> samples) {
  std::size_t crossings = 0;
  for (std::size_t n = 1; n < samples.size(); ++n) crossings += samples[n - 1] < 0 && samples[n] >= 0 ? 1 : 0;
  return static_cast<double>(samples.size()) / static_cast<double>(crossings);
}

// The mean square slope of octaves of cubic B-splines: each has 1/3 * 2/3 of (height / spacing)^2, as the integral of
// B'(u)^2 is 2/3 and that of B(u)^2 is 151/315.
TEST(Rubbing, TheForceOfRubbingFollowsTheSlopeOfTheSurface) {
  const Contact contact = sliding(3, 0.004);  // so slow that all octaves pass well below Nyquist
  const auto& texture = contact.texture;
  double power = 0, slope = 0;
  for (int octave = 0; octave < 5; ++octave) {
    const double share = std::pow(2.0, octave * (texture.spectral_slope + 1));
    const double spacing = 0.5 * texture.correlation_m / std::pow(2.0, octave);
    power += share * 151.0 / 315;
    slope += share * (2.0 / 3) / (spacing * spacing);
  }
  const double expected = 3 * texture.roughness_m * std::sqrt(slope / power) / kRate;
  const Samples force = force_of(contact, 4'000'000);
  EXPECT_NEAR(rms(std::span(force).subspan(48000)), expected, 0.03 * expected);
}

TEST(Rubbing, RubbingFollowsTheSpeedInPitchAndTheLoadInLevel) {
  const Samples slow = force_of(sliding(1, 0.003), 400'000), fast = force_of(sliding(1, 0.006), 400'000);
  EXPECT_NEAR(mean_period(slow) / mean_period(fast), 2, 0.1);
  const Samples loaded = force_of(sliding(5, 0.003), 400'000);
  for (std::size_t n = 1000; n < loaded.size(); n += 997) ASSERT_NEAR(loaded[n], 5 * slow[n], 1e-12);
}

TEST(Rubbing, RollingIsSofterAndOnLongerWavesThanSliding) {
  const Samples slides = force_of(sliding(1, 0.003), 400'000),
                rolls = force_of(rolling(1, 0.003 * kRollingRatio), 400'000);
  EXPECT_NEAR(mean_period(rolls) / mean_period(slides), 1, 0.1);
  EXPECT_NEAR(rms(slides) / rms(rolls), kRollingRatio, 0.1 * kRollingRatio);
}

TEST(Rubbing, RubbingSoundsAlikeAtEverySampleRate) {
  const Contact contact = sliding(1, 0.003);
  const double level = rms(force_of(contact, 480'000)) * kRate;
  EXPECT_NEAR(rms(force_of(contact, 960'000, 96000)) * 96000, level, 0.03 * level);
}

TEST(Rubbing, RoughnessThatPassesFasterThanNyquistIsLeftOut) {
  const Samples force = force_of(sliding(1, 1000), 48000);
  EXPECT_LT(peak(std::span(force).subspan(40000)), 1e-12 * peak(force));
  const Samples near = force_of(sliding(1, 0.6), 48000);  // the longest waves at 12 kHz
  EXPECT_GT(rms(near), 0);
  EXPECT_LT(peak(near), 10 * rms(near));
}

TEST(Rubbing, StandingStillMakesNoForce) {
  Rubbing rubbing(1, kRate);
  Samples impulses(48000);
  rubbing.update(0, sliding(1, 0.02));
  rubbing.fill(0, 2400, impulses.data());
  for (std::size_t at = 2400; at < impulses.size(); at += 1200) {
    rubbing.update(static_cast<Frame>(at), sliding(1, 0));
    rubbing.fill(static_cast<Frame>(at), 1200, impulses.data() + at);
  }
  EXPECT_GT(peak(std::span(impulses).first(2400)), 0);
  EXPECT_LT(peak(std::span(impulses).subspan(24000)), 1e-9 * peak(impulses));
}

TEST(Rubbing, RubbingEndsWhenItIsToldToAndWhenUpdatesStop) {
  for (const bool told : {true, false}) {
    Rubbing rubbing(1, kRate);
    Samples impulses(9600);
    rubbing.update(0, sliding(1, 0.02));
    rubbing.fill(0, 480, impulses.data());
    if (told) rubbing.update(480, sliding(0, 0));
    rubbing.fill(480, impulses.size() - 480, impulses.data() + 480);
    const std::size_t last = told ? 480 + 240 : 4800 + 240 + 1;
    EXPECT_GT(rubbing.over_from(), static_cast<Frame>(last) - 2);
    EXPECT_LE(rubbing.over_from(), static_cast<Frame>(last));
    EXPECT_GT(peak(std::span(impulses).subspan(last - 100, 100)), 0);
    EXPECT_EQ(peak(std::span(impulses).subspan(last)), 0);
    // Neither its beginning nor its end is a step.
    EXPECT_LE(largest_step(impulses, 1, impulses.size()), 1.2 * largest_step(impulses, 1, told ? 480 : 4480));
  }
}

TEST(Contacts, ContactsAreHeardAsLongAsTheyLast) {
  Player player;
  player.install(0, short_lived());
  for (Frame frame = 480; frame < 24000; frame += 240) player.push(contact_at(frame, 0, sliding(1, 0.1)));
  player.push(contact_at(24000, 0, sliding(0, 0)));
  player.render(48000);
  EXPECT_EQ(peak(std::span(player.left).first(480)), 0);
  const double loud = rms(std::span(player.left).subspan(9600, 14400));
  EXPECT_GT(loud, 0);
  EXPECT_NEAR(rms(std::span(player.left).subspan(4800, 4800)), loud, 0.5 * loud);
  EXPECT_LT(rms(player.left_from(43200)), 1e-3 * loud);
  EXPECT_LE(largest_step(player.left, 1, player.left.size()), 1.2 * largest_step(player.left, 4800, 23800));
  player.render(96000);
  EXPECT_EQ(player.mixer.counters().ringing_voices, 0u);
}

TEST(Contacts, ContactsOfALostSenderEndByThemselves) {
  Player player;
  player.install(0, short_lived());
  player.push(contact_at(0, 0, sliding(1, 0.1)));
  player.render(48000);
  EXPECT_GT(rms(std::span(player.left).first(4800)), 0);
  player.render(96000);
  EXPECT_EQ(player.mixer.counters().ringing_voices, 0u);
}

TEST(Contacts, ContactsSoundTheSameInAnyBlocksAndOnAnyThreads) {
  Samples reference;
  for (const auto& [block, threads] :
       {std::pair<std::size_t, std::size_t>{256, 1}, {1, 1}, {100, 1}, {1024, 1}, {256, 2}}) {
    Player player;
    set(player.mixer, &MixerSettings::threads, threads);
    const Map map = short_lived();
    for (ObjectNumber object = 0; object < 2; ++object) player.install(object, map);
    player.push(strike_at(77, 1, {0, 0, 0.01}));
    for (Frame frame = 480; frame < 9600; frame += 203) {
      Contact contact = sliding(1 + 1e-5 * static_cast<double>(frame), 0.02);
      player.push(contact_at(frame, 0, contact));
      contact.number = 1, contact.roll_m_s = 0.5;
      player.push(contact_at(frame + 5, 1, contact));
    }
    player.push(gain_at(5000, 0, 0.3, 0.01));
    player.render(12000, block);
    if (reference.empty()) reference = player.left;
    for (std::size_t n = 0; n < reference.size(); ++n) {
      ASSERT_NEAR(player.left[n], reference[n], 3e-6 * peak(reference)) << "blocks of " << block << ", frame " << n;
    }
  }
}

TEST(Contacts, ContactsOfOneObjectAreFourAtATimeAndMoreAreCounted) {
  Player player;
  player.install(0, short_lived());
  for (std::uint32_t number = 0; number < kMaxForces + 1; ++number) {
    Contact contact = sliding(1, 0.1);
    contact.number = number;
    player.push(contact_at(0, 0, contact));
  }
  player.render(256);
  EXPECT_EQ(player.mixer.counters().refused, 1u);
}

// Twelve contacts of two objects come and go by chance, so that often all places are taken and one is given back just
// before or after the next is asked for. Pulses take places, too.
TEST(Contacts, WhichContactsFindAPlaceDoesNotDependOnWhereBlocksEnd) {
  Samples reference;
  std::uint64_t refused = 0;
  for (const std::size_t block : {1000000u, 1u, 64u, 255u, 1024u}) {
    Player player;
    for (ObjectNumber object = 0; object < 3; ++object) player.install(object, short_lived());
    std::mt19937 random(7);
    const auto below = [&random](std::uint32_t limit) { return static_cast<std::uint32_t>(random() % limit); };
    for (Frame frame = 0; frame < 24000; frame += 1 + below(60)) {
      const std::uint32_t number = below(12);
      Contact contact = below(3) == 0 ? sliding(0, 0) : sliding(0.1 * (1 + below(10)), 0.1);
      contact.number = number;
      player.push(contact_at(frame, number % 2, contact));
      if (below(10) == 0) player.push(strike_at(frame, number % 2, {0, 0, 0.001}, 0.0005));
      if (below(100) == 0) player.push({.frame = frame, .object = number % 2, .verb = verb::Clear{0.01}});
    }
    player.render(26000, block);
    if (reference.empty()) {
      reference = player.left;
      refused = player.mixer.counters().refused;
      EXPECT_GT(refused, 20u) << "otherwise nothing is tested";
    }
    EXPECT_EQ(player.mixer.counters().refused, refused) << "blocks of " << block;
    EXPECT_LT(relative_error_db(player.left, reference), -110) << "blocks of " << block;
  }
}

TEST(Contacts, ContactsThatAreNotNumbersAreRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  Player player;
  player.install(0, short_lived());
  std::uint64_t refused = 0;
  for (const double bad : {kNan, kInfinity, -1.0, 1e9}) {
    for (int field = 0; field < 6; ++field) {
      Contact contact = sliding(1, 0.1);
      double* const fields[] = {&contact.force_n.x,
                                &contact.slip_m_s,
                                &contact.roll_m_s,
                                &contact.texture.roughness_m,
                                &contact.texture.correlation_m,
                                &contact.texture.spectral_slope};
      if (field == 0 && bad == -1) continue;  // a force may point anywhere
      if (field == 5 && bad == -1) continue;
      *fields[field] = bad;
      player.push(contact_at(static_cast<Frame>(player.left.size()), 0, contact));
      player.render(256);
      EXPECT_EQ(player.mixer.counters().refused, ++refused) << bad << " in field " << field;
    }
  }
  EXPECT_EQ(peak(player.left), 0);
}

TEST(Contacts, ContactsAreRealTimeSafe) {
  Player player;
  player.install(0, short_lived());
  std::vector<float> left(256), right(256);
  for (int block = 0; block < 100; ++block) {
    player.push(contact_at(block * 256 + 9, 0, sliding(block % 10 == 9 ? 0 : 1, 0.1)));
    const RealtimeScope scope;
    player.mixer.render(left, right);
    ASSERT_EQ(scope.seen().total(), 0u) << scope.seen().first;
  }
}

}  // namespace
}  // namespace ringdown::synth::test
