#include "clients/plugin/sources.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace ringdown::plugin {
namespace {

namespace fs = std::filesystem;

const fs::path kPresetFolder = fs::path(RINGDOWN_SOURCE_DIR) / "presets";

TEST(Sources, EveryPresetBankIsAChoice) {
  for (const auto& entry : fs::directory_iterator(kPresetFolder / "banks")) {
    if (entry.path().extension() != ".glb") continue;
    const std::string name = entry.path().stem();
    EXPECT_NE(std::find(kPresets.begin(), kPresets.end(), name), kPresets.end())
        << name << ": add it at the end of kPresets";
  }
}

TEST(Sources, EveryChoiceHasItsFile) {
  for (std::size_t choice = kFirstPreset; choice < kChoices; ++choice) {
    const Source source = find_source(choice, "", RINGDOWN_BIN_DIR "/plugin.so");
    EXPECT_TRUE(fs::exists(source.path)) << source.path;
    EXPECT_EQ(source.name, choice_name(choice));
  }
  EXPECT_LE(kChoices, 128u) << "the parameter's range, which cannot grow";
}

TEST(Sources, InstrumentsOfManyNotesAreNoteMaps) {
  for (const char* name : {"vibraphone", "kalimba", "music-box-comb", "glass-harp"}) {
    const auto at = std::find(kPresets.begin(), kPresets.end(), name) - kPresets.begin();
    EXPECT_TRUE(
        is_note_map(find_source(kFirstPreset + static_cast<std::size_t>(at), "", RINGDOWN_BIN_DIR "/plugin.so")))
        << name;
  }
}

// Sessions hold these numbers.
TEST(Sources, ChoicesKeepTheirNumbers) {
  EXPECT_EQ(choice_name(0), "file");
  EXPECT_EQ(choice_name(8), "own 8");
  EXPECT_EQ(choice_name(9), "vibraphone-key");
  EXPECT_EQ(choice_name(13), "brick");
  EXPECT_EQ(choice_name(45), "xylophone-key");
  EXPECT_EQ(choice_name(46), "vibraphone");
}

TEST(Sources, AFileCountsForTheFirstChoiceAndForChoicesThatThereAreNot) {
  for (const std::size_t choice : {std::size_t{0}, kChoices, std::size_t{127}}) {
    EXPECT_EQ(find_source(choice, "/my/bell.glb", "").path, "/my/bell.glb");
    EXPECT_EQ(find_source(choice, "", "").name, "vibraphone-key");
  }
  EXPECT_EQ(find_source(13, "/my/bell.glb", "").name, "brick");
}

TEST(Sources, PresetsLieBesideThePlugInOrAboveIt) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "share/ringdown/presets/banks");
  fs::create_directories(folder / "lib/vst3/ringdown.vst3/Contents/x86_64-linux");
  const fs::path binary = folder / "lib/vst3/ringdown.vst3/Contents/x86_64-linux/ringdown.so";
  EXPECT_EQ(presets_near(binary), fs::weakly_canonical(folder / "share/ringdown/presets"));
  fs::create_directories(folder / "lib/vst3/ringdown.vst3/presets/banks");
  EXPECT_EQ(presets_near(binary), fs::weakly_canonical(folder / "lib/vst3/ringdown.vst3/presets"));
}

TEST(Sources, AFolderOfTheUsersHoldsBanksAndNoteMaps) {
  const test::TemporaryFolder folder;
  setenv("XDG_DATA_HOME", folder.path().c_str(), 1);
  fs::create_directories(folder / "ringdown/plugin");
  EXPECT_EQ(find_source(3, "", "").path, folder / "ringdown/plugin/3.glb");
  EXPECT_FALSE(is_note_map(find_source(3, "", "")));
  static_cast<void>(folder.write("ringdown/plugin/3.toml", ""));
  EXPECT_TRUE(is_note_map(find_source(3, "", "")));
  unsetenv("XDG_DATA_HOME");
}

}  // namespace
}  // namespace ringdown::plugin
