// ringdown-bake FOLDER: what is baked, what is left alone, what is said.
#include "tests/batch/box_folder.h"

#include "engine/modal/bank_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

bool says(const Outcome& ran, const std::string& text) { return ran.output.find(text) != std::string::npos; }

TEST(FolderBake, EveryObjectOfAFolderIsBakedAndASecondTimeNone) {
  const BoxFolder boxes;
  for (int n = 1; n <= 3; ++n) boxes.box("b" + std::to_string(n), 80 + 10 * n);
  const Outcome first = boxes.bake({"--jobs", "2"});
  ASSERT_EQ(first.exit_code, 0) << first.output;
  EXPECT_TRUE(says(first, "3 objects: 3 baked, 0 unchanged, 0 failed; ")) << first.output;
  EXPECT_EQ(first.output.find('\x1b'), std::string::npos) << "no terminal, no cursor";
  EXPECT_EQ(boxes.whole_banks(), (Words{"b1.glb", "b2.glb", "b3.glb"}));
  EXPECT_EQ(boxes.files_in_banks(), boxes.whole_banks());
  const auto length = [&](const std::string& name) {
    const auto bank = modal::read_bank(boxes.bank(name));
    double longest = 0;
    for (const modal::Vec3f& p : bank->positions) longest = std::max<double>(longest, p[0]);
    return longest;
  };
  EXPECT_NEAR(length("b1"), 0.09, 1e-6);
  EXPECT_NEAR(length("b3"), 0.11, 1e-6);

  const auto written = fs::last_write_time(boxes.bank("b2"));
  const Outcome second = boxes.bake();
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_TRUE(says(second, "3 objects: 0 baked, 3 unchanged, 0 failed; ")) << second.output;
  EXPECT_EQ(fs::last_write_time(boxes.bank("b2")), written);
  EXPECT_TRUE(says(boxes.bake({"--force"}), "3 baked, 0 unchanged"));
  EXPECT_NE(fs::last_write_time(boxes.bank("b2")), written);
}

// What changed the one object, and not the other.
TEST(FolderBake, AnObjectIsBakedAgainWhenItsInputsChange) {
  const BoxFolder boxes;
  boxes.box("a", 100);
  boxes.box("b", 110);
  boxes.write("objects/own.geo",
              "SetFactory(\"OpenCASCADE\"); Include \"parts/size.geo\";\nBox(1) = {0, 0, 0, size, 40, 20};");
  boxes.write("objects/parts/size.geo", "size = 90;\n");
  boxes.write("materials/other.toml", [&] {
    std::ifstream file(boxes.materials() / "stuff.toml");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    return text.replace(text.find("stuff"), 5, "other");
  }());
  boxes.write("objects/a.toml",
              "material = \"other\"\ngeometry = \"own.geo\"\nunit_m = 0.001\nmesh_size_m = 0.02\nelement = \"tet4\"\n");
  ASSERT_EQ(boxes.bake().exit_code, 0);
  const std::string bank = boxes.bank("a");
  const auto append = [](const fs::path& path) { std::ofstream(path, std::ios::app) << "\n"; };
  const std::pair<const char*, std::function<void()>> changes[] = {
      {"its object file", [&] { append(boxes.objects() / "a.toml"); }},
      {"its geometry", [&] { append(boxes.objects() / "own.geo"); }},
      {"what that includes", [&] { append(boxes.objects() / "parts/size.geo"); }},
      {"its material", [&] { append(boxes.materials() / "other.toml"); }},
      {"the bank is missing", [&] { fs::remove(bank); }},
      {"it was cut off", [&] { fs::resize_file(bank, fs::file_size(bank) - 8); }},
      {"it is no bank", [&] { std::ofstream(bank) << "old"; }},
  };
  for (const auto& [what, change] : changes) {
    change();
    const Outcome ran = boxes.bake();
    EXPECT_TRUE(says(ran, "2 objects: 1 baked, 1 unchanged, 0 failed; ")) << what << "\n" << ran.output;
    EXPECT_TRUE(says(ran, "a: baked")) << what << "\n" << ran.output;
  }
  EXPECT_TRUE(says(boxes.bake({"--points", "50"}), "2 baked, 0 unchanged")) << "other options";
  EXPECT_TRUE(says(boxes.bake({"--points", "50"}), "0 baked, 2 unchanged"));
}

