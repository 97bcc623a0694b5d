#include "engine/base/folders.h"

#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;

// A folder of presets with one scene, "drum", for as long as it lives.
class OwnPresets {
 public:
  OwnPresets() {
    fs::create_directories(folder_ / "scenes");
    std::ofstream(folder_ / "scenes/drum.toml") << "[scene]\n";
    ::setenv("RINGDOWN_PRESETS", folder_.path().c_str(), 1);
  }
  ~OwnPresets() { ::unsetenv("RINGDOWN_PRESETS"); }
  [[nodiscard]] fs::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
};

TEST(PresetOrFile, ANameIsAPreset) {
  const OwnPresets presets;
  EXPECT_EQ(*preset_or_file("drum", PresetKind::scene), presets / "scenes/drum.toml");
}

TEST(PresetOrFile, WhatHasAFolderOrAnEndingIsAFileWhetherItExistsOrNot) {
  const OwnPresets presets;
  for (const char* given : {"drum.toml", "my/drum", "./drum", "/drum"}) {
    EXPECT_EQ(*preset_or_file(given, PresetKind::scene), given);
  }
}

TEST(PresetOrFile, AFileOfThatNameComesFirst) {
  const OwnPresets presets;
  const fs::path before = fs::current_path();
  fs::current_path(presets / "scenes");
  std::ofstream("drum") << "[scene]\n";
  EXPECT_EQ(*preset_or_file("drum", PresetKind::scene), "drum");
  fs::current_path(before);
}

TEST(PresetOrFile, AnUnknownNameIsRefusedWithThoseThatThereAre) {
  const OwnPresets presets;
  const auto found = preset_or_file("drumm", PresetKind::scene);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::bad_input);
  EXPECT_NE(found.error().message.find("'drumm'"), std::string::npos) << found.error().message;
  EXPECT_NE(found.error().message.find("which has drum"), std::string::npos) << found.error().message;
}

}  // namespace
}  // namespace ringdown::test
