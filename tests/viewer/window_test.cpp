// The window as people use it: on a display, with real keys and a real mouse (xdotool), against a real daemon on a JACK
// server; what it asks the daemon is overheard on the way, and what comes of it is seen in the daemon's own answers.
#include "clients/viewer/panels/overlays.h"
#include "clients/viewer/material_choice.h"
#include "engine/modal/bank_file.h"
#include "tests/viewer/file_drop.h"
#include "tests/viewer/studio.h"

#include <epoxy/gl.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace ringdown::viewer {
namespace {

TEST(Window, EveryKeyOfTheSceneDoesWhatItSays) {
  OPEN_STUDIO(studio);
  ASSERT_EQ(studio.app().focused(), Pane::scene);
  const auto camera = [&] { return studio.app().scene_view().camera(); };
  const std::vector<std::pair<const char*, glm::vec3>> moves = {{"w", camera().forward()}, {"s", -camera().forward()},
                                                                {"a", -camera().right()},  {"d", camera().right()},
                                                                {"Prior", {0, 0, 1}},      {"Next", {0, 0, -1}}};
  for (const auto& [key, way] : moves) {
    const glm::vec3 before = camera().position_m;
    studio.act({"keydown", key});
    EXPECT_TRUE(studio.until([&] { return glm::dot(camera().position_m - before, way) > 0.01F; })) << key;
    studio.act({"keyup", key});
  }
  const std::vector<std::tuple<const char*, float Camera::*, float>> turns = {
      {"Left", &Camera::yaw, 1}, {"Right", &Camera::yaw, -1}, {"Up", &Camera::pitch, 1}, {"Down", &Camera::pitch, -1}};
  for (const auto& [key, angle, sign] : turns) {
    const float before = camera().*angle;
    studio.act({"keydown", key});
    EXPECT_TRUE(studio.until([&] { return sign * (camera().*angle - before) > 0.01F; })) << key;
    studio.act({"keyup", key});
  }
  for (const auto& [key, sign] : {std::pair{"equal", 1.0F}, {"minus", -1.0F}}) {
    const glm::vec3 before = camera().position_m;
    studio.act({"keydown", key});
    EXPECT_TRUE(studio.until([&] { return sign * glm::dot(camera().position_m - before, camera().forward()) > 0.01F; }))
        << key;
    studio.act({"keyup", key});
  }
  studio.press("Home");
  EXPECT_TRUE(studio.until([&] { return glm::length(camera().position_m - glm::vec3(0, -1.5F, 0.6F)) < 1e-4F; }));

  studio.act({"mousemove", "5", "5"});  // the space bar then strikes in the middle of the picture
  studio.press("space");
  ASSERT_TRUE(studio.asks<protocol::Strike>());
  EXPECT_EQ(studio.relay().asked<protocol::Strike>()[0].object.name, "bell");
  EXPECT_TRUE(studio.until([&] { return studio.status().sounding_objects > 0; }));

  studio.press("h");
  ASSERT_TRUE(studio.asks<protocol::SpawnBox>());
  EXPECT_EQ(studio.relay().asked<protocol::SpawnBox>()[0].object->name, "bell");
  EXPECT_TRUE(studio.until([&] { return studio.status().bodies == 3; }));
  studio.press("j");
  ASSERT_TRUE(studio.asks<protocol::SpawnSphere>());
  EXPECT_TRUE(studio.until([&] { return studio.status().bodies == 4; }));
  studio.press("q");
  ASSERT_TRUE(studio.asks<protocol::ClearAll>());
  EXPECT_EQ(studio.status().bodies, 4) << "only the sound is cleared";
  studio.press("ctrl+Delete");
  ASSERT_TRUE(studio.asks<protocol::SceneClear>());
  EXPECT_TRUE(studio.until([&] { return studio.status().bodies == 0; }));
  studio.press("F6");
  ASSERT_TRUE(studio.asks<protocol::SceneLoad>());
  ASSERT_TRUE(studio.asks<protocol::ScenePause>()) << "it begins when the geometry is here";
  EXPECT_FALSE(studio.relay().asked<protocol::ScenePause>()[0].paused);
  ASSERT_TRUE(studio.until([&] { return studio.app().model().scene().reported_time_s() > 0; }));
  EXPECT_EQ(studio.status().bodies, 2);
  studio.press("F5");
  EXPECT_TRUE(studio.until([&] { return studio.app().model().scene().paused(); }));
}

// The keys of "both windows" act in every pane.
TEST(Window, TheMaterialsAndNodesKeysActInEveryPane) {
  OPEN_STUDIO(studio);
  using Bell = protocol::ObjectReply;
  struct Pair {
    const char *up, *down;
    double modal::MaterialScale::*factor;
  };
  for (const Pane pane : {Pane::scene, Pane::sound, Pane::side}) {
    ASSERT_TRUE(studio.until([&] { return studio.app().focused() == pane; }));
    for (const auto& [up, down, factor] :
         {Pair{"z", "x", &modal::MaterialScale::alpha}, Pair{"c", "v", &modal::MaterialScale::beta},
          Pair{"b", "n", &modal::MaterialScale::density}, Pair{"m", "comma", &modal::MaterialScale::stiffness}}) {
      EXPECT_TRUE(studio.changes_bell(up, [&](const Bell& b) { return b.scale.*factor > 1.01; }));
      EXPECT_TRUE(studio.changes_bell(down, [&](const Bell& b) { return std::abs(b.scale.*factor - 1) < 1e-3; }));
    }
    studio.press("period");
    EXPECT_TRUE(studio.until([&] { return studio.app().commands().choice().node == 1; }));
    studio.press("slash");
    EXPECT_TRUE(studio.until([&] { return studio.app().commands().choice().node == 0; }));
    studio.press("ctrl+Tab");
  }
  EXPECT_TRUE(studio.until([&] { return studio.app().focused() == Pane::scene; })) << "ctrl+tab comes round";
}

TEST(Window, EveryKeyOfTheSoundDoesWhatItSays) {
  OPEN_STUDIO(studio);
  studio.press("ctrl+Tab");
  ASSERT_TRUE(studio.until([&] { return studio.app().focused() == Pane::sound; }));
  using Bell = protocol::ObjectReply;
  const Bell before = studio.bell();
  EXPECT_TRUE(studio.changes_bell("s", [&](const Bell& b) { return b.selected_modes < before.modes; }));
  EXPECT_TRUE(studio.changes_bell("a", [&](const Bell& b) { return b.selected_modes > before.modes * 9 / 10; }));
  EXPECT_TRUE(studio.changes_bell(
      "q", [&](const Bell& b) { return b.first_mode == before.modes - 20 && b.selected_modes == 20; }));
  EXPECT_TRUE(studio.changes_bell("t", [&](const Bell& b) { return b.selected_modes == before.modes; }));
  EXPECT_EQ(studio.relay().asked<protocol::RingModes>().size(), 2u);
  EXPECT_TRUE(studio.until([&] { return studio.status().sounding_modes > before.modes / 2; }));

  studio.press("e");
  ASSERT_TRUE(studio.asks<protocol::ClearAll>());
  EXPECT_TRUE(studio.until([&] { return studio.status().sounding_modes == 0; }));
  studio.press("period");
  EXPECT_TRUE(studio.until([&] { return studio.app().commands().choice().node == 1; }));
  studio.press("r");
  ASSERT_TRUE(studio.asks<protocol::StrikeVertex>());
  EXPECT_EQ(studio.relay().asked<protocol::StrikeVertex>()[0].verb.vertex, 1u);
  EXPECT_TRUE(studio.until([&] { return studio.status().sounding_objects == 1; }));

  studio.press("Down");
  EXPECT_TRUE(studio.until([&] { return studio.app().commands().choice().mode == 1; }));
  studio.press("Up");
  EXPECT_TRUE(studio.until([&] { return studio.app().commands().choice().mode == 0; }));
  studio.press("Down");
  EXPECT_TRUE(studio.changes_bell("Return", [](const Bell& b) { return b.first_mode == 1 && b.selected_modes == 1; }));
  const auto bars = [&] { return studio.app().model().object("bell")->amplitudes; };
  EXPECT_TRUE(studio.until([&] {
    const std::vector<float> heights = bars();
    return heights.size() == static_cast<std::size_t>(before.modes) && heights[1] > 0.01F &&
           std::ranges::count_if(heights, [](float h) { return h > 1e-5F; }) == 1;
  })) << "its bar stands alone";
  studio.press("g");
  EXPECT_TRUE(studio.until([&] {
    return std::ranges::any_of(studio.app().scene_view().stage().contents().frame.bodies,
                               [](const DrawnBody& b) { return b.displacement && std::abs(b.displacement_m) > 1e-3F; });
  })) << "it moves in that mode";
}

TEST(Window, TheTestToneIsHeardAndSeen) {
  OPEN_STUDIO(studio);
  studio.press("ctrl+Tab");
  ASSERT_TRUE(studio.until([&] { return studio.app().focused() == Pane::sound; }));
  studio.press("w");
  ASSERT_TRUE(studio.asks<protocol::TestTone>());
  const Model& model = studio.app().model();
  ASSERT_TRUE(studio.until([&] { return model.peak().held > 0.09; }));
  std::vector<float> left, right;
  // Zero crossings of a second of it.
  EXPECT_TRUE(studio.until([&] {
    const auto second = static_cast<std::size_t>(model.sound().sample_rate_hz());
    model.sound().last(second, left, right);
    int rising = 0;
    for (std::size_t i = 1; i < left.size(); ++i) rising += left[i - 1] < 0 && left[i] >= 0;
    return std::abs(rising - 440) <= 1;
  }));
  studio.press("w");
  EXPECT_TRUE(studio.until([&] { return model.peak().held == 0; }));
}

TEST(Window, KeysForAllPanesWorkInEither) {
  OPEN_STUDIO(studio);
  App& app = studio.app();
  const auto blank = app.window().read_pixels();
  studio.press("F1");
  EXPECT_TRUE(studio.until([&] { return app.window().read_pixels().rgba != blank.rgba; }));
  studio.press("Escape");
  studio.until([&] { return false; }, 1s);
  EXPECT_TRUE(app.runs()) << "the first Escape closes the help";
  studio.press("F2");
  EXPECT_TRUE(studio.until([&] { return !app.settings().dark; }));
  const double force = app.commands().choice().impulse_ns;
  studio.press("l");
  EXPECT_TRUE(studio.until([&] { return app.commands().choice().impulse_ns > 1.3 * force; }));
  studio.press("k");
  EXPECT_TRUE(studio.until([&] { return app.commands().choice().impulse_ns < 1.1 * force; }));
  studio.press("p");
  ASSERT_TRUE(studio.asks<protocol::StrikeVertex>());
  EXPECT_TRUE(studio.until([&] { return studio.status().sounding_objects == 1; }));
  studio.press("BackSpace");
  ASSERT_TRUE(studio.asks<protocol::ClearAll>());
  EXPECT_TRUE(studio.until([&] { return studio.status().sounding_objects == 0; }));
  studio.press("ctrl+Tab");
  ASSERT_TRUE(studio.until([&] { return app.focused() == Pane::sound; }));
  ASSERT_TRUE(studio.changes_bell("m", [](const auto& b) { return b.scale.stiffness > 1.01; }));
  ASSERT_TRUE(studio.changes_bell("ctrl+z", [](const auto& b) { return std::abs(b.scale.stiffness - 1) < 1e-3; }));
  ASSERT_TRUE(studio.changes_bell("ctrl+y", [](const auto& b) { return b.scale.stiffness > 1.01; }));
  studio.press("ctrl+equal");
  EXPECT_TRUE(studio.until([&] { return app.window().scale() > 1.1; }));
  studio.press("ctrl+minus");
  EXPECT_TRUE(studio.until([&] { return app.window().scale() < 1.1; }));
  for (const char* key : {"Tab", "F11"}) {
    studio.press(key);
    EXPECT_TRUE(studio.until([&] { return app.window().full_screen() && app.window().width() == 1280; })) << key;
    studio.press(key);
    EXPECT_TRUE(studio.until([&] { return !app.window().full_screen() && app.window().width() == 900; })) << key;
  }
  studio.press("Escape");
  EXPECT_TRUE(studio.until([&] { return !app.runs(); }));
}

TEST(Window, TheObjectKeysGoThroughAllObjects) {
  OPEN_STUDIO(studio);
  App& app = studio.app();
  app.client().send(protocol::LoadObject{"plate", kPresets + "/banks/steel-plate.glb"});
  ASSERT_TRUE(studio.until([&] { return app.model().object("plate"); }));
  app.commands().choose_object("bell");
  for (const char* key : {"o", "i"}) {
    const std::string before = app.commands().choice().object;
    studio.press(key);
    EXPECT_TRUE(studio.until([&] { return app.commands().choice().object != before; })) << key;
  }
  EXPECT_EQ(app.commands().choice().object, "bell");
}

// The address stands at the top of the left pane.
TEST(Window, InATextFieldLettersAreText) {
  OPEN_STUDIO(studio);
  App& app = studio.app();
  studio.act({"mousemove", "60", "18"});
  studio.hold({"click", "1"});
  ASSERT_TRUE(studio.until([] { return ImGui::GetIO().WantTextInput; }));
  EXPECT_EQ(app.focused(), Pane::side);
  for (const char* key : {"z", "b", "comma", "period", "p", "BackSpace", "Tab"}) studio.hold({"key", key});
  EXPECT_EQ(app.commands().choice().node, 0u);
  EXPECT_FALSE(app.window().full_screen());
  EXPECT_TRUE(studio.relay().asked<protocol::SetMaterial>().empty());
  EXPECT_TRUE(studio.relay().asked<protocol::StrikeVertex>().empty());
  EXPECT_TRUE(studio.relay().asked<protocol::ClearAll>().empty());
  studio.hold({"click", "1"});  // in ImGui 1.90 Tab has gone on to a button
  ASSERT_TRUE(studio.until([] { return ImGui::GetIO().WantTextInput; }));
  studio.hold({"key", "Escape"});
  EXPECT_TRUE(studio.until([] { return !ImGui::GetIO().WantTextInput; })) << "escape leaves the field";
  EXPECT_TRUE(app.runs()) << "and not the window";
  studio.hold({"click", "1"});
  ASSERT_TRUE(studio.until([] { return ImGui::GetIO().WantTextInput; }));
  studio.press("ctrl+Tab");
  EXPECT_TRUE(studio.until([&] { return app.focused() == Pane::scene; })) << "ctrl+tab leaves the field";
  ASSERT_TRUE(studio.until([] { return !ImGui::GetIO().WantTextInput; }));
  EXPECT_TRUE(studio.changes_bell("z", [](const auto& b) { return b.scale.alpha > 1.01; }))
      << "a letter is a key again";
}

TEST(Window, AFrameSurroundsTheFocusedPane) {
  OPEN_STUDIO(studio);
  App& app = studio.app();
  const ImU32 focus = make_skin(true).focus;
  // Whether the window's picture has the frame's colour there.
  const auto framed = [&](double x, double y) {
    const Image image = app.window().read_pixels();
    const auto i =
        4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
    const auto channel = [&](int shift) { return static_cast<std::uint8_t>(focus >> shift); };
    return image.rgba[i] == channel(IM_COL32_R_SHIFT) && image.rgba[i + 1] == channel(IM_COL32_G_SHIFT) &&
           image.rgba[i + 2] == channel(IM_COL32_B_SHIFT);
  };
  const double left = app.scene_view().origin().x, right = left + app.scene_view().size().x;
  const double height = app.window().height(), width = app.window().width();
  const std::map<Pane, std::pair<double, double>> sides = {
      {Pane::scene, {left, right}}, {Pane::sound, {right, width}}, {Pane::side, {0, left}}};
  for (int i = 0; i < 3; ++i) {
    for (const auto& [pane, ends] : sides) {
      const auto [from, to] = ends;
      const double middle = (from + to) / 2;
      for (const auto& [x, y] :
           {std::pair{middle, 1.0}, {middle, height - 2}, {from + 1, height / 2}, {to - 2, height / 2}}) {
        EXPECT_EQ(framed(x, y), pane == app.focused()) << x << ", " << y << " in turn " << i;
      }
    }
    const Pane before = app.focused();
    studio.press("ctrl+Tab");
    ASSERT_TRUE(studio.until([&] { return app.focused() != before; }));
    app.frame();
  }
}

TEST(Window, TheClockStopsAtTheScenesEnd) {
  EXPECT_EQ(scene_note("demo", 3.21, 12, false), "demo   3.2 s of 12 s");
  EXPECT_EQ(scene_note("chimes", 11.36, 11.4, true), "chimes   11.4 s of 11.4 s   paused (F5)");
  EXPECT_EQ(scene_note("demo", 50, 12, false), "demo   12.0 s of 12 s   ended (F6: restart)");
  EXPECT_EQ(scene_note("endless", 50, 0, false), "endless   50.0 s");
}

// The table fills the lower right of the window.
TEST(Window, AClickInTheTableOfModesSelectsOneAndTheNextSelectsAll) {
  OPEN_STUDIO(studio);
  const auto modes = studio.bell().modes;
  studio.act({"mousemove", "800", "490"});
  studio.hold({"click", "1"});
  ASSERT_TRUE(studio.until([&] { return studio.bell().selected_modes == 1; }));
  ASSERT_TRUE(studio.asks<protocol::RingModes>());
  EXPECT_EQ(studio.relay().asked<protocol::RingModes>()[0].verb.first,
            static_cast<std::uint32_t>(studio.bell().first_mode));
  EXPECT_TRUE(studio.until([&] { return studio.status().sounding_modes == 1; }));
  studio.hold({"click", "1"});
  EXPECT_TRUE(studio.until([&] { return studio.bell().selected_modes == modes; }));
}

TEST(Window, ASceneIsLoadedByTheKeyboardAlone) {
  OPEN_STUDIO(studio);
  ASSERT_TRUE(studio.until([&] { return !studio.app().model().files().scenes().empty(); }));
  studio.press("ctrl+Tab");
  ASSERT_TRUE(studio.until([&] { return studio.app().focused() == Pane::sound; }));
  studio.press("ctrl+Tab");
  ASSERT_TRUE(studio.until([&] { return studio.app().focused() == Pane::side; }));
  const auto loads = [&] { return studio.relay().asked<protocol::SceneLoad>(); };
  for (int i = 0; i < 12 && loads().empty(); ++i) {
    studio.hold({"key", "Down"});
    if (i >= 4) studio.hold({"key", "space"});  // past the address, the buttons, the heading and the search
  }
  ASSERT_TRUE(studio.asks<protocol::SceneLoad>());
  const std::string path = loads()[0].path;
  EXPECT_TRUE(std::ranges::count(studio.app().model().files().scenes(), path)) << path;
  EXPECT_TRUE(studio.until([&] { return studio.app().model().scene().description().file == path; }));
}

TEST(Window, ABodyIsRemovedAndComesBack) {
  OPEN_STUDIO(studio);
  studio.act({"mousemove", "5", "5"});  // so that the key acts in the middle of the picture
  studio.press("Delete");
  ASSERT_TRUE(studio.until([&] { return studio.status().bodies == 1; }));
  EXPECT_TRUE(studio.until([&] { return studio.app().model().scene().bodies().size() == 1; }));
  studio.press("ctrl+z");
  ASSERT_TRUE(studio.until([&] { return studio.status().bodies == 2; }));
  EXPECT_TRUE(studio.until([&] { return studio.app().model().scene().bodies().size() == 2; }));
  EXPECT_EQ(studio.app().model().scene().bodies().at(0).name, "bell");
}

// By the protocol by which a file manager of a desktop drops files.
TEST(Window, ADroppedObjectIsBakedBesideAndStandsInThePicture) {
  OPEN_STUDIO(studio);
  std::filesystem::copy_file(kPresets + "/objects/box.geo", studio.folder() / "box.geo");
  const std::filesystem::path object = studio.folder().write(
      "brick.toml", "material = 'concrete'\ngeometry = 'box.geo'\nunit_m = 0.001\nmesh_size_m = 0.06\n");
  const FileDrop drop("Ringdown", object);
  ASSERT_TRUE(studio.until([&] { return drop.is_taken(); }));
  ASSERT_TRUE(studio.until([&] {
    const auto& objects = studio.app().model().objects();
    const auto brick =
        std::ranges::find_if(objects, [](const auto& entry) { return entry.first.starts_with("brick-"); });
    return brick != objects.end() && brick->second.bank &&
           studio.app().scene_view().stage().contents().items.size() == 3;
  })) << studio.condition();
  EXPECT_TRUE(studio.app().baker().jobs().empty());
}

TEST(Window, ARecordingIsStartedAndEnded) {
  OPEN_STUDIO(studio);
  studio.press("ctrl+r");
  ASSERT_TRUE(studio.asks<protocol::RecordStart>());
  ASSERT_TRUE(studio.until([&] { return studio.app().model().recording(); }));
  EXPECT_TRUE(studio.status().recording);
  studio.press("ctrl+r");
  ASSERT_TRUE(studio.asks<protocol::RecordStop>());
  EXPECT_TRUE(studio.until([&] { return !studio.app().model().recording(); }));
  std::filesystem::remove(studio.relay().asked<protocol::RecordStart>()[0].path);
}

TEST(Window, AMaterialOfTheListIsSetAndUndone) {
  OPEN_STUDIO(studio);
  Commands& commands = studio.app().commands();
  const KnownObject* bell = studio.app().model().object("bell");
  const modal::Material bronze = *bell->bank->bank.material;
  for (const modal::Material& known : known_materials()) {
    if (known.name != "glass") continue;
    commands.edits().change(*bell, protocol::SetMaterial{{"bell", {}}, choice_of(bronze, known).scale}, "material");
  }
  EXPECT_TRUE(studio.until([&] { return studio.bell().scale.density < 0.5; }));
  EXPECT_EQ(material_name(bronze, studio.bell().scale, known_materials()), "glass");
  studio.press("ctrl+z");
  EXPECT_TRUE(studio.until([&] { return studio.bell().scale == modal::MaterialScale{}; }));
}

TEST(Window, AMutedObjectRingsUnheard) {
  OPEN_STUDIO(studio);
  const Model& model = studio.app().model();
  Commands& commands = studio.app().commands();
  commands.set_mute(*model.object("bell"), true);
  ASSERT_TRUE(studio.until([&] { return model.object("bell")->mute; }));
  EXPECT_TRUE(studio.bell().mute);
  commands.perform(Action::project_test_force);
  ASSERT_TRUE(studio.until([&] { return model.load().sounding_objects == 1; })) << "it rings";
  // What was heard before the mute was complete is held for a while; then nothing is left, though the bell rings.
  // Notices of load and level come together, so after some more of the former the latter tell of the ringing bell.
  EXPECT_TRUE(studio.until([&] { return model.peak().held == 0 || model.load().sounding_objects == 0; }));
  for (int notice = 0; notice < 3; ++notice) {
    const double mean = model.load().mean;
    ASSERT_TRUE(studio.until([&] { return model.load().mean != mean; }));
  }
  EXPECT_EQ(model.load().sounding_objects, 1);
  EXPECT_EQ(model.peak().held, 0);
  commands.set_mute(*model.object("bell"), false);
  EXPECT_TRUE(studio.until([&] { return model.peak().held > 1e-4; })) << "it still rings";
}

TEST(Window, WhatIsHeardIsCaptured) {
  OPEN_STUDIO(studio);
  const Model& model = studio.app().model();
  const std::filesystem::path file = studio.folder() / "take.wav";
  studio.app().commands().capture_to(file.string());
  ASSERT_TRUE(studio.until([&] { return model.status() && model.status()->capture; })) << studio.condition();
  studio.app().commands().perform(Action::project_test_force);
  ASSERT_TRUE(studio.until([&] { return model.status()->captured_s > 1; }));
  EXPECT_FALSE(std::filesystem::exists(file));
  studio.app().commands().capture_to(std::nullopt);
  ASSERT_TRUE(studio.until([&] { return !model.status()->capture; }));
  ASSERT_TRUE(std::filesystem::exists(file));
  EXPECT_GT(std::filesystem::file_size(file), 8u * 48000);
}

TEST(Window, AnEditedSceneIsSavedAndLoadsAgain) {
  OPEN_STUDIO(studio);
  const Model& model = studio.app().model();
  Commands& commands = studio.app().commands();
  commands.edits().change(*model.object("bell"), protocol::SetMaterial{{"bell", {}}, {1, 1, 1, 4, 0.5}}, "material");
  commands.perform(Action::new_box);
  ASSERT_TRUE(studio.until([&] { return studio.status().bodies == 3; }));
  const std::filesystem::path file = studio.folder() / "edited.toml";
  commands.save_scene(file.string(), false);
  ASSERT_TRUE(studio.until([&] { return std::filesystem::exists(file); })) << studio.condition();
  commands.save_scene(file.string(), false);
  EXPECT_TRUE(studio.until([&] { return !model.messages().empty() && model.messages().back().failed; }));
  commands.perform(Action::clear_scene);
  commands.load_scene(file.string());
  ASSERT_TRUE(studio.until([&] { return model.scene().description().file == file.string(); })) << studio.condition();
  EXPECT_EQ(studio.status().bodies, 3);
  EXPECT_EQ(studio.bell().scale, (modal::MaterialScale{1, 1, 1, 4, 0.5}));
}

// A framebuffer that something else left bound would take the frame, and the window would stay black.
TEST(Window, EachPaneAloneIsPaintedIntoTheWindow) {
  const VirtualDisplay display;
  if (!display.works()) GTEST_SKIP() << "needs Xvfb (./run packages)";
  for (const Pane only : {Pane::scene, Pane::sound, Pane::any}) {
    auto window = Window::open({400, 300, true, 1});
    ASSERT_TRUE(window) << window.error().message;
    auto renderer = SceneRenderer::create();
    ASSERT_TRUE(renderer) << renderer.error().message;
    App app(std::move(*window), std::move(*renderer), Settings{}, {at(9), std::nullopt, only, std::nullopt});
    app.draw();
    GLint painted = -1;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &painted);
    EXPECT_EQ(painted, 0) << static_cast<int>(only);
  }
}

