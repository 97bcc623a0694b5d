// The viewer's camera as the listener: which way it faces, and when it is told.
#include "clients/viewer/camera_listener.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ringdown::viewer {
namespace {

Vec3 as_vec3(const glm::vec3& v) { return {v.x, v.y, v.z}; }

TEST(CameraListener, FacesWhatTheCameraSeesWithTheLeftEarToThePicturesLeft) {
  for (const float yaw : {-2.0F, 0.0F, 0.7F, 3.0F}) {
    for (const float pitch : {-1.2F, 0.0F, 0.5F}) {
      const Camera camera{.position_m = {1, -2, 3}, .yaw = yaw, .pitch = pitch};
      const ringdown::Pose pose = listener_of(camera);
      EXPECT_LT(length(pose.position_m - Vec3{1, -2, 3}), 1e-6);
      EXPECT_LT(length(rotated(pose.rotation, {1, 0, 0}) - as_vec3(camera.forward())), 1e-6) << yaw << " " << pitch;
      EXPECT_LT(length(rotated(pose.rotation, {0, -1, 0}) - as_vec3(camera.right())), 1e-6) << yaw << " " << pitch;
      EXPECT_LT(length(rotated(pose.rotation, {0, 0, 1}) - as_vec3(camera.up())), 1e-6) << yaw << " " << pitch;
    }
  }
}

TEST(CameraListener, TellsWhenTheCameraMovesNowAndThenBesidesAndOnceWhenItEnds) {
  CameraListener listener;
  Camera camera;
  EXPECT_FALSE(listener.update(camera, false, 0)) << "nobody has listened";
  EXPECT_TRUE(listener.update(camera, true, 1));
  EXPECT_FALSE(listener.update(camera, true, 1.02));
  camera.yaw += 0.1F;
  EXPECT_TRUE(listener.update(camera, true, 1.04));
  EXPECT_FALSE(listener.update(camera, true, 1.06));
  EXPECT_TRUE(listener.update(camera, true, 2)) << "a scene may have brought a listener of its own";
  const auto end = listener.update(camera, false, 2.02);
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->holds<protocol::ListenerOff>());
  EXPECT_FALSE(listener.update(camera, false, 2.04));
}

}  // namespace
}  // namespace ringdown::viewer
