// These tests have other programs, Python's libraries and node, read the files that `ringdown picture` writes.
#include "clients/cli/picture/answer.h"
#include "clients/cli/picture/bank_page.h"
#include "clients/cli/picture/shape_view.h"
#include "clients/cli/picture/view_data.h"
#include "engine/modal/bank_file.h"
#include "tests/integration/process.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <sstream>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;

const fs::path kBanks = fs::path(RINGDOWN_SOURCE_DIR) / "presets/banks";

Outcome picture(const fs::path& bank, std::vector<std::string> options) {
  options.insert(options.begin(), {RINGDOWN_BIN_DIR "/ringdown", "picture", bank.string(), "-o"});
  return run(options);
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// What check_page.py says, by first word; the text of all table cells under "cell", one in a line.
std::map<std::string, std::string> read(const fs::path& path) {
  const Outcome ran = run({"/usr/bin/python3", RINGDOWN_SOURCE_DIR "/tests/picture/check_page.py", path});
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  std::map<std::string, std::string> said;
  std::istringstream lines(ran.output);
  for (std::string line; std::getline(lines, line);) {
    const auto space = line.find(' ');
    said[line.substr(0, space)] +=
        line.substr(std::min(space, line.size() - 1) + 1) + (line.starts_with("cell") ? "\n" : "");
  }
  return said;
}

std::vector<fs::path> preset_banks() {
  std::vector<fs::path> banks;
  for (const auto& entry : fs::directory_iterator(kBanks)) {
    if (entry.path().extension() == ".glb") banks.push_back(entry.path());
  }
  return banks;
}

TEST(Picture, ThePictureIsAPngOfItsSizeWithSomethingOnIt) {
  const TemporaryFolder folder;
  for (const auto& [options, size] : {std::pair{std::vector<std::string>{}, "1120 900"}, {{"--small"}, "480 200"}}) {
    std::vector<std::string> all = {folder / "x.png"};
    all.insert(all.end(), options.begin(), options.end());
    ASSERT_EQ(picture(kBanks / "bronze-bell.glb", all).exit_code, 0);
    auto said = read(folder / "x.png");
    EXPECT_EQ(said["size"], size);
    EXPECT_GT(std::stoi(said["colours"]), 200);
    EXPECT_LT(std::stoi(said["white"].substr(2)), 95);
    EXPECT_GT(std::stoi(said["white"].substr(2)), 40) << "a light background";
  }
}

// The fourth part of the picture shows the pieces of each pattern, together and apart.
TEST(Picture, ABodyThatBreaksHasAPictureOfItsPieces) {
  const TemporaryFolder folder;
  ASSERT_EQ(picture(kBanks / "tumbler.glb", {folder / "x.png"}).exit_code, 0);
  EXPECT_EQ(read(folder / "x.png")["size"], "1120 1200");
  ASSERT_EQ(picture(kBanks / "tumbler.glb", {folder / "x.svg"}).exit_code, 0);
  const modal::Bank bank = *modal::read_bank(kBanks / "tumbler.glb");
  for (const modal::BreakPattern& pattern : bank.fracture->patterns) {
    cli::Canvas canvas(cli::Canvas::Kind::svg, 400, 300);
    cli::draw_pieces(canvas, {0, 0, 400, 300}, pattern, 0.5);
    const std::string drawn = std::move(canvas).finish();
    std::size_t triangles = 0, areas = 0;
    for (const modal::PieceBank& piece : pattern.pieces) triangles += piece.bank.triangles.size();
    for (auto at = drawn.find("<path"); at != std::string::npos; at = drawn.find("<path", at + 1)) ++areas;
    EXPECT_GE(areas, triangles);
  }
}

TEST(Picture, ThePictureIsTheSameEveryTime) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"}) {
    const std::string stem = folder / name;
    for (const char* ending : {".png", ".svg", ".html"}) {
      ASSERT_EQ(picture(kBanks / "coin.glb", {stem + ending}).exit_code, 0);
    }
  }
  EXPECT_TRUE(bytes_of(folder / "a.png") == bytes_of(folder / "b.png"));
  EXPECT_TRUE(bytes_of(folder / "a.svg") == bytes_of(folder / "b.svg"));
  EXPECT_TRUE(bytes_of(folder / "a.html") == bytes_of(folder / "b.html"));
}

