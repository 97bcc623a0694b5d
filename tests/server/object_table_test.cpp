#include "server/session/object_table.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace ringdown::session {
namespace {

TEST(ObjectTable, TheTableFindsByNameAndByNumberWhatWasAddedAndNothingElse) {
  ObjectTable table;
  EXPECT_FALSE(table.find("bell"));
  EXPECT_FALSE(table.find(0));
  EXPECT_FALSE(table.find(synth::kMaxObjects));
  const ObjectSnapshot bell = table.add({.name = "bell", .number = 7});
  table.add({.name = "anvil", .number = 0});
  EXPECT_EQ(table.find("bell"), bell);
  EXPECT_EQ(table.find(7), bell);
  EXPECT_EQ(*table.names(), (ObjectTable::Names{"anvil", "bell"}));
  ASSERT_EQ(table.all().size(), 2u);
  EXPECT_EQ(table.all()[1], bell);
  table.remove(7);
  EXPECT_FALSE(table.find("bell"));
  EXPECT_FALSE(table.find(7));
  EXPECT_EQ(*table.names(), ObjectTable::Names{"anvil"});
  EXPECT_EQ(bell->name, "bell") << "whoever holds a snapshot keeps it";
}

TEST(ObjectTable, AChangeReplacesTheSnapshotAndLeavesTheOldOneAsItWas) {
  ObjectTable table;
  const ObjectSnapshot old = table.add({.name = "bell", .number = 1});
  const auto [before, after] = table.replace(1, [](ObjectState& object) { object.gain = 0.5; });
  EXPECT_EQ(before, old);
  EXPECT_EQ(old->gain, 1);
  EXPECT_EQ(after->gain, 0.5);
  EXPECT_EQ(table.find("bell"), after);
  EXPECT_FALSE(table.replace(2, [](ObjectState&) { FAIL(); }).after);
}

TEST(ObjectTable, AGainThatIsSetShowsInAllSnapshotsOfTheObject) {
  ObjectTable table;
  const ObjectSnapshot old = table.add({.name = "bell", .number = 1});
  const ObjectSnapshot next = table.replace(1, [](ObjectState& object) { object.group = "bells"; }).after;
  const ObjectSnapshot other = table.add({.name = "anvil", .number = 2});
  old->gain.set(0.25);
  EXPECT_EQ(next->gain, 0.25);
  EXPECT_EQ(table.find("bell")->gain, 0.25);
  EXPECT_EQ(other->gain, 1);
}

TEST(ObjectTable, CollectFreesWhatNobodyHoldsAndNothingElse) {
  ObjectTable table;
  std::weak_ptr<const ObjectState> first = table.add({.name = "bell", .number = 1});
  const ObjectSnapshot held = table.replace(1, [](ObjectState& object) { object.pan = 1; }).after;
  const std::weak_ptr<const ObjectState> last = table.replace(1, [](ObjectState& object) { object.pan = -1; }).after;
  EXPECT_FALSE(first.expired()) << "a reader may still look at it";
  table.collect();
  EXPECT_TRUE(first.expired());
  EXPECT_EQ(held->pan, 1);
  table.remove(1);
  EXPECT_FALSE(last.expired());
  table.collect();
  EXPECT_TRUE(last.expired());
}

// One writer adds, changes, removes and collects; every snapshot that a reader finds is whole: its gain and pan belong
// together, and it has the name and number that were asked for.
TEST(ObjectTable, ReadersFindWholeSnapshotsWhileAWriterReplacesThem) {
  constexpr int kRounds = 20'000;
  constexpr synth::ObjectNumber kObjects = 4;
  const auto name = [](synth::ObjectNumber number) { return "an object with a long name " + std::to_string(number); };
  ObjectTable table;
  std::atomic<bool> done = false;
  std::atomic<std::uint64_t> found = 0, broken = 0;
  std::vector<std::jthread> readers;
  for (int reader = 0; reader < 3; ++reader) {
    readers.emplace_back([&] {
      std::vector<std::string> names;
      for (synth::ObjectNumber number = 0; number < kObjects; ++number) names.push_back(name(number));
      for (synth::ObjectNumber n = 0; !done; n = (n + 1) % kObjects) {
        const ObjectSnapshot by_name = table.find(names[n]), by_number = table.find(n);
        for (const ObjectSnapshot& object : {by_name, by_number}) {
          if (!object) continue;
          ++found;
          broken += object->name != names[n] || object->number != n || object->gain != object->pan;
        }
        broken += table.names()->size() > kObjects;
      }
    });
  }
  for (int round = 0; round < kRounds || found < kRounds; ++round) {
    const auto number = static_cast<synth::ObjectNumber>(round) % kObjects;
    if (!table.find(number)) {
      table.add({.name = name(number), .number = number, .gain = 0, .pan = 0});
    } else if (round % 16 < 4) {
      table.remove(number);
    } else {
      table.replace(number, [round](ObjectState& object) { object.gain = object.pan = round; });
    }
    if (round % 8 == 0) table.collect();
  }
  done = true;
  readers.clear();
  EXPECT_EQ(broken, 0u);
}

}  // namespace
}  // namespace ringdown::session
