// ringdown-viewer as a program: its pictures, its refusals, what it remembers. Where things must be in a picture
// follows from a pinhole camera, written down here once more.
#include "tests/integration/daemon_fixture.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/virtual_display.h"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;

constexpr int kWidth = 480, kHeight = 300;
const std::string kViewer = RINGDOWN_BIN_DIR "/ringdown-viewer";
const std::string kPresets = RINGDOWN_SOURCE_DIR "/presets";

struct Colour {
  int r = 0, g = 0, b = 0;
  [[nodiscard]] int away_from(const Colour& o) const {
    return std::max({std::abs(r - o.r), std::abs(g - o.g), std::abs(b - o.b)});
  }
  friend auto operator<=>(const Colour&, const Colour&) = default;
};

struct Picture {
  int width = 0, height = 0;
  std::vector<unsigned char> rgb;
  [[nodiscard]] Colour at(double x, double y) const {
    const auto i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    return {rgb.at(i), rgb.at(i + 1), rgb.at(i + 2)};
  }
};

Picture read_png(const std::filesystem::path& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, path.c_str())) return {};
  image.format = PNG_FORMAT_RGB;
  Picture picture{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  picture.rgb.resize(PNG_IMAGE_SIZE(image));
  png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr);
  return picture;
}

// A camera at (0, -2, 0.5) that looks along y with a vertical field of view of 40 degrees.
std::array<double, 2> pixel_of(double x, double y, double z) {
  const double focal = kHeight / 2.0 / std::tan(20 * std::numbers::pi / 180);
  return {kWidth / 2.0 + focal * x / (y + 2), kHeight / 2.0 - focal * (z - 0.5) / (y + 2)};
}

// A bell that hangs at the left, and a ball that falls from (0.3, 0, 0.9) at the scene's beginning.
std::filesystem::path write_scene(const TemporaryFolder& folder) {
  return folder.write("scene.toml", R"([scene]
[camera]
position_m = [0, -2, 0.5]
target_m = [0, 0, 0.5]
field_of_view_degrees = 40
[[static]]
name = "floor"
shape = "plane"
[[object]]
name = "bell"
bank = ")" + kPresets + R"(/banks/bronze-bell.glb"
[[body]]
name = "bell"
object = "bell"
shape = "convex"
position_m = [-0.3, 0, 0.5]
fixed = true
[[body]]
name = "ball"
shape = "sphere"
radius_m = 0.06
density_kg_m3 = 2000
position_m = [0.3, 0, 0.9]
)");
}

Outcome take(const std::filesystem::path& scene, const std::filesystem::path& picture,
             const std::vector<std::string>& more = {}) {
  std::vector<std::string> command = {
      kViewer,  "--screenshot",         picture.string(),       "--scene", scene.string(), "--only", "scene",
      "--size", std::to_string(kWidth), std::to_string(kHeight)};
  command.insert(command.end(), more.begin(), more.end());
  return run(command);
}

#define NEED_DISPLAY(display)   \
  const VirtualDisplay display; \
  if (!display.works()) GTEST_SKIP() << "Xvfb is not installed"

TEST(ViewerProgram, TheScreenshotShowsBodiesWhereTheyAreAtThatTime) {
  NEED_DISPLAY(display);
  const TemporaryFolder folder;
  const auto scene = write_scene(folder);
  const auto first = take(scene, folder / "0.png", {"--at", "0"});
  ASSERT_EQ(first.exit_code, 0) << first.output;
  const auto later = take(scene, folder / "3.png", {"--at", "0.3"});
  ASSERT_EQ(later.exit_code, 0) << later.output;
  const Picture before = read_png(folder / "0.png"), after = read_png(folder / "3.png");
  ASSERT_EQ(before.width, kWidth);
  ASSERT_EQ(before.height, kHeight);
  std::set<Colour> colours;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) colours.insert(after.at(x, y));
  }
  EXPECT_GT(colours.size(), 500u) << "it is as good as blank";

  const auto [bell_x, bell_y] = pixel_of(-0.3, 0, 0.58);  // its frame begins at its mouth
  const Colour bronze = after.at(bell_x, bell_y);
  EXPECT_GT(bronze.r, bronze.b + 40) << "the bell is not there, or not orange";
  const Colour behind = after.at(kWidth / 2.0, bell_y);
  EXPECT_LT(behind.r, behind.b + 20) << "there is nothing between bell and ball";

  // g t^2 / 2 = 0.441 m below.
  const auto [ball_x, high] = pixel_of(0.3, 0, 0.9);
  const double low = pixel_of(0.3, 0, 0.9 - 0.5 * 9.81 * 0.3 * 0.3)[1];
  EXPECT_GT(before.at(ball_x, high).away_from(after.at(ball_x, high)), 30) << "it has left";
  EXPECT_GT(before.at(ball_x, low).away_from(after.at(ball_x, low)), 30) << "it has come";
  EXPECT_LT(before.at(ball_x, high).away_from(after.at(ball_x, low)), 40) << "it is the same ball";
  const double radius = pixel_of(0.36, 0, 0.5)[0] - ball_x;
  EXPECT_LT(before.at(ball_x, low + 1.3 * radius).away_from(after.at(ball_x, low + 1.3 * radius)), 30)
      << "it is not lower than that";
}

