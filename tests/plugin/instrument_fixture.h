// An instrument that plays a bank of one mode, and what a listener hears of it.
#pragma once

#include "clients/plugin/instrument.h"
#include "engine/modal/bank_file.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace ringdown::plugin {

using test::Samples;

inline constexpr double kRate = 48000;
inline constexpr std::uint8_t kOn = 0x90, kOff = 0x80, kKeyPressure = 0xa0, kControl = 0xb0, kPressure = 0xd0,
                              kBend = 0xe0;
inline constexpr std::uint8_t kSustain = 64, kSostenuto = 66, kDamp = 67;

// One mode at 1 kHz, so that a key's sound is one sinusoid.
class InstrumentTest : public testing::Test {
 protected:
  InstrumentTest() {
    bank_ = folder_ / "mode.glb";
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(1000, 0.5), bank_));
    instrument_.set_file(bank_);
    set(Parameter::width, 0);
    instrument_.start();
  }
  void set(Parameter parameter, double value) { instrument_.parameters().set(parameter, value); }
  void play(std::uint8_t status, std::uint8_t first, std::uint8_t second = 0) { play_bytes({status, first, second}); }
  void play_bytes(const std::vector<std::uint8_t>& message) { bytes_.push_back(message); }
  // The worker does what it would within some milliseconds.
  void settle() { instrument_.set_file(instrument_.file()); }

  // Left of the next frames; what was played happens in the first of them.
  Samples hear(std::size_t frames) {
    std::vector<MidiMessage> messages;
    for (const auto& message : bytes_) messages.push_back({0, message});
    std::vector<float> left(frames), right(frames);
    instrument_.render(messages, left.data(), right.data(), frames);
    bytes_.clear();
    right_ = test::to_doubles(right);
    return test::to_doubles(left);
  }
  double pitch_hz(std::size_t frames = 9600) { return test::fit_damped_sinusoid(hear(frames), kRate).frequency_hz; }
  double loudness(std::size_t frames = 480) { return test::peak(hear(frames)); }

  test::TemporaryFolder folder_;
  std::filesystem::path bank_;
  Instrument instrument_{kRate, RINGDOWN_BIN_DIR "/plugin.so"};
  std::vector<std::vector<std::uint8_t>> bytes_;
  Samples right_;
};

}  // namespace ringdown::plugin
