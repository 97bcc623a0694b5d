// Acoustic surfaces of glTF scenes: what the file says about them reaches the events of contacts.
#include "engine/scene/gltf/scene.h"
#include "engine/scene/gltf/surface.h"
#include "engine/scene/world.h"
#include "tests/scene/box_bank.h"
#include "tests/scene/gltf_room.h"
#include "tests/scene/gltf_text.h"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace ringdown::scene::gltf_surface_test {
namespace {

using modal::Json;
using test::GltfRoom;

constexpr const char* kPhysics = "KHR_physics_rigid_bodies";
constexpr const char* kAudio = "KHR_audio_rigid_bodies";

Result<GltfScene> read(const GltfRoom& room, const modal::ReadBeside& beside = {}) {
  const std::string bytes = room.glb();
  return parse_gltf_scene(std::as_bytes(std::span(bytes)), "room.glb", beside);
}

// A node of shape 0 with this surface.
Json collider(std::size_t surface, bool moves = false) {
  Json node;
  node["extensions"][kPhysics]["collider"]["geometry"]["shape"] = 0;
  if (moves) node["extensions"][kPhysics]["motion"] = Json::object();
  node["extensions"][kAudio]["acousticSurface"] = surface;
  return node;
}

GltfRoom room_with(const Json& surface) {
  GltfRoom room;
  room.add("KHR_implicit_shapes", "shapes", {{"type", "sphere"}, {"sphere", {{"radius", 0.1}}}});
  room.add_node(collider(room.add(kAudio, "acousticSurfaces", surface), true));
  return room;
}

TEST(GltfSurface, AFinishIsReadWithTheDraftsDefaults) {
  const auto usual = read(room_with({{"roughness", 1e-6}}));
  ASSERT_TRUE(usual) << usual.error().message;
  EXPECT_TRUE(usual->notes.empty());
  EXPECT_NEAR(usual->scene.bodies[0].surface.waviness.value(), 1e-3, 1e-15);
  EXPECT_EQ(usual->scene.bodies[0].surface.texture.shortest_m, 0);
  const auto own =
      read(room_with({{"shortWavelength", 1e-6}, {"waviness", 2e-7}, {"wavinessLength", 5e-3}, {"roughness", 1e-6}}));
  ASSERT_TRUE(own);
  EXPECT_EQ(own->scene.bodies[0].surface.texture.shortest_m, 1e-6);
  EXPECT_NEAR(own->scene.bodies[0].surface.waviness.value(), 4e-5, 1e-15);
  const auto steep = read(room_with({{"waviness", 1e-3}, {"wavinessLength", 2e-3}}));
  ASSERT_TRUE(steep);
  ASSERT_EQ(steep->notes.size(), 1);
  EXPECT_NE(steep->notes[0].find("longer and gentler"), std::string::npos);
  EXPECT_FALSE(read(room_with({{"waviness", -1}})));
  EXPECT_FALSE(read(room_with({{"wavinessLength", 0}})));
}

GltfRoom room_with_profile(const std::vector<float>& heights, const Json& spacing) {
  GltfRoom room = room_with(Json::object());
  Json& surface = room.json["extensions"][kAudio]["acousticSurfaces"][0];
  surface["profile"] = room.add_array(heights, 5126, "SCALAR", 1);
  if (!spacing.is_null()) surface["sampleSpacing"] = spacing;
  return room;
}

TEST(GltfSurface, AProfileIsReadAndNotScaled) {
  const std::vector<float> heights{0, 1e-6F, 0, -1e-6F, 0, 2e-6F, 0, -2e-6F};
  GltfRoom room = room_with_profile(heights, 5e-6);
  room.json["nodes"][0]["scale"] = {3, 3, 3};
  const auto scene = read(room);
  ASSERT_TRUE(scene) << scene.error().message;
  const auto& relief = scene->scene.bodies[0].surface.relief;
  ASSERT_TRUE(relief && relief->profile);
  EXPECT_NEAR(relief->profile->length_m(), 4e-5, 1e-15);
  EXPECT_TRUE(std::ranges::equal(relief->profile->heights_m(), heights));
  EXPECT_FALSE(read(room_with_profile(heights, {}))) << "a profile without a spacing";
  EXPECT_FALSE(read(room_with_profile(heights, 0)));
  EXPECT_FALSE(read(room_with_profile({1e-6F}, 5e-6)));
  EXPECT_FALSE(read(room_with_profile({1e-6F, std::nanf("")}, 5e-6)));
}

// `format`: PNG_FORMAT_RGB or PNG_FORMAT_RGBA.
std::string png_of(int width, int height, const std::vector<unsigned char>& pixels, png_uint_32 format) {
  png_image png = {};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(width);
  png.height = static_cast<png_uint_32>(height);
  png.format = format;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(png), '\0');
  png_alloc_size_t size = bytes.size();
  EXPECT_TRUE(png_image_write_to_memory(&png, bytes.data(), &size, 0, pixels.data(), 0, nullptr));
  bytes.resize(size);
  return bytes;
}