TEST(Picture, PresetsHaveAPageWithEveryMode) {
  const TemporaryFolder folder;
  std::vector<fs::path> banks = preset_banks();
  std::ranges::sort(banks, {}, [](const fs::path& path) { return fs::file_size(path); });
  banks.erase(banks.begin() + 15, banks.end() - 1);  // the small ones and the largest
  for (const fs::path& path : banks) {
    const auto bank = *modal::read_bank(path);
    ASSERT_EQ(picture(path, {folder / "x.html"}).exit_code, 0) << path;
    auto said = read(folder / "x.html");
    EXPECT_EQ(said["title"], bank.name);
    EXPECT_EQ(said["rows"], std::to_string(bank.mode_count() + 1));
    EXPECT_EQ(said["faults"], "0 outside 0") << path;
    EXPECT_LT(fs::file_size(folder / "x.html"), 1'000'000u) << path;
    EXPECT_EQ(said["points"], std::to_string(6 * bank.point_count()));
    EXPECT_EQ(said["triangles"], std::to_string(6 * bank.triangles.size()));
    const std::size_t places = cli::places_of(bank).size();
    EXPECT_EQ(said["places"], std::to_string(2 * places));
    EXPECT_EQ(said["shapes"], std::to_string(6 * places * bank.mode_count()));
    for (const double hz : bank.frequency_hz) {
      std::ostringstream cell;
      cell << std::fixed;
      cell.precision(3);
      cell << hz << "\n";
      EXPECT_NE(said["cell"].find(cell.str()), std::string::npos) << hz;
    }
  }
}

TEST(Picture, ThePictureNamesCannotBreakOut) {
  const TemporaryFolder folder;
  modal::Bank bank = bar_bank(5);
  bank.name = "</title><script>alert(1)</script>\"' onload=x & \xC3\x28 \x01 \xE2\x99\xAA";
  bank.material->name = "<img src=x onerror=alert(2)>";
  bank.provenance.generator = "]]><!--</svg>";
  const cli::Answer answer = cli::answer_of(bank, {});
  std::ofstream(folder / "x.html") << cli::bank_page(bank, answer);
  auto said = read(folder / "x.html");
  EXPECT_EQ(said["title"], "</title><script>alert(1)</script>\"' onload=x & \xEF\xBF\xBD(   \xE2\x99\xAA");
  EXPECT_EQ(said["faults"], "0 outside 0");
  EXPECT_EQ(said["rows"], "6");
}

TEST(Picture, ForeignBanksAreDrawnToo) {
  modal::Bank bank = bar_bank(3);  // no triangles
  bank.material.reset(), bank.mass.reset(), bank.name.clear(), bank.frequency_error.clear();
  bank.decay_per_s[1] = 0;
  for (auto& shape : bank.shapes) shape = {0, 0, 0};  // a mode that moves nothing
  EXPECT_FALSE(cli::bank_page(bank, cli::answer_of(bank, {})).empty());
  modal::Bank single = single_mode_bank(25000, 1);
  single.positions.resize(1), single.shapes.resize(1), single.triangles.clear();
  EXPECT_FALSE(cli::bank_page(single, cli::answer_of(single, Vec3{1, 2, 3})).empty());
  const modal::Bank large = random_bank(1, 2, cli::kMaxDrawn + 1);
  const std::string page = cli::bank_page(large, cli::answer_of(large, {}));
  EXPECT_NE(page.find("id=\"view-data\">{}</script>"), std::string::npos) << "too large a surface is left out";
}

