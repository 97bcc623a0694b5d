// Messages of the MIDI Tuning Standard, byte for byte, against the table of frequencies in its specification.
#include "engine/microtuning/played_tuning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace ringdown::microtuning {
namespace {

using Message = std::vector<std::uint8_t>;

class MidiTuning : public testing::Test {
 protected:
  double frequency_hz(std::size_t key) const {
    return 440 * std::pow(2, (static_cast<double>(key) + tuning_->semitones(key) - 69) / 12);
  }
  void take(const Message& message, const KeySet& held = {}) { tuning_->take(message, held); }
  bool changes(const Message& message) {
    std::vector<double> before, after;
    for (std::size_t key = 0; key < kKeys; ++key) before.push_back(tuning_->semitones(key));
    take(message);
    for (std::size_t key = 0; key < kKeys; ++key) after.push_back(tuning_->semitones(key));
    return before != after;
  }

  std::unique_ptr<PlayedTuning> tuning_ = std::make_unique<PlayedTuning>();
};

// The table of the specification, rounded to 0.0001 Hz.
TEST_F(MidiTuning, OneKeyHasThePitchOfTheSpecification) {
  const struct {
    std::uint8_t note, high, low;
    double hz;
  } table[] = {{0x00, 0x00, 0x00, 8.1758},    {0x01, 0x00, 0x00, 8.6620},     {0x0c, 0x00, 0x00, 16.3516},
               {0x3c, 0x00, 0x00, 261.6256},  {0x3d, 0x00, 0x00, 277.1826},   {0x44, 0x7f, 0x7f, 439.9984},
               {0x45, 0x00, 0x00, 440.0000},  {0x45, 0x00, 0x01, 440.0016},   {0x78, 0x00, 0x00, 8372.0181},
               {0x78, 0x00, 0x01, 8372.0476}, {0x7f, 0x00, 0x00, 12543.8540}, {0x7f, 0x00, 0x01, 12543.8982}};
  for (const auto& [note, high, low, hz] : table) {
    take({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 0x45, note, high, low, 0xf7});
    EXPECT_NEAR(frequency_hz(69), hz, 6e-5);
  }
  EXPECT_EQ(frequency_hz(68), 440 * std::pow(2, -1 / 12.0)) << "other keys stay";
  EXPECT_FALSE(changes({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 0x45, 0x7f, 0x7f, 0x7f, 0xf7})) << "no change";
}

TEST_F(MidiTuning, AMessageTunesSeveralKeysOfOneProgram) {
  take({0xf0, 0x7f, 0x12, 0x08, 0x02, 0x00, 0x02, 0x3c, 0x3c, 0x40, 0x00, 0x3d, 0x3d, 0x20, 0x00, 0xf7});
  EXPECT_EQ(tuning_->semitones(60), 0.5);
  EXPECT_EQ(tuning_->semitones(61), 0.25);
  take({0xf0, 0x7f, 0x12, 0x08, 0x02, 0x05, 0x01, 0x3c, 0x3e, 0x00, 0x00, 0xf7});
  EXPECT_EQ(tuning_->semitones(60), 0.5) << "program 5 is not played";
  tuning_->select(0, kTuningProgram, 5, {});
  EXPECT_EQ(tuning_->semitones(60), 2);
  EXPECT_EQ(tuning_->semitones(61), 0) << "program 5 says nothing about it";
}

TEST_F(MidiTuning, ProgramsOfBanksAreProgramsOfTheirOwn) {
  take({0xf0, 0x7f, 0x7f, 0x08, 0x07, 0x03, 0x01, 0x01, 0x3c, 0x3f, 0x00, 0x00, 0xf7});
  EXPECT_EQ(tuning_->semitones(60), 0);
  tuning_->select(0, kTuningProgram, 1, {});
  EXPECT_EQ(tuning_->semitones(60), 0);
  tuning_->select(0, kTuningBank, 3, {});
  EXPECT_EQ(tuning_->semitones(60), 3);
  take({0xf0, 0x7f, 0x7f, 0x08, 0x07, 0x00, 0x00, 0x01, 0x3c, 0x3d, 0x00, 0x00, 0xf7});
  tuning_->select(0, kTuningProgram, 0, {});
  tuning_->select(0, kTuningBank, 0, {});
  EXPECT_EQ(tuning_->semitones(60), 1) << "bank 0 is the one that messages without a bank mean";
}

Message dump(Message head, std::uint8_t third_byte_of_key_60 = 0x01) {
  for (const char letter : {'n', 'a', 'm', 'e', ' ', 'o', 'f', ' ', '1', '6', ' ', 'b', 'y', 't', 'e', 's'}) {
    head.push_back(static_cast<std::uint8_t>(letter));
  }
  for (std::uint8_t key = 0; key < 128; ++key) {
    const bool stays = key == 61;
    const std::uint8_t fifty_cents = 0x40;
    head.insert(head.end(), {stays ? std::uint8_t{0x7f} : key, stays ? std::uint8_t{0x7f} : fifty_cents,
                             stays ? std::uint8_t{0x7f} : (key == 60 ? third_byte_of_key_60 : std::uint8_t{0})});
  }
  std::uint8_t sum = 0;
  for (std::size_t i = 1; i < head.size(); ++i) sum ^= head[i];
  head.push_back(sum & 0x7f);
  head.push_back(0xf7);
  return head;
}

TEST_F(MidiTuning, ADumpTunesAllKeys) {
  const Message plain = dump({0xf0, 0x7e, 0x7f, 0x08, 0x01, 0x00});
  ASSERT_EQ(plain.size(), 408u);
  take(plain);
  for (const std::size_t key : {0, 59, 62, 127}) EXPECT_EQ(tuning_->semitones(key), 0.5) << key;
  EXPECT_EQ(tuning_->semitones(60), 0.5 + 1 / 16384.0);
  EXPECT_EQ(tuning_->semitones(61), 0) << "no change";
  const Message of_bank = dump({0xf0, 0x7e, 0x7f, 0x08, 0x04, 0x02, 0x09}, 0x03);
  ASSERT_EQ(of_bank.size(), 409u);
  take(of_bank);
  tuning_->select(0, kTuningProgram, 9, {});
  tuning_->select(0, kTuningBank, 2, {});
  EXPECT_EQ(tuning_->semitones(60), 0.5 + 3 / 16384.0);
}

// C is 25 cents low, E is 63 cents high, B is 64 cents low.
const Message kOneByteScale = {0x27, 0x40, 0x40, 0x40, 0x7f, 0x40, 0x40, 0x40, 0x40, 0x40, 0x40, 0x00};
// C is a semitone low, E a quarter tone high, B almost a semitone high, D 1/8192 of a semitone high.
const Message kTwoByteScale = {0x00, 0x00, 0x40, 0x00, 0x40, 0x01, 0x40, 0x00, 0x60, 0x00, 0x40, 0x00,
                               0x40, 0x00, 0x40, 0x00, 0x40, 0x00, 0x40, 0x00, 0x40, 0x00, 0x7f, 0x7f};

Message joined(Message head, const Message& tail) {
  head.insert(head.end(), tail.begin(), tail.end());
  head.push_back(0xf7);
  return head;
}

TEST_F(MidiTuning, AScaleTunesAllOctavesOfTheChannelsItNames) {
  for (const std::uint8_t form : {0x7e, 0x7f}) {
    tuning_ = std::make_unique<PlayedTuning>();
    take(joined({0xf0, form, 0x7f, 0x08, 0x08, 0x02, 0x01, 0x05}, kOneByteScale));
    for (std::size_t channel = 0; channel < 16; ++channel) {
      const bool is_named = channel == 0 || channel == 2 || channel == 7 || channel == 15;
      for (const std::size_t octave : {0, 5, 10}) {
        for (const auto& [degree, cents] : {std::pair(0, -25), {4, 63}, {2, 0}}) {
          const std::size_t key = 12 * octave + static_cast<std::size_t>(degree);
          tuning_->press(key, channel);
          EXPECT_NEAR(tuning_->semitones(key), is_named ? cents / 100.0 : 0, 1e-7) << channel << " " << key;
        }
      }
    }
    tuning_->press(59, 2);
    EXPECT_NEAR(tuning_->semitones(59), -0.64, 1e-7);
  }
}

TEST_F(MidiTuning, AFineScaleHasPartsOf8192OfASemitone) {
  take(joined({0xf0, 0x7f, 0x7f, 0x08, 0x09, 0x03, 0x7f, 0x7f}, kTwoByteScale));
  for (const std::size_t channel : {0, 9, 15}) {
    for (const auto& [key, semitones] : {std::pair(60, -1.0),
                                         {62, 1 / 8192.0},
                                         {64, 0.5},
                                         {71, 8191 / 8192.0},
                                         {65, 0.0},
                                         {0, -1.0},
                                         {119, 8191 / 8192.0}}) {
      tuning_->press(static_cast<std::size_t>(key), channel);
      EXPECT_EQ(tuning_->semitones(static_cast<std::size_t>(key)), semitones) << key;
    }
  }
}

TEST_F(MidiTuning, AScaleHoldsUntilAProgramIsChosen) {
  take({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 0x3c, 0x3d, 0x00, 0x00, 0xf7});
  EXPECT_EQ(tuning_->semitones(60), 1);
  take(joined({0xf0, 0x7f, 0x7f, 0x08, 0x08, 0x00, 0x00, 0x01}, kOneByteScale));
  EXPECT_NEAR(tuning_->semitones(60), -0.25, 1e-7);
  tuning_->select(0, 6, 0, {});
  EXPECT_NEAR(tuning_->semitones(60), -0.25, 1e-7) << "another parameter";
  tuning_->select(0, kTuningProgram, 0, {});
  EXPECT_EQ(tuning_->semitones(60), 1);
}

TEST_F(MidiTuning, OnlyScalesInRealTimeRetuneKeysThatAreHeld) {
  const KeySet held = KeySet().set(60);
  take(joined({0xf0, 0x7e, 0x7f, 0x08, 0x08, 0x00, 0x00, 0x01}, kOneByteScale), held);
  EXPECT_EQ(tuning_->semitones(60), 0);
  EXPECT_NEAR(tuning_->semitones(72), -0.25, 1e-7);
  take(joined({0xf0, 0x7f, 0x7f, 0x08, 0x09, 0x00, 0x00, 0x01}, kTwoByteScale), held);
  EXPECT_EQ(tuning_->semitones(60), -1);
}

TEST_F(MidiTuning, DumpsOfScalesArePrograms) {
  const auto named = [](Message head, const Message& scale) {
    head.insert(head.end(), 16, 0x20);
    head.insert(head.end(), scale.begin(), scale.end());
    return joined(head, {0x00});
  };
  const Message coarse = named({0xf0, 0x7e, 0x7f, 0x08, 0x05, 0x02, 0x09}, kOneByteScale);
  const Message fine = named({0xf0, 0x7e, 0x7f, 0x08, 0x06, 0x00, 0x00}, kTwoByteScale);
  ASSERT_EQ(coarse.size(), 37u);
  ASSERT_EQ(fine.size(), 49u);
  take(coarse);
  EXPECT_EQ(tuning_->semitones(60), 0) << "program 9 of bank 2 is not played";
  take(fine);
  EXPECT_EQ(tuning_->semitones(60), -1);
  EXPECT_EQ(tuning_->semitones(71), 8191 / 8192.0);
  tuning_->select(0, kTuningBank, 2, {});
  tuning_->select(0, kTuningProgram, 9, {});
  EXPECT_NEAR(tuning_->semitones(127 - 127 % 12), -0.25, 1e-7);
  for (Message bad : {coarse, fine}) {
    bad.erase(bad.begin() + 20);
    EXPECT_FALSE(changes(bad)) << "a byte is missing";
  }
}

TEST_F(MidiTuning, OnlyRealTimeMessagesRetuneKeysThatAreHeld) {
  const KeySet held = KeySet().set(60);
  take({0xf0, 0x7e, 0x7f, 0x08, 0x07, 0x00, 0x00, 0x02, 0x3c, 0x3d, 0x00, 0x00, 0x3d, 0x3e, 0x00, 0x00, 0xf7}, held);
  EXPECT_EQ(tuning_->semitones(60), 0);
  EXPECT_EQ(tuning_->semitones(61), 1);
  tuning_->press(60, 0);
  EXPECT_EQ(tuning_->semitones(60), 1) << "when it is struck again";
  take({0xf0, 0x7f, 0x7f, 0x08, 0x07, 0x00, 0x00, 0x01, 0x3c, 0x3e, 0x00, 0x00, 0xf7}, held);
  EXPECT_EQ(tuning_->semitones(60), 2);
}

TEST_F(MidiTuning, EachChannelPlaysItsOwnProgram) {
  take({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x07, 0x02, 0x3c, 0x3d, 0x00, 0x00, 0x3d, 0x3e, 0x00, 0x00, 0xf7});
  tuning_->select(4, kTuningProgram, 7, {});
  tuning_->press(60, 4);
  tuning_->press(61, 5);
  EXPECT_EQ(tuning_->semitones(60), 1);
  EXPECT_EQ(tuning_->semitones(61), 0);
}

TEST_F(MidiTuning, MessagesPrecedeTheBase) {
  KeyTuning base;
  base.semitones[60] = -0.3;
  base.unmapped.set(60).set(61);
  tuning_->set_base(base);
  EXPECT_EQ(tuning_->semitones(60), -0.3);
  EXPECT_TRUE(tuning_->is_unmapped(60));
  take({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 0x3c, 0x3c, 0x00, 0x00, 0xf7});
  EXPECT_EQ(tuning_->semitones(60), 0);
  EXPECT_FALSE(tuning_->is_unmapped(60));
  EXPECT_TRUE(tuning_->is_unmapped(61));
}

TEST_F(MidiTuning, TheFrameOfAMessageMayBeMissing) {
  take({0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 0x3c, 0x3d, 0x00, 0x00});
  EXPECT_EQ(tuning_->semitones(60), 1);
}

TEST_F(MidiTuning, DamagedMessagesAndOthersChangeNothing) {
  const Message good = {0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 0x3c, 0x3d, 0x00, 0x00, 0xf7};
  for (std::size_t size = 0; size + 1 < good.size(); ++size) {
    EXPECT_FALSE(changes(Message(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)))) << size;
  }
  for (const std::size_t at : {1, 3, 4, 6, 7, 8, 9, 10}) {
    Message bad = good;
    bad[at] = 0x90;
    EXPECT_FALSE(changes(bad)) << at;
  }
  EXPECT_FALSE(changes({0xf0, 0x41, 0x7f, 0x08, 0x02, 0x00, 0x01, 0x3c, 0x3d, 0x00, 0x00, 0xf7})) << "a maker's own";
  EXPECT_FALSE(changes({0xf0, 0x7e, 0x7f, 0x08, 0x00, 0x00, 0xf7})) << "a request for a dump";
  EXPECT_FALSE(changes({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x02, 0x3c, 0x3d, 0x00, 0x00, 0xf7})) << "a key too few";
  for (const std::uint8_t form : {0x08, 0x09}) {
    const Message& scale = form == 0x08 ? kTwoByteScale : kOneByteScale;
    EXPECT_FALSE(changes(joined({0xf0, 0x7f, 0x7f, 0x08, form, 0x03, 0x7f, 0x7f}, scale))) << "the other form's length";
  }
  Message long_dump = dump({0xf0, 0x7e, 0x7f, 0x08, 0x01, 0x00});
  long_dump.insert(long_dump.end() - 1, 0);
  EXPECT_FALSE(changes(long_dump));
  EXPECT_TRUE(changes(good));
}

