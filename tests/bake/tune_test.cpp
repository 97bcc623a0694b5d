// ringdown tune: the optimiser against closed forms, families of modes, a bar that a finer bake finds in tune, and a
// cup whose level is known.
#include "engine/bake/bake_object.h"
#include "engine/bake/tuning/tune_object.h"
#include "engine/base/atomic_file.h"
#include "engine/base/note.h"
#include "tests/bake/cup.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <sys/wait.h>

namespace ringdown {
namespace {

namespace fs = std::filesystem;
using Eigen::VectorXd;
using test::TemporaryFolder;

const fs::path kPresets = fs::path(RINGDOWN_SOURCE_DIR) / "presets";

double cents(double is, double wanted) { return 1200 * std::log2(is / wanted); }

// The first flexural frequencies of a free Euler-Bernoulli strip [Hz]: length and thickness in mm, steel.
double strip_hz(double length, double thickness, double root) {
  return root * root / (2 * M_PI) * std::sqrt(210e9 / 7800 / 12) * thickness * 1e-3 / std::pow(length * 1e-3, 2);
}

TEST(Tune, TheTunerFindsTheLengthOfAStripThatSoundsItsNote) {
  const auto cents_of = [](const VectorXd& p) -> Result<VectorXd> {
    return VectorXd::Constant(1, cents(strip_hz(p[0], 6, 4.730041), 440));
  };
  const auto tuned = bake::tune({{"length", 100, 600, 200}}, cents_of, {.tolerance_cents = 0.01});
  ASSERT_TRUE(tuned) << tuned.error().message;
  EXPECT_TRUE(tuned->reached);
  EXPECT_LE(std::abs(tuned->cents[0]), 0.01);
  EXPECT_NEAR(strip_hz(tuned->parameters[0], 6, 4.730041), 440, 0.01);
  EXPECT_LE(tuned->evaluations, 12);
}

// Two strips of one plate: f ~ h / l^2 and f' ~ 1 / l: both have one solution, far from the start.
TEST(Tune, TheTunerFindsTwoParametersForTwoTargets) {
  const auto cents_of = [](const VectorXd& p) -> Result<VectorXd> {
    return (VectorXd(2) << cents(p[1] / (p[0] * p[0]), 3.0 / 4), cents(1 / p[0], 1.0 / 2)).finished();
  };
  const auto tuned = bake::tune({{"l", 0.5, 8, 7.5}, {"h", 0.1, 9, 0.2}}, cents_of, {.tolerance_cents = 1e-3});
  ASSERT_TRUE(tuned) << tuned.error().message;
  EXPECT_TRUE(tuned->reached);
  EXPECT_NEAR(tuned->parameters[0], 2, 1e-5);
  EXPECT_NEAR(tuned->parameters[1], 3, 1e-5);
}

TEST(Tune, TheTunerStopsAtABoundAndSaysWhatItMisses) {
  const auto cents_of = [](const VectorXd& p) -> Result<VectorXd> { return VectorXd::Constant(1, 100 * (p[0] - 5)); };
  const auto tuned = bake::tune({{"x", 0, 2, 1}}, cents_of, {});
  ASSERT_TRUE(tuned) << tuned.error().message;
  EXPECT_FALSE(tuned->reached);
  EXPECT_DOUBLE_EQ(tuned->parameters[0], 2);
  EXPECT_DOUBLE_EQ(tuned->cents[0], -300);
}

// One parameter at its bound must not hold the other back.
TEST(Tune, TheTunerSlidesAlongABound) {
  const auto cents_of = [](const VectorXd& p) -> Result<VectorXd> {
    return (VectorXd(2) << 50 * (p[0] - 3), 80 * (p[1] - 0.25)).finished();
  };
  const auto tuned = bake::tune({{"x", 0, 1, 0.9}, {"y", 0, 1, 0.9}}, cents_of, {});
  ASSERT_TRUE(tuned);
  EXPECT_FALSE(tuned->reached);
  EXPECT_NEAR(tuned->parameters[0], 1, 1e-9);
  EXPECT_NEAR(tuned->parameters[1], 0.25, 1e-3);
}

TEST(Tune, FewerTargetsThanParametersStayNearTheStart) {
  const auto cents_of = [](const VectorXd& p) -> Result<VectorXd> {
    return VectorXd::Constant(1, 1000 * (p[0] + p[1] - 1));
  };
  const auto tuned = bake::tune({{"x", 0, 1, 0.3}, {"y", 0, 1, 0.5}}, cents_of, {});
  ASSERT_TRUE(tuned);
  EXPECT_TRUE(tuned->reached);
  EXPECT_NEAR(tuned->parameters[0], 0.4, 1e-3);
  EXPECT_NEAR(tuned->parameters[1], 0.6, 1e-3);
}

// Rosenbrock's valley, whose slopes turn as one walks along it.
TEST(Tune, TheTunerFollowsACurvedValley) {
  const auto cents_of = [](const VectorXd& p) -> Result<VectorXd> {
    return (VectorXd(2) << 10 * (p[1] - p[0] * p[0]), 1 - p[0]).finished();
  };
  const auto tuned = bake::tune({{"x", -2, 2, -1.2}, {"y", -1, 3, 1}}, cents_of,
                                {.tolerance_cents = 1e-5, .max_evaluations = 300, .probe = 1e-5});
  ASSERT_TRUE(tuned);
  EXPECT_TRUE(tuned->reached) << tuned->cents.transpose();
}

TEST(Tune, TheTunerWalksAroundWhatCannotBeEvaluated) {
  const auto cents_of = [](const VectorXd& p) -> Result<VectorXd> {
    if (p[0] > 0.55) return fail(ErrorKind::bad_input, "no mesh");
    return VectorXd::Constant(1, 100 * (p[0] * p[0] - 0.25));
  };
  const auto tuned = bake::tune({{"x", 0, 1, 0.05}}, cents_of, {});
  ASSERT_TRUE(tuned) << tuned.error().message;
  EXPECT_TRUE(tuned->reached);
  const auto nowhere = [](const VectorXd&) -> Result<VectorXd> { return fail(ErrorKind::bad_input, "no mesh"); };
  const auto failed = bake::tune({{"x", 0, 1, 0.5}}, nowhere, {});
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "no mesh");
}

TEST(Tune, TheTunerStopsWhenAskedTo) {
  int asked = 0;
  bake::TuneOptions options;
  options.stopped = [&] { return ++asked > 2; };
  const auto cents_of = [](const VectorXd& p) -> Result<VectorXd> {
    return VectorXd::Constant(1, std::sin(1e3 * p[0]) + 2);
  };
  const auto tuned = bake::tune({{"x", 0, 1, 0.5}}, cents_of, options);
  ASSERT_FALSE(tuned);
  EXPECT_EQ(tuned.error().kind, ErrorKind::cancelled);
}

TEST(Pitch, NotesHaveNumbersAndFrequencies) {
  EXPECT_EQ(note_number("A4"), 69);
  EXPECT_EQ(note_number("C-1"), 0);
  EXPECT_EQ(note_number("G9"), 127);
  for (const char* sharp : {"F#3", "Fs3", "Gb3"}) EXPECT_EQ(note_number(sharp), 54) << sharp;
  for (const char* none : {"", "H4", "A", "A44", "a4", "G#9", "Cb-1", "4A"}) EXPECT_FALSE(note_number(none)) << none;
  EXPECT_DOUBLE_EQ(note_frequency(69), 440);
  EXPECT_NEAR(note_frequency(53), 174.614, 1e-3);
  for (int number = 12; number <= 127; ++number) EXPECT_EQ(note_number(note_word(number)), number);
}

TEST(ObjectText, AChangedObjectFileChangesFiguresAndKeepsTheRest) {
  const std::string text =
      "# a bar\nname = \"old\"\nmaterial = \"steel\"  # or brass\ngeometry = \"bar.geo\"\nmesh_size_m = 0.01\n\n"
      "[parameters]\nlength = 300  # mm\nwidth = 40\n";
  const auto changed = bake::change_object(
      text, {.parameters = {{"length", 312.5}, {"depth", 3}}, .mesh_size_m = 0.007, .geometry = "../bar.geo"});
  ASSERT_TRUE(changed) << changed.error().message;
  EXPECT_EQ(*changed,
            "# a bar\nmaterial = \"steel\"  # or brass\ngeometry = \"../bar.geo\"\nmesh_size_m = 0.007\n\n"
            "[parameters]\nlength = 312.5  # mm\nwidth = 40\ndepth = 3\n");
  const auto added =
      bake::change_object("material = \"steel\"\ngeometry = \"bar.geo\"\n", {.parameters = {{"length", 1}}});
  ASSERT_TRUE(added) << added.error().message;
  EXPECT_EQ(*added, "material = \"steel\"\ngeometry = \"bar.geo\"\n\n[parameters]\nlength = 1\n");
  EXPECT_FALSE(bake::change_object("material = \"steel\"\n", {}));
  EXPECT_FALSE(bake::change_object("material = \"steel\"\ngeometry = \"b.geo\"\nparameters = { length = 3 }\n",
                                   {.parameters = {{"length", 4}}}));
}

TEST(ObjectText, ALevelTakesThePlaceOfAnyOtherAmount) {
  const std::string head = "material = \"glass\"\ngeometry = \"cup.geo\"\n";
  for (const char* amount : {"full = true\n", "depth_m = 0.02\n", "volume_ml = 5\n", "level_m = 0.1\n"}) {
    const auto changed =
        bake::change_object(head + "[fill]  # of a spring\n" + amount + "levels = 16\n", {.level_m = 0.03});
    ASSERT_TRUE(changed) << changed.error().message;
    const auto recipe = bake::parse_object(*changed, "cup.toml");
    ASSERT_TRUE(recipe) << recipe.error().message << *changed;
    EXPECT_EQ(recipe->options.liquids.fill->amount.kind, liquid::Amount::Kind::kLevel);
    EXPECT_EQ(recipe->options.liquids.fill->amount.value, 0.03);
    EXPECT_EQ(recipe->options.liquids.fill->levels, 16u);
    EXPECT_NE(changed->find("# of a spring"), std::string::npos);
  }
  EXPECT_FALSE(bake::change_object(head + "fill = { full = true }\n", {.level_m = 0.03}));
}

TEST(ObjectText, AChangedShapeHasItsOwnPitch) {
  const std::string text = "material = \"steel\"\npitch = \"F#3\"  # of the old one\ngeometry = \"bar.geo\"\n";
  const auto pitch_line = [&text](const bake::ObjectChanges& changes) {
    const std::string changed = bake::change_object(text, changes).value_or("");
    const std::size_t at = changed.find("pitch");
    return at == changed.npos ? "" : changed.substr(at, changed.find('\n', at) - at);
  };
  EXPECT_EQ(pitch_line({.pitch_hz = 440}), "pitch = \"A4\"  # of the old one");
  EXPECT_EQ(pitch_line({.pitch_hz = 441}), "pitch = 441  # of the old one");
  EXPECT_EQ(pitch_line({}), "");
}

bake::ObjectRecipe bar(double mesh_size_m, fem::Element element) {
  bake::ObjectRecipe recipe = bake::read_object(kPresets / "objects/vibraphone-key.toml").value();
  recipe.meshing.mesh_size_m = mesh_size_m;
  recipe.meshing.order = fem::order_of(element);
  recipe.options.element = element;
  recipe.options.keep_modes = 0;
  return recipe;
}

modal::Bank bank_of(bake::ObjectRecipe recipe, double top_hz) {
  recipe.options.band_high_hz = top_hz;
  auto object = bake::bake_object(recipe, kPresets / "materials");
  EXPECT_TRUE(object) << object.error().message;
  return object->baked.bank;
}

std::vector<double> frequencies_of(const modal::Bank& bank, bake::ModeFamily family) {
  std::vector<double> frequencies;
  for (const std::size_t mode : bake::modes_of(bank, bake::body_axes(bank, {}), family)) {
    frequencies.push_back(bank.frequency_hz[mode]);
  }
  return frequencies;
}

// A slender bar without an arch has each family's frequencies from the textbook: bending by Timoshenko's beam to some
// percent, twist by the torsion constant of its section, length waves by c / 2 l.
TEST(ModeFamilies, TheModeFamiliesOfAPlainBarAreTheTextbooks) {
  bake::ObjectRecipe recipe = bar(0.02, fem::Element::kTet20);
  recipe.geometry = kPresets / "objects/box.geo";
  recipe.meshing.parameters = {{"length", 300}, {"width", 24}, {"thickness", 10}};
  const modal::Bank bank = bank_of(recipe, 20000);
  const double speed = std::sqrt(72e9 / 2700), l = 0.3, h = 0.010, w = 0.024;
  const auto bending = [&](double thickness, double root) {
    const double k = root / l, gyration = thickness / std::sqrt(12.0);
    return k * k * gyration * speed / (2 * M_PI) / std::sqrt(1 + std::pow(k * gyration, 2) * (1 + 2 * 1.34 / 0.85));
  };
  const auto vertical = frequencies_of(bank, bake::ModeFamily::kVertical);
  const auto lateral = frequencies_of(bank, bake::ModeFamily::kLateral);
  const auto torsion = frequencies_of(bank, bake::ModeFamily::kTorsion);
  const auto longitudinal = frequencies_of(bank, bake::ModeFamily::kLongitudinal);
  ASSERT_GE(vertical.size(), 5u);
  ASSERT_GE(lateral.size(), 3u);
  ASSERT_GE(torsion.size(), 3u);
  ASSERT_GE(longitudinal.size(), 2u);
  const std::array roots = {4.730041, 7.853205, 10.995608, 14.137165, 17.278760};
  for (int n = 0; n < 5; ++n) EXPECT_NEAR(vertical[n] / bending(h, roots[n]), 1, 0.03) << n;
  for (int n = 0; n < 3; ++n) EXPECT_NEAR(lateral[n] / bending(w, roots[n]), 1, 0.04) << n;
  const double ratio = w / h, torsion_constant = w * h * h * h / 3 * (1 - 0.63 / ratio);
  const double polar = w * h * (w * w + h * h) / 12;
  const double twist = std::sqrt(72e9 / (2 * 1.34) * torsion_constant / (2700 * polar)) / (2 * l);
  for (int n = 0; n < 3; ++n) EXPECT_NEAR(torsion[n] / ((n + 1) * twist), 1, 0.04) << n;
  for (int n = 0; n < 2; ++n) EXPECT_NEAR(longitudinal[n] / ((n + 1) * speed / (2 * l)), 1, 0.02) << n;
}

// The same bar struck from its side: what was vertical is lateral.
TEST(ModeFamilies, TheStrikeSaysWhatIsVertical) {
  bake::ObjectRecipe recipe = bar(0.03, fem::Element::kTet10);
  const modal::Bank bank = bank_of(recipe, 5000);
  const auto flat = bake::body_axes(bank, {}), side = bake::body_axes(bank, Vec3{0, 1, 0});
  EXPECT_EQ(bake::modes_of(bank, flat, bake::ModeFamily::kVertical),
            bake::modes_of(bank, side, bake::ModeFamily::kLateral));
  EXPECT_EQ(bake::modes_of(bank, flat, bake::ModeFamily::kTorsion),
            bake::modes_of(bank, side, bake::ModeFamily::kTorsion));
  EXPECT_NEAR(std::abs(flat.strike.z), 1, 1e-6);
  EXPECT_NEAR(std::abs(flat.along.x), 1, 1e-6);
}

// The claim of the whole: what the tuner calls in tune, elements of another order on another mesh find in tune.
TEST(TuneObject, ABarIsInTuneByAnotherFinerBake) {
  const TemporaryFolder folder;
  bake::TuneRequest request{.recipe = bar(0.024, fem::Element::kTet20)};
  request.variables = {{"length", 220, 380, 300}, {"arch_depth", 3, 9, 6}};
  request.targets = {{.mode = 1, .frequency_hz = 440}, {.mode = 2, .frequency_hz = 1760}};
  int told = 0;
  request.told = [&](const bake::TuneStep& step) {
    EXPECT_GT(step.number, told);
    told = step.number;
  };
  const auto tuned = bake::tune_object(request, kPresets / "materials");
  ASSERT_TRUE(tuned) << tuned.error().message;
  EXPECT_TRUE(tuned->reached);
  EXPECT_GT(told, 3);
  EXPECT_LE(told, tuned->bakes);
  for (const bake::FoundMode& mode : tuned->found) {
    EXPECT_LE(std::abs(mode.cents), 0.3);
    EXPECT_LT(mode.error_cents, 1);
  }
  bake::ObjectRecipe finer = bar(0.013, fem::Element::kTet35);
  for (const auto& [name, value] : tuned->parameters) finer.meshing.parameters[name] = value;
  const auto vertical = frequencies_of(bank_of(finer, 2500), bake::ModeFamily::kVertical);
  ASSERT_GE(vertical.size(), 2u);
  EXPECT_NEAR(cents(vertical[0], 440), 0, 3);
  EXPECT_NEAR(cents(vertical[1], 1760), 0, 3);
}

// Shear across the grain is so soft that a bar in tune without one is off by a tenth of a semitone with it.
TEST(TuneObject, ABarWithAGrainIsInTuneWithIt) {
  const auto wooden = [](double mesh_size_m, fem::Element element) {
    bake::ObjectRecipe recipe = bar(mesh_size_m, element);
    recipe.material = "rosewood";
    recipe.options.makeup.grain = bake::Grain{.along = {1, 0, 0}, .radial = Vec3{0, 0, 1}};
    return recipe;
  };
  bake::TuneRequest request{.recipe = wooden(0.024, fem::Element::kTet20)};
  request.variables = {{"length", 220, 380, 300}};
  request.targets = {{.mode = 1, .frequency_hz = 330}};
  const auto tuned = bake::tune_object(request, kPresets / "materials");
  ASSERT_TRUE(tuned) << tuned.error().message;
  EXPECT_TRUE(tuned->reached);
  bake::ObjectRecipe finer = wooden(0.013, fem::Element::kTet35);
  for (const auto& [name, value] : tuned->parameters) finer.meshing.parameters[name] = value;
  EXPECT_NEAR(cents(frequencies_of(bank_of(finer, 2500), bake::ModeFamily::kVertical).at(0), 330), 0, 3);
  bake::ObjectRecipe without = request.recipe;
  without.meshing.parameters = finer.meshing.parameters;
  without.options.makeup.grain.reset();
  EXPECT_GT(cents(frequencies_of(bank_of(without, 2500), bake::ModeFamily::kVertical).at(0), 330), 10);
}

struct Ran {
  int exit_code;
  std::string output;
};

Ran tune(const std::string& arguments, const fs::path& folder = ".") {
  const std::string command = "cd " + folder.string() +
                              " && RINGDOWN_CACHE=/dev/null/none " RINGDOWN_BIN_DIR "/ringdown-tune " + arguments +
                              " 2>&1";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::string output;
  std::array<char, 512> part{};
  while (std::fgets(part.data(), part.size(), pipe)) output += part.data();
  return {WEXITSTATUS(::pclose(pipe)), output};
}

const std::string kKey = (kPresets / "objects/vibraphone-key.toml").string();

TEST(TuneProgram, TheProgramWritesAnObjectForEachNoteOfAScale) {
  const TemporaryFolder folder;
  const fs::path bars = folder.path() / "bars";
  const Ran ran = tune(kKey + " --vary length:200:400 -o x --target 1=A4");
  EXPECT_EQ(ran.exit_code, 2);
  const Ran scale =
      tune(kKey + " --mesh-size 0.03 --vary length:200..420 --target 1=note --scale A4..As4 -o " + bars.string());
  ASSERT_EQ(scale.exit_code, 0) << scale.output;
  const auto low = bake::read_object(bars / "A4.toml"), high = bake::read_object(bars / "As4.toml");
  ASSERT_TRUE(low) << low.error().message;
  ASSERT_TRUE(high) << high.error().message;
  EXPECT_EQ(high->name, "As4");
  EXPECT_DOUBLE_EQ(low->pitch_hz.value_or(0), 440) << "the key's own was A3";
  EXPECT_NEAR(high->pitch_hz.value_or(0), 466.1638, 1e-4);
  EXPECT_TRUE(fs::equivalent(low->geometry, kPresets / "objects/bar.geo"));
  EXPECT_GT(low->meshing.parameters.at("length"), high->meshing.parameters.at("length"));
  EXPECT_NE(scale.output.find("of the first"), std::string::npos) << scale.output;
}

// The target is the pitch that a bake has at a level, so that this is the level to be found.
TEST(TuneProgram, TheProgramFindsTheLevelOfALiquid) {
  const TemporaryFolder folder;
  static_cast<void>(folder.write("cup.geo", test::kCup));
  const auto cup = [&](const std::string& fill) {
    return folder.write("cup.toml",
                        "material = \"glass\"\ngeometry = \"cup.geo\"\nunit_m = 0.001\nmesh_size_m = 0.012\n"
                        "element = \"tet10\"\nshape_error = 0.2\nband_hz = [20, 4500]\nscale = 2\n[fill]\n" +
                            fill);
  };
  constexpr double kLevel_m = 0.045;
  const modal::Bank known = bank_of(bake::read_object(cup(formatted("level_m = {}\n", kLevel_m))).value(), 4500);
  const double wanted_hz = frequencies_of(known, bake::ModeFamily::kAny).at(0);
  const Ran ran = tune(cup("full = true\nlevels = 8\n").string() +
                           formatted(" --vary fill.level:0.02..0.06 --target any:1={:.6g} -o tuned.toml", wanted_hz),
                       folder.path());
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  std::printf("%s", ran.output.c_str());
  const auto tuned = bake::read_object(folder.path() / "tuned.toml");
  ASSERT_TRUE(tuned) << tuned.error().message;
  EXPECT_NEAR(tuned->options.liquids.fill->amount.value, kLevel_m, 1e-4);
  EXPECT_EQ(tuned->options.liquids.fill->levels, 8u);
  EXPECT_FALSE(tuned->meshing.parameters.contains("fill.level"));
}

TEST(TuneProgram, TheProgramSaysWhatCannotBeReachedAndWritesNothing) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "x.toml";
  const Ran ran = tune(kKey + " --mesh-size 0.03 --vary length:290..310 --target 1=A5 -q -o " + out.string());
  EXPECT_EQ(ran.exit_code, 1) << ran.output;
  EXPECT_NE(ran.output.find("out of reach: the best misses by"), std::string::npos) << ran.output;
  EXPECT_FALSE(fs::exists(out));
}