TEST(Picture, TheStruckPointIsTheNearestOrTheLoudest) {
  modal::Bank bank = bar_bank(4);
  const cli::Answer middle = cli::answer_of(bank, Vec3{0.151, 0.3, 0.1});
  EXPECT_EQ(middle.point, 8u) << "of 17 along 0.3 m";
  EXPECT_NEAR(std::abs(middle.amplitude[1]), 0, 1e-2 * std::abs(middle.amplitude[0])) << "the second mode rests there";
  const cli::Answer loudest = cli::answer_of(bank, {});
  EXPECT_TRUE(loudest.point == 0 || loudest.point == 16) << "a free bar moves most at its ends";
  EXPECT_EQ(std::abs(loudest.direction.z), 1);
}

// The Fourier integral of exp(-d t) sin(w t), summed.
TEST(Picture, TheSpectrumIsThatOfTheSound) {
  const modal::Bank bank = single_mode_bank(300, 40);
  const cli::Answer answer = cli::answer_of(bank, {});
  const auto level = [&](double hz) {
    double re = 0, im = 0;
    const double step = 1e-6, two_pi = 2 * std::numbers::pi;
    for (double t = 0; t < 0.4; t += step) {
      const double s = step * std::exp(-40 * t) * std::sin(two_pi * 300 * t);
      re += s * std::cos(two_pi * hz * t), im += s * std::sin(two_pi * hz * t);
    }
    return 20 * std::log10(std::hypot(re, im));
  };
  for (const double hz : {100.0, 290.0, 320.0, 1000.0}) {
    EXPECT_NEAR(cli::level_db(bank, answer, hz) - cli::level_db(bank, answer, 300), level(hz) - level(300), 0.01);
  }
}

TEST(Picture, TheViewDrawsEveryTriangleChoosesModesAndStrikesWhatIsPressed) {
  if (!installed("node")) GTEST_SKIP() << "node is not installed";
  const TemporaryFolder folder;
  const auto bank = *modal::read_bank(kBanks / "coin.glb");
  ASSERT_EQ(picture(kBanks / "coin.glb", {folder / "x.html"}).exit_code, 0);
  const Outcome ran = run({"node", RINGDOWN_SOURCE_DIR "/tests/picture/run_view.js", folder / "x.html"});
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_NE(ran.output.find("faces " + std::to_string(bank.triangles.size()) + " points 0"), std::string::npos)
      << ran.output;
  EXPECT_NE(ran.output.find("sounds 0"), std::string::npos) << "nothing was struck beside the object";
  EXPECT_NE(ran.output.find("struck Struck at ("), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("peak true"), std::string::npos) << ran.output;
  const std::string last = std::to_string(bank.mode_count() - 2);  // the last one was chosen, then the one before it
  EXPECT_NE(ran.output.find("title mode " + last + ", " + last + "/1 Hz"), std::string::npos) << ran.output;
}

