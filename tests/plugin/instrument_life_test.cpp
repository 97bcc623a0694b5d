// The instrument through a session: files, threads, the audio thread's rules, and the daemon's note maps.
#include "engine/modal/levels/level_bank.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/surface_index.h"
#include "server/session/midi_player.h"
#include "server/session/session.h"
#include "tests/plugin/instrument_fixture.h"
#include "tests/support/realtime_guard.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <thread>

namespace ringdown::plugin {
namespace {

TEST_F(InstrumentTest, AFileThatCannotBeReadLeavesTheSoundAsItIs) {
  instrument_.set_file("/nowhere/bell.glb");
  play(kOn, 60, 127);
  EXPECT_GT(loudness(), 0.01);
  instrument_.start();
  play(kOn, 60, 127);
  EXPECT_EQ(loudness(), 0) << "from the beginning there is nothing to play";
  instrument_.set_file(bank_);
  play(kOn, 60, 127);
  EXPECT_GT(loudness(), 0.01);
}

TEST_F(InstrumentTest, ChangesOfTheObjectNeverUseUpTheMixer) {
  for (int turn = 0; turn < 40; ++turn) {
    set(Parameter::object, turn % 2 == 0 ? 0 : 17);
    settle();
    if (turn % 5 == 0) hear(64);  // and sometimes the host does not play at all
  }
  for (int turn = 0; turn < 20; ++turn) {  // and then no more at all
    set(Parameter::object, turn % 2 == 0 ? 10 : 17);
    settle();
  }
  hear(64);
  settle();
  hear(64);
  settle();
  play(kOn, 60, 127);
  EXPECT_GT(loudness(), 0.001);
}

TEST_F(InstrumentTest, AnotherSampleRateKeepsThePitch) {
  instrument_.stop();
  instrument_.set_sample_rate(96000);
  instrument_.start();
  play(kOn, 69, 127);
  EXPECT_NEAR(test::fit_damped_sinusoid(hear(9600), 96000).frequency_hz / 440, 1, 1e-4);
}

TEST_F(InstrumentTest, NothingThatTheAudioThreadDoesAllocatesLocksOrCallsTheSystem) {
  if (!test::kRealtimeGuardWorks) GTEST_SKIP() << "the sanitizer watches, or nobody";
  std::vector<float> left(64), right(64);
  const std::array<std::array<std::uint8_t, 3>, 12> all = {{{kOn, 60, 90},
                                                            {kOn, 64, 127},
                                                            {kKeyPressure, 60, 50},
                                                            {kPressure, 70, 0},
                                                            {kBend, 10, 90},
                                                            {kControl, 74, 100},
                                                            {kControl, kSustain, 127},
                                                            {kOff, 60, 0},
                                                            {kControl, kSustain, 0},
                                                            {kTuneKeyHigh, 64, 70},
                                                            {kTuneKeyLow, 64, 7},
                                                            {kControl, 120, 0}}};
  for (int round = 0; round < 20; ++round) {
    for (const auto& bytes : all) {
      const MidiMessage message{11, bytes};
      const test::RealtimeScope scope;
      set(Parameter::width, round * 5);
      set(Parameter::gain, -round);
      instrument_.render({&message, 1}, left.data(), right.data(), 64);
      ASSERT_EQ(scope.seen().total(), 0u) << scope.seen().first;
    }
    settle();
  }
}

// Also for the thread sanitizer.
TEST_F(InstrumentTest, TheHostMayChangeEverythingWhileItPlays) {
  std::atomic<bool> ends = false;
  std::thread audio([&] {
    std::vector<float> left(128), right(128);
    for (std::uint8_t key = 0; !ends; key = static_cast<std::uint8_t>((key + 7) % 128)) {
      const std::array<std::uint8_t, 3> bytes{kOn, key, 100}, bend{kBend, 0, key}, pressure{kPressure, key, 0};
      const std::array<MidiMessage, 3> messages = {{{0, bytes}, {5, bend}, {9, pressure}}};
      {
        const test::RealtimeScope scope;
        instrument_.render(messages, left.data(), right.data(), 128);
        ASSERT_EQ(scope.seen().total(), 0u) << scope.seen().first;
      }
      for (const float sample : left) ASSERT_TRUE(std::isfinite(sample));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  for (int turn = 0; turn < 5; ++turn) {
    set(Parameter::object, turn % 3 == 0 ? 0 : 10 + turn);
    set(Parameter::embed, 1);
    instrument_.set_embedded(instrument_.embedded());
    instrument_.set_file(turn % 2 == 0 ? bank_.string() : "");
    set(Parameter::size, 0.5 + turn / 10.0);
    set(Parameter::pan, turn);
    settle();
  }
  ends = true;
  audio.join();
}

// More than libringdown takes in a block, and blows harder than it takes.
TEST_F(InstrumentTest, AFloodIsNoReasonToAllocate) {
  set(Parameter::even_loudness, 0);
  set(Parameter::size, 4);
  set(Parameter::density, 10);
  settle();
  std::vector<std::array<std::uint8_t, 3>> bytes;
  for (std::uint8_t key = 0; key < 128; ++key) bytes.push_back({kOn, key, 127});
  for (int i = 0; i < 384; ++i) bytes.push_back({kControl, 120, 0});
  std::vector<MidiMessage> messages;
  for (const auto& message : bytes) messages.push_back({0, message});
  std::vector<float> left(64), right(64);
  for (int block = 0; block < 3; ++block) {
    const test::RealtimeScope scope;
    instrument_.render(messages, left.data(), right.data(), 64);
    ASSERT_EQ(scope.seen().total(), 0u) << scope.seen().first;
  }
}

TEST_F(InstrumentTest, ANoteMapThatStrikesBesideItsObjectIsRefused) {
  std::filesystem::copy_file(bank_, folder_ / "bell.glb");
  const std::string text = "[[note]]\nnote = 60\nobject = 'bell'\npoint_m = ";
  instrument_.set_file(folder_.write("far.toml", text + "[47.0, 0, 0]\n"));
  instrument_.start();
  play(kOn, 60, 127);
  EXPECT_EQ(loudness(), 0);
  instrument_.set_file(folder_.write("near.toml", text + "[0.6, 0.6, 0.6]\n"));
  play(kOn, 60, 127);
  EXPECT_GT(loudness(), 0);
}

// The daemon's keyboard, without the plug-in.
Samples by_the_daemon(const std::filesystem::path& map, const std::vector<std::array<std::uint8_t, 3>>& messages,
                      std::size_t every) {
  session::Session session(kRate);
  const auto file = session::read_note_map(map);
  EXPECT_TRUE(file);
  for (const auto& entry : file->notes) {
    if (session.rack().find({.name = entry.object, .number = {}})) continue;
    const auto bank = map.parent_path() / file->banks / (entry.object + ".glb");
    EXPECT_TRUE(session.rack().load(entry.object, bank));
  }
  const session::NoteTable table = session::resolve(*file, session.rack().objects());
  session::MidiPlayer player;
  SpscRing<synth::Event> played(64);
  Samples sound;
  std::vector<float> left(every), right(every);
  for (const auto& message : messages) {
    player.play(message, session.rack().mixer().counters().frames, table, session.rack().mixer(), played);
    session.rack().mixer().render(left, right);
    const Samples more = test::to_doubles(left);
    sound.insert(sound.end(), more.begin(), more.end());
  }
  return sound;
}

TEST_F(InstrumentTest, ANoteMapSoundsAsInTheDaemon) {
  const std::filesystem::path map = RINGDOWN_SOURCE_DIR "/presets/notes/vibraphone.toml";
  const std::vector<std::array<std::uint8_t, 3>> messages = {
      {kOn, 60, 127}, {kOn, 64, 30},           {kOff, 60, 0},  {kControl, kSustain, 127}, {kOn, 89, 100}, {kOff, 89, 0},
      {kOn, 53, 1},   {kControl, kSustain, 0}, {kOn, 20, 100}, {kControl, kDamp, 127}};
  instrument_.set_file(map);
  set(Parameter::even_loudness, 0);
  instrument_.start();
  Samples sound;
  for (const auto& [status, first, second] : messages) {
    play(status, first, second);
    const Samples more = hear(2000);
    sound.insert(sound.end(), more.begin(), more.end());
  }
  const Samples expected = by_the_daemon(map, messages, 2000);
  EXPECT_GT(test::peak(expected), 1e-3);
  // Modes 120 dB below full scale may rest, and when each is looked at differs.
  Samples difference(sound.size());
  std::transform(sound.begin(), sound.end(), expected.begin(), difference.begin(), std::minus<>());
  EXPECT_LT(20 * std::log10(test::peak(difference)), -120);
}

// The mode that sounds a note has the note's pitch. A struck note is sounded by the loudest mode up to a twelfth above
// it, and a bowed note by the mode whose losses the hair's falling friction makes up first: that of the largest shape^2
// / decay.
TEST(NoteMaps, EveryPresetMapPlaysEachNoteInTune) {
  for (const auto& entry : std::filesystem::directory_iterator(RINGDOWN_SOURCE_DIR "/presets/notes")) {
    const auto map = session::read_note_map(entry.path());
    ASSERT_TRUE(map) << map.error().message;
    std::map<std::string, modal::Bank> banks;
    for (const auto& note : map->notes) {
      const auto file = entry.path().parent_path() / map->banks / note.bank_file();
      if (!banks.contains(note.object)) {
        const modal::Bank read = modal::read_bank(file).value();
        banks[note.object] = note.level_m ? modal::at_level(read, *note.level_m).value().bank : read;
      }
      const modal::Bank& bank = banks.at(note.object);
      ASSERT_TRUE(note.point_m && (note.impulse_ns || note.bow_direction));
      const Vec3 way = note.impulse_ns ? *note.impulse_ns : *note.bow_direction;
      const modal::SurfacePoint at = modal::SurfaceIndex(bank).nearest(*note.point_m);
      EXPECT_LT(at.distance_m, 1e-3) << entry.path() << " " << note.note;
      const double pitch_hz = 440 * std::exp2((static_cast<double>(note.note) - 69) / 12);
      double max = 0, found_hz = 0;
      for (std::size_t m = 0; m < bank.mode_count(); ++m) {
        if (bank.frequency_hz[m] > 3 * pitch_hz) continue;
        double given = 0;
        for (std::size_t i = 0; i < 3; ++i) {
          const auto& shape = bank.shape(m, at.points[i]);
          given += at.weights[i] * dot({shape[0], shape[1], shape[2]}, way);
        }
        const double share = note.impulse_ns ? std::abs(given) : given * given / bank.decay_per_s[m];
        if (share > max) max = share, found_hz = bank.frequency_hz[m];
      }
      EXPECT_LT(std::abs(1200 * std::log2(found_hz / pitch_hz)), 10) << entry.path() << " " << note.note;
    }
  }
}

}  // namespace
}  // namespace ringdown::plugin
