#include "engine/scene/rotation.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace ringdown::scene::scene_file_test {
namespace {

namespace fs = std::filesystem;

// A folder with one file that may stand for a bank: scene files are read without opening banks.
class SceneFile : public testing::Test {
 protected:
  SceneFile() {
    const char* test = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::path(testing::TempDir()) / ("ringdown-scene-" + std::string(test));
    fs::create_directories(folder_ / "presets/banks");
    std::ofstream(folder_ / "bell.glb") << "bank";
    std::ofstream(folder_ / "presets/banks/bowl.glb") << "bank";
  }
  ~SceneFile() override { fs::remove_all(folder_); }

  [[nodiscard]] Result<SceneDescription> parse(const std::string& text) const {
    return parse_scene(text, folder_ / "a.toml", folder_ / "presets");
  }
  // The message must begin with the file and this line, and hold `word`.
  void expect_error(const std::string& text, int line, const std::string& word) const {
    const auto scene = parse(text);
    ASSERT_FALSE(scene) << text;
    const std::string& message = scene.error().message;
    EXPECT_EQ(message.rfind((folder_ / "a.toml").string() + ":" + std::to_string(line) + ": ", 0), 0u) << message;
    EXPECT_NE(message.find(word), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << "one sentence";
  }

  fs::path folder_;
};

TEST_F(SceneFile, EveryKeyOfASceneFileArrives) {
  const auto scene = parse(R"(
[scene]
gravity_m_s2 = [0, -1.5, 0]
step_s = 0.001
seed = 42
duration_s = 7
gain = 3
[contact]
spring_n_m = 1e6
damper_ns_m = 2e4
bounce_threshold_m_s = 0.1
minimum_repeat_s = 0.05
[[object]]
name = "bell"
bank = "bell.glb"
gain = 0.5
pan = -0.25
material = { alpha = 2, beta = 0, density = 1.5, stiffness = 3, size = 0.5 }
[[object]]
name = "bowl"
bank = "banks/bowl.glb"
[[static]]
name = "wall"
shape = "plane"
normal = [1, 0, 0]
offset_m = -2
restitution = 0.9
[[static]]
name = "step"
shape = "box"
size_m = [1, 2, 0.5]
position_m = [0, 0, 1]
rotation = { axis = [0, 0, 1], degrees = 90 }
[[body]]
name = "first"
object = "bell"
shape = "convex"
position_m = [1, 2, 3]
rotation = { axis = [2, 0, 0], degrees = 180 }
velocity_m_s = [4, 5, 6]
spin_rad_s = [7, 8, 9]
fixed = true
contact = "two-way"
scatter_m = 0.1
restitution = 0.3
friction = 0.7
rolling_m = 0.003
contact_time_s = 0.002
edge_radius_m = 0.004
young_pa = 5e9
poisson = 0.4
roughness_m = 1e-5
correlation_m = 2e-3
spectral_slope = -1.5
[[body]]
name = "ball"
shape = "sphere"
radius_m = 0.05
density_kg_m3 = 7800
)");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->gravity_m_s2, (Vec3{0, -1.5, 0}));
  EXPECT_EQ(scene->step_s, 0.001);
  EXPECT_EQ(scene->seed, 42u);
  EXPECT_EQ(scene->duration_s, 7);
  EXPECT_EQ(scene->contact.spring_n_m, 1e6);
  EXPECT_EQ(scene->contact.damper_ns_m, 2e4);
  EXPECT_EQ(scene->contact.bounce_threshold_m_s, 0.1);
  EXPECT_EQ(scene->contact.minimum_repeat_s, 0.05);
  ASSERT_EQ(scene->objects.size(), 2u);
  EXPECT_EQ(scene->objects[0].bank, folder_ / "bell.glb");
  EXPECT_EQ(scene->objects[0].gain, 1.5);  // its own times the scene's
  EXPECT_EQ(scene->objects[1].gain, 3);
  EXPECT_EQ(scene->objects[0].pan, -0.25);
  EXPECT_EQ(scene->objects[0].material, (modal::MaterialScale{2, 0, 1.5, 3, 0.5}));
  EXPECT_EQ(scene->objects[1].bank, folder_ / "presets/banks/bowl.glb");
  ASSERT_EQ(scene->statics.size(), 2u);
  EXPECT_EQ(scene->statics[0].normal, (Vec3{1, 0, 0}));
  EXPECT_EQ(scene->statics[0].offset_m, -2);
  EXPECT_EQ(scene->statics[0].surface.restitution, 0.9);
  EXPECT_EQ(scene->statics[1].type, StaticType::box);
  EXPECT_EQ(scene->statics[1].size_m, (Vec3{1, 2, 0.5}));
  EXPECT_NEAR(scene->statics[1].rotation.z, std::sqrt(0.5), 1e-12);
  ASSERT_EQ(scene->bodies.size(), 2u);
  const BodyDescription& first = scene->bodies[0];
  EXPECT_EQ(first.shape.type, ShapeType::convex);
  EXPECT_EQ(first.position_m, (Vec3{1, 2, 3}));
  EXPECT_NEAR(first.rotation.x, 1, 1e-12);
  EXPECT_EQ(first.velocity_m_s, (Vec3{4, 5, 6}));
  EXPECT_EQ(first.spin_rad_s, (Vec3{7, 8, 9}));
  EXPECT_TRUE(first.fixed);
  EXPECT_TRUE(first.two_way);
  EXPECT_EQ(first.scatter_m, 0.1);
  EXPECT_EQ(first.surface.friction, 0.7);
  EXPECT_EQ(first.surface.contact_time_s, 0.002);
  EXPECT_EQ(first.surface.rolling_m, 0.003);
  EXPECT_EQ(first.surface.contact_time_s, 0.002);
  EXPECT_EQ(first.surface.edge_radius_m, 0.004);
  EXPECT_EQ(first.surface.young_pa, 5e9);
  EXPECT_EQ(first.surface.poisson, 0.4);
  EXPECT_EQ(first.surface.texture, (synth::Texture{1e-5, 2e-3, -1.5}));
  EXPECT_FALSE(scene->bodies[1].surface.contact_time_s);
  EXPECT_FALSE(scene->bodies[1].surface.young_pa);
  EXPECT_EQ(scene->bodies[1].object, "");
  EXPECT_EQ(scene->bodies[1].shape.radius_m, 0.05);
  EXPECT_EQ(scene->bodies[1].density_kg_m3, 7800);
}

TEST_F(SceneFile, JointsEmittersCameraAndListenerOfASceneFileArrive) {
  const auto scene = parse(R"(
[[body]]
name = "first"
size_m = [1, 1, 1]
density_kg_m3 = 1
[[body]]
name = "ball"
shape = "sphere"
radius_m = 0.05
density_kg_m3 = 7800
[[emitter]]
name = "rain"
shape = "sphere"
radius_m = 0.01
density_kg_m3 = 2500
scatter_m = 0.2
every_s = 0.3
count = 12
[[joint]]
name = "hook"
type = "hinge"
bodies = ["ball"]
anchor_m = [0, 0, 2]
axis = [0, 1, 0]
low_degrees = -30
high_degrees = 45
friction_nm = 0.1
[[joint]]
name = "chain"
type = "ball"
bodies = ["first", "ball"]
anchor_m = [0, 0, 1]
[camera]
position_m = [1, -2, 3]
target_m = [0, 0, 1]
field_of_view_degrees = 40
[listener]
position_m = [0, -1, 1.7]
)");
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->emitters.size(), 1u);
  const EmitterDescription& rain = scene->emitters[0];
  EXPECT_EQ(rain.name, "rain");
  EXPECT_EQ(rain.every_s, 0.3);
  EXPECT_EQ(rain.count, 12u);
  EXPECT_EQ(rain.body.shape.radius_m, 0.01);
  EXPECT_EQ(rain.body.scatter_m, 0.2);
  ASSERT_EQ(scene->joints.size(), 2u);
  const JointDescription &hook = scene->joints[0], &chain = scene->joints[1];
  EXPECT_EQ(hook.type, JointType::hinge);
  EXPECT_EQ(hook.body, "ball");
  EXPECT_EQ(hook.other, "");
  EXPECT_EQ(hook.anchor_m, (Vec3{0, 0, 2}));
  EXPECT_EQ(hook.axis, (Vec3{0, 1, 0}));
  EXPECT_EQ(hook.low_degrees, -30);
  EXPECT_EQ(hook.high_degrees, 45);
  EXPECT_EQ(hook.friction_nm, 0.1);
  EXPECT_EQ(chain.type, JointType::ball);
  EXPECT_EQ(chain.body, "first");
  EXPECT_EQ(chain.other, "ball");
  ASSERT_TRUE(scene->camera);
  EXPECT_EQ(scene->camera->position_m, (Vec3{1, -2, 3}));
  EXPECT_EQ(scene->camera->target_m, (Vec3{0, 0, 1}));
  EXPECT_EQ(scene->camera->field_of_view_degrees, 40);
  ASSERT_TRUE(scene->listener);
  EXPECT_EQ(scene->listener->position_m, (Vec3{0, -1, 1.7}));
}

TEST_F(SceneFile, JointsEmittersCameraAndListenerThatCannotBeAreRefused) {
  const std::string ball = "[[body]]\nname = \"b\"\nshape = \"sphere\"\nradius_m = 1\ndensity_kg_m3 = 1\n";
  const std::string joint = ball + "[[joint]]\nname = \"j\"\nanchor_m = [0, 0, 0]\ntype = \"ball\"\n";
  expect_error(joint + "bodies = [\"gong\"]\n", 10, "no body 'gong'");
  expect_error(joint + "bodies = [\"b\", \"b\"]\n", 10, "to itself");
  expect_error(joint + "bodies = [\"b\", \"b\", \"b\"]\n", 10, "one body or two");
  expect_error(joint, 6, "bodies is missing");
  expect_error(joint + "bodies = [\"b\"]\naxis = [1, 0, 0]\n", 11, "unknown key 'axis'");
  expect_error(joint + "bodies = [\"b\"]\nfriction_nm = -1\n", 11, "friction_nm");
  expect_error("[[emitter]]\nname = \"e\"\nshape = \"sphere\"\nradius_m = 1\ndensity_kg_m3 = 1\nevery_s = 1\n", 1,
               "count is missing");
  expect_error("[[emitter]]\nname = \"e\"\nfixed = true\n", 1, "missing");
  expect_error("[camera]\nfield_of_view_degrees = 200\n", 2, "outside 1 ... 170");
  expect_error("[listener]\nposition_m = [0, 0, 0]\ntarget_m = [0, 0, 0]\n", 3, "must not be position_m");
  expect_error("[listener]\nrotation = { x = 0, y = 0, z = 0, w = 1 }\ntarget_m = [0, 0, 0]\n", 2, "not both");
  expect_error("[listener]\nhumidity_percent = 101\n", 2, "humidity_percent");
}

TEST_F(SceneFile, AListenerFacesItsTargetOrIsTurnedAndComesBackFromItsText) {
  const auto faces = parse("[listener]\nposition_m = [1, 1, 1]\ntarget_m = [1, 4, 5]\n");
  ASSERT_TRUE(faces) << faces.error().message;
  const Pose pose = listener_pose(*faces->listener);
  const Vec3 front = rotated(pose.rotation, {1, 0, 0}), left = rotated(pose.rotation, {0, 1, 0});
  EXPECT_NEAR(length(front - Vec3{0, 0.6, 0.8}), 0, 1e-12);
  EXPECT_NEAR(length(left - Vec3{-1, 0, 0}), 0, 1e-12);
  const auto turned =
      parse("[listener]\nposition_m = [1, 2, 3]\nrotation = { axis = [0, 0, 1], degrees = 90 }\ntemperature_c = 5\n");
  ASSERT_TRUE(turned) << turned.error().message;
  EXPECT_NEAR(length(rotated(listener_pose(*turned->listener).rotation, {1, 0, 0}) - Vec3{0, 1, 0}), 0, 1e-12);
  const auto again = parse(to_toml(*turned));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->listener->rotation, turned->listener->rotation);
  EXPECT_EQ(again->listener->temperature_c, 5);
}

