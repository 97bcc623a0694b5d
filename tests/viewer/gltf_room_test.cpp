// A room in the layout of Blender's exporter, from the exporter to the ear and the eye: baked in place, rendered, and
// shown in the window. Its buffers lie in files beside it.
#include "engine/modal/bank_file.h"
#include "tests/integration/process.h"
#include "tests/scene/gltf_room.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/virtual_display.h"

#include <gtest/gtest.h>
#include <png.h>
#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;
using modal::Json;

constexpr const char* kPhysics = "KHR_physics_rigid_bodies";
constexpr const char* kAudio = "KHR_audio_rigid_bodies";
constexpr int kWidth = 480, kHeight = 300;

// A glass bar that falls onto a stone slab, and a camera in front of them. Colliders name shapes as the add-on writes
// them, filters have its systems, and joints its nodes; a lamp is there as in every file from Blender.
fs::path write_room(const TemporaryFolder& folder) {
  test::GltfRoom room;
  const char* shapes = "KHR_collision_shapes";
  room.json["extensionsUsed"] = {kPhysics, shapes, kAudio, "KHR_lights_punctual"};
  room.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", 54}, {"name", "Light"}}};
  room.add(shapes, "shapes",
           {{"type", "mesh"}, {"mesh", {{"mesh", 0}}}, {"extensions", {{kPhysics, {{"convexHull", true}}}}}});
  room.add(shapes, "shapes", {{"type", "box"}, {"box", {{"size", {2, 0.1, 2}}}}});
  room.add(kPhysics, "physicsMaterials", {{"staticFriction", 0.5}, {"dynamicFriction", 0.5}, {"restitution", 0.4}});
  room.add(kPhysics, "collisionFilters", {{"collisionSystems", {"System_0"}}, {"collideWithSystems", {"System_0"}}});
  room.add(kAudio, "acousticMaterials", {{"name", "Glass"}});
  room.add(kAudio, "acousticSurfaces", {{"name", "Glass"}, {"material", 0}});
  const Json collider = {{"physicsMaterial", 0}, {"collisionFilter", 0}};
  room.add_node(
      {{"name", "Light"}, {"translation", {4, 6, -1}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  Json bar = {
      {"name", "Glass.001"}, {"mesh", room.add_box("Cube.001", {0.4, 0.02, 0.06})}, {"translation", {0, 0.5, 0}}};
  bar["rotation"] = {0, 0, 0.0871557, 0.9961947};
  bar["extensions"][kPhysics] = {{"motion", {{"mass", 1}}}, {"collider", collider}};
  bar["extensions"][kPhysics]["collider"]["shape"] = 0;
  bar["extensions"][kAudio] = {{"acousticSurface", 0}};
  room.add_node(bar);
  Json slab = {{"name", "Floor"}, {"mesh", room.add_box("Plane", {2, 0.1, 2})}, {"translation", {0, -0.05, 0}}};
  slab["extensions"][kPhysics]["collider"] = collider;
  slab["extensions"][kPhysics]["collider"]["shape"] = 1;
  room.add_node(slab);
  room.json["cameras"] = {
      {{"name", "Camera"}, {"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
  room.add_node({{"name", "Camera"}, {"camera", 0}, {"translation", {0, 0.4, 1.5}}});
  std::ofstream(folder / "room.bin", std::ios::binary) << room.binary;
  return folder.write("room.gltf", room.gltf("room.bin"));
}

// The share of a sound's energy that lies within 2 % of a frequency, by the Fourier sums of a grid of them.
double share_near(const std::vector<float>& samples, double rate_hz, double frequency_hz) {
  double near = 0, all = 0;
  for (double f = 100; f < 6000; f *= 1.004) {
    double c = 0, s = 0;
    for (std::size_t n = 0; n < samples.size(); ++n) {
      const double turn = 2 * std::numbers::pi * f * static_cast<double>(n) / rate_hz;
      c += static_cast<double>(samples[n]) * std::cos(turn), s += static_cast<double>(samples[n]) * std::sin(turn);
    }
    const double power = (c * c + s * s) * f;
    all += power;
    if (std::abs(f / frequency_hz - 1) < 0.02) near += power;
  }
  return near / all;
}

TEST(GltfRoom, ARoomFromBlenderIsBakedHeardAndSeen) {
  const TemporaryFolder folder;
  const fs::path room = write_room(folder), wave = folder / "room.wav", picture = folder / "room.png";
  const std::string bin = RINGDOWN_BIN_DIR "/";
  const Outcome baked = run({bin + "ringdown-bake", room, "--preview", "--band", "20", "6000", "--no-cache"});
  ASSERT_EQ(baked.exit_code, 0) << baked.output;
  const auto bank = modal::read_bank(modal::bank_path({room, {0}}));
  ASSERT_TRUE(bank) << bank.error().message;
  const double lowest_hz = std::ranges::min(bank->frequency_hz);

  const Outcome rendered = run({bin + "ringdown", "render", "--scene", room, "--seconds", "1.2", "-o", wave});
  ASSERT_EQ(rendered.exit_code, 0) << rendered.output;
  EXPECT_EQ(rendered.output.find("not played"), std::string::npos) << rendered.output;
  SF_INFO info{};
  SNDFILE* file = ::sf_open(wave.c_str(), SFM_READ, &info);
  ASSERT_NE(file, nullptr);
  std::vector<float> frames(static_cast<std::size_t>(info.frames * info.channels)), left;
  ::sf_readf_float(file, frames.data(), info.frames);
  ::sf_close(file);
  // It falls for sqrt(2 h / g), with h up to its lower corner: 0.31 s.
  const auto first = static_cast<std::size_t>(0.25 * info.samplerate);
  for (std::size_t n = 0; n < static_cast<std::size_t>(info.frames); ++n)
    left.push_back(frames[n * static_cast<std::size_t>(info.channels)]);
  EXPECT_EQ(std::ranges::count_if(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(first),
                                  [](float x) { return x != 0; }),
            0)
      << "it is heard before it lands";
  const std::vector<float> ringing(left.end() - info.samplerate / 4, left.end());
  EXPECT_GT(std::abs(*std::ranges::max_element(ringing, {}, [](float x) { return std::abs(x); })), 1e-5F);
  EXPECT_GT(share_near(ringing, info.samplerate, lowest_hz), 0.1) << lowest_hz;

  const VirtualDisplay display;
  if (!display.works()) GTEST_SKIP() << "Xvfb is not installed; baked and heard, not seen";
  const Outcome taken = run({bin + "ringdown-viewer", "--screenshot", picture, "--scene", room, "--only", "scene",
                             "--at", "0", "--size", std::to_string(kWidth), std::to_string(kHeight)});
  ASSERT_EQ(taken.exit_code, 0) << taken.output;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&image, picture.c_str()));
  image.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> rgb(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr));
  // The camera looks along -z of the file from (0, 0.4, 1.5), by a pinhole with a vertical angle of 0.7.
  const double focal = kHeight / 2.0 / std::tan(0.35);
  const auto at = [&](double x, double y) {
    const auto column = static_cast<std::size_t>(kWidth / 2.0 + focal * x / 1.5);
    const auto row = static_cast<std::size_t>(kHeight / 2.0 - focal * (y - 0.4) / 1.5);
    return &rgb[3 * (row * kWidth + column)];
  };
  const auto away = [](const unsigned char* a, const unsigned char* b) {
    return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
  };
  // The bar leans by 10 degrees: its right end is 35 mm higher than its middle.
  EXPECT_GT(away(at(0, 0.5), at(0, 0.58)), 25) << "no bar at its middle";
  EXPECT_GT(away(at(0.18, 0.5 + 0.18 * 0.1736), at(0.18, 0.45)), 25) << "no bar at its right end";
  EXPECT_GT(away(at(-0.18, 0.5 - 0.18 * 0.1736), at(-0.18, 0.55)), 25) << "no bar at its left end";
  EXPECT_LT(away(at(0, 0.58), at(0.1, 0.58)), 12) << "nothing beside it";
}

}  // namespace
}  // namespace ringdown::test