TEST(Picture, ABankWithoutTrianglesIsStruckAtItsPoints) {
  if (!installed("node")) GTEST_SKIP() << "node is not installed";
  const TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(bar_bank(3), folder / "bar.glb"));
  ASSERT_EQ(picture(folder / "bar.glb", {folder / "x.html"}).exit_code, 0);
  const Outcome ran = run({"node", RINGDOWN_SOURCE_DIR "/tests/picture/run_view.js", folder / "x.html"});
  EXPECT_NE(ran.output.find("faces 0 points 17"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("sounds 0"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("peak true"), std::string::npos) << ran.output;
}

TEST(Picture, APageWhoseShapesWouldBeTooLargeHasPlacesAllOverTheBody) {
  const auto bank = *modal::read_bank(kBanks / "crash-cymbal.glb");
  const std::vector<std::uint16_t> places = cli::places_of(bank);
  EXPECT_EQ(places.size(), cli::kMaxShapeBytes / (6 * bank.mode_count()));
  double farthest = 0;
  for (const auto& point : bank.positions) {
    double nearest = 1;
    for (const std::uint16_t p : places)
      nearest = std::min(nearest, length(cli::wide(point) - cli::wide(bank.positions[p])));
    farthest = std::max(farthest, nearest);
  }
  EXPECT_LT(farthest, 0.015) << "of a disc of 0.36 m";
}

// Each number that strike_page.js and press_page.js print after "error", in dB; all of them are stated in `output`.
std::vector<double> errors_in(const std::string& output) {
  std::vector<double> errors;
  for (auto at = output.find("error "); at != std::string::npos; at = output.find("error ", at + 1)) {
    errors.push_back(std::strtod(output.c_str() + at + 6, nullptr));
  }
  return errors;
}

// A body with maps of radiation, one with modes above Nyquist's frequency and pieces, a gong that glides when it is
// struck hard, and a bank of another maker, whose loudness follows from its triangles.
TEST(Picture, ThePageSoundsAsRenderDoes) {
  if (!installed("node")) GTEST_SKIP() << "node is not installed";
  const TemporaryFolder folder;
  modal::Bank foreign = *modal::read_bank(kBanks / "coin.glb");
  foreign.radiation.reset(), foreign.gain = 0.5;
  ASSERT_TRUE(modal::write_bank(foreign, folder / "foreign.glb"));
  std::vector<fs::path> banks = {folder / "foreign.glb"};
  for (const char* name : {"bronze-bell", "tumbler", "opera-gong"})
    banks.push_back(kBanks / (name + std::string(".glb")));
  for (const fs::path& bank : banks) {
    ASSERT_EQ(picture(bank, {folder / "x.html"}).exit_code, 0);
    const Outcome ran = run({"node", RINGDOWN_SOURCE_DIR "/tests/picture/strike_page.js", folder / "x.html",
                             RINGDOWN_BIN_DIR "/ringdown", bank});
    const std::vector<double> errors = errors_in(ran.output);
    EXPECT_EQ(errors.size(), 3u) << ran.output;
    for (const double error : errors) EXPECT_LT(error, -60) << bank << "\n" << ran.output;
  }
}

// By mouse and by finger, each at what the eye sees.
TEST(Picture, ThePageSoundsInABrowserWhereItIsPressed) {
  if (!installed("node")) GTEST_SKIP() << "node is not installed";
  if (!installed("chromium")) GTEST_SKIP() << "chromium is not installed";
  const TemporaryFolder folder;
  const fs::path bank = kBanks / "steel-plate.glb";
  ASSERT_EQ(picture(bank, {folder / "x.html"}).exit_code, 0);
  const Outcome ran = run({"node", RINGDOWN_SOURCE_DIR "/tests/picture/press_page.js", folder / "x.html",
                           RINGDOWN_BIN_DIR "/ringdown", bank, "chromium"});
  const std::vector<double> errors = errors_in(ran.output);
  EXPECT_EQ(errors.size(), 2u) << ran.output;
  for (const char* how : {"mouse", "touch"})
    EXPECT_NE(ran.output.find(how + std::string(" audio running")), std::string::npos) << ran.output;
  for (const double error : errors) EXPECT_LT(error, -60) << ran.output;
}

TEST(Picture, APictureThatCannotBeWrittenIsReported) {
  const Outcome ran = picture(kBanks / "coin.glb", {"/nowhere/x.png"});
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_NE(ran.output.find("/nowhere/x.png"), std::string::npos);
  EXPECT_EQ(picture("/nowhere.glb", {"x.html"}).exit_code, 3);
  EXPECT_EQ(picture(kBanks / "coin.glb", {"x.png", "--at", "1,2"}).exit_code, 2);
  EXPECT_EQ(picture(kBanks / "coin.glb", {"x.jpg"}).exit_code, 2) << "no such kind of picture";
  EXPECT_EQ(picture(kBanks / "coin.glb", {"x.html", "--small"}).exit_code, 2);
}

}  // namespace
}  // namespace ringdown::test