TEST_F(MidiTuning, NoBytesDoHarm) {
  std::mt19937 random(1);
  for (int turn = 0; turn < 20'000; ++turn) {
    Message message = {0xf0, 0x7f, 0x7f, 0x08};
    for (std::size_t i = random() % 24; i > 0; --i) message.push_back(static_cast<std::uint8_t>(random() % 130));
    if (random() % 2) message.push_back(0xf7);
    take(message);
    tuning_->select(random() % 16, static_cast<std::uint8_t>(3 + random() % 2), random() % 128, {});
  }
  for (std::size_t key = 0; key < kKeys; ++key) EXPECT_LE(std::abs(tuning_->semitones(key)), 128);
}

TEST_F(MidiTuning, AsManyProgramsAsABankHasAreKept) {
  for (std::uint8_t program = 0; program < 128; ++program) {
    take({0xf0, 0x7f, 0x7f, 0x08, 0x02, program, 0x01, 0x00, program, 0x00, 0x00, 0xf7});
  }
  take({0xf0, 0x7f, 0x7f, 0x08, 0x07, 0x01, 0x00, 0x01, 0x00, 0x05, 0x00, 0x00, 0xf7});
  for (std::uint8_t program = 0; program < 128; ++program) {
    tuning_->select(0, kTuningProgram, program, {});
    EXPECT_EQ(tuning_->semitones(0), program);
  }
  tuning_->select(0, kTuningProgram, 0, {});
  tuning_->select(0, kTuningBank, 1, {});
  EXPECT_EQ(tuning_->semitones(0), 0) << "one program more is ignored";
}

}  // namespace
}  // namespace ringdown::microtuning
