// The scene pane: the picture, the camera, and the mouse. [UI]
//
// Dragging turns the camera, the wheel moves it forward. A click on a surface strikes it there: harder the longer the
// button is held, or with the slider's impulse. Shift and drag pushes a body in the direction of the drag. A click with
// Control chooses a flat piece of a surface as a support; a drag with Control chooses all triangles in a rectangle that
// face the camera. A body that is placed has handles, which the mouse drags. While the panel of mallets, bows and
// couplings is open, clicks and drags on surfaces are its own.
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/panels/place_panel.h"
#include "clients/viewer/panels/skin.h"
#include "clients/viewer/panels/touch_panel.h"
#include "clients/viewer/render/scene_renderer.h"
#include "clients/viewer/stage.h"
#include "clients/viewer/support_choice.h"

#include <optional>
#include <string>
#include <utility>

namespace ringdown::viewer {

class SceneView {
 public:
  explicit SceneView(SceneRenderer renderer) : renderer_(std::move(renderer)) {}

  // Fills the current ImGui window. `at_s` is the scene time to show; nothing: the current time.
  void draw(const Skin& skin, Model& model, Commands& commands, bool strength_by_time, double now_s,
            std::optional<double> at_s = std::nullopt);

  // Sets the share of the width and height at which the picture is drawn before it is stretched.
  void set_detail(double share) { detail_ = share; }

  // Performs actions of the camera, and those on what is under the mouse. Returns false for all others.
  bool perform(Action action, Model& model, Commands& commands);
  // Performs the action of a key that is held down, for `seconds`.
  void move(Action action, double seconds);

  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] Camera& camera() { return camera_; }
  [[nodiscard]] const Stage& stage() const { return stage_; }
  [[nodiscard]] const SupportChoice& support() const { return support_; }
  [[nodiscard]] const PlacePanel& placing() const { return place_; }
  [[nodiscard]] const TouchPanel& touching() const { return touch_; }
  [[nodiscard]] ImVec2 origin() const { return origin_; }  // position of the picture in the window, in pixels
  [[nodiscard]] ImVec2 size() const { return size_; }

  // Returns the factor on the impulse of a click whose button was down for this time: 1 at kUsualClick_s.
  static double strength_of_click(double seconds);
  static constexpr double kUsualClick_s = 0.25;

 private:
  struct Press {
    ImVec2 at;
    double since_s;
    std::optional<Hit> hit;
    bool pushes = false, chooses = false, touches = false, dragged = false;
  };
  void follow_scene(const Model& model, float aspect);
  void handle_mouse(const Model& model, Commands& commands, bool strength_by_time, double now_s);
  void release(const Model& model, Commands& commands, bool strength_by_time, double now_s);
  void draw_press(const Skin& skin, bool strength_by_time, double now_s) const;
  void draw_middle(const Skin& skin) const;
  void strike(const Hit& hit, Commands& commands, double factor);
  void touch(const Press& press, Commands& commands);
  [[nodiscard]] std::optional<SurfacePoint> surface_at(const Hit& hit) const;
  [[nodiscard]] Vec3 in_body(const Hit& hit, glm::vec3 direction) const;
  void choose(const Hit& hit, const Model& model);
  void choose_between(const Press& press, ImVec2 to, const Model& model);
  // Returns the window position of a point in an object's frame; nothing if it is behind the camera or not drawn.
  [[nodiscard]] std::optional<ImVec2> place_of(const std::string& object, Vec3 point_m) const;
  [[nodiscard]] std::optional<Hit> hit_at(ImVec2 at) const;
  [[nodiscard]] glm::vec3 push_of(const Press& press, ImVec2 to) const;

  SceneRenderer renderer_;
  Stage stage_;
  Camera camera_;
  std::optional<std::string> shown_;  // the scene, or the objects without a body, for which the camera was set
  ImVec2 origin_{0, 0}, size_{1, 1};  // place and size of the picture in the window
  bool hovered_ = false;
  double detail_ = 1;
  std::optional<Press> press_;
  SupportChoice support_;
  PlacePanel place_;
  TouchPanel touch_;
};

}  // namespace ringdown::viewer
