// The mouse in the window, on a display, against a real daemon: what it strikes, and how it moves the camera.
#include "engine/modal/bank_file.h"
#include "tests/viewer/studio.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace ringdown::viewer {
namespace {

// The bell's sample point that is nearest to the camera: nothing of the bell hides it. The pixel lies a little towards
// its middle, because such a point may be at the edge of what is seen.
struct Target {
  Vec3 object_m;    // in the bell's frame
  glm::vec2 pixel;  // in the window
};
Target nearest_point(Studio& studio) {
  const auto bank = modal::read_bank(kPresets + "/banks/bronze-bell.glb");
  EXPECT_TRUE(bank);
  const SceneView& view = studio.app().scene_view();
  const auto& set = view.stage().contents();
  const auto bell =
      static_cast<std::size_t>(std::ranges::find(set.items, "bell", &StageItem::object) - set.items.begin());
  Target target{};
  float nearest = 1e9F;
  for (const auto& [x, y, z] : bank->positions) {
    const glm::vec3 point(set.frame.bodies[bell].pose * glm::vec4(x, y, z, 1));
    const float away = glm::length(point - view.camera().position_m);
    const auto pixel = view.camera().project(point, static_cast<int>(view.size().x), static_cast<int>(view.size().y));
    if (away >= nearest || !pixel) continue;
    nearest = away;
    target = {{x, y, z}, glm::vec2(view.origin().x, view.origin().y) + *pixel};
  }
  const glm::vec2 middle = glm::vec2(view.origin().x, view.origin().y) +
                           *view.camera().project(glm::vec3(set.frame.bodies[bell].pose[3]),
                                                  static_cast<int>(view.size().x), static_cast<int>(view.size().y));
  target.pixel += 3.0F * glm::normalize(middle - target.pixel);
  return target;
}

TEST(Window, AClickOnTheBellStrikesItThere) {
  OPEN_STUDIO(studio);
  const Target target = nearest_point(studio);
  const auto x = std::to_string(std::lround(target.pixel.x)), y = std::to_string(std::lround(target.pixel.y));
  studio.act({"mousemove", x, y});
  studio.act({"click", "1"});
  ASSERT_TRUE(studio.asks<protocol::Strike>());
  const protocol::Strike strike = studio.relay().asked<protocol::Strike>()[0];
  EXPECT_EQ(strike.object.name, "bell");
  // A pixel is some 2 mm there, and the surface bends.
  EXPECT_LT(length(strike.verb.point_m - target.object_m), 0.02);
  EXPECT_GT(length(strike.verb.impulse_ns), 0);
  std::optional<KnownContact> told;
  bool sounds = false, glows = false;
  EXPECT_TRUE(studio.until([&] {
    const Model& model = studio.app().model();
    if (!model.contacts().empty()) told = model.contacts().back();
    sounds = sounds || model.load().sounding_objects == 1;
    glows = glows || std::ranges::any_of(studio.app().scene_view().stage().contents().frame.bodies,
                                         [](const DrawnBody& body) { return body.glow > 0.3F; });
    return told && sounds && glows;
  })) << "told "
      << told.has_value() << ", sounds " << sounds << ", glows " << glows << "; " << studio.condition();
  ASSERT_TRUE(told);
  EXPECT_LT(length(told->point_m - target.object_m), 0.02) << "as the daemon tells it";
}

TEST(Window, AClickHeldLongerStrikesHarder) {
  OPEN_STUDIO(studio);
  const Target target = nearest_point(studio);
  studio.act({"mousemove", std::to_string(std::lround(target.pixel.x)), std::to_string(std::lround(target.pixel.y))});
  const auto strikes = [&] { return studio.relay().asked<protocol::Strike>(); };
  studio.act({"mousedown", "1"});
  studio.act({"mouseup", "1"});
  ASSERT_TRUE(studio.until([&] { return strikes().size() == 1; }));
  studio.act({"mousedown", "1"});
  studio.until([] { return false; }, 2s);
  studio.act({"mouseup", "1"});
  ASSERT_TRUE(studio.until([&] { return strikes().size() == 2; }));
  EXPECT_LE(length(strikes()[0].verb.impulse_ns), length(strikes()[1].verb.impulse_ns))
      << "however long the first took";
  EXPECT_NEAR(length(strikes()[1].verb.impulse_ns), 8 * studio.app().commands().choice().impulse_ns, 1e-6);
}

TEST(Window, ControlAndAClickChooseASupportWhichIsCopiedAsText) {
  OPEN_STUDIO(studio);
  const Target target = nearest_point(studio);
  const SupportChoice& support = studio.app().scene_view().support();
  studio.act({"mousemove", std::to_string(std::lround(target.pixel.x)), std::to_string(std::lround(target.pixel.y))});
  studio.act({"keydown", "ctrl"});
  studio.hold({"click", "1"});
  EXPECT_TRUE(studio.until([&] { return !support.empty(); }));
  EXPECT_EQ(support.object(), "bell");
  EXPECT_EQ(support.text().find("[[support]]"), 0u);
  const double flat_m2 = support.area_m2();
  // A rectangle around it adds what faces the camera there.
  studio.act({"mousemove_relative", "--", "-40", "-40"});
  studio.act({"mousedown", "1"});
  for (int i = 0; i < 4; ++i) studio.act({"mousemove_relative", "--", "20", "20"});
  studio.act({"mouseup", "1"});
  EXPECT_TRUE(studio.until([&] { return support.area_m2() > flat_m2; }));
  studio.hold({"key", "c"});
  studio.act({"keyup", "ctrl"});
  EXPECT_TRUE(studio.until([&] { return ImGui::GetClipboardText() == support.text(); })) << ImGui::GetClipboardText();
  EXPECT_TRUE(studio.relay().asked<protocol::Strike>().empty()) << "a choice is no strike";
}

TEST(Window, DraggingTurnsTheWheelZoomsAndShiftPushes) {
  OPEN_STUDIO(studio);
  App& app = studio.app();
  const SceneView& view = app.scene_view();
  const auto in_view = [&](glm::vec3 point) {
    const auto pixel = view.camera().project(point, static_cast<int>(view.size().x), static_cast<int>(view.size().y));
    return std::pair(std::to_string(std::lround(view.origin().x + pixel->x)),
                     std::to_string(std::lround(view.origin().y + pixel->y)));
  };
  const auto [bx, by] = in_view({0.4F, -0.05F, 0.05F});
  studio.drag(bx, by, 4, -15, 0, "shift");
  ASSERT_TRUE(studio.asks<protocol::ScenePush>());
  EXPECT_LT(studio.relay().asked<protocol::ScenePush>()[0].impulse_ns.x, 0);
  EXPECT_TRUE(studio.until([&] {
    const auto& set = view.stage().contents();
    return std::ranges::any_of(set.frame.bodies,
                               [](const DrawnBody& b) { return b.pose[3].x > 0.01F && b.pose[3].x < 0.39F; });
  })) << "the block does not move";

  const float yaw = view.camera().yaw;
  studio.drag(bx, by, 4, -20, 0);
  EXPECT_TRUE(studio.until([&] { return std::abs(view.camera().yaw - yaw) > 0.02F; }));
  const glm::vec3 before = view.camera().position_m;
  studio.act({"click", "4"});
  EXPECT_TRUE(
      studio.until([&] { return glm::dot(view.camera().position_m - before, view.camera().forward()) > 0.01F; }));
  EXPECT_TRUE(studio.relay().asked<protocol::Strike>().empty()) << "a drag strikes nothing";
}

// Returns the middle pixel of what is seen of an object, in the window; nothing if it is not seen.
std::optional<glm::vec2> pixel_of(Studio& studio, const std::string& object) {
  const SceneView& view = studio.app().scene_view();
  const auto& [frame, items, picked] = view.stage().contents();
  constexpr int kStep = 5, kEdge = 30;
  std::vector<glm::vec2> seen;
  for (int y = kEdge; y < static_cast<int>(view.size().y) - kEdge; y += kStep) {
    for (int x = kEdge; x < static_cast<int>(view.size().x) - kEdge; x += kStep) {
      const auto hit = pick(view.camera().ray_through(static_cast<float>(x), static_cast<float>(y),
                                                      static_cast<int>(view.size().x), static_cast<int>(view.size().y)),
                            picked);
      if (hit && hit->id < items.size() && items[hit->id].object == object) seen.emplace_back(x, y);
    }
  }
  if (seen.size() < 8) return std::nullopt;
  return glm::vec2(view.origin().x, view.origin().y) + seen[seen.size() / 2];
}

std::string text_of(float pixel) { return std::to_string(std::lround(pixel)); }

TEST(Window, AMalletIsThrownAndABowIsDrawnByTheMouse) {
  OPEN_STUDIO(studio);
  const TouchPanel& panel = studio.app().scene_view().touching();
  const Camera& camera = studio.app().scene_view().camera();
  const History& history = studio.app().commands().edits().history();
  const Touches& touches = studio.app().commands().edits().touches();
  const Target target = nearest_point(studio);
  studio.press("t");
  ASSERT_TRUE(studio.until([&] { return panel.is_open(); }));
  studio.act({"mousemove", text_of(target.pixel.x), text_of(target.pixel.y)});
  studio.hold({"click", "1"});
  ASSERT_TRUE(studio.asks<protocol::HitMallet>());
  const protocol::HitMallet mallet = studio.relay().asked<protocol::HitMallet>()[0];
  EXPECT_EQ(mallet.object.name, "bell");
  EXPECT_LT(length(mallet.verb.point_m - target.object_m), 0.02);
  EXPECT_NEAR(length(mallet.verb.velocity_m_s), 1, 1e-6);
  EXPECT_GT(mallet.verb.velocity_m_s.y, 0.5) << "away from the camera, into the surface";
  EXPECT_TRUE(studio.until([&] { return studio.status().sounding_objects == 1; }));
  EXPECT_EQ(history.undoes(), "") << "a blow cannot be undone";

  studio.press("t");
  ASSERT_TRUE(studio.until([&] { return panel.kind() == TouchPanel::Kind::bow; }));
  const float yaw = camera.yaw;
  const auto bows = [&] { return studio.relay().asked<protocol::SetBow>(); };
  studio.drag(text_of(target.pixel.x), text_of(target.pixel.y), 3, 8, 0);
  ASSERT_TRUE(studio.until([&] { return bows().size() == 1 && touches.bows().size() == 1; }));
  EXPECT_EQ(bows()[0].object.name, "bell");
  EXPECT_LT(length(bows()[0].verb.point_m - target.object_m), 0.02);
  EXPECT_GT(bows()[0].verb.direction.x, 0.8) << "as the mouse went, to the right";
  EXPECT_GT(bows()[0].verb.force_n, 0);
  EXPECT_EQ(camera.yaw, yaw) << "the drag does not turn the camera";
  studio.press("ctrl+z");
  ASSERT_TRUE(studio.until([&] { return bows().size() == 2; }));
  EXPECT_EQ(bows()[1].verb.force_n, 0) << "undo lifts it";
  EXPECT_EQ(bows()[1].verb.number, bows()[0].verb.number);
  EXPECT_TRUE(touches.bows().empty());
  studio.press("ctrl+y");
  ASSERT_TRUE(studio.until([&] { return bows().size() == 3; }));
  EXPECT_EQ(bows()[2].verb.force_n, bows()[0].verb.force_n);
  EXPECT_EQ(touches.bows().size(), 1u);
  studio.press("BackSpace");
  studio.press("t");
  studio.press("t");
  ASSERT_TRUE(studio.until([&] { return !panel.is_open() && touches.bows().empty(); }));
  EXPECT_TRUE(studio.relay().asked<protocol::Strike>().empty());
}

TEST(Window, ADragFromObjectToObjectCouplesThemAndUndoSeparatesThem) {
  OPEN_STUDIO(studio);
  std::string text = scene_text();
  text.replace(text.find("[0, -1.5, 0.6]"), 14, "[0, -2, 0.6]");
  text.replace(text.find("[0, 0, 0.45]"), 12, "[-0.2, 0, 0.45]");
  text += "[[object]]\nname = 'other'\nbank = '" + kPresets + "/banks/bronze-bell.glb'\n";
  text += "[[body]]\nname = 'other'\nobject = 'other'\nposition_m = [0.2, 0, 0.45]\nfixed = true\n";
  studio.app().commands().load_scene(studio.folder().write("pair.toml", text).string());
  ASSERT_TRUE(studio.until([&] { return pixel_of(studio, "other") && pixel_of(studio, "bell"); }))
      << studio.condition();
  for (int i = 0; i < 3; ++i) studio.press("t");
  const TouchPanel& panel = studio.app().scene_view().touching();
  ASSERT_TRUE(studio.until([&] { return panel.is_open() && panel.kind() == TouchPanel::Kind::coupling; }));
  const glm::vec2 from = pixel_of(studio, "bell").value(), to = pixel_of(studio, "other").value();
  const auto asked = [&] { return studio.relay().asked<protocol::SetCoupling>(); };
  studio.drag(text_of(from.x), text_of(from.y), 1, 0, 12);
  studio.until([] { return false; }, 1s);
  EXPECT_TRUE(asked().empty()) << "an object does not touch itself";
  studio.drag(text_of(from.x), text_of(from.y), 1, static_cast<int>(std::lround(to.x - from.x)),
              static_cast<int>(std::lround(to.y - from.y)));
  ASSERT_TRUE(studio.until([&] { return asked().size() == 1; }));
  EXPECT_EQ(asked()[0].object.name, "bell");
  EXPECT_EQ(asked()[0].other.name, "other");
  EXPECT_NEAR(length(asked()[0].verb.direction), 1, 1e-6);
  EXPECT_GT(asked()[0].verb.direction.y, 0) << "the other pushes the bell away from the camera";
  EXPECT_EQ(studio.app().commands().edits().touches().couplings().size(), 1u);
  // A strike on one object is heard in the other.
  studio.app().commands().choose_object("bell");
  studio.press("p");
  EXPECT_TRUE(studio.until([&] { return studio.status().sounding_objects == 2; })) << studio.condition();
  studio.press("ctrl+z");
  ASSERT_TRUE(studio.until([&] { return asked().size() == 2; }));
  EXPECT_EQ(asked()[1].verb.stiffness, 0);
  EXPECT_TRUE(studio.app().commands().edits().touches().couplings().empty());
}

// The bell is fixed, so it stays where the mouse puts it.
TEST(Window, AnArrowOfTheGizmoMovesABodyAndUndoPutsItBack) {
  OPEN_STUDIO(studio);
  const PlacePanel& placing = studio.app().scene_view().placing();
  const Target target = nearest_point(studio);
  studio.take_focus();
  studio.act({"mousemove", std::to_string(std::lround(target.pixel.x)), std::to_string(std::lround(target.pixel.y))});
  studio.press("e");
  ASSERT_TRUE(studio.until([&] { return placing.body() == 0 && placing.middle_of(Handle::move_x); }));
  const SceneView& view = studio.app().scene_view();
  const auto drawn_at = [&] {  // in pixels
    const glm::vec3 origin(view.stage().contents().frame.bodies[0].pose[3]);
    return view.camera().project(origin, static_cast<int>(view.size().x), static_cast<int>(view.size().y)).value();
  };
  const glm::vec2 before = drawn_at();
  const ImVec2 grip = *placing.middle_of(Handle::move_x);
  studio.drag(std::to_string(std::lround(grip.x)), std::to_string(std::lround(grip.y)), 4, 10, 0);
  const auto bell_m = [&] {
    const auto pose = studio.app().commands().edits().pose_of(0);
    return pose ? pose->position_m : Vec3{};
  };
  const auto asked = [&] { return studio.relay().asked<protocol::ScenePlace>(); };
  ASSERT_TRUE(studio.until([&] { return !asked().empty(); }));
  studio.until([] { return false; }, 1s);  // the daemon says now where it is
  const Vec3 moved_m = bell_m();
  EXPECT_GT(moved_m.x, 0.01);
  EXPECT_NEAR(drawn_at().x - before.x, 40, 2) << "the body follows the mouse";
  EXPECT_NEAR(moved_m.y, 0, 1e-6) << "along x only";
  EXPECT_NEAR(moved_m.z, 0.45, 1e-6);
  EXPECT_TRUE(studio.relay().asked<protocol::Strike>().empty()) << "a drag of a handle strikes nothing";
  // One step, or several on a machine that is so slow that they are no single gesture.
  const History& history = studio.app().commands().edits().history();
  for (int steps = 0; steps < 8 && !history.undoes().empty(); ++steps) studio.press("ctrl+z");
  EXPECT_TRUE(studio.until([&] { return std::abs(bell_m().x) < 1e-6; }));
  studio.until([] { return false; }, 1s);
  EXPECT_NEAR(bell_m().x, 0, 1e-6) << "as the daemon says";
  studio.act({"mousemove", std::to_string(std::lround(target.pixel.x)), std::to_string(std::lround(target.pixel.y))});
  studio.press("e");
  EXPECT_TRUE(studio.until([&] { return !placing.body(); }));
}

}  // namespace
}  // namespace ringdown::viewer
