// The scene pane: the picture, the camera, and what the mouse does in it. [UI]
//
// Drag: look. Wheel: zoom. Click on a surface: strike it there; held longer, harder, or by the slider's strength.
// Shift and drag: push a body the way the mouse goes.
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/panels/skin.h"
#include "clients/viewer/render/scene_renderer.h"
#include "clients/viewer/stage.h"

#include <optional>
#include <string>

namespace ringdown::viewer {

class SceneView {
 public:
  explicit SceneView(SceneRenderer renderer) : renderer_(std::move(renderer)) {}

  // Draws into the current ImGui window, all of it. `at_s` as in Stage::set.
  void draw(const Skin& skin, Model& model, Commands& commands, bool strength_by_time, double now_s,
            std::optional<double> at_s = std::nullopt);

  // The share of its width and height that the picture is drawn with, and then stretched.
  void set_detail(double share) { detail_ = share; }

  // Camera and test force; false for what is not the scene view's to do.
  bool perform(Action action, Model& model, Commands& commands);
  // What a held key does in `seconds`.
  void move(Action action, double seconds);

  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] const Stage& stage() const { return stage_; }
  [[nodiscard]] ImVec2 origin() const { return origin_; }  // of the picture in the window, in pixels
  [[nodiscard]] ImVec2 size() const { return size_; }

  // How much harder a click strikes that was held so long: 1 at kUsualHold_s.
  static double strength_of_hold(double seconds);
  static constexpr double kUsualHold_s = 0.25;

 private:
  struct Press {
    ImVec2 at;
    double since_s;
    std::optional<Hit> hit;
    bool pushes = false, dragged = false;
  };
  void follow_scene(const Model& model, float aspect);
  void handle_mouse(Commands& commands, bool strength_by_time, double now_s);
  void release(Commands& commands, bool strength_by_time, double now_s);
  void draw_press(const Skin& skin, bool strength_by_time, double now_s) const;
  void draw_middle(const Skin& skin) const;
  void strike(const Hit& hit, Commands& commands, double factor);
  [[nodiscard]] std::optional<Hit> hit_at(ImVec2 place) const;
  [[nodiscard]] glm::vec3 push_of(const Press& press, ImVec2 to) const;

  SceneRenderer renderer_;
  Stage stage_;
  Camera camera_;
  std::optional<std::string> shown_;  // the file, and the objects of a row, that the camera was set for
  ImVec2 origin_{0, 0}, size_{1, 1};  // of the picture
  bool hovered_ = false;
  double detail_ = 1;
  std::optional<Press> press_;
};

}  // namespace ringdown::viewer
