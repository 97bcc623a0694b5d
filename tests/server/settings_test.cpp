// The settings file: the same options as the command line's, by their long names.
#include "server/settings.h"

#include "packaging/manual/command_line.h"
#include "server/options.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <unistd.h>

namespace ringdown::server {
namespace {

namespace fs = std::filesystem;

class Settings : public testing::Test {
 protected:
  // The options of a command line and of a file together.
  Result<DaemonOptions> read(const std::string& text, const std::string& command_line = "") {
    std::ofstream(file_) << text;
    DaemonOptions options;
    manual::App app("", "ringdownd");
    add_options(app, options);
    std::istringstream words(command_line);
    EXPECT_EQ(app.take({std::istream_iterator<std::string>(words), {}}), "");
    if (auto good = read_settings(app, file_); !good) return fail(good.error());
    return options;
  }

  std::string refusal(const std::string& text) {
    const auto options = read(text);
    return options ? "nothing" : options.error().message;
  }

  test::TemporaryFolder folder_;
  fs::path file_ = folder_ / "ringdownd.toml";
};

TEST_F(Settings, EveryKindOfValueIsTakenFromTheSettingsFile) {
  const auto options = read(R"(
    driver = "null"   # with a remark
    rate = 44100
    floor = 96.5
    connect = true
    name = "my # bells, 2"
    object = ["bell=/banks/bell.glb", "bowl=a b.glb"]
  )");
  ASSERT_TRUE(options) << options.error().message;
  EXPECT_EQ(options->driver, DaemonOptions::DriverKind::null);
  EXPECT_EQ(options->sample_rate_hz, 44100);
  EXPECT_EQ(options->mixer.floor_db, 96.5);
  EXPECT_TRUE(options->connect);
  EXPECT_EQ(options->jack_name, "my # bells, 2");
  ASSERT_EQ(options->objects.size(), 2u);
  EXPECT_EQ(options->objects[1].first, "bowl");
  EXPECT_EQ(options->objects[1].second, "a b.glb");
  EXPECT_EQ(options->port, DaemonOptions().port) << "what the file leaves out stays";
}

TEST_F(Settings, TheCommandLineWinsOverTheSettingsFile) {
  const auto options = read("rate = 44100\nblock = 64\nconnect = false\nobject = [\"a=a.glb\"]",
                            "--rate 96000 --connect --object b=b.glb");
  ASSERT_TRUE(options) << options.error().message;
  EXPECT_EQ(options->sample_rate_hz, 96000);
  EXPECT_EQ(options->block_frames, 64u);
  EXPECT_TRUE(options->connect);
  ASSERT_EQ(options->objects.size(), 1u);
  EXPECT_EQ(options->objects[0].first, "b");
}

TEST_F(Settings, AWrongSettingIsNamedWithFileLineAndKey) {
  const std::string place = file_.string() + ":2: ";
  const std::pair<std::string, std::string> wrong[] = {
      {"\nrte = 44100", "rte"},          {"\nrate = 1", "rate"},      {"\nrate = \"fast\"", "rate"},
      {"\nconnect = 1", "connect"},      {"\nrate = [1, 2]", "rate"}, {"\nobject = [\"bell\"]", "object"},
      {"\ndriver = \"alsa\"", "driver"}, {"\nport = 70000", "port"},  {"\nrate = ", "not TOML"},
      {"\nhelp = true", "help"},         {"\n[rate]\nx = 1", "rate"}, {"\nobject = [[1]]", "object"},
  };
  for (const auto& [text, named] : wrong) {
    const std::string sentence = refusal(text);
    EXPECT_TRUE(sentence.starts_with(place)) << text << ": " << sentence;
    EXPECT_NE(sentence.find(named), std::string::npos) << text << ": " << sentence;
  }
  EXPECT_TRUE(refusal("") == "nothing");
}

TEST_F(Settings, TheUsualSettingsFileIsInTheUsersConfigurationFolder) {
  const fs::path usual = folder_ / "ringdown" / "ringdownd.toml";
  ::setenv("XDG_CONFIG_HOME", folder_.path().c_str(), 1);
  EXPECT_FALSE(settings_file({})) << "there is none yet";
  fs::create_directories(usual.parent_path());
  std::ofstream(usual) << "rate = 44100\n";
  EXPECT_EQ(settings_file({}), usual);
  EXPECT_EQ(settings_file("other.toml"), "other.toml");
  EXPECT_FALSE(settings_file("none"));
  ::unsetenv("XDG_CONFIG_HOME");
}

}  // namespace
}  // namespace ringdown::server
