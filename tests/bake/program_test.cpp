// ringdown-bake as its user meets it: exit codes, what it prints, what it leaves behind.
#include "engine/modal/bank_file.h"
#include "engine/modal/damping.h"
#include "tests/support/temporary_folder.h"

#include <gmsh.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sys/wait.h>
#include <unistd.h>

namespace ringdown::program_test {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

const fs::path kPresets = fs::path(RINGDOWN_SOURCE_DIR) / "presets";

struct Ran {
  int exit_code;
  std::string output;
};

// Without a cache unless `environment` names one: tests must neither use nor fill the user's.
Ran bake(const std::string& arguments, const std::string& environment = "RINGDOWN_CACHE=/dev/null/none") {
  const std::string command = environment + " " RINGDOWN_BIN_DIR "/ringdown-bake " + arguments + " 2>&1";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::string output;
  std::array<char, 512> part{};
  while (std::fgets(part.data(), part.size(), pipe)) output += part.data();
  return {WEXITSTATUS(::pclose(pipe)), output};
}

TEST(BakeProgram, TheProgramBakesAPreset) {
  const TemporaryFolder folder;
  const fs::path bank = folder.path() / "bar.glb";
  const Ran ran = bake((kPresets / "objects/wooden-bar.toml").string() + " -o " + bank.string());
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_NE(ran.output.find("unknowns"), std::string::npos) << ran.output;
  EXPECT_EQ(ran.output.find('\r'), std::string::npos) << "progress is for terminals";
  auto fresh = modal::read_bank(bank), kept = modal::read_bank(kPresets / "banks/wooden-bar.glb");
  ASSERT_TRUE(fresh) << fresh.error().message;
  ASSERT_EQ(fresh->mode_count(), kept->mode_count());
  // The kept one knows what its modes radiate, has them in the order of that, and the air damps them.
  const double error = std::ranges::max(fresh->frequency_error) + std::ranges::max(kept->frequency_error);
  const auto undamped = [](const modal::Bank& of) {
    std::vector<double> frequencies;
    for (std::size_t m = 0; m < of.mode_count(); ++m)
      frequencies.push_back(std::sqrt(modal::undamped_lambda({of.frequency_hz[m], of.decay_per_s[m]})));
    std::ranges::sort(frequencies);
    return frequencies;
  };
  const std::vector<double> found = undamped(*fresh), wanted = undamped(*kept);
  // gmsh 4.8 made the mesh of the bank that is kept; another version makes another mesh.
  const bool same_mesh = GMSH_API_VERSION_MAJOR == 4 && GMSH_API_VERSION_MINOR == 8;
  for (std::size_t m = 0; m < found.size(); ++m) EXPECT_NEAR(found[m] / wanted[m], 1, same_mesh ? 1e-5 : error);
}

TEST(BakeProgram, OptionsOverrideTheObject) {
  const TemporaryFolder folder;
  const fs::path bank = folder.path() / "bar.glb";
  const Ran ran = bake((kPresets / "objects/wooden-bar.toml").string() + " -q -m steel --element tet4 --points 30 " +
                       "--band 100 9000 --keep 4 --set length=200 --mesh-size 0.01 --name rod -o " + bank.string());
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_EQ(ran.output, "");
  const auto read = modal::read_bank(bank);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->name, "rod");
  EXPECT_EQ(read->mode_count(), 4u);
  EXPECT_LE(read->point_count(), 30u);
  EXPECT_EQ(read->material->name, "steel");
  EXPECT_EQ(read->provenance.element, "tet4 consistent");
  EXPECT_NEAR(read->mass->mass_kg, 7800 * 0.2 * 0.045 * 0.022, 0.6);
}

