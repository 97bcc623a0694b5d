// Tunings of the instrument's keys: by files, by MIDI's messages, by a master of MTS-ESP.
#include "tests/microtuning/mts_esp_master.h"
#include "tests/plugin/instrument_fixture.h"

#include <cmath>
#include <cstdlib>
#include <fstream>

namespace ringdown::plugin {
namespace {

const std::string kTwelve =
    "twelve equal steps\n12\n100.0\n200.0\n300.0\n400.0\n500.0\n600.0\n700.0\n800.0\n900.0\n1000.0\n1100.0\n2\n";
const std::string kJust = "just\n7\n9/8\n5/4\n4/3\n3/2\n5/3\n15/8\n2/1\n";
// White keys, A4 = 432 Hz.
const std::string kWhite = "12\n0\n127\n60\n69\n432.0\n7\n0\nx\n1\nx\n2\n3\nx\n4\nx\n5\nx\n6\n";

class KeyTunings : public InstrumentTest {
 protected:
  void tune(const std::string& scale, const std::string& mapping) {
    Tunings& tunings = instrument_.tunings();
    tunings.set_file(Tunings::File::scale, scale.empty() ? "" : folder_.write("a.scl", scale).string());
    tunings.set_file(Tunings::File::mapping, mapping.empty() ? "" : folder_.write("a.kbm", mapping).string());
    set(Parameter::scale, kHostTuning);
    settle();
  }
  // The pitch of a key that is struck alone.
  double pitch_of(std::uint8_t key, std::uint8_t channel = 0) {
    play(kControl, 120, 0);
    hear(1024);
    play(static_cast<std::uint8_t>(kOn | channel), key, 100);
    return pitch_hz();
  }
  void play_note_change(std::uint8_t kind, std::uint8_t key, std::uint8_t note, std::uint8_t fraction) {
    play_bytes({0xf0, kind, 0x7f, 0x08, 0x07, 0x00, 0x00, 0x01, key, note, fraction, 0x00, 0xf7});
  }
};

TEST_F(KeyTunings, TwelveEqualStepsChangeNoSample) {
  const auto some_notes = [&] {
    instrument_.start();
    play(kOn, 69, 100);
    Samples all = hear(300);
    for (std::uint8_t key = 40; key < 100; key += 7) {
      play(kOn, key, key);
      const Samples more = hear(300);
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  };
  const Samples untuned = some_notes();
  tune(kTwelve, "");
  const Samples tuned = some_notes();
  EXPECT_GT(test::peak(untuned), 1e-3);
  EXPECT_EQ(untuned, tuned);
}

TEST_F(KeyTunings, ASizeForEachKeyOfAScale) {
  tune(kJust, kWhite);
  EXPECT_NEAR(pitch_of(69) / 432, 1, 1e-4);
  EXPECT_NEAR(pitch_of(60) / (432 * 3 / 5.0), 1, 1e-4);
  EXPECT_NEAR(pitch_of(64) / (432 * 3 / 4.0), 1, 1e-4);
  play(kControl, 120, 0);
  hear(2048);
  play(kOn, 61, 127);
  EXPECT_EQ(loudness(), 0) << "an unmapped key";
  set(Parameter::scale, 0);
  settle();
  EXPECT_NEAR(pitch_of(69) / 440, 1, 1e-4);
}

TEST_F(KeyTunings, ABadFileLeavesTheTuningAsItWas) {
  tune(kJust, "");
  const double before_hz = pitch_of(62);
  EXPECT_NEAR(before_hz / (440 * std::exp2(-9 / 12.0) * 5 / 4), 1, 1e-4);
  testing::internal::CaptureStderr();
  tune("just\n7\n9/8\n", "");
  instrument_.tunings().set_file(Tunings::File::mapping, "");  // as before: nothing is read again
  settle();
  const std::string told = testing::internal::GetCapturedStderr();
  EXPECT_EQ(told, "Ringdown: " + (folder_ / "a.scl").string() + ":4: the file ends here, before note 2 of 7\n");
  EXPECT_NEAR(pitch_of(62) / before_hz, 1, 1e-6);
}

TEST_F(KeyTunings, FilesOfTheUsersFolder) {
  const auto own = folder_ / "ringdown" / "plugin";
  std::filesystem::create_directories(own);
  setenv("XDG_DATA_HOME", folder_.path().c_str(), 1);
  std::ofstream(own / "1.scl") << kJust;
  std::ofstream(own / "2.scl") << kJust;
  std::ofstream(own / "2.kbm") << kWhite;
  std::ofstream(own / "3.kbm") << "0\n0\n127\n60\n69\n432\n0\n";
  const double c_hz = 440 * std::exp2(-9 / 12.0);
  for (const auto& [own_number, hz] :
       {std::pair{1, c_hz * 9 / 8}, {2, 432 * 27 / 40.0}, {3, 432 * std::exp2(-7 / 12.0)}}) {
    set(Parameter::scale, static_cast<double>(kFirstOwnTuning) + own_number - 1);
    settle();
    EXPECT_NEAR(pitch_of(own_number == 1 ? 61 : 62) / hz, 1, 1e-4) << own_number;
  }
  unsetenv("XDG_DATA_HOME");
}

TEST_F(KeyTunings, ANoteMapsOwnTuningMovesItsObjects) {
  const std::string notes = "[[note]]\nnote = 69\nobject = 'mode'\n";
  std::ofstream(folder_ / "a.scl") << kTwelve;
  std::ofstream(folder_ / "a.kbm") << "0\n0\n127\n60\n69\n220\n0\n";
  instrument_.set_file(folder_.write("plain.toml", notes));
  EXPECT_NEAR(pitch_of(69) / 1000, 1, 1e-4) << "its own pitch";
  instrument_.set_file(folder_.write("tuned.toml", "scale = 'a.scl'\nmapping = 'a.kbm'\n" + notes));
  EXPECT_NEAR(pitch_of(69) / 500, 1, 1e-4) << "an octave below equal temperament";
  tune(kTwelve, "");
  EXPECT_NEAR(pitch_of(69) / 1000, 1, 1e-4) << "the player's scale precedes the map's";
}

TEST_F(KeyTunings, ARealTimeMessageRetunesWhatRings) {
  play(kOn, 69, 100);
  hear(480);
  play_note_change(0x7f, 69, 70, 0x40);
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / (440 * std::exp2(1.5 / 12)), 1, 1e-4);
  play_note_change(0x7e, 69, 67, 0x00);
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / (440 * std::exp2(1.5 / 12)), 1, 1e-4) << "not in real time, while the key is held";
  play(kOff, 69);
  play(kControl, 120, 0);
  hear(1024);
  play(kOn, 69, 100);
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / (440 * std::exp2(-2 / 12.0)), 1, 1e-4) << "when it is struck again";
}

