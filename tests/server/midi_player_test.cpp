// Notes as a listener hears them: the player and a mixer, no JACK.
#include "server/session/midi_player.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace ringdown::session {
namespace {

using test::Samples;

constexpr double kRate = 48000;
constexpr std::uint8_t kOn = 0x90, kOff = 0x80, kControl = 0xb0, kPressure = 0xd0, kKeyPressure = 0xa0, kSostenuto = 66,
                       kSustain = 64, kDamp = 67;

class MidiPlayerTest : public testing::Test {
 protected:
  MidiPlayerTest() {
    for (synth::ObjectNumber object = 0; object < 2; ++object) {
      const auto map = std::make_shared<const modal::StrikeMap>(test::shared(test::single_mode_bank(1000, 0.1)));
      auto voice = std::make_unique<synth::Voice>(map, modal::MaterialScale{}, kRate);
      EXPECT_TRUE(mixer_.install(object, std::move(voice), synth::Mixer::Install::replace));
    }
    table_.notes[60] =
        NoteTable::Strike{.object = 0, .point_m = {1, 0, 0}, .impulse_ns = {0, 0, 1}, .contact_time_s = 0};
    table_.notes[61] =
        NoteTable::Strike{.object = 1, .point_m = {1, 0, 0}, .impulse_ns = {0, 0, 1}, .contact_time_s = 0};
    table_.notes[62] = table_.notes[60];  // the same object again
  }

  void play(std::uint8_t status, std::uint8_t first, std::uint8_t second, synth::Frame after = 0) {
    const std::array<std::uint8_t, 3> message{status, first, second};
    player_.play(message, mixer_.counters().frames + after, table_, mixer_, played_);
  }

  // The loudest sample of the next frames.
  double hear(std::size_t frames) {
    std::vector<float> left(frames), right(frames);
    mixer_.render(left, right);
    last_ = test::to_doubles(left);
    return test::peak(last_);
  }

  // The bows' moves since the last call.
  std::vector<synth::verb::Bow> bows() {
    std::vector<synth::verb::Bow> all;
    for (; const synth::Event* event = played_.front(); played_.pop()) {
      if (const auto* bow = event->verb.get_if<synth::verb::Bow>()) all.push_back(*bow);
    }
    return all;
  }