TEST_F(SceneFile, SurfacesOutOfRangeAreRefused) {
  const std::string floor = "[[static]]\nname = \"f\"\nshape = \"plane\"\n";
  expect_error(floor + "young_pa = 0\n", 4, "young_pa");
  expect_error(floor + "poisson = 0.5\n", 4, "poisson");
  expect_error(floor + "edge_radius_m = 0\n", 4, "edge_radius_m");
  expect_error(floor + "rolling_m = -1\n", 4, "rolling_m");
  expect_error(floor + "roughness_m = 1\n", 4, "roughness_m");
  expect_error(floor + "correlation_m = 0\n", 4, "correlation_m");
  expect_error(floor + "spectral_slope = 1\n", 4, "spectral_slope");
}

TEST_F(SceneFile, AnEmptySceneFileIsAnEmptyScene) {
  const auto scene = parse("");
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->step_s, 1.0 / 500);
  EXPECT_EQ(scene->gravity_m_s2, (Vec3{0, 0, -9.81}));
}

TEST_F(SceneFile, ABrokenSceneFileIsNamedWithItsLine) { expect_error("[scene]\nseed = = 3\n", 2, "not TOML"); }
TEST_F(SceneFile, UnknownKeysOfASceneFileAreRefused) {
  expect_error("[scene]\nseed = 1\ngravty = 3\n", 3, "unknown key 'gravty'");
  expect_error("[sceen]\n", 1, "unknown key 'sceen'");
  expect_error("[[object]]\nname = \"a\"\nbank = \"bell.glb\"\nmaterial = { alfa = 1 }\n", 4, "'alfa'");
  expect_error("[[static]]\nname = \"a\"\nshape = \"plane\"\nsize_m = [1, 1, 1]\n", 4, "'size_m'");
  expect_error("[[body]]\nname = \"a\"\nshape = \"sphere\"\nradius_m = 1\ndensity_kg_m3 = 9\nsize_m = [1, 1, 1]\n", 6,
               "'size_m'");
}
TEST_F(SceneFile, WrongTypesInASceneFileAreRefused) {
  expect_error("[scene]\nstep_s = \"fast\"\n", 2, "step_s must be a number");
  expect_error("[scene]\nseed = 1.5\n", 2, "seed must be a whole number");
  expect_error("[scene]\ngravity_m_s2 = -9.81\n", 2, "three numbers");
  expect_error("[scene]\ngravity_m_s2 = [0, 0, \"down\"]\n", 2, "three numbers");
  expect_error("[[object]]\nname = 3\nbank = \"bell.glb\"\n", 2, "name must be a text");
  expect_error("[[body]]\nname = \"a\"\nsize_m = [1, 1, 1]\ndensity_kg_m3 = 1\nfixed = 1\n", 5, "true or false");
  expect_error("[object]\nname = \"a\"\n", 1, "[[object]]");
  expect_error("scene = 3\n", 1, "scene must be a table");
  expect_error("object = [1, 2]\n", 1, "[[object]]");
}
TEST_F(SceneFile, NumbersOutOfRangeInASceneFileAreRefused) {
  expect_error("[scene]\n\nstep_s = 0\n", 3, "0 is outside 1e-05 ... 0.05");
  expect_error("[contact]\nspring_n_m = -1\n", 2, "-1 is outside");
  expect_error("[scene]\nstep_s = nan\n", 2, "nan is outside");
  expect_error("[[object]]\nname = \"a\"\nbank = \"bell.glb\"\npan = 2\n", 4,
               "object 'a': pan = 2 is outside -1 ... 1");
  expect_error("[scene]\ngain = 100\n[[object]]\nname = \"a\"\nbank = \"bell.glb\"\ngain = 20\n", 6, "too high");
  expect_error("[[static]]\nname = \"f\"\nshape = \"plane\"\nrestitution = 1.1\n", 4, "static 'f'");
  expect_error("[scene]\ngravity_m_s2 = [0, 0, -inf]\n", 2, "gravity_m_s2");
  expect_error("[scene]\nseed = -1\n", 2, ">= 0");
}
TEST_F(SceneFile, WrongChoicesInASceneFileAreRefused) {
  expect_error("[[static]]\nname = \"f\"\nshape = \"cone\"\n", 3, "\"plane\", \"box\"");
  expect_error("[[body]]\nname = \"b\"\nshape = \"cone\"\n", 3, "\"trimesh\"");
  expect_error("[[body]]\nname = \"b\"\nshape = \"convex\"\n", 3, "a box or a sphere");
}
TEST_F(SceneFile, MissingKeysOfASceneFileAreRefused) {
  expect_error("[scene]\n[[object]]\nbank = \"bell.glb\"\n", 2, "name is missing");
  expect_error("[[object]]\nname = \"a\"\n", 1, "bank is missing");
  expect_error("[[static]]\nname = \"a\"\nshape = \"box\"\n", 1, "size_m is missing");
  expect_error("[[body]]\nname = \"a\"\nshape = \"sphere\"\nradius_m = 0.1\n", 1, "density_kg_m3 is missing");
  expect_error("[[body]]\nname = \"a\"\nsize_m = [1, 1, 1]\ndensity_kg_m3 = 1\nrotation = { axis = [0, 0, 1] }\n", 5,
               "degrees is missing");
}
TEST_F(SceneFile, ThingsThatASceneFileDoesNotDefineAreRefused) {
  expect_error("[[object]]\nname = \"a\"\nbank = \"gong.glb\"\n", 3, "no bank");
  expect_error("\n[[body]]\nname = \"a\"\nobject = \"gong\"\n", 4, "no object 'gong'");
  const auto scene = read_scene(folder_ / "none.toml", {});
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("none.toml"), std::string::npos);
}
TEST_F(SceneFile, NamesThatCannotBeAreRefusedInASceneFile) {
  expect_error("[[object]]\nname = \"a b\"\nbank = \"bell.glb\"\n", 2, "A-Z");
  expect_error("[[object]]\nname = \"a\"\nbank = \"bell.glb\"\n[[object]]\nname = \"a\"\nbank = \"bell.glb\"\n", 5,
               "taken by line 2");
}
TEST_F(SceneFile, DirectionsOfNoLengthAreRefusedInASceneFile) {
  expect_error("[[static]]\nname = \"f\"\nshape = \"plane\"\nnormal = [0, 0, 0]\n", 4, "normal must not be");
  expect_error(
      "[[static]]\nname = \"f\"\nshape = \"box\"\nsize_m = [1, 1, 1]\n"
      "rotation = { axis = [0, 0, 0], degrees = 3 }\n",
      5, "axis must not be");
}
TEST_F(SceneFile, TooManyBodiesInASceneFileAreRefused) {
  std::string text;
  for (int k = 0; k < static_cast<int>(kMaxBodies) + 1; ++k) {
    text += "[[body]]\nname = \"b" + std::to_string(k) + "\"\nsize_m = [1, 1, 1]\ndensity_kg_m3 = 1\n";
  }
  expect_error(text, static_cast<int>(kMaxBodies) * 4 + 1, "at most 1024");
}

}  // namespace
}  // namespace ringdown::scene::scene_file_test