TEST_F(KeyTunings, BendsAddToTunings) {
  set(Parameter::bend_range, 2);
  play_note_change(0x7f, 69, 69, 0x40);
  play(kOn, 69, 100);
  play(kBend, 127, 127);
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / (440 * std::exp2(2.5 / 12)), 1, 1e-4);
}

TEST_F(KeyTunings, RegisteredParametersChooseAProgram) {
  play_bytes({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x05, 0x01, 69, 71, 0x00, 0x00, 0xf7});
  hear(64);
  EXPECT_NEAR(pitch_of(69) / 440, 1, 1e-4);
  play(kOff, 69);
  for (const auto& [number, value] : {std::pair<std::uint8_t, std::uint8_t>{101, 0}, {100, 3}, {6, 5}}) {
    play(kControl, number, value);
  }
  hear(64);
  settle();
  EXPECT_NEAR(pitch_of(69) / (440 * std::exp2(2 / 12.0)), 1, 1e-4);
  play(kOff, 69);
  play(kControl, 120, 0);
  play(kOn | 3, 69, 100);
  hear(1024);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / 440, 1, 1e-4) << "another channel";
}

TEST_F(KeyTunings, AMasterChannelOfMpeChoosesForItsZone) {
  set(Parameter::mpe, 1);
  play_bytes({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x05, 0x01, 69, 71, 0x00, 0x00, 0xf7});
  for (const auto& [number, value] : {std::pair<std::uint8_t, std::uint8_t>{101, 0}, {100, 3}, {6, 5}}) {
    play(kControl, number, value);
  }
  play(kOn | 3, 69, 100);
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / (440 * std::exp2(2 / 12.0)), 1, 1e-4);
}

TEST(MtsEspInPlugIn, AMasterTunesTheKeysAndLetsThemGo) {
  test::MtsEspMaster master;
  test::TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(test::single_mode_bank(1000, 0.5), folder / "mode.glb"));
  Instrument instrument(kRate, RINGDOWN_BIN_DIR "/plugin.so");
  instrument.set_file(folder / "mode.glb");
  instrument.start();
  const auto pitch_hz = [&] {
    instrument.set_file(instrument.file());  // the worker does what it would within some milliseconds
    const std::array<std::uint8_t, 3> off = {kControl, 120, 0}, on = {kOn, 69, 100};
    std::vector<float> left(9600), right(9600);
    instrument.render(std::array{MidiMessage{0, off}}, left.data(), right.data(), 2048);
    instrument.render(std::array{MidiMessage{0, on}}, left.data(), right.data(), left.size());
    return test::fit_damped_sinusoid(test::to_doubles(left), kRate).frequency_hz;
  };
  master.tune(69, 450);
  EXPECT_NEAR(pitch_hz() / 440, 1, 1e-4) << "there is no master yet";
  master.set_present(true);
  EXPECT_NEAR(pitch_hz() / 450, 1, 1e-4);
  instrument.tunings().set_file(Tunings::File::scale, folder.write("a.scl", kTwelve));
  instrument.parameters().set(Parameter::scale, kHostTuning);
  EXPECT_NEAR(pitch_hz() / 440, 1, 1e-4) << "the player's choice";
  instrument.parameters().set(Parameter::scale, 0);
  EXPECT_NEAR(pitch_hz() / 450, 1, 1e-4);
  master.set_present(false);
  EXPECT_NEAR(pitch_hz() / 440, 1, 1e-4);
}

}  // namespace
}  // namespace ringdown::plugin