// Ridges across u, `waves` of them, as steep as `slope`. With alpha, half of the picture is transparent.
std::string ridges(int waves, double slope, bool alpha = false) {
  constexpr int kWidth = 256, kHeight = 16;
  std::vector<unsigned char> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double s = slope * std::cos(2 * std::numbers::pi * waves * x / kWidth), z = 1 / std::sqrt(1 + s * s);
      for (const double part : {-s * z, 0.0, z})
        pixels.push_back(static_cast<unsigned char>(std::lround(127.5 * (part + 1))));
      if (alpha) pixels.push_back(x % 2 == 0 ? 0 : 128);
    }
  }
  return png_of(kWidth, kHeight, pixels, alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB);
}

// A box of 0.4 m edges whose every face has the whole map.
GltfRoom room_with_map(const std::string& image, bool in_material) {
  GltfRoom room;
  room.add("KHR_implicit_shapes", "shapes", {{"type", "box"}, {"box", {{"size", {0.4, 0.4, 0.4}}}}});
  const std::size_t mesh = room.add_box("Tiled", {0.4, 0.4, 0.4});
  room.json["images"] = {{{"mimeType", "image/png"}, {"bufferView", room.add_view(image.data(), image.size())}}};
  room.json["textures"] = {{{"source", 0}}};
  Json surface = Json::object();
  if (in_material) {
    room.json["materials"] = {{{"normalTexture", {{"index", 0}}}}};
    room.json["meshes"][mesh]["primitives"][0]["material"] = 0;
  } else {
    surface["normalTexture"] = {{"index", 0}};
  }
  Json node = collider(room.add(kAudio, "acousticSurfaces", surface));
  node["mesh"] = mesh;
  room.add_node(node);
  node["scale"] = {2, 2, 2};
  room.add_node(node);
  return room;
}

TEST(GltfSurface, ANormalMapIsReliefThatScalesWithItsMesh) {
  for (const bool in_material : {true, false}) {
    const auto scene = read(room_with_map(ridges(8, 0.2), in_material));
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_TRUE(scene->notes.empty());
    for (const auto& [body, size] : {std::pair(0, 1.0), {1, 2.0}}) {
      const auto& relief = scene->scene.bodies.at(static_cast<std::size_t>(body)).surface.relief;
      ASSERT_TRUE(relief && relief->mesoscale);
      EXPECT_NEAR(relief->mesoscale->length_m(), size * 0.4 * 16, 1e-6) << "16 rows, one after the other";
      EXPECT_NEAR(relief->mesoscale->rms_slope(), 0.2 / std::sqrt(2.0), 0.003);
      // Ridges 50 mm apart: 0.2 / q high, with q = 2 pi / 50 mm.
      const auto heights = relief->mesoscale->heights_m();
      const auto [low, high] = std::ranges::minmax(heights);
      EXPECT_NEAR(high - low, size * 2 * 0.2 * 0.05 / (2 * std::numbers::pi), 2e-4 * size);
    }
  }
}

TEST(GltfSurface, WhatIsTransparentInANormalMapIsFeltAlike) {
  const auto plain = read(room_with_map(ridges(8, 0.2), true));
  const auto alpha = read(room_with_map(ridges(8, 0.2, true), true));
  ASSERT_TRUE(plain && alpha);
  const auto& relief = alpha->scene.bodies.at(0).surface.relief;
  ASSERT_TRUE(relief && relief->mesoscale);
  EXPECT_TRUE(std::ranges::equal(relief->mesoscale->heights_m(),
                                 plain->scene.bodies.at(0).surface.relief->mesoscale->heights_m()));
}

