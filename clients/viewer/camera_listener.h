// Lets the daemon hear its objects from the viewer's camera. [UI]
#pragma once

#include "clients/viewer/render/camera.h"
#include "protocol/request.h"

#include <optional>

namespace ringdown::viewer {

class CameraListener {
 public:
  // Returns the request to send in this frame, if one is due: the camera's pose whenever it has moved, and from time to
  // time besides, because a newly loaded scene may set its own listener; and once when the user stops listening from
  // the camera: the listener then goes to `otherwise`, or is removed.
  std::optional<protocol::Request> update(const Camera& camera, bool listens, double now_s,
                                          const std::optional<ringdown::Pose>& otherwise = {});

 private:
  static constexpr double kAgain_s = 0.5;
  bool listening_ = false;
  ringdown::Pose sent_;
  double sent_s_ = 0;
};

// Returns the listener's pose for a camera: x to the front, y to the left, z up.
ringdown::Pose listener_of(const Camera& camera);

}  // namespace ringdown::viewer