  synth::Mixer mixer_{kRate};
  NoteTable table_;
  SpscRing<synth::Event> played_{64};
  MidiPlayer player_;
  Samples last_;
};

TEST_F(MidiPlayerTest, ANoteLandsOnItsSample) {
  play(kOn, 60, 127, 137);
  hear(1000);
  EXPECT_EQ(test::peak(std::span(last_).first(138)), 0) << "a sine begins at zero";
  EXPECT_NE(last_[138], 0);
}

TEST_F(MidiPlayerTest, HalfTheVelocityIsAQuarterOfTheImpulse) {
  play(kOn, 60, 127);
  const double loud = hear(480);
  play(kControl, 120, 0);
  hear(2000);
  play(kOn, 60, 64);
  EXPECT_NEAR(hear(480) / loud, std::pow(64.0 / 127, 2), 1e-3);
}

TEST_F(MidiPlayerTest, ASoftBlowIsDuller) {
  table_.notes[60]->contact_time_s = 3e-4;
  play(kOn, 60, 127);
  const double loud = hear(480);
  play(kControl, 120, 0);
  hear(2000);
  play(kOn, 60, 20);
  const double quiet = hear(480), share = std::pow(20.0 / 127, 2);
  // The half sine's spectrum at 1 kHz, for a contact (1 / share)^(1/5) times as long.
  const auto spectrum = [](double tau) { return std::cos(M_PI * 1000 * tau) / (1 - std::pow(2 * 1000 * tau, 2)); };
  EXPECT_NEAR(quiet / loud, share * spectrum(3e-4 * std::pow(share, -0.2)) / spectrum(3e-4), 1e-3 * share);
}

TEST_F(MidiPlayerTest, NotesRingOnWhenReleasedUnlessTheMapSaysOtherwise) {
  play(kOn, 60, 127);
  const double loud = hear(480);
  play(kOff, 60, 0);
  hear(48000);
  EXPECT_GT(hear(480), 0.8 * loud);
  table_.release_s = 0.1;
  play(kOn, 60, 1);
  play(kOff, 60, 0);
  hear(2400);
  EXPECT_NEAR(hear(48) / loud, 0.5, 0.06) << "half way through the damping";
  hear(2400);
  EXPECT_EQ(hear(480), 0);
}

TEST_F(MidiPlayerTest, TheSustainPedalKeepsReleasedNotesUntilItIsLifted) {
  table_.release_s = 0.01;
  play(kControl, kSustain, 127);
  play(kOn, 60, 127);
  play(kOn, 61, 127);
  play(kOff, 60, 0);
  hear(9600);
  EXPECT_GT(hear(480), 0);
  EXPECT_EQ(mixer_.counters().ringing_voices, 2u);
  play(kControl, kSustain, 0);
  hear(960);
  hear(128);
  EXPECT_EQ(mixer_.counters().ringing_voices, 1u) << "the key that is still down";
}

TEST_F(MidiPlayerTest, TheDampPedalIsAHandOnEverything) {
  table_.damp_s = 0.05;
  play(kOn, 60, 127);
  play(kOff, 60, 0);
  play(kOn, 61, 127);
  hear(480);
  play(kControl, kDamp, 127);
  hear(2600);
  EXPECT_EQ(hear(480), 0);
  play(kOn, 60, 127);
  EXPECT_GT(hear(480), 0) << "struck under the hand it sounds as long as the key is down";
  play(kOn, 60, 0);  // a note on of velocity 0 is a note off
  hear(2600);
  EXPECT_EQ(hear(480), 0);
}

TEST_F(MidiPlayerTest, AnObjectThatAnotherKeyHoldsIsNotDamped) {
  table_.release_s = 0.01;
  play(kOn, 60, 127);
  play(kOn, 62, 127);
  play(kOff, 60, 0);
  hear(4800);
  EXPECT_GT(hear(480), 0);
  play(kOff, 62, 0);
  hear(4800);
  EXPECT_EQ(hear(480), 0);
}

// RP-015 of the MIDI Association: pedals up.
TEST_F(MidiPlayerTest, ResetAllControllersLiftsThePedalsOfItsChannel) {
  table_.release_s = 0.1;
  table_.damp_s = 0.02;
  for (const std::uint8_t pedal : {kSustain, kSostenuto}) {
    play(kOn, 60, 127);
    play(kControl, pedal, 127);
    play(kOff, 60, 0);
    play(kControl | 1, 121, 0);
    hear(9600);
    EXPECT_GT(hear(480), 0) << "another channel's reset";
    play(kControl, 121, 0);
    hear(14400);
    EXPECT_EQ(hear(480), 0) << int{pedal};
    play(kOn, 60, 127);
    play(kOff, 60, 0);
    hear(14400);
    EXPECT_EQ(hear(480), 0) << "later notes are not kept";
  }
  play(kControl, kDamp, 127);
  play(kControl, 121, 0);
  play(kOn, 60, 127);
  play(kOff, 60, 0);
  hear(2400);
  EXPECT_GT(hear(48), 0) << "released as without the damp pedal, under which it would be silent by now";
}

TEST_F(MidiPlayerTest, ChangesOfModeEndTheNotesOfTheirChannel) {
  table_.release_s = 0.01;
  for (const std::uint8_t controller : {123, 124, 125, 126, 127}) {
    play(kOn | 2, 60, 127);
    play(kOn | 3, 61, 127);
    play(kControl | 2, controller, 0);
    hear(960);
    hear(128);
    EXPECT_EQ(mixer_.counters().ringing_voices, 1u) << int{controller};
    play(kOff | 2, 60, 0);  // comes too late
    play(kControl | 3, controller, 0);
    hear(960);
    EXPECT_EQ(hear(480), 0) << int{controller};
  }
}

TEST_F(MidiPlayerTest, SystemResetEndsEverything) {
  table_.notes[62]->bow = {.direction = {0, 0, 1}, .speed_m_s = 0.1, .force_n = 40};
  for (const std::size_t length : {1u, 3u}) {
    play(kControl, kSustain, 127);
    play(kOn | 5, 61, 127);
    play(kOn | 6, 62, 127);
    hear(4800);
    EXPECT_GT(hear(480), 0);
    const std::array<std::uint8_t, 3> reset{0xff, 0xff, 0xff};
    player_.play(std::span(reset).first(length), mixer_.counters().frames, table_, mixer_, played_);
    hear(4800);
    EXPECT_EQ(hear(480), 0);
    table_.release_s = 0.01;  // and the pedal is up
    play(kOn, 61, 127);
    play(kOff, 61, 0);
    hear(960);
    EXPECT_EQ(hear(480), 0);
    while (played_.front()) played_.pop();
  }
}

TEST_F(MidiPlayerTest, SostenutoKeepsTheKeysThatWereDownWhenItWentDown) {
  table_.release_s = 0.01;
  play(kOn, 60, 127);
  play(kControl, kSostenuto, 127);
  play(kOn, 61, 127);
  play(kOff, 60, 0);
  play(kOff, 61, 0);
  hear(4800);
  hear(128);
  EXPECT_EQ(mixer_.counters().ringing_voices, 1u) << "61 came later";
  play(kControl, kSustain, 127);
  play(kControl, kSostenuto, 0);
  hear(4800);
  EXPECT_GT(hear(480), 0) << "the sustain pedal takes it over";
  play(kControl, kSustain, 0);
  hear(960);
  EXPECT_EQ(hear(480), 0);

  play(kOn, 60, 127);
  play(kControl, kSostenuto, 127);
  play(kControl, kSustain, 127);
  play(kOff, 60, 0);
  play(kControl, kSustain, 0);
  hear(4800);
  EXPECT_GT(hear(480), 0) << "the other way round";
  play(kControl, kSostenuto, 0);
  hear(960);
  EXPECT_EQ(hear(480), 0);
}

TEST_F(MidiPlayerTest, AKeySoundsUntilEveryChannelThatHoldsItHasReleasedIt) {
  table_.release_s = 0.01;
  play(kOn, 60, 127);
  play(kOff | 4, 60, 0);
  hear(4800);
  EXPECT_GT(hear(480), 0) << "that channel did not hold it";
  play(kOn | 4, 60, 127);
  play(kOff, 60, 0);
  hear(4800);
  EXPECT_GT(hear(480), 0) << "that channel holds it still";
  play(kOff | 4, 60, 0);
  hear(960);
  EXPECT_EQ(hear(480), 0);
}

TEST_F(MidiPlayerTest, APedalIsUpWhenItIsUpOnEveryChannel) {
  table_.release_s = 0.01;
  play(kControl | 1, kSustain, 127);
  play(kControl | 2, kSustain, 127);
  play(kOn, 60, 127);
  play(kOff, 60, 0);
  play(kControl | 1, kSustain, 0);
  hear(4800);
  EXPECT_GT(hear(480), 0);
  play(kControl | 2, kSustain, 0);
  hear(960);
  EXPECT_EQ(hear(480), 0);
}

TEST_F(MidiPlayerTest, DampingDoesNotClick) {
  play(kOn, 60, 127);
  hear(4800);
  const double step = test::largest_step(last_, 1, last_.size());
  play(kControl, kDamp, 127);
  hear(9600);
  EXPECT_LE(test::largest_step(last_, 1, last_.size()), 1.01 * step);
}

TEST_F(MidiPlayerTest, MessagesThatPlayNoNoteAreIgnored) {
  const std::vector<std::vector<std::uint8_t>> odd = {
      {}, {kOn}, {kOn, 60}, {0xf8}, {0xf0, 1, 2, 3, 0xf7}, {0xe0, 0, 64}, {kOn, 10, 100}, {0xff, 0xff, 0xff}};
  for (const auto& message : odd) player_.play(message, 0, table_, mixer_, played_);
  EXPECT_EQ(hear(480), 0);
  EXPECT_EQ(player_.dropped(), 0u);
}

TEST_F(MidiPlayerTest, WhatNotesDoIsReported) {
  table_.release_s = 0.3;
  play(kOn, 60, 127, 17);
  play(kOff, 60, 0, 40);
  const synth::Event* told = played_.front();
  ASSERT_TRUE(told);
  ASSERT_TRUE(told->verb.holds<synth::verb::Strike>());
  EXPECT_EQ(told->frame, 17);
  EXPECT_EQ(told->verb.get<synth::verb::Strike>().impulse_ns, (Vec3{0, 0, 1}));
  played_.pop();
  told = played_.front();
  ASSERT_TRUE(told);
  ASSERT_TRUE(told->verb.holds<synth::verb::Clear>());
  EXPECT_EQ(told->frame, 40);
  EXPECT_EQ(told->verb.get<synth::verb::Clear>().ramp_s, 0.3);
}

TEST_F(MidiPlayerTest, NotesThatTheMixerCannotTakeAreCounted) {
  for (std::size_t i = 0; i < synth::kQueueCapacity + 1; ++i) play(kOn, 60, 127);
  EXPECT_EQ(player_.dropped(), 1u);
}

// Bowed at the middle of a mode of 1 kHz, the note sounds as long as its key is down.
TEST_F(MidiPlayerTest, ABowedNoteSoundsWhileItsKeyIsDownAndFollowsPressureAndSlideOnItsChannel) {
  constexpr std::uint8_t kSlide = 74;
  table_.notes[60]->bow = {.direction = {0, 0, 1}, .speed_m_s = 0.1, .force_n = 40};
  play(kOn | 3, 60, 127);
  auto told = bows();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NEAR(told[0].speed_m_s, 0.1, 1e-6);
  EXPECT_NEAR(told[0].force_n, 20, 1e-6);
  hear(24000);
  EXPECT_GT(hear(4800), 1e-3) << "it is driven still";
  EXPECT_EQ(mixer_.counters().refused.load(), 0u);

  play(kPressure | 4, 20, 0), play(kControl | 4, kSlide, 20);
  EXPECT_TRUE(bows().empty()) << "another channel";
  play(kPressure | 3, 127, 0), play(kControl | 3, kSlide, 64), play(kKeyPressure | 3, 60, 0);
  told = bows();
  ASSERT_EQ(told.size(), 3u);
  EXPECT_NEAR(told[0].force_n, 40, 1e-5);
  EXPECT_NEAR(told[1].speed_m_s, 0.1 * 64 / 127, 1e-6);
  EXPECT_EQ(told[2].force_n, 0) << "lifted, the key still down";
  play(kPressure | 3, 60, 0);
  EXPECT_EQ(bows().size(), 1u);

  play(kOff | 3, 60, 0);
  told = bows();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].force_n, 0);
  hear(4800);
  const double lifted = hear(4800);
  hear(43200);
  EXPECT_NEAR(hear(4800) / lifted, std::exp(-0.1), 0.005) << "it rings on by itself, and dies as the mode does";
  play(kPressure | 3, 127, 0);
  EXPECT_TRUE(bows().empty());
}