TEST(BakeProgram, RefusalsHaveTheirExitCodesAndOneSentence) {
  const TemporaryFolder folder;
  const std::string out = " -o " + (folder.path() / "x.glb").string();
  const fs::path mesh = folder.write("bad.msh", "no mesh");
  const std::pair<std::string, int> cases[] = {
      {"", 2},
      {"--nonsense" + out, 2},
      {mesh.string() + " -m steel", 2},
      {(kPresets / "objects/wooden-bar.toml").string() + " --solver magic" + out, 3},
      {(kPresets / "objects/wooden-bar.toml").string() + " --processes 0" + out, 2},
      {mesh.string() + out + " --points few", 2},
      {mesh.string() + out + " --set length", 2},
      {mesh.string() + out + " -m steel --set-material nu", 2},
      {mesh.string() + out + " -m steel --scale 0", 2},
      {(kPresets / "objects/wooden-bar.toml").string() + " --set-material nu=0.3" + out, 3},
      {(kPresets / "objects/wooden-bar.toml").string() + " --set-material poisson_ratio=0.6" + out, 3},
      {mesh.string() + out + " -m steel --error small", 2},
      {mesh.string() + out + " -m steel --error 60%", 2},
      {mesh.string() + out + " -m steel --error 0.1% --preview", 2},
      {"/nowhere" + out, 3},
      {mesh.string() + out, 3},
      {mesh.string() + " -m steel" + out, 3},
      {mesh.string() + " -m kryptonite" + out, 3},
      {"/nowhere.toml" + out, 3},
      {(kPresets / "objects/wooden-bar.toml").string() + " -o /nowhere/x.glb", 1},
  };
  for (const auto& [arguments, exit_code] : cases) {
    const Ran ran = bake(arguments);
    EXPECT_EQ(ran.exit_code, exit_code) << arguments << "\n" << ran.output;
    EXPECT_EQ(std::count(ran.output.begin(), ran.output.end(), '\n'), 1) << ran.output;
    EXPECT_TRUE(ran.output.starts_with("ringdown-bake: ")) << ran.output;
  }
  EXPECT_FALSE(fs::exists(folder.path() / "x.glb"));
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(BakeProgram, ASecondBakeComesFromTheCacheAndIsTheSameFile) {
  const TemporaryFolder folder;
  const std::string environment = "RINGDOWN_CACHE=" + (folder.path() / "cache").string();
  const auto bar = [&](const std::string& name, const std::string& options) {
    const std::string mesh = options.find("--mesh-size") == options.npos ? " --mesh-size 0.03 " : " ";
    const std::string band = options.find("--band") == options.npos ? "--band 20 8000 " : "";
    return bake((kPresets / "objects/wooden-bar.toml").string() + mesh + band + options + " -o " +
                    (folder.path() / name).string(),
                environment);
  };
  const auto solved = [](const Ran& ran) { return ran.output.find("from the cache") == std::string::npos; };
  const Ran apart = bar("apart.glb", "--no-cache");
  ASSERT_EQ(apart.exit_code, 0) << apart.output;
  EXPECT_FALSE(fs::exists(folder.path() / "cache"));
  EXPECT_TRUE(solved(bar("first.glb", "")));
  const Ran second = bar("second.glb", "");
  EXPECT_FALSE(solved(second)) << second.output;
  EXPECT_FALSE(solved(bar("half.glb", "--scale 0.5"))) << "a smaller one has no modes that were not found";
  EXPECT_TRUE(solved(bar("twice.glb", "--scale 2 --band 20 4200"))) << "a larger one has";
  EXPECT_FALSE(solved(bar("twice-low.glb", "--scale 2 --band 20 4000")));
  EXPECT_FALSE(solved(bar("denser.glb", "--set-material density_kg_m3=900"))) << "a factor on its modes";
  EXPECT_FALSE(solved(bar("smaller.glb", "--unit 0.0005 --mesh-size 0.015 --points 40"))) << "the same shape";
  EXPECT_TRUE(solved(bar("steel.glb", "-m steel"))) << "another Poisson's ratio";
  EXPECT_TRUE(solved(bar("longer.glb", "--set length=341")));
  EXPECT_TRUE(bytes_of(folder.path() / "first.glb") == bytes_of(folder.path() / "second.glb"));
  EXPECT_TRUE(bytes_of(folder.path() / "first.glb") == bytes_of(folder.path() / "apart.glb"));
}

TEST(BakeProgram, TheProgramScalesWithoutMeshingAgain) {
  const TemporaryFolder folder;
  const auto bar = [&](const std::string& options) {
    const fs::path bank = folder.path() / "bar.glb";
    const Ran ran = bake((kPresets / "objects/wooden-bar.toml").string() + " " + options + " -o " + bank.string());
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
    return modal::read_bank(bank).value();
  };
  const modal::Bank one = bar("--element tet10 --band 20 5000"),
                    half = bar("--element tet10 --scale 0.5 --band 40 10000 --set-material beta_s=0");
  ASSERT_EQ(one.mode_count(), half.mode_count());
  EXPECT_NEAR(half.mass->mass_kg / one.mass->mass_kg, 0.125, 1e-9);
  EXPECT_NEAR(*std::ranges::min_element(half.frequency_hz) / *std::ranges::min_element(one.frequency_hz), 2, 1e-4);
  EXPECT_EQ(half.material->damping.beta_s, 0);
  for (std::size_t p = 0; p < one.point_count(); ++p) EXPECT_EQ(half.positions[p][0], one.positions[p][0] / 2);
}

TEST(BakeProgram, TheProgramSaysWhatItLeftOut) {
  const TemporaryFolder folder;
  const fs::path bank = folder.path() / "bar.glb";
  const Ran ran = bake((kPresets / "objects/wooden-bar.toml").string() + " --keep 10 --floor 50 -o " + bank.string());
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_NE(ran.output.find("left out of the band: "), std::string::npos) << ran.output;
  const auto read = modal::read_bank(bank);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->mode_count(), 10u);
  EXPECT_GT(read->provenance.dropped_modes, 0);
  EXPECT_EQ(read->provenance.floor_db, 50);
  EXPECT_LT(read->provenance.loss_db, 0);
}

