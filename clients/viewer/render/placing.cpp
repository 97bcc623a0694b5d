#include "clients/viewer/render/placing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::viewer {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

Angles angles_of(const Rotation& rotation) {
  const auto& [x, y, z, w] = std::array{rotation.x, rotation.y, rotation.z, rotation.w};
  const double heading = std::atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  const double tilt = std::asin(std::clamp(2 * (w * y - z * x), -1.0, 1.0));
  const double roll = std::atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
  return {heading / kDegree, tilt / kDegree, roll / kDegree};
}

Rotation rotation_of(const Angles& degrees) {
  return about({0, 0, 1}, degrees[0] * kDegree) * about({0, 1, 0}, degrees[1] * kDegree) *
         about({1, 0, 0}, degrees[2] * kDegree);
}

ringdown::Pose changed(const ringdown::Pose& pose, Vec3 centre_m, const Gizmo::Change& change) {
  const Rotation turn = Rotation::from_wxyz(change.turn.w, change.turn.x, change.turn.y, change.turn.z);
  const Vec3 move_m{change.move_m.x, change.move_m.y, change.move_m.z};
  return {centre_m + to_matrix(turn) * (pose.position_m - centre_m) + move_m, normalized(turn * pose.rotation)};
}

}  // namespace ringdown::viewer
