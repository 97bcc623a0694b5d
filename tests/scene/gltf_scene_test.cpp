// Scenes that other programs write, against closed forms of what their numbers
// mean.
#include "engine/scene/gltf/scene.h"
#include "engine/scene/rotation.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_text.h"
#include "engine/scene/world.h"
#include "tests/scene/gltf_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>

namespace ringdown::scene::gltf_scene_test {
namespace {

constexpr double kG = 9.81;

using test::base64;
using test::bytes_of;
using test::document;
using test::good;
using test::kBall;
using test::kBox;
using test::kCollider0;
using test::kCollider1;
using test::kPlane;
using test::node;
using test::parse;
using test::run_until;
using test::silent_world;

void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_LT(length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(GltfScene, ABallFallsAlongMinusYOfTheFileAndRestsOnAPlane) {
  const GltfScene read =
      good(document(node(R"("motion": {"mass": 2}, )" + kCollider0, R"(, "translation": [1, 5, 3])") + "," +
                        node(kCollider1, R"(, "translation": [0, 1, 0])"),
                    kBall + "," + kPlane));
  EXPECT_TRUE(read.notes.empty());
  World world = silent_world(read.scene);
  run_until(world, 0.5);
  // y of the file is our z, and z of the file our -y.
  expect_near(world.bodies()[0].position_m, {1, -3, 5 - 0.5 * kG * 0.25}, 1e-9);
  run_until(world, 6);
  expect_near(world.bodies()[0].position_m, {1, -3, 1.1}, 1e-3);
}

TEST(GltfScene, TransformsOfAHierarchyAreComposed) {
  // The parent turns y to -x and is twice as large, the child is three times as
  // large as its own box.
  const double h = std::sqrt(0.5);
  const std::string parent = R"({"translation": [1, 2, 3], "rotation": [0, 0, )" + std::to_string(h) + "," +
                             std::to_string(h) + R"(], "scale": [2, 2, 2], "children": [1]})";
  const GltfScene read = good(document(
      parent + "," +
          node(R"("motion": {"mass": 1, "linearVelocity": [0, 1, 0], "centerOfMass": [0, 0.1, 0]}, )" + kCollider0,
               R"(, "translation": [0, 1, 0], "scale": [1, 3, 1])"),
      kBox));
  ASSERT_EQ(read.scene.bodies.size(), 1);
  const BodyDescription& body = read.scene.bodies[0];
  // (1, 2, 3) + 2 * turned (0, 1, 0) = (-1, 2, 3) in the file.
  expect_near(body.position_m, {-1, -3, 2}, 1e-6);
  expect_near(body.shape.size_m, {0.4, 2.4, 1.2}, 1e-6);
  expect_near(body.velocity_m_s, {-1, 0, 0}, 1e-6);  // the file's -x
  ASSERT_TRUE(body.mass);
  expect_near(body.mass->center_of_mass_m, {0, 0.6, 0}, 1e-6);
}

TEST(GltfScene, NegativeScalesGiveTheSizesOfPositiveOnes) {
  const GltfScene read = good(document(node(R"("motion": {}, )" + kCollider0, R"(, "scale": [1, -2, 3])"), kBox));
  expect_near(read.scene.bodies[0].shape.size_m, {0.2, 0.8, 1.8}, 1e-12);
}

TEST(GltfScene, MassesFollowFromVolumesAndGivenNumbersComeFirst) {
  const GltfScene read = good(
      document(node(R"("motion": {}, )" + kCollider0) + "," + node(R"("motion": {"mass": 3}, )" + kCollider1) + "," +
                   node(R"("motion": {"mass": 3, "inertiaDiagonal": [1, 2, 3], "inertiaOrientation": [0, 0, 0, 1]}, )" +
                        kCollider0),
               kBox + R"(, {"type": "cylinder", "cylinder": {"height": 2, "radiusTop": 0.5, "radiusBottom": 0.5}})"));
  const modal::MassProperties& box = *read.scene.bodies[0].mass;
  EXPECT_NEAR(box.mass_kg, 1000 * 0.2 * 0.4 * 0.6, 1e-9);
  std::vector<double> moments{box.inertia_kg_m2.x, box.inertia_kg_m2.y, box.inertia_kg_m2.z};
  std::ranges::sort(moments);
  EXPECT_NEAR(moments[0], 48 * (0.04 + 0.16) / 12, 1e-9);
  EXPECT_NEAR(moments[1], 48 * (0.04 + 0.36) / 12, 1e-9);
  EXPECT_NEAR(moments[2], 48 * (0.16 + 0.36) / 12, 1e-9);
  const Vec3 cylinder = read.scene.bodies[1].mass->inertia_kg_m2;  // of a prism of 32 sides: 0.65 % less
  EXPECT_NEAR(std::min({cylinder.x, cylinder.y, cylinder.z}), 3 * 0.25 / 2, 0.01 * 0.375);
  EXPECT_NEAR(std::max({cylinder.x, cylinder.y, cylinder.z}), 3 * (3 * 0.25 + 4) / 12, 0.01 * 1.19);
  expect_near(read.scene.bodies[2].mass->inertia_kg_m2, {1, 2, 3}, 1e-12);
}

TEST(GltfScene, AGravityFactorScalesTheFall) {
  std::string nodes;
  const std::vector<double> factors{0, -1, 0.5, 2};
  for (std::size_t k = 0; k < factors.size(); ++k) {
    nodes += (k ? "," : "") +
             node(R"("motion": {"mass": 1, "gravityFactor": )" + std::to_string(factors[k]) + "}, " + kCollider0,
                  R"(, "translation": [)" + std::to_string(k) + ", 0, 0]");
  }
  World world = silent_world(good(document(nodes, kBall)).scene);
  run_until(world, 0.4);
  for (std::size_t k = 0; k < factors.size(); ++k)
    EXPECT_NEAR(world.bodies()[k].position_m.z, -0.5 * kG * factors[k] * 0.16, 1e-9) << factors[k];
}

// The restitution of a ball on a plane, from how high the ball rises.
double bounce(const std::string& of_ball, const std::string& of_plane) {
  const auto material = [](const std::string& text) { return "{" + text + "}"; };
  World world = silent_world(
      good(document(node(R"("motion": {"mass": 1}, "collider": {"geometry": {"shape": 0}, "physicsMaterial": 0})",
                         R"(, "translation": [0, 1.1, 0])") +
                        "," + node(R"("collider": {"geometry": {"shape": 1}, "physicsMaterial": 1})"),
                    kBall + "," + kPlane,
                    R"("physicsMaterials": [)" + material(of_ball) + "," + material(of_plane) + "]"))
          .scene);
  run_until(world, std::sqrt(2 / kG) + 0.02);
  double highest = 0;
  for (int k = 0; k < 500; ++k) {
    world.step();
    highest = std::max(highest, world.bodies()[0].position_m.z - 0.1);
  }
  return std::sqrt(highest);
}

TEST(GltfScene, MaterialsCombineAsTheyAsk) {
  const std::string low = R"("restitution": 0.4, "restitutionCombine": )",
                    high = R"("restitution": 0.9, "restitutionCombine": )";
  EXPECT_NEAR(bounce(low + R"("average")", high + R"("minimum")"), 0.65, 0.01);
  EXPECT_NEAR(bounce(low + R"("minimum")", high + R"("maximum")"), 0.4, 0.01);
  EXPECT_NEAR(bounce(low + R"("maximum")", high + R"("multiply")"), 0.9, 0.01);
  EXPECT_NEAR(bounce(low + R"("multiply")", high + R"("multiply")"), 0.36, 0.01);
}

TEST(GltfScene, DynamicFrictionActsOnWhatSlides) {
  World world = silent_world(
      good(
          document(
              node(
                  R"("motion": {"mass": 1, "linearVelocity": [3, 0, 0]}, "collider": {"geometry": {"shape": 0}, "physicsMaterial": 0})",
                  R"(, "translation": [0, 0.2, 0])") +
                  "," + node(R"("collider": {"geometry": {"shape": 1}, "physicsMaterial": 0})"),
              R"({"type": "box", "box": {"size": [0.4, 0.4, 0.4]}}, )" + kPlane,
              R"("physicsMaterials": [{"staticFriction": 0.9, "dynamicFriction": 0.3}])"))
          .scene);
  run_until(world, 3);
  EXPECT_NEAR(world.bodies()[0].position_m.x, 9 / (2 * 0.3 * kG),
              0.02);  // v^2 / (2 mu g)
}

TEST(GltfScene, FiltersSayWhoCollides) {
  const auto falls_through = [](const std::string& of_ball, const std::string& of_plane) {
    World world = silent_world(
        good(document(node(R"("motion": {"mass": 1}, "collider": {"geometry": {"shape": 0}, "collisionFilter": 0})",
                           R"(, "translation": [0, 0.3, 0])") +
                          "," + node(R"("collider": {"geometry": {"shape": 1}, "collisionFilter": 1})"),
                      kBall + "," + kPlane, R"("collisionFilters": [{)" + of_ball + "}, {" + of_plane + "}]"))
            .scene);
    run_until(world, 0.6);
    return world.bodies()[0].position_m.z < 0;
  };
  const std::string is_a = R"("collisionSystems": ["a"])", is_b = R"("collisionSystems": ["b"])";
  EXPECT_FALSE(falls_through(is_a, is_b));
  EXPECT_FALSE(falls_through(is_a, is_b + R"(, "collideWithSystems": ["a"])"));
  EXPECT_TRUE(falls_through(is_a, is_b + R"(, "collideWithSystems": ["b"])"));
  EXPECT_TRUE(falls_through(is_a, is_b + R"(, "notCollideWithSystems": ["a"])"));
  EXPECT_FALSE(falls_through(is_a, is_b + R"(, "notCollideWithSystems": ["b"])"));
  EXPECT_TRUE(falls_through(is_a + R"(, "notCollideWithSystems": ["b"])", is_b));
  EXPECT_FALSE(falls_through(R"("collisionSystems": ["a", "b"])", R"("notCollideWithSystems": ["a"])"));
}

// Every shape rests on the plane with its lowest point on it.
TEST(GltfScene, EveryShapeRestsOnAPlane) {
  const std::vector<std::pair<std::string, double>> shapes{
      {kBall, 0.1},
      {kBox, 0.2},
      {R"({"type": "cylinder", "cylinder": {"height": 0.5, "radiusTop": 0.25, "radiusBottom": 0.25}})", 0.25},
      {R"({"type": "cylinder", "cylinder": {"height": 0.3, "radiusTop": 0, "radiusBottom": 0.25}})", 0.15},
      {R"({"type": "plane", "plane": {"sizeX": 1, "sizeZ": 0.5}})", 0.05}};
  for (const auto& [shape, height] : shapes) {
    World world =
        silent_world(good(document(node(R"("motion": {"mass": 1}, )" + kCollider0, R"(, "translation": [0, 0.4, 0])") +
                                       "," + node(kCollider1),
                                   shape + "," + kPlane))
                         .scene);
    run_until(world, 3);
    EXPECT_NEAR(world.bodies()[0].position_m.z, height, 2e-3) << shape;
  }
}

TEST(GltfScene, ACapsuleLiesDown) {
  World world = silent_world(
      good(document(
               node(R"("motion": {"mass": 1}, )" + kCollider0,
                    R"(, "translation": [0, 0.4, 0], "rotation": [0, 0, 0.6, 0.8])") +
                   "," + node(kCollider1),
               R"({"type": "capsule", "capsule": {"height": 0.5, "radiusTop": 0.1, "radiusBottom": 0.1}}, )" + kPlane))
          .scene);
  run_until(world, 6);
  EXPECT_NEAR(world.bodies()[0].position_m.z, 0.1, 5e-3);
}

TEST(GltfScene, SeveralCollidersMakeOneBody) {
  // A table of a top and two legs under a motion without a collider of its own.
  const auto part = [](const std::string& place, const std::string& scale) {
    return node(kCollider0, R"(, "translation": )" + place + R"(, "scale": )" + scale);
  };
  const GltfScene read =
      good(document(node(R"("motion": {"mass": 5})", R"(, "children": [1, 2, 3], "translation": [0, 0.1, 0])") + "," +
                        part("[0, 1, 0]", "[5, 0.25, 2]") + "," + part("[0.4, 0.5, 0]", "[0.5, 2.375, 1]") + "," +
                        part("[-0.4, 0.5, 0]", "[0.5, 2.375, 1]") + "," + node(kCollider1),
                    kBox + "," + kPlane));
  ASSERT_EQ(read.scene.bodies.size(), 1);
  // The two legs and the top as boxes: volumes and centres by hand.
  const double top = 1.0 * 0.1 * 1.2, leg = 0.1 * 0.95 * 0.6;
  expect_near(read.scene.bodies[0].mass->center_of_mass_m, {0, (top * 1 + 2 * leg * 0.5) / (top + 2 * leg), 0}, 1e-9);
  World world = silent_world(read.scene);
  run_until(world, 2);
  EXPECT_NEAR(world.bodies()[0].position_m.z, -0.025,
              3e-3);  // the legs end 0.025 above the node
}

// A unit square in the file's xz plane as a mesh, inside the document.
const std::string kSquare =
    R"(, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 1, "byteLength": 12}],)";

std::string square_buffers(const std::string& points) {
  const std::vector<std::uint16_t> corners{0, 2, 1, 0, 3, 2};
  const auto buffer = [](const std::string& bytes) {
    return R"({"byteLength": )" + std::to_string(bytes.size()) + R"(, "uri": "data:application/octet-stream;base64,)" +
           base64(bytes) + "\"}";
  };
  return R"("buffers": [)" + buffer(points) + "," + buffer(bytes_of(corners)) + "]";
}

std::string square_buffers() {
  return square_buffers(bytes_of(std::vector<float>{-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1}));
}

TEST(GltfScene, AMeshInDataUrisIsAFloor) {
  World world = silent_world(
      good(document(node(R"("motion": {"mass": 1}, )" + kCollider0, R"(, "translation": [0.3, 0.5, 0.2])") + "," +
                        node(R"("collider": {"geometry": {"node": 1}})", R"(, "mesh": 0, "scale": [2, 1, 3])"),
                    kBall, "", kSquare + square_buffers()))
          .scene);
  run_until(world, 4);
  expect_near(world.bodies()[0].position_m, {0.3, -0.2, 0.1}, 5e-3);
}

// The square above in normalized bytes, which gltfpack writes.
TEST(GltfScene, AMeshOfQuantizedPointsIsAFloor) {
  const std::vector<std::int8_t> points{-127, 0, -127, 0, 127, 0, -127, 0, 127, 0, 127, 0, -127, 0, 127, 0};
  std::string square = kSquare;
  square.replace(square.find("5126"), 4, R"(5120, "normalized": true)");
  square.replace(square.find(R"("byteLength": 48)"), 16, R"("byteLength": 16, "byteStride": 4)");
  const GltfScene read = good(document(
      node(R"("motion": {"mass": 1}, )" + kCollider0, R"(, "translation": [0.3, 0.5, 0.2])") + "," +
          node(R"("collider": {"geometry": {"node": 1}})", R"(, "mesh": 0, "scale": [2, 1, 3])"),
      kBall, "", R"(, "extensionsRequired": ["KHR_mesh_quantization"])" + square + square_buffers(bytes_of(points))));
  EXPECT_TRUE(read.notes.empty());
  World world = silent_world(read.scene);
  run_until(world, 4);
  expect_near(world.bodies()[0].position_m, {0.3, -0.2, 0.1}, 5e-3);
}

TEST(GltfScene, ASliderFallsToItsLimitAndAFixedJointHolds) {
  const auto at_end = [](const std::string& limits) {
    World world = silent_world(
        good(
            document(node(R"("motion": {"mass": 1}, )" + kCollider0, R"(, "children": [1], "translation": [0, 2, 0])") +
                         "," + R"({"translation": [0, 0, 0]}, )" +
                         node(R"("joint": {"connectedNode": 1, "joint": 0})", R"(, "translation": [0, 2, 0])"),
                     kBall, R"("physicsJoints": [{"limits": [)" + limits + "]}]"))
            .scene);
    run_until(world, 2);
    return world.bodies()[0].position_m;
  };
  const std::string no_turn = R"({"angularAxes": [0, 1, 2], "min": 0, "max": 0})";
  expect_near(at_end(R"({"linearAxes": [0, 2], "max": 0}, {"linearAxes": [1], "min": -0.5, "max": 0.2}, )" + no_turn),
              {0, 0, 1.5}, 2e-3);
  expect_near(at_end(R"({"linearAxes": [0, 1, 2], "max": 0}, )" + no_turn), {0, 0, 2}, 2e-3);
}

TEST(GltfScene, AHingesDriveTurnsAtItsSpeedAndSpringsToItsTarget) {
  const auto turned = [](const std::string& drive, double seconds) {
    World world = silent_world(
        good(
            document(
                node(R"("motion": {"mass": 1, "gravityFactor": 0}, )" + kCollider0, R"(, "children": [1])") + ",{}," +
                    node(R"("joint": {"connectedNode": 1, "joint": 0})"),
                kBox,
                R"("physicsJoints": [{"limits": [{"linearAxes": [0, 1, 2], "max": 0}, {"angularAxes": [0, 2], "max": 0}],
                         "drives": [{"type": "angular", "axis": 1, )" +
                    drive + "}]}]"))
            .scene);
    run_until(world, seconds);
    return world.bodies()[0];
  };
  const BodyState steady = turned(R"("mode": "force", "velocityTarget": 2, "damping": 5)", 2);
  expect_near(steady.spin_rad_s, {0, 0, 2}, 1e-3);  // about the file's y, our z
  const BodyState sprung =
      turned(R"("mode": "acceleration", "positionTarget": 0.5, "stiffness": 100, "damping": 20)", 3);
  const Vec3 x = to_matrix(sprung.rotation) * Vec3{1, 0, 0};
  EXPECT_NEAR(std::atan2(x.y, x.x), 0.5, 2e-3);
}

// Two nodes of glTF: a body of 2 kg that creeps along the file's x at 100 N, and the joint that keeps it from turning.
// The second frame of the joint is the ground's, so that its velocity is the body's with the other sign.
TEST(GltfScene, AMotorBesideALockedTurnCreepsWithoutTurning) {
  const std::string joint =
      R"("physicsMaterials": [{"staticFriction": 0.4, "dynamicFriction": 0.4}], "physicsJoints": [{"limits": [{"angularAxes": [0, 1, 2], "min": 0, "max": 0}],
         "drives": [{"type": "linear", "mode": "force", "axis": 0, "maxForce": 100, "velocityTarget": -0.003, "damping": 1000000}]}])";
  const GltfScene read = good(document(
      node(R"("collider": {"geometry": {"shape": 0}, "physicsMaterial": 0})", R"(, "translation": [0, -0.05, 0])") +
          "," +
          node(
              R"("motion": {"mass": 2}, "collider": {"geometry": {"shape": 1}, "physicsMaterial": 0}, "joint": {"connectedNode": 0, "joint": 0, "enableCollision": true})",
              R"(, "translation": [0, 0.031, 0])"),
      R"({"type": "box", "box": {"size": [2, 0.1, 0.4]}}, {"type": "box", "box": {"size": [0.24, 0.06, 0.02]}})",
      joint));
  EXPECT_TRUE(read.notes.empty()) << read.notes[0];
  ASSERT_EQ(read.scene.joints.size(), 1);
  World world = silent_world(read.scene);
  const Rotation upright = world.bodies()[1].rotation;
  run_until(world, 3);
  const BodyState body = world.bodies()[1];
  EXPECT_NEAR(body.center_m.x, 0.009, 2e-4);
  EXPECT_NEAR(body.center_m.z, 0.03, 1e-3);
  EXPECT_LT(length(to_rotation_vector(inverse(upright) * body.rotation)), 1e-3);
}

