// Scenes written as glTF: read again they are the same, bit for bit, and other programs find them where they are.
#include "engine/modal/bank_file.h"
#include "engine/scene/contact/contact_rules.h"
#include "engine/scene/gltf/scene.h"
#include "engine/scene/gltf/writer.h"
#include "engine/scene/rotation.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::scene::gltf_writer_test {
namespace {

const std::filesystem::path kPresets = std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets";

Result<GltfScene> read(std::span<const std::byte> bytes) { return parse_gltf_scene(bytes, "scene.glb", {}); }

struct Exported {
  SceneDescription scene;
  std::vector<modal::Bank> banks;
  std::vector<std::byte> bytes;
};

Exported exported(const std::filesystem::path& path) {
  auto scene = read_scene(path, kPresets);
  if (!scene) throw std::runtime_error(scene.error().message);
  std::vector<modal::Bank> banks;
  for (const ObjectDescription& object : scene->objects) banks.push_back(modal::read_bank(object.bank).value());
  auto bytes = to_glb(*scene, banks);
  if (!bytes) throw std::runtime_error(path.string() + ": " + bytes.error().message);
  return {*scene, std::move(banks), *bytes};
}

TEST(GltfWriter, EveryPresetSceneIsReadAgainBitForBit) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kPresets / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    auto [scene, banks, bytes] = exported(entry.path());
    const auto again = read(bytes);
    ASSERT_TRUE(again) << entry.path() << again.error().message;
    EXPECT_TRUE(again->notes.empty());
    ASSERT_EQ(again->scene.objects.size(), scene.objects.size());
    for (std::size_t k = 0; k < scene.objects.size(); ++k) {
      const std::string bank = again->scene.objects[k].bank.string();
      ASSERT_TRUE(bank.starts_with("scene.glb#")) << bank;
      scene.objects[k].gain *= banks[k].gain;
      scene.objects[k].bank = bank;
    }
    for (BodyDescription& body : scene.bodies) body.breaks.reset();  // exported bodies stay whole
    EXPECT_EQ(to_toml(again->scene), to_toml(scene)) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 5);
}

TEST(GltfWriter, BanksInsideAreThoseOfTheScene) {
  const auto [scene, banks, bytes] = exported(kPresets / "scenes/bell-and-clapper.toml");
  const auto again = read(bytes);
  ASSERT_TRUE(again) << again.error().message;
  for (std::size_t k = 0; k < banks.size(); ++k) {
    const auto bank = modal::parse_bank(bytes, again->scene.objects[k].bank.string(),
                                        modal::split_bank_path(again->scene.objects[k].bank).model);
    ASSERT_TRUE(bank) << bank.error().message;
    EXPECT_EQ(bank->frequency_hz, banks[k].frequency_hz);
    EXPECT_EQ(bank->decay_per_s, banks[k].decay_per_s);
    EXPECT_EQ(bank->shapes, banks[k].shapes);
    EXPECT_EQ(bank->positions, banks[k].positions);
    EXPECT_EQ(bank->triangles, banks[k].triangles);
  }
}

// As another program reads the file: without Ringdown's own scene in it.
// The scene as a program reads it that knows nothing of ours.
Result<GltfScene> read_by_others(std::span<const std::byte> bytes) {
  const std::string mark = "\"fingerprint\":\"";
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  text[text.find(mark) + mark.size()] = '-';
  return read(std::as_bytes(std::span(text)));
}

TEST(GltfWriter, OtherProgramsFindEveryFinish) {
  auto [scene, banks, bytes] = exported(kPresets / "scenes/demo.toml");
  scene.bodies[0].surface.waviness = 3e-4;
  scene.bodies[0].surface.texture.shortest_m = 2e-6;
  const auto plain = read_by_others(to_glb(scene, banks).value());
  ASSERT_TRUE(plain) << plain.error().message;
  const auto found = std::ranges::find(plain->scene.bodies, scene.bodies[0].name, &BodyDescription::name);
  ASSERT_NE(found, plain->scene.bodies.end());
  EXPECT_NEAR(found->surface.waviness.value(), 3e-4, 1e-15);
  EXPECT_EQ(found->surface.texture.shortest_m, 2e-6);
}

// Whether impacts feel vibrations stays in the file when another program has changed it.
TEST(GltfWriter, TwoWayContactsSurviveAnotherProgram) {
  auto [scene, banks, bytes] = exported(kPresets / "scenes/demo.toml");
  scene.bodies[1].two_way = true;
  const std::vector<std::byte> written = to_glb(scene, banks).value();
  for (const auto& again : {read(written), read_by_others(written)}) {
    ASSERT_TRUE(again) << again.error().message;
    ASSERT_EQ(again->scene.bodies.size(), scene.bodies.size());
    for (const BodyDescription& body : again->scene.bodies) EXPECT_EQ(body.two_way, body.name == scene.bodies[1].name);
  }
}

