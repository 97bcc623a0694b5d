// Moves, turns and sizes a body of the scene: by the handles of a gizmo in the picture, or by numbers in a panel. [UI]
//
// The size is that of the object that the body plays, so every body that plays the object gets it.
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/panels/skin.h"
#include "clients/viewer/render/placing.h"
#include "clients/viewer/render/gizmo.h"
#include "clients/viewer/stage.h"

#include <cstdint>
#include <optional>
#include <string>

namespace ringdown::viewer {

class PlacePanel {
 public:
  // Begins to place a body, or ends if it is placed already.
  void toggle(std::int32_t body);
  void end() { body_.reset(), drag_.reset(); }
  [[nodiscard]] std::optional<std::int32_t> body() const { return body_; }

  // Draws the gizmo over the picture, which lies at `origin`, and the panel. Ends when the body leaves the scene.
  void draw(const Skin& skin, ImVec2 origin, ImVec2 size, const Camera& camera, const Stage::Contents& contents,
            const Model& model, Commands& commands);

  // The button went down at a point of the window. Returns whether that is a handle, which the mouse then drags.
  bool press(ImVec2 at);
  [[nodiscard]] bool is_dragged() const { return drag_.has_value(); }
  void drag(ImVec2 to, const Model& model, Commands& commands);
  void release() { drag_.reset(); }

  // Returns the middle of a handle's line in the window, if the handle is shown.
  [[nodiscard]] std::optional<ImVec2> middle_of(Handle handle) const;

 private:
  struct Drag {
    Handle handle;
    glm::vec2 from;
    Gizmo gizmo;  // as it was when the button went down
    ringdown::Pose pose;
    Vec3 centre_m;
    double size;
  };
  [[nodiscard]] glm::vec2 in_picture(ImVec2 at) const { return {at.x - origin_.x, at.y - origin_.y}; }
  void draw_gizmo(const Skin& skin) const;
  void draw_numbers(const Skin& skin, ImVec2 size, const Model& model, Commands& commands);
  void set_size(double factor, const Model& model, Commands& commands) const;

  std::optional<std::int32_t> body_;
  ringdown::Pose pose_;  // in this frame
  Vec3 centre_m_;        // of the body's bounding box
  std::string object_;   // that the body plays; empty: none
  double size_ = 1;      // of the object
  std::optional<Gizmo> gizmo_;
  std::optional<Drag> drag_;
  ImVec2 origin_{0, 0};
  Angles angles_{};  // of pose_, as typed
};

}  // namespace ringdown::viewer