TEST_F(MidiPlayerTest, ABowIsResetByItsChannelAndFollowsTheChannelThatStillHoldsItsKey) {
  table_.notes[60]->bow = {.direction = {0, 0, 1}, .speed_m_s = 0.1, .force_n = 40};
  play(kOn | 3, 60, 127), play(kPressure | 3, 127, 0), play(kControl | 3, 11, 10), bows();
  play(kControl | 4, 121, 0);
  EXPECT_TRUE(bows().empty()) << "another channel's reset";
  play(kControl | 3, 121, 0);
  auto told = bows();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NEAR(told[0].force_n, 20, 1e-6) << "as before any pressure";
  EXPECT_NEAR(told[0].speed_m_s, 0.1, 1e-6);
  play(kKeyPressure | 4, 60, 0);
  EXPECT_TRUE(bows().empty()) << "of a channel that does not hold the key";
  play(kOn | 4, 60, 64), play(kOff | 4, 60, 0), bows();
  play(kPressure | 3, 127, 0);
  told = bows();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NEAR(told[0].force_n, 40, 1e-5);
  play(kControl | 3, 120, 0);
  told = bows();
  ASSERT_EQ(told.size(), 1u) << "all sound off lifts it";
  EXPECT_EQ(told[0].force_n, 0);
  play(kControl | 3, 120, 0);
  EXPECT_TRUE(bows().empty());
}

}  // namespace
}  // namespace ringdown::session
