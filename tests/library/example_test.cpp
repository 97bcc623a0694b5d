// The C example bounces: its blows are where mechanics says, and each is 0.6 of the one before.
#include "clients/library/ringdown.h"
#include "engine/modal/bank_file.h"
#include "tests/integration/process.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

namespace ringdown::test::example_test {
namespace {

constexpr double kRate_hz = 48000, kPitch_hz = 1000, kDecay_per_s = 60;

TEST(LibraryExample, BouncesAsMechanicsSays) {
  const std::string program = RINGDOWN_BIN_DIR "/game_engine";
  if (!std::filesystem::exists(program)) GTEST_SKIP() << "the example is not built with sanitizers";
  const TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(single_mode_bank(kPitch_hz, kDecay_per_s, {0, 0, 1}), folder / "bell.glb"));
  const auto sound = folder / "bounces.f32";
  const Outcome outcome = run({program, folder / "bell.glb", sound});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;

  std::ifstream file(sound, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::vector<float> samples(bytes.size() / sizeof(float));
  std::memcpy(samples.data(), bytes.data(), samples.size() * sizeof(float));
  ASSERT_EQ(samples.size(), 2u * 3u * 48000u);
  const auto peak_in = [&](double from_s, double to_s) {
    float peak = 0;
    for (auto i = static_cast<std::size_t>(from_s * kRate_hz); i < static_cast<std::size_t>(to_s * kRate_hz); ++i) {
      peak = std::max(peak, std::abs(samples[2 * i]));
    }
    return static_cast<double>(peak);
  };
  // The game's steps of 1/60 s move its landings by up to two steps.
  const double fall_s = std::sqrt(2 * 0.2 / 9.81), flight_s = 2 * 0.6 * 9.81 * fall_s / 9.81;
  EXPECT_EQ(peak_in(0, fall_s - 0.034), 0);
  const double first = peak_in(fall_s - 0.034, fall_s + 0.04);
  const double second = peak_in(fall_s + flight_s - 0.05, fall_s + flight_s + 0.05);
  EXPECT_GT(first, 0);
  EXPECT_NEAR(second / first, 0.6, 0.06);

  EXPECT_EQ(run({program, "/nonexistent.glb", sound}).exit_code, 1);
}

// C# plays the same bounces through the same library, in a world as Unity's: the same bytes.
TEST(LibraryExample, InCSharpGivesTheBytesOfTheOneInC) {
  if (!installed("mcs") || !installed("mono")) GTEST_SKIP() << "mono-mcs and mono-runtime are not installed";
  const std::string program = RINGDOWN_BIN_DIR "/game_engine";
  if (!std::filesystem::exists(program)) GTEST_SKIP() << "the example is not built with sanitizers";
  const TemporaryFolder folder;
  const std::string sources = RINGDOWN_SOURCE_DIR "/clients/csharp/";
  const auto bounce = folder / "Bounce.exe";
  const Outcome made = run({"mcs", "-out:" + bounce.string(), sources + "Bounce.cs", sources + "Ringdown.cs"});
  ASSERT_EQ(made.exit_code, 0) << made.output;
  ASSERT_TRUE(modal::write_bank(random_bank(1, 30, 12), folder / "bell.glb"));
  const Process::Environment environment = {{"LD_LIBRARY_PATH", RINGDOWN_BIN_DIR "/../lib"}};
  const Outcome sharp = run({"mono", bounce, folder / "bell.glb", folder / "sharp.f32"}, environment);
  ASSERT_EQ(sharp.exit_code, 0) << sharp.output;
  ASSERT_EQ(run({program, folder / "bell.glb", folder / "c.f32"}).exit_code, 0);
  const auto bytes_of = [](const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  EXPECT_EQ(bytes_of(folder / "sharp.f32").size(), 8u * 3 * 48000);
  EXPECT_TRUE(bytes_of(folder / "sharp.f32") == bytes_of(folder / "c.f32"));
  const Outcome refused = run({"mono", bounce, "/nonexistent.glb", folder / "sharp.f32"}, environment);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.output.find("/nonexistent.glb"), std::string::npos) << refused.output;
}

// The Unity package strikes where a collision says, in the body's own frame. Unity is not here: Unity.cs stands for the
// few parts of it that the package uses.
TEST(LibraryExample, OfUnityStrikesWhereTheCollisionIs) {
  if (!installed("mcs") || !installed("mono")) GTEST_SKIP() << "mono-mcs and mono-runtime are not installed";
  if (std::string(RINGDOWN_SANITIZERS) != "") GTEST_SKIP() << "a sanitized library wants a sanitized program";
  const TemporaryFolder folder;
  const std::string package = RINGDOWN_SOURCE_DIR "/clients/unity/";
  const auto program = folder / "unity.exe";
  const Outcome made =
      run({"mcs", "-warnaserror", "-out:" + program.string(), RINGDOWN_SOURCE_DIR "/tests/library/Unity.cs",
           package + "Runtime/Ringdown.cs", package + "Runtime/RingdownMixer.cs", package + "Runtime/RingingBody.cs",
           package + "Samples~/Drop/Drop.cs"});
  ASSERT_EQ(made.exit_code, 0) << made.output;
  ASSERT_TRUE(modal::write_bank(random_bank(1, 30, 12), folder / "bell.glb"));
  const Outcome played = run({"mono", program, folder / "bell.glb"}, {{"LD_LIBRARY_PATH", RINGDOWN_BIN_DIR "/../lib"}});
  EXPECT_EQ(played.exit_code, 0) << played.output;
}

// C# breaks the pane into the pieces that the C library tells of.
TEST(LibraryExample, InCSharpAPaneBreaksIntoItsPieces) {
  if (!installed("mcs") || !installed("mono")) GTEST_SKIP() << "mono-mcs and mono-runtime are not installed";
  if (std::string(RINGDOWN_SANITIZERS) != "") GTEST_SKIP() << "a sanitized library wants a sanitized program";
  const TemporaryFolder folder;
  const std::string pane = RINGDOWN_SOURCE_DIR "/presets/banks/window-pane.glb";
  const auto breaks = folder / "Breaks.exe";
  const Outcome made = run({"mcs", "-out:" + breaks.string(), RINGDOWN_SOURCE_DIR "/tests/library/Breaks.cs",
                            RINGDOWN_SOURCE_DIR "/clients/csharp/Ringdown.cs"});
  ASSERT_EQ(made.exit_code, 0) << made.output;
  const Outcome sharp = run({"mono", breaks, pane}, {{"LD_LIBRARY_PATH", RINGDOWN_BIN_DIR "/../lib"}});
  ASSERT_EQ(sharp.exit_code, 0) << sharp.output;

  ringdown_bank* bank = nullptr;
  ASSERT_EQ(ringdown_bank_open(pane.c_str(), &bank, nullptr), RINGDOWN_OK);
  ringdown_pattern_info pattern{};
  pattern.size = sizeof pattern;
  ASSERT_EQ(ringdown_breakable(bank, 0, &pattern, nullptr), RINGDOWN_OK);
  ringdown_bank_info whole{};
  whole.size = sizeof whole;
  ringdown_bank_describe(bank, &whole);
  ringdown_bank_release(bank);
  std::istringstream told(sharp.output);
  std::size_t pieces = 0, points = 0;
  double mass_kg = 0, armed_kg = 0, momentum_ns = 0;
  told >> pieces >> mass_kg >> armed_kg >> momentum_ns >> points;
  EXPECT_EQ(pieces, pattern.pieces) << sharp.output;
  EXPECT_NEAR(mass_kg, whole.mass_kg, 1e-6 * mass_kg);
  EXPECT_NEAR(armed_kg, whole.mass_kg, 1e-6 * mass_kg);
  EXPECT_NEAR(momentum_ns, -0.025, 1e-8);
  EXPECT_GT(points, 100u);
}

// The pages' own programs and command compile as C99 and play, with the library installed below any folder and moved.
TEST(LibraryExample, OfThePagesCompileAndPlay) {
  if (!installed("cc") || std::string(RINGDOWN_SANITIZERS) != "") GTEST_SKIP() << "no compiler, or one that sanitizes";
  if (!installed("pkg-config")) GTEST_SKIP() << "pkg-config is not installed";
  const TemporaryFolder folder;
  for (const char* component : {"libringdown1", "libringdown-dev"}) {
    const Outcome put =
        run({"cmake", "--install", RINGDOWN_BIN_DIR "/..", "--component", component, "--prefix", folder / "first"});
    ASSERT_EQ(put.exit_code, 0) << put.output;
  }
  const auto prefix = folder / "moved";
  std::filesystem::rename(folder / "first", prefix);
  std::filesystem::path library;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(prefix)) {
    if (entry.path().filename() == "ringdown.pc") library = entry.path().parent_path().parent_path();
  }
  ASSERT_FALSE(library.empty()) << "no ringdown.pc was installed";
  const auto played = [&](const std::string& name, const std::filesystem::path& bank) {
    std::ifstream page(RINGDOWN_SOURCE_DIR "/docs/use/" + name + ".md");
    const std::string text{std::istreambuf_iterator<char>(page), {}};
    const std::size_t begin = text.find("```c\n") + 5, end = text.find("```", begin);
    if (end == text.npos) return Outcome{1, name + " has no program"};
    std::ofstream(folder / (name + ".c")) << text.substr(begin, end - begin);
    const std::string command = "cc -std=c99 -Wall -Wextra -Werror " + (folder / (name + ".c")).string() +
                                " $(pkg-config --cflags --libs ringdown) -o " + (folder / name).string();
    const Outcome made = run({"sh", "-c", command}, {{"PKG_CONFIG_PATH", (library / "pkgconfig").string()}});
    return made.exit_code != 0 ? made : run({folder / name, bank}, {{"LD_LIBRARY_PATH", library.string()}});
  };
  ASSERT_TRUE(modal::write_bank(random_bank(1, 30, 12), folder / "bell.glb"));
  const Outcome bell = played("library", folder / "bell.glb");
  EXPECT_EQ(bell.exit_code, 0);
  EXPECT_NE(bell.output.find("30 modes ring"), std::string::npos) << bell.output;
  const Outcome pane = played("breaking", RINGDOWN_SOURCE_DIR "/presets/banks/window-pane.glb");
  EXPECT_EQ(pane.exit_code, 0) << pane.output;
  EXPECT_NE(pane.output.find("20: "), std::string::npos) << pane.output;
}

}  // namespace
}  // namespace ringdown::test::example_test