TEST(FolderBake, ABankBakedAloneIsUnchangedForTheFolderAndViceVersa) {
  const BoxFolder boxes;
  boxes.box("a", 100);
  const auto alone = [&](const std::string& option) {
    return run({RINGDOWN_BIN_DIR "/ringdown-bake", boxes.objects() / "a.toml", "-o", boxes.bank("a"), "--materials",
                boxes.materials(), "--no-cache", option});
  };
  fs::create_directories(boxes.banks());
  EXPECT_TRUE(says(alone("--update"), "unknowns"));
  EXPECT_TRUE(says(boxes.bake(), "0 baked, 1 unchanged"));
  EXPECT_EQ(alone("--update").output, "a: unchanged\n");
  EXPECT_TRUE(says(alone("--preview"), "unknowns")) << "without --update it always bakes";
  EXPECT_TRUE(says(boxes.bake(), "1 baked, 0 unchanged"));
}

TEST(FolderBake, ABadObjectDoesNotStopTheOthersOfItsFolder) {
  const BoxFolder boxes;
  boxes.box("good", 100);
  boxes.box("goodtoo", 90);
  boxes.write("objects/nokey.toml", "material = \"stuff\"\n\ngeomtry = \"box.geo\"\n");
  boxes.write("objects/mesh.toml", "material = \"stuff\"\ngeometry = \"bad.msh\"\n");
  boxes.write("objects/bad.msh", "no mesh");
  boxes.box("stone", 100);
  boxes.write("objects/stone.toml", "material = \"stone\"\ngeometry = \"box.geo\"\n");
  const Outcome ran = boxes.bake();
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_TRUE(says(ran, "5 objects: 2 baked, 0 unchanged, 3 failed; ")) << ran.output;
  EXPECT_TRUE(says(ran, "\nringdown-bake: mesh: ")) << ran.output;
  EXPECT_TRUE(says(ran, "bad.msh")) << ran.output;
  EXPECT_TRUE(says(ran, "nokey.toml:")) << "its place: " << ran.output;
  EXPECT_TRUE(says(ran, "\nringdown-bake: stone: there is no material 'stone' in ")) << ran.output;
  EXPECT_EQ(boxes.files_in_banks(), (Words{"good.glb", "goodtoo.glb"}));
  EXPECT_TRUE(says(boxes.bake(), "0 baked, 2 unchanged, 3 failed")) << "failures are tried again";
}

TEST(FolderBake, ShapesWithoutAnObjectFileNeedAMaterialAndAreBakedOnce) {
  const BoxFolder boxes;
  boxes.box("a", 100);
  const std::string box = "SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 0.1, 0.04, 0.02};\n";
  boxes.write("objects/alone.geo", box);
  boxes.write("objects/twice.geo", box);
  boxes.write("objects/twice.msh", "no mesh");
  boxes.write("objects/a.stl", "beside an object of this name");
  const Words coarse = {"--element", "tet4", "--mesh-size", "0.02"};
  const Outcome without = boxes.bake(coarse);
  EXPECT_EQ(without.exit_code, 0);
  EXPECT_TRUE(says(without, "1 object: 1 baked")) << without.output;
  EXPECT_TRUE(says(without, "left out: 3 shapes without an object file; --material bakes them")) << without.output;
  Words options = coarse;
  options.insert(options.end(), {"--material", "stuff"});
  const Outcome with = boxes.bake(options);
  EXPECT_EQ(with.exit_code, 3);
  EXPECT_TRUE(says(with, "3 objects: 1 baked, 1 unchanged, 1 failed; ")) << with.output;
  EXPECT_TRUE(says(with, "twice.geo and twice.msh would both become twice.glb; rename one of them")) << with.output;
  EXPECT_EQ(boxes.files_in_banks(), (Words{"a.glb", "alone.glb"}));
  EXPECT_TRUE(says(boxes.bake(options), "0 baked, 2 unchanged, 1 failed"));
}

TEST(FolderBake, BanksOfNestedFoldersKeepTheirRelativePaths) {
  const BoxFolder boxes;
  boxes.box("a", 100);
  fs::create_directories(boxes.objects() / "small");
  boxes.box("small/a", 105);
  EXPECT_TRUE(says(boxes.bake(), "1 object: 1 baked"));
  EXPECT_TRUE(says(boxes.bake({"--recursive"}), "2 objects: 1 baked, 1 unchanged"));
  EXPECT_EQ(boxes.whole_banks(), (Words{"a.glb", "small/a.glb"}));
}

