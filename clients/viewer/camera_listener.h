// Lets the daemon hear its objects from the viewer's camera. [UI]
#pragma once

#include "clients/viewer/render/camera.h"
#include "protocol/request.h"

#include <optional>

namespace ringdown::viewer {

class CameraListener {
 public:
  // Returns the request to send in this frame, if one is due: where the camera is, whenever it has moved and now and
  // then besides, because a scene that is loaded may have a listener of its own; and once that nobody listens any more.
  std::optional<protocol::Request> update(const Camera& camera, bool listens, double now_s);

 private:
  static constexpr double kAgain_s = 0.5;
  bool listening_ = false;
  ringdown::Pose sent_;
  double sent_s_ = 0;
};

// Returns the pose of a listener that looks as the camera does: x to the front, y to the left, z up.
ringdown::Pose listener_of(const Camera& camera);

}  // namespace ringdown::viewer
