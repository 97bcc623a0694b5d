// glTF scenes as texts, put together from their parts. For tests of scenes that other programs write.
#pragma once

#include "engine/scene/gltf/scene.h"
#include "engine/scene/world.h"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::test {

inline Result<scene::GltfScene> parse(const std::string& text) {
  const modal::ReadBeside none = [](const std::string& relative, std::size_t) -> Result<std::string> {
    return fail(ErrorKind::bad_input, "no file " + relative);
  };
  return scene::parse_gltf_scene(std::as_bytes(std::span(text)), "room.gltf", none);
}

// A document of nodes, shapes, and further members of the physics extension and of the whole.
inline std::string document(const std::string& nodes, const std::string& shapes, const std::string& physics = "",
                            const std::string& more = "") {
  return R"({"asset": {"version": "2.0"}, "nodes": [)" + nodes + R"(], "extensions": {
    "KHR_implicit_shapes": {"shapes": [)" +
         shapes + R"(]},
    "KHR_physics_rigid_bodies": {)" +
         physics + "}}" + more + "}";
}

// A node with this physics extension, and further members.
inline std::string node(const std::string& physics, const std::string& more = "") {
  return R"({"extensions": {"KHR_physics_rigid_bodies": {)" + physics + "}}" + more + "}";
}

inline const std::string kBall = R"({"type": "sphere", "sphere": {"radius": 0.1}})";
inline const std::string kBox = R"({"type": "box", "box": {"size": [0.2, 0.4, 0.6]}})";
inline const std::string kPlane = R"({"type": "plane", "plane": {}})";
inline const std::string kCollider0 = R"("collider": {"geometry": {"shape": 0}})";
inline const std::string kCollider1 = R"("collider": {"geometry": {"shape": 1}})";

inline scene::GltfScene good(const std::string& text) {
  auto read = parse(text);
  EXPECT_TRUE(read) << read.error().message;
  return read.value_or(scene::GltfScene());
}

inline scene::World silent_world(const scene::SceneDescription& scene) {
  auto world = scene::World::create(scene, {}, 48000);
  if (!world) throw std::runtime_error(world.error().message);
  return std::move(*world);
}

inline void run_until(scene::World& world, double seconds) {
  while (world.time_s() < seconds - 1e-9) world.step();
}

inline std::string base64(const std::string& bytes) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    unsigned word = 0;
    for (std::size_t b = 0; b < 3; ++b)
      word = word << 8 | (k + b < bytes.size() ? static_cast<unsigned char>(bytes[k + b]) : 0);
    for (std::size_t c = 0; c < 4; ++c) text += k + c <= bytes.size() ? letters[word >> (18 - 6 * c) & 63] : '=';
  }
  return text;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

}  // namespace ringdown::test