// As on another computer: names of files are the daemon's.
TEST(ViewerProgram, ARunningDaemonResolvesTheScenesPathInItsOwnFolder) {
  NEED_DISPLAY(display);
  const TemporaryFolder folder, elsewhere;
  const auto scene = write_scene(folder);
  Daemon daemon({"--driver", "null", "--root", folder.path().string()});
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const auto picture = elsewhere / "picture.png";
  const auto taken = run({"env", "-C", elsewhere.path().string(), kViewer, "--screenshot", picture.string(), "--scene",
                          relative(scene).string(), "--at", "0", "--only", "scene", "--size", std::to_string(kWidth),
                          std::to_string(kHeight), "--to", "osc.udp://127.0.0.1:" + std::to_string(daemon.port())});
  ASSERT_EQ(taken.exit_code, 0) << taken.output;
  const auto [bell_x, bell_y] = pixel_of(-0.3, 0, 0.58);
  const Colour bronze = read_png(picture).at(bell_x, bell_y);
  EXPECT_GT(bronze.r, bronze.b + 40) << "the bell is not there, or not orange";
}

TEST(ViewerProgram, TheLightThemeIsLight) {
  NEED_DISPLAY(display);
  const TemporaryFolder folder;
  const auto taken = take(write_scene(folder), folder / "light.png", {"--at", "0", "--theme", "light"});
  ASSERT_EQ(taken.exit_code, 0) << taken.output;
  const Colour corner = read_png(folder / "light.png").at(kWidth - 5, 60);
  EXPECT_GT(std::min({corner.r, corner.g, corner.b}), 150);
}

TEST(ViewerProgram, TheViewerRefusesWrongArgumentsInOneSentence) {
  NEED_DISPLAY(display);
  const TemporaryFolder folder;
  const auto without = run({kViewer, "--screenshot", (folder / "a.png").string()});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_NE(without.output.find("--scene"), std::string::npos);
  const auto missing = take("/nonexistent/scene.toml", folder / "a.png");
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_NE(missing.output.find("/nonexistent/scene.toml"), std::string::npos) << missing.output;
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
  const auto blind = run({"env", "-u", "DISPLAY", kViewer, "--to", "osc.udp://127.0.0.1:9"});
  EXPECT_EQ(blind.exit_code, 1);
  EXPECT_NE(blind.output.find("xvfb-run"), std::string::npos) << blind.output;
}

std::string text_of(const std::filesystem::path& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// Starts the window, waits until it is there, presses keys, the last of which ends it.
void visit(const TemporaryFolder& folder, const std::vector<std::string>& keys) {
  Process viewer({kViewer, "--to", "osc.udp://127.0.0.1:9"}, {{"XDG_CONFIG_HOME", folder.path().string()}});
  const auto found =
      run({"xdotool", "search", "--sync", "--onlyvisible", "--name", "^Ringdown$", "windowfocus", "--sync"});
  ASSERT_EQ(found.exit_code, 0) << found.output;
  for (const std::string& key : keys) ASSERT_EQ(run({"xdotool", "key", key}).exit_code, 0);
  EXPECT_EQ(viewer.wait(), 0) << viewer.output();
}

TEST(ViewerProgram, TheViewerRestoresItsSettings) {
  NEED_DISPLAY(display);
  if (!installed("xdotool")) GTEST_SKIP() << "xdotool is not installed";
  const TemporaryFolder folder;
  const auto file = folder.path() / "ringdown" / "viewer.toml";
  visit(folder, {"F2", "ctrl+equal", "Escape"});
  const std::string first = text_of(file);
  EXPECT_NE(first.find("dark = false"), std::string::npos) << first;
  EXPECT_NE(first.find("scale = 1.125"), std::string::npos) << first;
  EXPECT_NE(first.find("osc.udp://127.0.0.1:9"), std::string::npos) << first;
  EXPECT_NE(first.find("width = 1440"), std::string::npos) << first;
  visit(folder, {"F2", "Escape"});
  const std::string second = text_of(file);
  EXPECT_NE(second.find("dark = true"), std::string::npos) << "it began light: " << second;
  EXPECT_NE(second.find("scale = 1.125"), std::string::npos) << second;
}

TEST(ViewerProgram, AMalformedSettingsFileIsReportedAndKept) {
  NEED_DISPLAY(display);
  if (!installed("xdotool")) GTEST_SKIP() << "xdotool is not installed";
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "ringdown");
  const auto file = folder.write("ringdown/viewer.toml", "dark = 7\n");
  visit(folder, {"Escape"});
  EXPECT_EQ(text_of(file), "dark = 7\n");
}

}  // namespace
}  // namespace ringdown::test