TEST(GltfWriter, AnUnknownWayOfContactIsRefusedInOneSentence) {
  auto [scene, banks, bytes] = exported(kPresets / "scenes/demo.toml");
  scene.bodies[1].two_way = true;
  std::vector<std::byte> written = to_glb(scene, banks).value();
  std::string text(reinterpret_cast<const char*>(written.data()), written.size());
  const std::string mark = "\"contact\":\"two-way\"";
  const std::size_t at = text.find(mark);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, mark.size(), "\"contact\":\"two-wax\"");
  const auto again = read(std::as_bytes(std::span(text)));
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().message.find("one-way or two-way"), std::string::npos) << again.error().message;
}

TEST(GltfWriter, OtherProgramsFindEveryBodyInItsPlace) {
  auto [scene, banks, bytes] = exported(kPresets / "scenes/demo.toml");
  const auto plain = read_by_others(bytes);
  ASSERT_TRUE(plain) << plain.error().message;
  ASSERT_EQ(plain->notes.size(), 1);
  EXPECT_NE(plain->notes[0].find("another program has changed"), std::string::npos);
  const BodyDescription& other = scene.bodies.front();
  const auto found_other = std::ranges::find(plain->scene.bodies, other.name, &BodyDescription::name);
  ASSERT_NE(found_other, plain->scene.bodies.end());
  for (const BodyDescription& body : scene.bodies) {
    const auto found = std::ranges::find(plain->scene.bodies, body.name, &BodyDescription::name);
    ASSERT_NE(found, plain->scene.bodies.end()) << body.name;
    EXPECT_LT(length(found->position_m - body.position_m), 1e-9);
    EXPECT_LT(length(found->velocity_m_s - body.velocity_m_s), 1e-9);
    EXPECT_EQ(found->fixed, body.fixed);
    EXPECT_EQ(found->shape.type, body.shape.type);
    const SurfacePair theirs = combine(found->surface, found_other->surface),
                      ours = combine(body.surface, other.surface);
    EXPECT_NEAR(theirs.restitution, ours.restitution, 1e-12);
    EXPECT_NEAR(theirs.friction, ours.friction, 1e-12);
    EXPECT_NEAR(theirs.sliding_friction, ours.sliding_friction, 1e-12);
    EXPECT_EQ(found->surface.rolling_m, body.surface.rolling_m);
  }
}

TEST(GltfWriter, OtherProgramsFindAFreeJointsFramesLimitsAndDrives) {
  auto [scene, banks, bytes] = exported(kPresets / "scenes/demo.toml");
  const auto body = std::ranges::find(scene.bodies, false, &BodyDescription::fixed);
  JointDescription joint{.name = "leash", .type = JointType::free, .body = body->name, .anchor_m = {0.1, 0.2, 0.3}};
  joint.rotation = about({1, 2, 3}, 0.7);
  joint.end = {{0.15, 0.25, 0.2}, about({1, 2, 3}, 0.9)};
  joint.frame_of_body = true;
  joint.limits = {{.axes = {1}, .low = -0.5, .high = 0.6, .stiffness = 30, .damping = 2},
                  {.turns = true, .axes = {0, 2}, .high = 0.8}};
  joint.drives = {{.axis = 2, .drive = {.stiffness = 4, .damping = 0.5, .target = 0.1, .speed = -0.2, .max = 7}}};
  scene.joints = {joint};
  const auto plain = read_by_others(to_glb(scene, banks).value());
  ASSERT_TRUE(plain) << plain.error().message;
  ASSERT_EQ(plain->scene.joints.size(), 1);
  const JointDescription& found = plain->scene.joints[0];
  ASSERT_EQ(found.type, JointType::free);
  EXPECT_EQ(found.body, joint.body);
  EXPECT_TRUE(found.frame_of_body);
  EXPECT_EQ(found.limits, joint.limits);
  EXPECT_EQ(found.drives, joint.drives);
  EXPECT_LT(length(found.anchor_m - joint.anchor_m), 1e-9);
  EXPECT_LT(length(found.end.position_m - joint.end.position_m), 1e-9);
  EXPECT_LT(length(to_rotation_vector(inverse(found.rotation) * joint.rotation)), 1e-9);
  EXPECT_LT(length(to_rotation_vector(inverse(found.end.rotation) * joint.end.rotation)), 1e-9);
}

}  // namespace
}  // namespace ringdown::scene::gltf_writer_test
