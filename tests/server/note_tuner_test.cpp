// The sizes that a keyboard's tuning gives the objects of a rack.
#include "engine/modal/bank_file.h"
#include "server/session/midi_player.h"
#include "server/session/note_tuner.h"
#include "server/session/session.h"
#include "server/session/state.h"
#include "tests/microtuning/mts_esp_master.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace ringdown::session {
namespace {

class NoteTunerTest : public testing::Test {
 protected:
  NoteTunerTest() {
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(1000, 0.5), bank_));
    for (const char* name : {"a", "b"}) EXPECT_TRUE(session_.rack().load(name, bank_));
  }
  double size(const std::string& name) { return session_.rack().find({.name = name}).value()->material.size; }
  std::optional<NoteMap> map(const std::string& head) {
    const auto read =
        read_note_map(folder_.write("notes.toml", head + "[[note]]\nnote = 60\nobject = 'a'\n[[note]]\nnote = 62\n"
                                                         "object = 'b'\n[[note]]\nnote = 72\nobject = 'b'\n"));
    EXPECT_TRUE(read) << read.error().message;
    return read ? std::optional(*read) : std::nullopt;
  }
  // A scale of quarter tones, so that a key's deviation is half of its distance from key 60.
  std::optional<NoteMap> quarter_tones() {
    std::ofstream(folder_ / "quarters.scl") << "quarter tones\n1\n50.0\n";
    return map("scale = 'quarters.scl'\n");
  }
  void play(const std::vector<std::uint8_t>& message) {
    player_.play(message, session_.rack().mixer().counters().frames, {}, session_.rack().mixer(), played_);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path bank_ = folder_ / "mode.glb";
  Session session_{48000};
  MidiPlayer player_;
  SpscRing<synth::Event> played_{64};
};

TEST_F(NoteTunerTest, AnObjectHasTheSizeForTheLowestOfItsNotes) {
  NoteTuner tuner(session_.rack(), player_.tuning(), quarter_tones());
  tuner.catch_up();
  EXPECT_EQ(size("a"), 1);
  EXPECT_NEAR(size("b"), std::exp2(1 / 12.0), 1e-12) << "note 62 is a quarter of a tone above note 61's";
  ASSERT_TRUE(session_.rack().load("b", bank_));
  EXPECT_EQ(size("b"), 1) << "a new bank";
  tuner.catch_up();
  EXPECT_NEAR(size("b"), std::exp2(1 / 12.0), 1e-12);
}

TEST_F(NoteTunerTest, WithoutATuningNothingIsRetuned) {
  NoteTuner tuner(session_.rack(), player_.tuning(), map(""));
  const std::uint64_t version = session_.rack().observers().version();
  tuner.catch_up();
  EXPECT_EQ(session_.rack().observers().version(), version);
}

TEST_F(NoteTunerTest, WithoutAMapMessagesTuneTheObjectsInTheirOrder) {
  NoteTuner tuner(session_.rack(), player_.tuning(), std::nullopt);
  play({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 61, 62, 0x00, 0x00, 0xf7});
  tuner.catch_up();
  EXPECT_EQ(size("a"), 1);
  EXPECT_NEAR(size("b"), std::exp2(-1 / 12.0), 1e-12);
  play({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 61, 61, 0x00, 0x00, 0xf7});
  tuner.catch_up();
  EXPECT_EQ(size("b"), 1) << "exactly as before";
}

TEST_F(NoteTunerTest, AUsersSizeIsKeptAndMultiplied) {
  NoteTuner tuner(session_.rack(), player_.tuning(), quarter_tones());
  tuner.catch_up();
  ASSERT_TRUE(session_.rack().set_material({.name = "b"}, {.stiffness = 2, .size = 3}));
  tuner.catch_up();
  EXPECT_NEAR(size("b"), 3, 1e-12) << "the size that is heard";
  EXPECT_EQ(session_.rack().find({.name = "b"}).value()->material.stiffness, 2);
  play({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 62, 62, 0x00, 0x00, 0xf7});
  tuner.catch_up();
  EXPECT_NEAR(size("b"), 3 / std::exp2(1 / 12.0), 1e-12);
}

TEST_F(NoteTunerTest, AStateHoldsTheSizesOfEqualTemperament) {
  NoteTuner tuner(session_.rack(), player_.tuning(), quarter_tones());
  tuner.catch_up();
  const State state = state_of(session_);
  for (const State::Object& object : state.objects) EXPECT_EQ(object.material.size, 1) << object.name;
  Session again(48000);
  ASSERT_TRUE(restore(state, again, 0));
  NoteTuner tuner_again(again.rack(), player_.tuning(), quarter_tones());
  tuner_again.catch_up();
  EXPECT_EQ(again.rack().find({.name = "b"}).value()->material.size, size("b"));
}

TEST_F(NoteTunerTest, AMasterOfMtsEspTunesMapsWithoutAScale) {
  test::MtsEspMaster master;
  master.tune(62, 440 * std::exp2(-6 / 12.0));
  NoteTuner tuner(session_.rack(), player_.tuning(), map(""));
  tuner.catch_up();
  EXPECT_EQ(size("b"), 1);
  master.set_present(true);
  tuner.catch_up();
  EXPECT_NEAR(size("b"), std::exp2(-1 / 12.0), 1e-9);
  master.set_present(false);
  tuner.catch_up();
  EXPECT_EQ(size("b"), 1);
}

TEST_F(NoteTunerTest, AnUnmappedNoteStrikesNothing) {
  std::ofstream(folder_ / "one.kbm") << "2\n0\n127\n60\n60\n261.6255653\n2\n0\nx\n";
  NoteTuner tuner(session_.rack(), player_.tuning(), map("mapping = 'one.kbm'\n"));
  tuner.catch_up();
  EXPECT_TRUE(player_.tuning().is_unmapped(61));
  NoteTable table;
  for (const std::size_t note : {60, 61}) {
    table.notes[note] = NoteTable::Strike{.object = 0, .point_m = {1, 0, 0}, .impulse_ns = {0, 0, 1}};
  }
  for (const std::uint8_t note : {61, 60}) {
    const std::array<std::uint8_t, 3> message = {0x90, note, 127};
    player_.play(message, 0, table, session_.rack().mixer(), played_);
    EXPECT_EQ(played_.size(), note == 60 ? 1u : 0u);
  }
}

}  // namespace
}  // namespace ringdown::session