TEST(GltfScene, JoinedBodiesPassThroughEachOtherUnlessTheyMayCollide) {
  const std::string limits =
      R"("physicsJoints": [{"limits": [{"linearAxes": [0, 1, 2], "max": 0}, {"angularAxes": [0, 1, 2], "max": 0}]}])";
  const auto scene = [&](const std::string& more) {
    return good(document(node(R"("motion": {"mass": 1}, )" + kCollider0) + "," +
                             node(R"("motion": {"mass": 1}, "joint": {"connectedNode": 0, "joint": 0)" + more + "}, " +
                                  kCollider0),
                         kBall, limits))
        .scene;
  };
  EXPECT_FALSE(scene("").joints.at(0).collides);
  EXPECT_TRUE(scene(R"(, "enableCollision": true)").joints.at(0).collides);
}

TEST(GltfScene, EveryInstanceOfAModelIsAnObjectOfItsOwn) {
  const auto instance = [](const std::string& audio, const std::string& more) {
    return R"({"name": "my bell", "extensions": {"KHR_audio_rigid_bodies": {)" + audio +
           R"(}, "KHR_physics_rigid_bodies": {"motion": {"mass": 1}, "collider": {"geometry": {"shape": 0}}}})" + more +
           "}";
  };
  std::string text = document(instance(R"("modalModel": 0)", "") + "," +
                                  instance(R"("modalModel": 0, "gain": 0.5)", R"(, "scale": [2, 2, 2])") + "," +
                                  instance(R"("modalModel": 1)", ""),
                              kBall);
  text.replace(text.find(R"("KHR_implicit_shapes")"), 0, R"("KHR_audio_rigid_bodies": {"modalModels": [{}, {}]}, )");
  const SceneDescription scene = good(text).scene;
  ASSERT_EQ(scene.objects.size(), 3);
  EXPECT_EQ(scene.objects[0].name, "my_bell");
  EXPECT_EQ(scene.objects[1].name, "my_bell-2");
  EXPECT_EQ(scene.objects[0].bank, "room.gltf#0");
  EXPECT_EQ(scene.objects[2].bank, "room.gltf#1");
  EXPECT_EQ(scene.objects[1].gain, 0.5);
  // The model was made for the node at its scale: the points lie farther apart, the pitch stays.
  EXPECT_EQ(scene.objects[1].bank, "room.gltf#0@2.0");
  EXPECT_EQ(scene.objects[1].material, modal::MaterialScale{});
  EXPECT_EQ(scene.bodies[1].object, "my_bell-2");
}