TEST(BakeProgram, EverySolverFindsTheSamePitches) {
  const TemporaryFolder folder;
  std::vector<double> yardstick;
  for (const std::string solver : {"dense", "spectra", "block", "slepc --processes 2"}) {
    if (solver.starts_with("slepc") && !fs::exists(RINGDOWN_BIN_DIR "/ringdown-modes-slepc")) {
      GTEST_SKIP() << "ringdown-modes-slepc was not built: no SLEPc here";
    }
    const fs::path bank = folder.path() / "bar.glb";
    const Ran ran = bake((kPresets / "objects/wooden-bar.toml").string() +
                         " -q --no-cache --element tet4 --mesh-size 0.03 --band 20 9000 --solver " + solver + " -o " +
                         bank.string());
    ASSERT_EQ(ran.exit_code, 0) << ran.output;
    const auto read = modal::read_bank(bank);
    ASSERT_TRUE(read);
    if (yardstick.empty()) yardstick = read->frequency_hz;
    ASSERT_EQ(read->mode_count(), yardstick.size()) << solver;
    for (std::size_t m = 0; m < yardstick.size(); ++m) EXPECT_NEAR(read->frequency_hz[m] / yardstick[m], 1, 1e-7);
  }
  EXPECT_GT(yardstick.size(), 3u);
}

TEST(BakeProgram, TheProgramFindsThePresetsWhereItIsTold) {
  const TemporaryFolder folder;
  const Ran ran = bake("a.msh -m steel -o b.glb", "RINGDOWN_CACHE=/dev/null/none RINGDOWN_PRESETS=/nowhere");
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_NE(ran.output.find("RINGDOWN_PRESETS"), std::string::npos);
}

TEST(BakeProgram, ControlCLeavesNothingBehind) {
  const TemporaryFolder folder;
  const std::string program = RINGDOWN_BIN_DIR "/ringdown-bake", bell = kPresets / "objects/bronze-bell.toml",
                    out = folder.path() / "bell.glb";
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    std::freopen("/dev/null", "w", stderr);
    ::dup2(pipe[1], STDOUT_FILENO);
    ::execl(program.c_str(), program.c_str(), bell.c_str(), "--mesh-size", "0.012", "--no-cache", "--progress-lines",
            "-o", out.c_str(), nullptr);
    ::_exit(99);
  }
  ::close(pipe[1]);
  char progress = 0;
  EXPECT_EQ(::read(pipe[0], &progress, 1), 1) << "the bake began, which takes a minute and more";
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  ::close(pipe[0]);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace ringdown::program_test
