// The description of a scene, which comes in parts that get lost and arrive in any order, and the poses of its bodies.
#include "clients/viewer/link/known_scene.h"

#include <gtest/gtest.h>

#include <limits>

namespace ringdown::viewer {
namespace {

protocol::SceneReply head(std::int32_t version, std::int32_t bodies, std::int32_t statics) {
  return {version, bodies, statics, 12, {0, -2, 1}, {}, 50, "demo.toml"};
}
protocol::SceneBody body(std::int32_t version, std::int32_t id) {
  return {version, id, "body-" + std::to_string(id), id == 0 ? "-" : "bell", "sphere", {1, 1, 1}, false};
}
protocol::SceneStatic floor(std::int32_t version) { return {version, 0, "floor", "plane", {}, {}, 0, 0, 0, 1}; }
protocol::NotifyBody pose(std::int32_t id, double x) {
  return {id, "body-" + std::to_string(id), id == 0 ? "-" : "bell", {x, 0, 0}, 0, 0, 0, 1};
}

class Scene : public testing::Test {
 protected:
  KnownScene scene{0.04};
  double x_of(std::int32_t id, double time_s) { return scene.bodies().at(id).track.pose_at(time_s)->position_m.x; }
};

TEST_F(Scene, ASceneIsAskedForWhenItsVersionIsNewAndAgainWithoutAnAnswer) {
  EXPECT_FALSE(scene.wants(0));
  scene.on(protocol::NotifyScene{3, 0, false}, 0);
  EXPECT_TRUE(scene.wants(0));
  EXPECT_FALSE(scene.wants(0.4));
  EXPECT_TRUE(scene.wants(0.51));
  scene.on(head(3, 0, 0));
  EXPECT_FALSE(scene.wants(2));
  scene.on(protocol::NotifyScene{4, 0.04, false}, 2);
  EXPECT_TRUE(scene.wants(2));
}

TEST_F(Scene, ASceneIsTheSameInWhateverOrderItsPartsCome) {
  scene.on(protocol::NotifyScene{3, 0, false}, 0);
  scene.on(body(3, 1));
  scene.on(floor(3));
  scene.on(head(3, 2, 1));
  EXPECT_FALSE(scene.described());
  scene.on(body(3, 0));
  ASSERT_TRUE(scene.described());
  EXPECT_EQ(scene.bodies().size(), 2u);
  EXPECT_EQ(scene.bodies().at(0).object, "");
  EXPECT_EQ(scene.bodies().at(1).object, "bell");
  EXPECT_EQ(scene.statics().size(), 1u);
  EXPECT_EQ(scene.description().file, "demo.toml");
}

TEST_F(Scene, ASceneIsCompletedByASecondAnswerThatLostOtherParts) {
  scene.on(protocol::NotifyScene{3, 0, false}, 0);
  scene.on(head(3, 2, 0));
  scene.on(body(3, 0));
  ASSERT_TRUE(scene.wants(1));
  scene.on(head(3, 2, 0));
  scene.on(body(3, 1));
  EXPECT_TRUE(scene.described());
  EXPECT_FALSE(scene.wants(9));
}

TEST_F(Scene, PartsOfTwoVersionsAreNeverMixed) {
  scene.on(protocol::NotifyScene{4, 0, false}, 0);
  scene.on(head(3, 2, 0));
  scene.on(body(3, 0));
  scene.on(head(4, 2, 0));
  scene.on(body(3, 1));
  scene.on(body(4, 5));
  EXPECT_FALSE(scene.described());
  scene.on(body(4, 6));
  ASSERT_TRUE(scene.described());
  EXPECT_EQ(scene.bodies().size(), 2u);
  EXPECT_TRUE(scene.bodies().contains(5));
  scene.on(head(3, 0, 0));  // comes late
  EXPECT_EQ(scene.bodies().size(), 2u);
}

TEST_F(Scene, ABodyMissingFromANewDescriptionIsForgotten) {
  scene.on(head(1, 2, 0));
  scene.on(body(1, 0));
  scene.on(body(1, 1));
  scene.on(head(2, 1, 0));
  scene.on(body(2, 1));
  EXPECT_EQ(scene.bodies().size(), 1u);
  EXPECT_TRUE(scene.bodies().contains(1));
}

TEST_F(Scene, BodiesMoveAsNoticesSay) {
  scene.on(head(1, 1, 0));
  scene.on(body(1, 1));
  for (int i = 0; i <= 10; ++i) {
    scene.on(protocol::NotifyScene{1, 0.04 * i, false}, 50 + 0.04 * i);
    scene.on(pose(1, 0.08 * i));
  }
  const double shown_s = *scene.shown_time_at(50.4);
  EXPECT_NEAR(shown_s, 0.34, 1e-9);
  EXPECT_NEAR(x_of(1, shown_s), 0.68, 1e-9);
}

TEST_F(Scene, PosesOfANoticeThatWasOvertakenAreIgnored) {
  scene.on(protocol::NotifyScene{1, 1.0, false}, 0);
  scene.on(pose(1, 10));
  scene.on(protocol::NotifyScene{1, 0.96, false}, 0.001);
  scene.on(pose(1, 9));
  EXPECT_EQ(x_of(1, 5), 10);
  EXPECT_EQ(scene.reported_time_s(), 1.0);
}

TEST_F(Scene, PosesWhoseTimeWasLostAreIgnored) {
  scene.on(protocol::NotifyScene{1, 1.0, false}, 0);
  scene.on(pose(1, 10));
  scene.on(pose(1, 11));
  EXPECT_EQ(x_of(1, 1.0), 10);
  scene.on(protocol::NotifyScene{1, 1.04, true}, 0.04);
  scene.on(pose(1, 12));
  EXPECT_EQ(x_of(1, 1.04), 12);
}

TEST_F(Scene, BodiesOfANewSceneDoNotStartFromOldPoses) {
  scene.on(protocol::NotifyScene{1, 0.1, false}, 0);
  scene.on(pose(1, 10));
  scene.on(protocol::NotifyScene{2, 0, false}, 0.04);
  scene.on(pose(1, -5));
  EXPECT_EQ(x_of(1, 0), -5);
  EXPECT_LE(*scene.shown_time_at(0.05), 0.0);
}

TEST_F(Scene, ABodyThatNoticesNoLongerNameIsNotPresent) {
  scene.on(head(1, 2, 0));
  scene.on(body(1, 0));
  scene.on(body(1, 1));
  EXPECT_FALSE(scene.present(scene.bodies().at(0)));
  for (int i = 0; i < 30; ++i) {
    scene.on(protocol::NotifyScene{1, 0.04 * i, false}, 0.04 * i);
    scene.on(pose(0, 0));
    if (i < 10) scene.on(pose(1, 0));
  }
  EXPECT_TRUE(scene.present(scene.bodies().at(0)));
  EXPECT_FALSE(scene.present(scene.bodies().at(1)));
}

TEST_F(Scene, ASceneKeepsNoMoreBodiesThanItsBound) {
  scene.on(protocol::NotifyScene{1, 0, false}, 0);
  const auto max = static_cast<std::int32_t>(KnownScene::kMaxBodies);
  scene.on(head(1, std::numeric_limits<std::int32_t>::max(), 0));
  for (std::int32_t id = 0; id < max - 1; ++id) scene.on(body(1, id));
  EXPECT_FALSE(scene.described());
  scene.on(body(1, max - 1));
  EXPECT_TRUE(scene.described());
  scene.on(pose(max, 1));
  EXPECT_EQ(scene.bodies().size(), KnownScene::kMaxBodies);
}

TEST_F(Scene, ASceneKeepsNoMoreStaticsThanItsBound) {
  const auto max = static_cast<std::int32_t>(KnownScene::kMaxStatics);
  for (std::int32_t number = 0; number <= max; ++number) {
    scene.on(protocol::SceneStatic{1, number, "wall", "box", {}, {}, 0, 0, 0, 1});
  }
  scene.on(head(1, 0, max + 1));
  EXPECT_EQ(scene.statics().size(), KnownScene::kMaxStatics);
}

}  // namespace
}  // namespace ringdown::viewer
