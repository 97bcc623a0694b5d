// What the plug-in's window does without a display: edits and their undoing, the glow of modes, the held peak.
#include "clients/plugin/window/edits.h"
#include "clients/plugin/window/material_row.h"
#include "clients/plugin/window/mode_glow.h"
#include "clients/plugin/window/shown_body.h"
#include "clients/plugin/window/sliders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace ringdown::plugin {
namespace {

// A host that keeps what it was told.
struct Told : HostLink {
  std::map<std::size_t, float> values;
  std::vector<std::string> gestures;
  std::string file;
  std::array<std::string, kPoints> points;
  void begin_edit(std::size_t parameter) override { gestures.push_back("begin " + std::to_string(parameter)); }
  void set_parameter(std::size_t parameter, float value) override { values[parameter] = value; }
  void end_edit(std::size_t parameter) override { gestures.push_back("end " + std::to_string(parameter)); }
  void set_point(Which which, const std::string& text) override { points[static_cast<std::size_t>(which)] = text; }
  void set_file(const std::string& path) override { file = path; }
  void press_key(std::uint8_t, std::uint8_t) override {}
  void release_key(std::uint8_t) override {}
  void browse_files() override {}
  void set_scale(double) override {}
};

constexpr auto kGain = static_cast<std::size_t>(Parameter::gain), kSize = static_cast<std::size_t>(Parameter::size);

TEST(WindowEdits, AreUndoneAndDoneAgainOneByOne) {
  Told host;
  Edits edits(host);
  edits.begin(Parameter::gain);
  for (const double gain : {-1.0, -2.0, -3.0}) edits.move(Parameter::gain, gain);
  edits.end(Parameter::gain);
  edits.set(Parameter::size, 2);
  edits.set_point({{1, 2, 3}, {0, 0, 1}, 0, "mug"});
  edits.undo();
  EXPECT_EQ(host.points[0], "");
  EXPECT_EQ(host.values[kSize], 2);
  edits.undo();
  EXPECT_EQ(host.values[kSize], 1);
  EXPECT_EQ(host.values[kGain], -3);
  edits.undo();
  EXPECT_EQ(host.values[kGain], 0) << "a drag is one step";
  EXPECT_FALSE(edits.history().can_undo());
  edits.redo();
  edits.redo();
  edits.redo();
  EXPECT_EQ(host.values[kGain], -3);
  EXPECT_EQ(host.values[kSize], 2);
  EXPECT_EQ(host.points[0], to_text({{1, 2, 3}, {0, 0, 1}, 0, "mug"}));
  EXPECT_FALSE(edits.history().can_redo());
}

TEST(WindowEdits, BeginAndEndWithTheHostsRecording) {
  Told host;
  Edits edits(host);
  edits.set(Parameter::gain, 3);
  edits.undo();
  const std::string begin = "begin " + std::to_string(kGain), end = "end " + std::to_string(kGain);
  EXPECT_EQ(host.gestures, (std::vector{begin, end, begin, end}));
}

TEST(WindowEdits, AFileIsChosenAsObject) {
  Told host;
  Edits edits(host);
  edits.on_parameter(static_cast<std::size_t>(Parameter::object), 12);
  edits.play_file("/tmp/bell.glb");
  EXPECT_EQ(host.file, "/tmp/bell.glb");
  EXPECT_EQ(host.values[static_cast<std::size_t>(Parameter::object)], 0);
  edits.undo();
  EXPECT_EQ(host.file, "");
  EXPECT_EQ(host.values[static_cast<std::size_t>(Parameter::object)], 12);
}

TEST(WindowEdits, AMaterialIsOneStep) {
  Told host;
  Edits edits(host);
  edits.set({{Parameter::stiffness, 0.35}, {Parameter::density, 0.3}, {Parameter::loss, 2}});
  EXPECT_EQ(host.values[static_cast<std::size_t>(Parameter::density)], 0.3F);
  edits.undo();
  for (const Parameter parameter : {Parameter::stiffness, Parameter::density, Parameter::loss})
    EXPECT_EQ(host.values[static_cast<std::size_t>(parameter)], 1);
  EXPECT_FALSE(edits.history().can_undo());
}

// E and density of two metals; half of 1/Q = 1e-3 rings twice as long as 2e-3.
TEST(MaterialFactors, AreTheRatiosOfTheConstantsAndObeyTheParametersRanges) {
  const auto material = [](double e_pa, double density_kg_m3, double loss) {
    modal::Material m;
    m.youngs_modulus_pa = e_pa;
    m.density_kg_m3 = density_kg_m3;
    m.poisson_ratio = 0.3;
    m.loss_factors = {{0, loss}};
    return m;
  };
  const MaterialFactors factors = factors_of(material(200e9, 8000, 1e-3), material(70e9, 2700, 2e-3));
  EXPECT_NEAR(factors.stiffness, 0.35, 1e-12);
  EXPECT_NEAR(factors.density, 0.3375, 1e-12);
  EXPECT_NEAR(factors.loss, 2, 1e-9);
  EXPECT_EQ(factors.obstacle, "");
  EXPECT_EQ(factors_of(material(200e9, 8000, 1e-3), material(2e9, 1000, 1e-3)).obstacle,
            "Stiffness would be 0.01, and its range is 0.1 to 10.");
}

TEST(WindowEdits, ThePointIsThatOfOneObjectAndOneValueOfTheParameter) {
  Told host;
  Edits edits(host);
  edits.set_point({{1, 2, 3}, {0, 0, 1}, 0, "mug"});
  EXPECT_TRUE(edits.point_on("mug"));
  EXPECT_FALSE(edits.point_on("bell"));
  edits.set_point({{4, 5, 6}, {0, 0, 1}, 0, "mug"}, Which::second);
  EXPECT_EQ(edits.point_on("mug")->point_m, (Vec3{1, 2, 3}));
  EXPECT_EQ(edits.point_on("mug", Which::second)->point_m, (Vec3{4, 5, 6}));
  edits.undo();
  EXPECT_FALSE(edits.point_on("mug", Which::second));
  EXPECT_EQ(host.points[1], "");
  edits.redo();
  edits.on_parameter(static_cast<std::size_t>(Parameter::strike_point), 30);
  EXPECT_FALSE(edits.point_on("mug", Which::second));
  EXPECT_FALSE(edits.point_on("mug"));
}

TEST(History, KeepsItsLastEditsOnly) {
  History history;
  Values values;
  for (std::size_t i = 0; i < History::kMax + 10; ++i) {
    values.parameters[0] = static_cast<float>(i);
    history.record(values);
  }
  std::size_t steps = 0;
  for (std::optional<Values> now = values; (now = history.undo(*now)); ++steps) values = *now;
  EXPECT_EQ(steps, History::kMax);
  EXPECT_EQ(values.parameters[0], 10);
}

// Two modes that are struck alike: after a time t they stand at exp(-d t), and the level scales both.
TEST(ModeGlow, DividesTheLevelByTheBlowAndTheDecays) {
  ModeGlow glow({1, 30});
  glow.set_blow({1, 1});
  glow.follow(-20, 0, 1);
  EXPECT_FLOAT_EQ(glow.brightness(0), glow.brightness(1));
  const double each_db = -20 - 10 * std::log10(2);
  EXPECT_NEAR(static_cast<double>(glow.brightness(0)), 1 - each_db / ModeGlow::kDark_db, 1e-6);
  glow.follow(-22, 0.02, 2);  // twice the loss
  const double apart_db = 20 * std::log10(std::exp(1.0)) * 29 * 2 * 0.02;
  EXPECT_NEAR(static_cast<double>(glow.brightness(0) - glow.brightness(1)), apart_db / -ModeGlow::kDark_db, 1e-6);
}

TEST(ModeGlow, TakesARiseForABlowWhereverItIsStruckNow) {
  ModeGlow glow({1, 1});
  glow.set_blow({1, 0.1});
  glow.follow(-20, 0, 1);
  EXPECT_EQ(glow.leading(), 0U);
  glow.set_blow({0, 1});
  glow.follow(-21, 0.1, 1);
  EXPECT_EQ(glow.leading(), 0U) << "what rings goes on";
  glow.follow(-12, 0.1, 1);
  EXPECT_EQ(glow.leading(), 1U);
  EXPECT_EQ(glow.brightness(0), 0);
}

TEST(ModeGlow, IsDarkInSilence) {
  ModeGlow glow({1, 1});
  glow.set_blow({1, 1});
  glow.follow(-120, 0.1, 1);
  EXPECT_EQ(glow.brightness(0), 0);
  glow.follow(0, 0.1, 1);
  glow.follow(-120, 0.1, 1);
  EXPECT_EQ(glow.brightness(0), 0);
  EXPECT_EQ(glow.brightness(2), 0) << "there is no such mode";
}

TEST(LevelMeter, HoldsAPeakAndThenLetsItGo) {
  LevelMeter meter;
  meter.follow(-10, 1);
  EXPECT_EQ(meter.held_db(), -10);
  meter.follow(-40, 2);
  EXPECT_EQ(meter.held_db(), -10);
  EXPECT_TRUE(meter.is_moving());
  meter.follow(-120, 3);
  EXPECT_EQ(meter.held_db(), -120);
  EXPECT_FALSE(meter.is_moving());
}

TEST(ShownBody, OfANoteMapIsTheObjectOfTheNearestKey) {
  const std::string map = RINGDOWN_SOURCE_DIR "/presets/notes/vibraphone.toml";
  const auto low = read_body({map, map}, 0), same = read_body({map, map}, low->key), high = read_body({map, map}, 127);
  ASSERT_TRUE(low && same && high);
  EXPECT_TRUE(low->is_note_map);
  EXPECT_EQ(same->key, low->key);
  EXPECT_GT(high->key, low->key);
  EXPECT_GT(high->body.pitch_hz, low->body.pitch_hz);
}

TEST(ShownBody, ThatCannotBeReadSaysWhy) {
  const auto none = read_body({"none", "/nowhere/none.glb"}, 60);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("/nowhere/none.glb"), std::string::npos) << none.error().message;
}

}  // namespace
}  // namespace ringdown::plugin