TEST(GltfSurface, AMapOfOneTexelIsNamedAndNotFelt) {
  const auto scene = read(room_with_map(png_of(1, 1, {128, 128, 255}, PNG_FORMAT_RGB), true));
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->notes.size(), 1);
  EXPECT_NE(scene->notes[0].find("of one texel"), std::string::npos);
  EXPECT_FALSE(scene->scene.bodies[0].surface.relief);
}

TEST(GltfSurface, AMapThatIsNoneIsNamedAndNotFelt) {
  const auto broken = read(room_with_map("no picture", true));
  ASSERT_TRUE(broken) << broken.error().message;
  ASSERT_EQ(broken->notes.size(), 1);
  EXPECT_NE(broken->notes[0].find("must be a PNG"), std::string::npos);
  EXPECT_FALSE(broken->scene.bodies[0].surface.relief);
  GltfRoom beside = room_with_map(ridges(4, 0.1), true);
  beside.json["images"][0] = {{"uri", "a%20map.png"}};
  const auto found = read(beside, [](const std::string& name, std::size_t) -> Result<std::string> {
    EXPECT_EQ(name, "a map.png");
    return ridges(4, 0.1);
  });
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->scene.bodies[0].surface.relief);
}

// Speeds over the two surfaces, of the last event of each contact of a body that sounds.
std::array<double, 2> sweeps(SceneDescription scene, double seconds) {
  scene.bodies[0].object = "a";
  auto world = World::create(
      scene, std::vector{ringdown::test::sounding("a", 0, ringdown::test::box_bank({0.2, 0.2, 0.2}, 1))}, 48000);
  EXPECT_TRUE(world) << world.error().message;
  std::array<double, 2> last{};
  while (world->time_s() < seconds) {
    for (const auto& event : test::only<synth::verb::Contact>(world->step().events)) {
      if (dot(event.contact.force_n, event.contact.force_n) == 0) continue;
      for (std::size_t k = 0; k < 2; ++k)
        if (event.contact.surfaces[k].relief) last[k] = event.contact.surfaces[k].speed_m_s;
    }
  }
  return last;
}

TEST(GltfSurface, ASlidingBoxTravelsOverTheFloorAndARollingBallOverBoth) {
  const std::vector<float> heights{0, 1e-6F, 0, -1e-6F};
  auto relief = std::make_shared<modal::SurfaceRelief>();
  relief->profile = *modal::SurfaceTrack::make(heights, 1e-5);
  for (const bool round : {false, true}) {
    BodyDescription body = ringdown::test::body_of("a", round ? ShapeType::sphere : ShapeType::box, {0, 0, 0.1});
    if (round) body.shape.radius_m = 0.1;
    if (!round) body.shape.size_m = {0.2, 0.2, 0.2};
    body.velocity_m_s = {2, 0, 0};
    if (round) body.spin_rad_s = {0, 20, 0};
    SceneDescription scene = ringdown::test::scene_of({body}, 0);
    scene.bodies[0].surface.friction = scene.statics[0].surface.friction = 0.3;
    scene.bodies[0].surface.rolling_m = scene.statics[0].surface.rolling_m = 0;
    scene.bodies[0].surface.relief = scene.statics[0].surface.relief = relief;
    const auto [own, floor] = sweeps(scene, 0.3);
    const double expected_m_s = round ? 2 : 2 - 0.3 * 9.81 * 0.3;
    EXPECT_NEAR(floor, expected_m_s, 0.05) << round;
    EXPECT_NEAR(own, round ? expected_m_s : 0, 0.05) << round;
  }
}

TEST(GltfSurface, ReliefsOfEndedScenesAreKeptOnce) {
  const auto scene = [] {
    SceneDescription made;
    made.bodies.emplace_back();
    auto relief = std::make_shared<modal::SurfaceRelief>();
    relief->profile = *modal::SurfaceTrack::make(std::vector<float>{0, 1, 2, 1}, 1e-5);
    made.bodies[0].surface.relief = relief;
    return made;
  };
  Reliefs kept;
  SceneDescription first = scene(), second = scene();
  ASSERT_TRUE(kept.keep(first));
  ASSERT_TRUE(kept.keep(second));
  EXPECT_EQ(first.bodies[0].surface.relief, second.bodies[0].surface.relief);
}

}  // namespace
}  // namespace ringdown::scene::gltf_surface_test