TEST(FolderBake, BanksAreWrittenBesideTheObjectsByDefault) {
  const BoxFolder boxes;
  boxes.box("a", 100);
  const Words command = {
      RINGDOWN_BIN_DIR "/ringdown", "bake", boxes.objects(), "--materials", boxes.materials(), "--no-cache", "--quiet"};
  const Outcome ran = run(command);
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_EQ(ran.output, "");
  EXPECT_TRUE(modal::read_bank(boxes.objects() / "a.glb"));
}

TEST(FolderBake, ABakeBeyondItsBudgetOfProcessorTimeIsMarked) {
  const BoxFolder boxes;
  boxes.box("dear", 100, "budget_s = 0.001");
  boxes.box("fair", 100, "budget_s = 1000");
  const Outcome told = boxes.bake();
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_TRUE(says(told, "(budget 0.001 s) OVER")) << told.output;
  EXPECT_TRUE(says(told, "(budget 1e+03 s), ")) << told.output;
  EXPECT_TRUE(says(told, "0 failed, 1 over budget; ")) << told.output;
  EXPECT_EQ(boxes.bake({"--force", "--check-budgets"}).exit_code, 1);
  EXPECT_EQ(boxes.bake({"--check-budgets"}).exit_code, 0) << "nothing was baked, so nothing took long";
  fs::remove(boxes.objects() / "dear.toml");
  EXPECT_EQ(boxes.bake({"--force", "--check-budgets"}).exit_code, 0);
}

TEST(FolderBake, ATerminalShowsALineForEachRunningBake) {
  if (!installed("script")) GTEST_SKIP() << "script is not installed, which lends a terminal";
  const BoxFolder boxes;
  boxes.box("a", 100);
  boxes.box("b", 110);
  const auto on_terminal = [&](const Words& options) {
    std::string command;
    for (const std::string& word : boxes.command(options)) command += "'" + word + "' ";
    return run({"script", "--quiet", "--return", "--command", command, "/dev/null"});
  };
  const Outcome one = on_terminal({"--jobs", "1"});
  EXPECT_EQ(one.exit_code, 0) << one.output;
  EXPECT_TRUE(says(one, "a: begins, 0 s\r\n0 of 2 done\r\n")) << one.output;
  EXPECT_TRUE(says(one, "b: begins, 0 s\r\n1 of 2 done\r\n")) << one.output;
  EXPECT_TRUE(says(one, "\x1b[2A\r\x1b[Ja: baked, ")) << "two lines are taken back: " << one.output;
  EXPECT_TRUE(says(on_terminal({"--jobs", "2", "--force"}), "\x1b[3A\r\x1b[J")) << "three lines when two run";
}

TEST(FolderBake, StagesArePrintedAsPlainLinesOnRequest) {
  const BoxFolder boxes;
  boxes.box("a", 100);
  const Outcome ran = boxes.bake({"--progress"});
  EXPECT_TRUE(says(ran, "a: mesh\n")) << ran.output;
  EXPECT_EQ(ran.output.find('\r'), std::string::npos);
}

TEST(FolderBake, OptionsForAFolderAreRefusedForOneInputAndViceVersa) {
  const BoxFolder boxes;
  boxes.box("a", 100);
  fs::create_directories(boxes.banks());
  const Words one = {RINGDOWN_BIN_DIR "/ringdown-bake", boxes.objects() / "a.toml", "-o", boxes.bank("a")};
  const Words folder = {RINGDOWN_BIN_DIR "/ringdown-bake", boxes.objects(), "-o", boxes.banks()};
  const std::tuple<Words, Words, int> cases[] = {
      {one, {"--jobs", "2"}, 2},    {one, {"--force"}, 2},     {one, {"--recursive"}, 2}, {one, {"--check-budgets"}, 2},
      {folder, {"--name", "x"}, 2}, {folder, {"--update"}, 2}, {folder, {"-j", "0"}, 2},  {folder, {"-j", "x"}, 2},
  };
  for (auto [command, options, code] : cases) {
    command.insert(command.end(), options.begin(), options.end());
    const Outcome ran = run(command);
    EXPECT_EQ(ran.exit_code, code) << options[0] << " " << ran.output;
    EXPECT_EQ(std::count(ran.output.begin(), ran.output.end(), '\n'), 1) << ran.output;
  }
  const Outcome empty = run({RINGDOWN_BIN_DIR "/ringdown-bake", boxes.banks()});
  EXPECT_EQ(empty.exit_code, 3);
  EXPECT_TRUE(says(empty, "there are no objects in ")) << empty.output;
}

}  // namespace
}  // namespace ringdown::test
