#include "clients/viewer/camera_listener.h"

namespace ringdown::viewer {

ringdown::Pose listener_of(const Camera& camera) {
  const glm::vec3& at = camera.position_m;
  return {{at.x, at.y, at.z},
          about({0, 0, 1}, static_cast<double>(camera.yaw)) * about({0, 1, 0}, -static_cast<double>(camera.pitch))};
}

std::optional<protocol::Request> CameraListener::update(const Camera& camera, bool listens, double now_s,
                                                        const std::optional<ringdown::Pose>& otherwise) {
  if (!listens) {
    if (!listening_) return std::nullopt;
    listening_ = false;
    if (otherwise) return protocol::SetListener{{*otherwise}};
    return protocol::ListenerOff{};
  }
  const ringdown::Pose pose = listener_of(camera);
  if (listening_ && pose == sent_ && now_s < sent_s_ + kAgain_s) return std::nullopt;
  listening_ = true;
  sent_ = pose;
  sent_s_ = now_s;
  return protocol::SetListener{{pose}};
}

}  // namespace ringdown::viewer
