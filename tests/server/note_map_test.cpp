// Files that say what notes strike, and what is chosen where they say nothing.
#include "server/session/note_map.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <utility>
#include <unistd.h>

namespace ringdown::session {
namespace {

class NoteMapTest : public testing::Test {
 protected:
  Result<NoteMap> read(const std::string& text) {
    std::ofstream(path_) << text;
    return read_note_map(path_);
  }
  std::string refusal(const std::string& text) {
    const auto map = read(text);
    return map ? "accepted" : map.error().message;
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "notes.toml";
};

ObjectState object(const std::string& name, synth::ObjectNumber number, modal::Bank bank) {
  return {
      .name = name, .number = number, .map = std::make_shared<const modal::StrikeMap>(test::shared(std::move(bank)))};
}

ObjectSnapshot snapshot(const std::string& name, synth::ObjectNumber number) {
  return std::make_shared<const ObjectState>(object(name, number, test::bar_bank(5)));
}

TEST_F(NoteMapTest, ANoteStrikesWhatTheMapSays) {
  const auto map = read(
      "release_s = 0.3\ndamp_s = 0.2\n[[note]]\nnote = 40\nobject = 'bar'\npoint_m = [0.1, 0, 0]\n"
      "impulse_ns = [0, 0, -0.5]\ncontact_time_s = 0.001\n[[note]]\nnote = 41\nobject = 'not loaded yet'\n");
  ASSERT_FALSE(map) << "a name has no blanks";
  const auto good = read(
      "release_s = 0.3\ndamp_s = 0.2\n[[note]]\nnote = 40\nobject = 'bar'\npoint_m = [0.1, 0, 0]\n"
      "impulse_ns = [0, 0, -0.5]\ncontact_time_s = 0.001\n[[note]]\nnote = 41\nobject = 'later'\n");
  ASSERT_TRUE(good) << good.error().message;
  const NoteTable table = resolve(*good, {snapshot("bar", 7)});
  ASSERT_TRUE(table.notes[40]);
  EXPECT_EQ(table.notes[40]->object, 7u);
  EXPECT_EQ(table.notes[40]->point_m.x, 0.1);
  EXPECT_EQ(table.notes[40]->impulse_ns.z, -0.5);
  EXPECT_EQ(table.notes[40]->contact_time_s, 0.001);
  EXPECT_EQ(table.release_s, 0.3);
  EXPECT_EQ(table.damp_s, 0.2);
  EXPECT_FALSE(table.notes[41]);
  EXPECT_FALSE(table.notes[60]) << "with a map, only the map";
}

TEST_F(NoteMapTest, AnObjectHasOneBankAndOneLevel) {
  const std::string low = "[[note]]\nnote = 40\nobject = 'a'\nbank = 'glass'\nlevel_m = 0.05\n";
  const auto map = read(low + "[[note]]\nnote = 41\nobject = 'b'\nbank = 'glass'\nlevel_m = 0.07\n");
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->notes[0].bank, "glass");
  EXPECT_EQ(map->notes[1].level_m, 0.07);
  EXPECT_TRUE(read(low + "[[note]]\nnote = 41\nobject = 'a'\nbank = 'glass'\nlevel_m = 0.05\n"));
  for (const char* other : {"bank = 'glass'\nlevel_m = 0.06\n", "bank = 'glass'\n", "level_m = 0.05\n"})
    EXPECT_NE(refusal(low + "[[note]]\nnote = 41\nobject = 'a'\n" + other).find("an object of its own"),
              std::string::npos)
        << other;
}

TEST_F(NoteMapTest, ANoteIsBowedWhenTheMapNamesABow) {
  const auto map = read(
      "[[note]]\nnote = 40\nobject = 'bar'\nbow_speed_m_s = 0.3\nbow_force_n = 1\nbow_direction = [0, 3, 4]\n"
      "[[note]]\nnote = 41\nobject = 'bar'\nbow_force_n = 5\n[[note]]\nnote = 42\nobject = 'bar'\n");
  ASSERT_TRUE(map) << map.error().message;
  const NoteTable table = resolve(*map, {snapshot("bar", 7)});
  ASSERT_TRUE(table.notes[40] && table.notes[40]->bow && table.notes[41] && table.notes[41]->bow && table.notes[42]);
  EXPECT_EQ(table.notes[40]->bow->speed_m_s, 0.3);
  EXPECT_EQ(table.notes[40]->bow->force_n, 1);
  EXPECT_NEAR(table.notes[40]->bow->direction.y, 0.6, 1e-12);
  EXPECT_NEAR(table.notes[40]->bow->direction.z, 0.8, 1e-12);
  EXPECT_EQ(table.notes[41]->bow->speed_m_s, kDefaultBow_m_s);
  EXPECT_NEAR(std::abs(table.notes[41]->bow->direction.z), 1, 1e-12) << "as it moves most";
  EXPECT_FALSE(table.notes[42]->bow);
}

TEST_F(NoteMapTest, EveryFaultOfANoteMapIsASentenceWithItsLine) {
  const auto begins = [&](const std::string& text, const std::string& line, const std::string& word) {
    const std::string sentence = refusal(text);
    EXPECT_NE(sentence.find(path_.string() + ":" + line), std::string::npos) << sentence;
    EXPECT_NE(sentence.find(word), std::string::npos) << sentence;
  };
  begins("[[note]]\nnote = 128\nobject = 'a'\n", "2", "note");
  begins("[[note]]\nnote = -1\nobject = 'a'\n", "2", "note");
  begins("[[note]]\nnote = 1\n", "1", "object");
  begins("[[note]]\nnote = 1\nobject = '12'\n", "3", "object");
  begins("[[note]]\nnote = 1\nobject = 'a'\n[[note]]\nnote = 1\nobject = 'b'\n", "5", "note");
  begins("[[note]]\nnote = 1\nobject = 'a'\ncontact_time_s = 0.2\n", "4", "contact_time_s");
  begins("[[note]]\nnote = 1\nobject = 'a'\nimpulse_ns = [0, 1]\n", "4", "impulse_ns");
  begins("[[note]]\nnote = 1\nobject = 'a'\nbow_direction = [0, 0, 0]\n", "4", "bow_direction");
  begins("[[note]]\nnote = 1\nobject = 'a'\nbow_force_n = -1\n", "4", "bow_force_n");
  begins("[[note]]\nnote = 1\nobject = 'a'\nbow_force_n = 1\ncontact_time_s = 0.001\n", "2", "bow");
  begins("relaese_s = 1\n", "1", "relaese_s");
  begins("damp_s = 1\nscale = 'missing.scl'\n", "2", (folder_ / "missing.scl").string() + " cannot be read");
  const auto scale = folder_.write("bad.scl", "a\n1\n3/0\n");
  begins("scale = 'bad.scl'\n", "1", scale.string() + ":3: a pitch");
  begins("mapping = 'bad.scl'\n", "1", scale.string() + ":1: the size of the map");
  begins("release_s = 0\n", "1", "release_s");
}

TEST_F(NoteMapTest, AnObjectOfAnotherSizeIsStruckWhereThatPointHasCome) {
  ObjectState bar = object("bar", 0, test::bar_bank(5));
  const NoteTable::Strike one = best_strike(bar);
  bar.material = {.density = 3, .size = 2};
  const NoteTable::Strike large = best_strike(bar);
  EXPECT_NEAR(length(large.point_m - 2 * one.point_m), 0, 1e-12);
  EXPECT_NEAR(length(large.impulse_ns) / length(one.impulse_ns), 3 * 8, 1e-9) << "as many times its mass";
}

TEST_F(NoteMapTest, KeysAreListedByTheirNames) {
  EXPECT_EQ(key_list(std::nullopt, {snapshot("second", 3), snapshot("first", 1)}), "keys: C4 = first, C#4 = second");
  EXPECT_EQ(key_list(std::nullopt, {}), "");
  std::string text;
  for (int note = 30; note < 60; ++note) {
    text += "[[note]]\nnote = " + std::to_string(note) + "\nobject = '" + (note < 59 ? "bar" : "last") + "'\n";
  }
  const auto many = read(text + "[[note]]\nnote = 1\nobject = 'later'\n");
  ASSERT_TRUE(many);
  EXPECT_EQ(key_list(*many, {snapshot("bar", 1), snapshot("last", 2)}),
            "keys: F#1 = bar, G1 = bar, G#1 = bar ... B3 = last");
}

TEST_F(NoteMapTest, APointOfAMapMovesWithTheSizeThatATuningAsksFor) {
  const auto map = read("[[note]]\nnote = 40\nobject = 'bar'\npoint_m = [0.1, 0, 0]\n");
  ASSERT_TRUE(map);
  ObjectState bar = object("bar", 0, test::bar_bank(5));
  bar.material.size = 3;
  EXPECT_EQ(resolve(*map, {std::make_shared<const ObjectState>(bar)}).notes[40]->point_m.x, 0.1) << "a user's size";
  bar.untuned_size = 1.5;
  EXPECT_EQ(resolve(*map, {std::make_shared<const ObjectState>(bar)}).notes[40]->point_m.x, 0.2);
}

TEST_F(NoteMapTest, AnObjectWhoseMainModeRestsAtTheBestPointIsStruckAlongAnotherMode) {
  modal::Bank bank = test::bar_bank(5);
  for (std::size_t point = 0; point < bank.point_count(); ++point) bank.shapes[point] = {};
  const NoteTable::Strike strike = best_strike(object("bar", 0, bank));
  EXPECT_NEAR(std::abs(strike.impulse_ns.z), kDefaultVelocity_m_s * bank.mass->mass_kg, 1e-6);
}

// The gain of a bank stands for how loud it is: the impulse times the gain is the level.
TEST_F(NoteMapTest, ADefaultBlowLiesBetweenTwoLevelsHoweverLoudAnObjectIs) {
  const auto level = [](double gain) {
    modal::Bank bank = test::bar_bank(5);
    bank.gain = gain;
    const NoteTable table = resolve(std::nullopt, {std::make_shared<const ObjectState>(object("bar", 0, bank))});
    return gain * length(table.notes[kFirstDefaultNote]->impulse_ns);
  };
  EXPECT_NEAR(level(1e6) / level(1e5), 1, 1e-9);
  EXPECT_NEAR(level(1e-6) / level(1e-5), 1, 1e-9);
  EXPECT_NEAR(level(1e6) / level(1e-6), kMaxDefault_pa / kMinDefault_pa, 1e-9);
}

TEST_F(NoteMapTest, WithoutAMapTheObjectsLieInARowFromMiddleC) {
  const NoteTable table = resolve(std::nullopt, {snapshot("second", 3), snapshot("first", 1)});
  ASSERT_TRUE(table.notes[60] && table.notes[61]);
  EXPECT_EQ(table.notes[60]->object, 1u);
  EXPECT_EQ(table.notes[61]->object, 3u);
  EXPECT_FALSE(table.notes[59] || table.notes[62]);
  EXPECT_FALSE(table.release_s);
}

TEST_F(NoteMapTest, ABarIsStruckAtAnEndWhereAllItsModesMove) {
  const ObjectState bar = object("bar", 0, test::bar_bank(5));
  const NoteTable table = resolve(std::nullopt, {std::make_shared<const ObjectState>(bar)});
  ASSERT_TRUE(table.notes[60]);
  const auto& strike = *table.notes[60];
  const auto& positions = bar.map->bank().positions;
  EXPECT_TRUE(strike.point_m.x == positions.front()[0] || strike.point_m.x == positions.back()[0]);
  EXPECT_NEAR(std::abs(strike.impulse_ns.z), kDefaultVelocity_m_s * bar.map->bank().mass->mass_kg, 1e-6);
  EXPECT_EQ(strike.impulse_ns.x, 0);
}

}  // namespace
}  // namespace ringdown::session