TEST(TuneProgram, RefusalsHaveTheirExitCodesAndOneSentence) {
  const TemporaryFolder folder;
  const std::string rest = " -o " + (folder.path() / "x.toml").string(), vary = " --vary length:200..400";
  const std::pair<std::string, int> cases[] = {
      {"", 2},
      {kKey + vary + rest, 2},
      {kKey + vary + rest + " --target 1", 2},
      {kKey + vary + rest + " --target 0=440", 2},
      {kKey + vary + rest + " --target 1=H4", 2},
      {kKey + vary + rest + " --target 1=-5", 2},
      {kKey + vary + rest + " --target 1=4x", 2},
      {kKey + vary + rest + " --target 1=note", 2},
      {kKey + vary + rest + " --target sideways:1=440", 2},
      {kKey + vary + rest + " --target 1=440 --scale F6..F3", 2},
      {kKey + " --vary length:400..200 --target 1=440" + rest, 2},
      {"nothing.toml" + vary + " --target 1=440" + rest, 3},
      {kKey + " --vary girth:1..2 --target 1=440" + rest, 3},
      {kKey + vary + " --mesh-size 0.03 --target 30=440" + rest, 3},
      {kKey + " --vary fill.level:0.01..0.02 --target 1=440" + rest, 3},
      {kKey + vary + " --vary fill.level:0.01..0.02 --target 1=440" + rest, 3},
  };
  for (const auto& [arguments, code] : cases) {
    const Ran ran = tune(arguments);
    EXPECT_EQ(ran.exit_code, code) << arguments << "\n" << ran.output;
    EXPECT_EQ(std::count(ran.output.begin(), ran.output.end(), '\n'), 1) << ran.output;
  }
}

}  // namespace
}  // namespace ringdown