TEST(GltfScene, TheCameraIsTheListener) {
  const GltfScene read =
      good(document(R"({"camera": 0, "translation": [1, 2, 3]})", kBall, "",
                    R"(, "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}])"));
  ASSERT_TRUE(read.scene.listener && read.scene.listener->rotation);
  const Matrix3 turn = to_matrix(*read.scene.listener->rotation);
  expect_near(read.scene.listener->position_m, {1, -3, 2}, 1e-12);
  expect_near(turn * Vec3{1, 0, 0}, {0, 1, 0}, 1e-12);   // forward: the file's -z
  expect_near(turn * Vec3{0, 1, 0}, {-1, 0, 0}, 1e-12);  // left: the file's -x
  expect_near(turn * Vec3{0, 0, 1}, {0, 0, 1}, 1e-12);   // up
}

TEST(GltfScene, AsATextItIsReadAgainBitForBit) {
  const SceneDescription scene =
      good(
          document(
              node(
                  R"("motion": {"mass": 1, "gravityFactor": 0.3}, "collider": {"geometry": {"shape": 0}, "collisionFilter": 0, "physicsMaterial": 0})",
                  R"(, "children": [1], "scale": [1, 2, 1])") +
                  ",{}," + node(R"("joint": {"connectedNode": 1, "joint": 0})"),
              R"({"type": "cylinder", "cylinder": {}})",
              R"("collisionFilters": [{"collisionSystems": ["a"], "notCollideWithSystems": ["b"]}], "physicsMaterials": [{"frictionCombine": "maximum"}],
                       "physicsJoints": [{"limits": [{"linearAxes": [0, 1], "max": 0}, {"linearAxes": [2], "min": -1}, {"angularAxes": [0, 1, 2], "max": 0}],
                       "drives": [{"type": "linear", "mode": "force", "axis": 2, "stiffness": 3}]}])"))
          .scene;
  ASSERT_EQ(scene.joints.size(), 1);
  const std::string text = to_toml(scene);
  const auto again = parse_scene(text, "x.toml", {});
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(to_toml(*again), text);
  EXPECT_EQ(*again->bodies[0].shape.mesh, *scene.bodies[0].shape.mesh);
  EXPECT_EQ(again->bodies[0].filter, scene.bodies[0].filter);
  EXPECT_EQ(again->joints[0].drive, scene.joints[0].drive);
}

TEST(GltfScene, HostileDocumentsAreRefusedWithASentence) {
  const std::vector<std::string> bad{
      "",
      "{}",
      "glTF",
      std::string(100000, '['),
      R"({"asset": {"version": "1.0"}})",
      document(R"({"children": [0]})", kBall),
      document(R"({"children": [1]}, {"children": [0]}, {"children": [1]})", kBall),
      document(R"({"children": [7]})", kBall),
      document(R"({"rotation": [0, 0, 0, 0]})", kBall),
      document(
          R"({"translation": [1e308, 1e308, 0], "scale": [1e308, 1e308, 1e308], "children": [1]}, {"translation": [1e308, 1, 1]})",
          kBall),
      document(node(R"("collider": {"geometry": {"shape": 9}})"), kBall),
      document(node(R"("collider": {"geometry": {}})"), kBall),
      document(node(kCollider0), R"({"type": "sphere", "sphere": {"radius": -1}})"),
      document(node(R"("motion": {"mass": -1}, )" + kCollider0), kBall),
      document(node(R"("motion": {"mass": "heavy"}, )" + kCollider0), kBall),
      document(node(R"("motion": {"mass": 1, "inertiaDiagonal": [1e-300, 1e-300, 1e-300]}, )" + kCollider0), kBall),
      document(node(R"("motion": {"mass": 1, "inertiaDiagonal": [1, 1, -1]}, )" + kCollider0), kBall),
      document(node(R"("motion": {"mass": 1, "centerOfMass": [1e9, 0, 0]}, )" + kCollider0), kBall),
      document(node(R"("joint": {"connectedNode": 3, "joint": 0})"), kBall),
      document(node(R"("collider": {"geometry": {"node": 0}})", R"(, "mesh": 0)"), kBall, "",
               kSquare + R"("buffers": [{"byteLength": 48, "uri": "http://x/y"}])"),
      document(node(R"("collider": {"geometry": {"node": 0}})", R"(, "mesh": 0)"), kBall, "",
               kSquare + R"("buffers": [{"byteLength": 48, "uri": "data:;base64,!!!!"}])"),
      document(node(R"("collider": {"geometry": {"node": 0}})", R"(, "mesh": 0)"), kBall, "",
               kSquare + R"("buffers": [{"byteLength": 48}])")};
  for (const std::string& text : bad) {
    const auto read = parse(text);
    ASSERT_FALSE(read) << text.substr(0, 200);
    EXPECT_GT(read.error().message.size(), 10);
  }
}

TEST(GltfScene, DamagedDocumentsNeverEndTheProcess) {
  const std::string sound = document(
      node(R"("motion": {"mass": 1}, )" + kCollider0, R"(, "children": [1], "translation": [0.3, 0.5, 0.2])") + ",{}," +
          node(R"("collider": {"geometry": {"node": 2}}, "joint": {"connectedNode": 1, "joint": 0})",
               R"(, "mesh": 0, "scale": [2, 1, 3])"),
      kBox, R"("physicsJoints": [{"limits": [{"linearAxes": [0, 1, 2], "max": 0}]}])", kSquare + square_buffers());
  ASSERT_TRUE(parse(sound));
  std::size_t read = 0, seed = 1;
  for (int round = 0; round < 3000; ++round) {
    std::string text = sound;
    for (int k = 0; k < 2; ++k) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      const std::size_t at = (seed >> 33) % text.size();
      text[at] = "0123456789-.[]{}\",eE"[(seed >> 20) % 20];
    }
    if (const auto scene = parse(text)) {
      ++read;
      if (round % 10 == 0) {
        auto world = World::create(scene->scene, {}, 48000);
        if (world) world->step();
      }
    }
  }
  EXPECT_GT(read, 100);
}

}  // namespace
}  // namespace ringdown::scene::gltf_scene_test
