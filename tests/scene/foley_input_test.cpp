// Animations as programs for pictures export them, good and bad: every way of keys is heard alike, and what cannot be
// followed is named and leaves the rest as it is.
#include "engine/scene/gltf/picture_writer.h"
#include "engine/scene/gltf/scene.h"
#include "engine/scene/gltf/silent.h"
#include "engine/scene/gltf/writer.h"
#include "engine/scene/motion_path.h"
#include "tests/scene/gltf_room.h"
#include "tests/scene/keyframes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::scene::foley_input_test {
namespace {

using modal::Json;
using test::GltfRoom;

constexpr double kG = 9.81, kHeight_m = 0.4, kRestitution = 0.6, kFps = 30, kLength_s = 0.8, kEdge_m = 0.1;
// Of a cube of 1000 kg/m3.
const double kMass_kg = 1000 * kEdge_m * kEdge_m * kEdge_m;
const double kLanding_s = std::sqrt(2 * kHeight_m / kG), kSpeed_m_s = kG * kLanding_s;

// The height above the floor of what falls at 0 and bounces once.
double height_at(double t) {
  if (t < kLanding_s) return kHeight_m - 0.5 * kG * t * t;
  return kRestitution * kSpeed_m_s * (t - kLanding_s) - 0.5 * kG * (t - kLanding_s) * (t - kLanding_s);
}

void animate(GltfRoom& room, std::size_t node, const std::string& path, const std::vector<float>& times,
             const std::vector<float>& values, const std::string& way = "LINEAR") {
  const std::size_t width = path == "rotation" ? 4 : path == "weights" ? 1 : 3;
  Json& animations = room.json["animations"];
  if (animations.is_null()) animations = {{{"channels", Json::array()}, {"samplers", Json::array()}}};
  animations[0]["channels"].push_back(
      {{"sampler", animations[0]["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  const char* type = width == 4 ? "VEC4" : width == 3 ? "VEC3" : "SCALAR";
  animations[0]["samplers"].push_back({{"input", room.add_array(times, 5126, "SCALAR", 1)},
                                       {"output", room.add_array(values, 5126, type, width)},
                                       {"interpolation", way}});
}

std::vector<float> frames() {
  std::vector<float> times;
  for (int k = 0; k <= static_cast<int>(kLength_s * kFps); ++k) times.push_back(static_cast<float>(k / kFps));
  return times;
}

// Places of a cube's middle in every frame, `shift` and the cube's half above the floor.
std::vector<float> falling(const std::vector<float>& times, Vec3 shift = {}) {
  std::vector<float> places;
  for (const float t : times) {
    const double y = shift.y + 0.5 * kEdge_m + height_at(static_cast<double>(t));
    places.insert(places.end(), {static_cast<float>(shift.x), static_cast<float>(y), static_cast<float>(shift.z)});
  }
  return places;
}

// A floor, node 0, and a cube, mesh 1, without physics.
GltfRoom stage() {
  GltfRoom room;
  room.add_node({{"name", "floor"}, {"mesh", room.add_box("floor", {4, 0.2, 4})}, {"translation", {0, -0.1, 0}}});
  room.add_box("cube", {kEdge_m, kEdge_m, kEdge_m});
  return room;
}

// Adds a cube that falls and bounces beside the others, and returns its node.
std::size_t add_falling_cube(GltfRoom& room, double x = 0, const std::string& name = "cube") {
  const std::size_t node = room.add_node({{"name", name}, {"mesh", 1}, {"translation", {x, 1, 0}}});
  animate(room, node, "translation", frames(), falling(frames(), {x, 0, 0}));
  return node;
}

struct Heard {
  std::vector<HeardContact> blows;
  std::vector<std::string> notes;

  [[nodiscard]] bool says(const std::string& words) const {
    return std::ranges::any_of(notes, [&](const std::string& note) { return note.find(words) != std::string::npos; });
  }
};

Heard hear(const GltfRoom& room) {
  const std::string bytes = room.glb();
  const auto read = parse_gltf_scene(std::as_bytes(std::span(bytes)), "room.glb", {}, FoleyLimits{});
  EXPECT_TRUE(read) << read.error().message;
  if (!read) return {};
  Heard heard{test::play(read->scene, {}), read->notes};
  std::erase_if(heard.blows, [](const HeardContact& contact) { return contact.kind != HeardContact::blow; });
  return heard;
}

// One blow, of the closed form.
void expect_one_landing(const Heard& heard, double impulse_part = 1) {
  ASSERT_EQ(heard.blows.size(), 1u);
  const double impulse_ns = impulse_part * kMass_kg * (1 + kRestitution) * kSpeed_m_s;
  EXPECT_NEAR(heard.blows[0].time_s, kLanding_s, 1e-3);
  EXPECT_NEAR(length(heard.blows[0].push), impulse_ns, 0.02 * impulse_ns);
}

TEST(FoleyInput, ARecordedSceneIsReadWithTheStepThatItWasSimulatedIn) {
  GltfRoom room = stage();
  add_falling_cube(room);
  room.json["extras"]["ringdown"]["step_s"] = 0.0005;
  const std::string bytes = room.glb();
  const auto read = parse_gltf_scene(std::as_bytes(std::span(bytes)), "room.glb", {}, FoleyLimits{});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->scene.step_s, 0.0005);
}

TEST(FoleyInput, EveryWayOfKeysIsHeardAlike) {
  GltfRoom linear = stage();
  add_falling_cube(linear);
  expect_one_landing(hear(linear));

  GltfRoom step = stage();
  animate(step, step.add_node({{"name", "cube"}, {"mesh", 1}}), "translation", frames(), falling(frames()), "STEP");
  expect_one_landing(hear(step));

  // Three keys of a cubic, whose tangents are the velocities, are the two parabolas.
  const double end_s = kLength_s, u = kRestitution * kSpeed_m_s;
  const auto key = [](std::vector<float>& values, double in, double place, double out) {
    for (const double y : {in, place, out}) values.insert(values.end(), {0, static_cast<float>(y), 0});
  };
  std::vector<float> values;
  key(values, 0, 0.5 * kEdge_m + kHeight_m, 0);
  key(values, -kSpeed_m_s, 0.5 * kEdge_m, u);
  key(values, u - kG * (end_s - kLanding_s), 0.5 * kEdge_m + height_at(end_s), 0);
  GltfRoom cubic = stage();
  animate(cubic, cubic.add_node({{"name", "cube"}, {"mesh", 1}}), "translation",
          {0, static_cast<float>(kLanding_s), static_cast<float>(end_s)}, values, "CUBICSPLINE");
  expect_one_landing(hear(cubic));
}

// A mesh that is bound to a bone, whose own node is somewhere else.
GltfRoom skinned(bool blended) {
  GltfRoom room = stage();
  const std::size_t points = 24;
  std::vector<std::uint8_t> joints;
  std::vector<float> weights;
  for (std::size_t k = 0; k < points; ++k) {
    joints.insert(joints.end(), {1, 0, 0, 0});
    weights.insert(weights.end(), {blended && k == 0 ? 0.5F : 1.F, blended && k == 0 ? 0.5F : 0.F, 0, 0});
  }
  Json& attributes = room.json["meshes"][1]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = room.add_array(joints, 5121, "VEC4", 4, 34962);
  attributes["WEIGHTS_0"] = room.add_array(weights, 5126, "VEC4", 4, 34962);
  // The bind matrix takes the mesh 0.3 m down, into the bone's frame.
  std::vector<float> binds;
  for (int joint = 0; joint < 2; ++joint) {
    for (int k = 0; k < 16; ++k) binds.push_back(k == 13 ? -0.3F : k % 5 == 0 ? 1.F : 0.F);
  }
  room.add_node({{"name", "root"}, {"translation", {3, 3, 3}}});
  room.add_node({{"name", "bone"}});
  room.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", room.add_array(binds, 5126, "MAT4", 16)}}};
  room.add_node({{"name", "cup"}, {"mesh", 1}, {"skin", 0}, {"translation", {0, 7, 0}}});
  animate(room, 2, "translation", frames(), falling(frames(), {0, 0.3, 0}));
  return room;
}

TEST(FoleyInput, ASkinOfOneRigidBoneIsABodyThatTheBoneMoves) {
  const Heard heard = hear(skinned(false));
  EXPECT_FALSE(heard.says("bent"));
  expect_one_landing(heard);
}

TEST(FoleyInput, ASkinOfSeveralBonesIsNamed) {
  GltfRoom room = skinned(true);
  add_falling_cube(room, 1);
  const Heard heard = hear(room);
  EXPECT_TRUE(heard.says("the mesh of 'cup' is bent by several bones"));
  expect_one_landing(heard);
}

TEST(FoleyInput, KeysThatCannotBePlayedAreNamedAndTheRestPlays) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  struct Case {
    std::vector<float> times, values;
    std::string words;
  };
  const std::vector<float> still = {1, 1, 0, 1, 1, 0};
  std::vector<Case> cases = {{{0.5F, 0.2F}, still, "do not lie at times from 0 that rise"},
                             {{0.5F, 0.5F}, still, "do not lie at times from 0 that rise"},
                             {{-1, 0.5F}, still, "do not lie at times from 0 that rise"},
                             {{0, 0.5F}, {1, 1, 0, 1, nan, 0}, "is not a finite number"},
                             {{0, nan}, still, "is not a finite number"},
                             {{0, 0.5F}, {1, 1, 0}, "does not have a value for each of its 2 keys"}};
  Case long_one{{}, {}, "1000000"};
  for (int k = 0; k < 1000000; ++k) {
    long_one.times.push_back(static_cast<float>(0.01 * k));
    long_one.values.insert(long_one.values.end(), {1, 1, 0});
  }
  cases.push_back(std::move(long_one));
  for (const Case& bad : cases) {
    GltfRoom room = stage();
    add_falling_cube(room);
    const std::size_t node = room.add_node({{"name", "bad"}, {"mesh", 1}, {"translation", {1, 1, 0}}});
    animate(room, node, "translation", bad.times, bad.values);
    const Heard heard = hear(room);
    EXPECT_TRUE(heard.says("the animated translation of 'bad' is not played")) << bad.words;
    EXPECT_TRUE(heard.says(bad.words)) << (heard.notes.empty() ? "" : heard.notes[0]);
    expect_one_landing(heard);
  }
}

TEST(FoleyInput, OneFrameMovesNothingWhichIsSaid) {
  GltfRoom room = stage();
  animate(room, room.add_node({{"name", "cube"}, {"mesh", 1}}), "translation", {0}, {0, 0.05F, 0});
  const Heard heard = hear(room);
  EXPECT_TRUE(heard.says("keys at one moment only"));
  EXPECT_TRUE(heard.blows.empty());
}

TEST(FoleyInput, AScaleThatChangesIsNamedAndOneThatStaysIsNot) {
  GltfRoom room = stage();
  const std::size_t node = add_falling_cube(room);
  animate(room, node, "scale", {0, 0.5F}, {1, 1, 1, 1, 1, 1});
  EXPECT_TRUE(hear(room).notes.empty());
  const std::size_t grows = room.add_node({{"name", "balloon"}, {"mesh", 1}, {"translation", {1, 1, 0}}});
  animate(room, grows, "scale", {0, 0.5F}, {1, 1, 1, 2, 2, 2});
  animate(room, grows, "translation", {0, 0.5F}, {1, 1, 0, 1, 1, 0});
  const Heard heard = hear(room);
  EXPECT_TRUE(heard.says("changes the scale of 'balloon'"));
  expect_one_landing(heard);
}

TEST(FoleyInput, WhatIsScaledToNothingIsNotThereYet) {
  // A second cube stands in the air where the first one bounces to, and appears when that has passed.
  GltfRoom room = stage();
  add_falling_cube(room);
  const std::size_t late = room.add_node({{"name", "late"}, {"mesh", 1}, {"translation", {0, 0.3, 0}}});
  animate(room, late, "translation", frames(), [] {
    std::vector<float> values;
    for (std::size_t k = 0; k < frames().size(); ++k) values.insert(values.end(), {0, 0.3F, 0});
    return values;
  }());
  animate(room, late, "scale", {0, 0.79F}, {0, 0, 0, 1, 1, 1}, "STEP");
  const Heard heard = hear(room);
  EXPECT_TRUE(heard.notes.empty());
  expect_one_landing(heard);
}

TEST(FoleyInput, MirroredAndUnevenlyScaledNodesStrikeAndTheirBakeIsRefused) {
  GltfRoom room = stage();
  const std::size_t node = add_falling_cube(room, 0, "glass");
  room.json["materials"] = {{{"name", "glass"}}};
  room.json["meshes"][1]["primitives"][0]["material"] = 0;
  for (const auto& [scale, part] :
       {std::pair(std::vector<double>{-1, 1, 1}, 1.0), {{2, 1, 0.5}, 1.0}, {{2, 1, 2}, 4.0}}) {
    room.json["nodes"][node]["scale"] = scale;
    expect_one_landing(hear(room), part);
    const std::string bytes = room.glb();
    const auto glb = modal::parse_glb(std::as_bytes(std::span(bytes)), "room.glb");
    ASSERT_TRUE(glb);
    const auto silent = find_silent_bodies(*glb);
    ASSERT_TRUE(silent) << silent.error().message;
    const auto found = std::ranges::find(silent->bodies, "glass", &SilentBody::name);
    ASSERT_NE(found, silent->bodies.end());
    EXPECT_NE(found->trouble.find("scaled unevenly or mirrored"), std::string::npos);
  }
}

TEST(FoleyInput, MeshesThatAreNoBodiesAreNamedAndTheRestPlays) {
  GltfRoom room = stage();
  add_falling_cube(room);
  // Morph targets, a mesh of lines, and a flat one.
  const std::size_t soft = room.add_box("soft", {0.1, 0.1, 0.1});
  room.json["meshes"][soft]["primitives"][0]["targets"] = {
      {{"POSITION", room.json["meshes"][soft]["primitives"][0]["attributes"]["POSITION"]}}};
  const std::size_t lines = room.add_box("lines", {0.1, 0.1, 0.1}), flat = room.add_box("flat", {0.3, 0, 0.3});
  room.json["meshes"][lines]["primitives"][0]["mode"] = 1;
  double x = 1;
  for (const auto& [name, mesh] : {std::pair("soft", soft), {"lines", lines}, {"flat", flat}}) {
    const std::size_t node = room.add_node({{"name", name}, {"mesh", mesh}, {"translation", {x, 0.6, 0}}});
    animate(room, node, "translation", {0, 0.5F},
            {static_cast<float>(x), 0.6F, 0, static_cast<float>(x) + 0.1F, 0.6F, 0});
    x += 0.5;
  }
  const Heard heard = hear(room);
  EXPECT_TRUE(heard.says("morph targets"));
  EXPECT_TRUE(heard.says("the mesh of 'lines' has no triangles"));
  EXPECT_TRUE(heard.says("the mesh of 'flat' is flat"));
  expect_one_landing(heard);
}

// What `ringdown scene export --animate` writes goes through the same door.
TEST(FoleyInput, ARecordedSceneThroughItsFileGivesTheImpactsOfItsSimulation) {
  test::Preset preset = test::preset_scene("marble-rain");
  preset.scene.duration_s = 2.5;
  auto truth = test::simulate(preset.scene, preset.objects, 60);
  std::vector<modal::Bank> banks;
  for (const SoundingObject& object : preset.objects) banks.push_back(*object.bank);
  const auto bytes = to_glb(truth.animated, banks);
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto read = parse_gltf_scene(*bytes, "rain.glb", {}, FoleyLimits{});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->notes.empty());
  const auto number = [&](const std::string& name) {  // of a body or a static of the simulated scene
    const auto body = std::ranges::find(truth.animated.bodies, name, &BodyDescription::name);
    if (body != truth.animated.bodies.end()) return static_cast<BodyId>(body - truth.animated.bodies.begin());
    const auto fixed = std::ranges::find(truth.animated.statics, name, &StaticDescription::name);
    EXPECT_NE(fixed, truth.animated.statics.end()) << name;
    return kFirstStatic + static_cast<BodyId>(fixed - truth.animated.statics.begin());
  };
  std::vector<BodyId> numbers;
  for (const BodyDescription& one : read->scene.bodies) {
    numbers.push_back(number(one.name));
    if (!one.path) continue;
    const BodyDescription& two = truth.animated.bodies.at(numbers.back());
    EXPECT_NEAR(one.start_s, std::min(two.start_s, preset.scene.duration_s), 1e-6);
    ASSERT_TRUE(two.path);
    ASSERT_EQ(one.path->poses.size(), two.path->poses.size());
    EXPECT_LT(length(one.path->poses.back().position_m - two.path->poses.back().position_m), 1e-6);
  }
  std::vector<SoundingObject> objects = preset.objects;
  for (std::size_t k = 0; k < objects.size(); ++k) objects[k].name = read->scene.objects[k].name;
  std::vector<HeardContact> heard = test::play(read->scene, objects);
  for (HeardContact& contact : heard) {
    for (BodyId* id : {&contact.pair.first, &contact.pair.second}) *id = *id < kFirstStatic ? numbers.at(*id) : *id;
    if (contact.pair.second < contact.pair.first) std::swap(contact.pair.first, contact.pair.second);
  }
  const auto result = test::compare(truth.contacts, heard, 60);
  EXPECT_GE(result.alone, 40u);
  EXPECT_GE(result.found, 0.95 * static_cast<double>(result.alone)) << test::sentence_of(result);
  EXPECT_LE(result.time_ms, 2);
  EXPECT_LE(result.impulse_db, 1.5);
}

TEST(FoleyInput, APlainRecordingHasMeshesMaterialsByNameAndNoExtension) {
  test::Preset preset = test::preset_scene("marble-rain");
  preset.scene.duration_s = 1.5;
  const auto truth = test::simulate(preset.scene, preset.objects, 30);
  std::vector<modal::Bank> banks;
  for (const SoundingObject& object : preset.objects) banks.push_back(*object.bank);
  const auto bytes = to_picture_glb(truth.animated, banks);
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto glb = modal::parse_glb(*bytes, "rain.glb");
  ASSERT_TRUE(glb) << glb.error().message;
  EXPECT_FALSE(glb->json.contains("extensions"));
  EXPECT_FALSE(glb->json.contains("extensionsUsed"));
  ASSERT_GE(glb->json["materials"].size(), 1u);
  EXPECT_EQ(glb->json["materials"].back()["name"], banks.back().material->name);
  const auto read = parse_gltf_scene(*bytes, "rain.glb", {}, FoleyLimits{});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->scene.bodies.size(), truth.animated.bodies.size() + truth.animated.statics.size());
  const auto heard = test::play(read->scene, {});
  EXPECT_GT(std::ranges::count(heard, HeardContact::blow, &HeardContact::kind), 5);
}

}  // namespace
}  // namespace ringdown::scene::foley_input_test