// As a desktop tells X11 programs of a display with many pixels per inch.
TEST(Window, TheWindowTakesTheScaleOfTheDisplayUnlessOneIsChosen) {
  const VirtualDisplay display;
  if (!display.works()) GTEST_SKIP() << "needs Xvfb (./run packages)";
  Process desktop(
      {"xprop", "-root", "-format", "RESOURCE_MANAGER", "8s", "-set", "RESOURCE_MANAGER", "Xft.dpi:\t192\n"});
  ASSERT_EQ(desktop.wait(), 0) << desktop.output();
  for (const auto& [chosen, wanted] : {std::pair{0.0, 2.0}, {1.25, 1.25}}) {
    const auto window = Window::open({900, 520, false, chosen});
    ASSERT_TRUE(window) << window.error().message;
    EXPECT_EQ(window->scale(), wanted);
    EXPECT_EQ(window->display_scale(), 2);
    EXPECT_EQ(window->width(), 900) << "nobody sees it";
  }
  const auto seen = Window::open({400, 300, true, 0});
  ASSERT_TRUE(seen) << seen.error().message;
  EXPECT_EQ(seen->width(), 800);
  EXPECT_EQ(seen->height(), 600);
}

TEST(Window, TheWindowRecoversFromADaemonThatIsKilledAndStartedAgain) {
  OPEN_STUDIO(studio);
  const auto state = [&] { return studio.app().client().state(); };
  ASSERT_EQ(state().kind, ConnectionState::Kind::connected);
  studio.daemon().process().send_signal(SIGKILL);
  ASSERT_TRUE(studio.until([&] { return state().kind == ConnectionState::Kind::away; }));
  EXPECT_NE(state().sentence.find("ringdownd"), std::string::npos) << state().sentence;
  Process again({program("ringdownd"), "--port", std::to_string(studio.daemon().port()), "--driver", "null", "--object",
                 "plate=" + kPresets + "/banks/steel-plate.glb"});
  ASSERT_TRUE(studio.until([&] {
    const auto* plate = studio.app().model().object("plate");
    return state().kind == ConnectionState::Kind::connected && plate && plate->bank;
  }));
  EXPECT_FALSE(studio.app().model().object("bell"));
  EXPECT_TRUE(studio.until([&] {
    const auto& staged = studio.app().scene_view().stage().contents().items;
    return staged.size() == 1 && staged[0].object == "plate";
  }));
}

}  // namespace
}  // namespace ringdown::viewer
