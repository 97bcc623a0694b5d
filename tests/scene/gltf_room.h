// Binary glTF scenes in the layout of Blender's exporter, put together by tests: meshes with normals and texture
// coordinates, whose corners stand in them once for each face, and short indices.
#pragma once

#include "engine/base/vec3.h"
#include "engine/gltf/glb.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::test {

class GltfRoom {
 public:
  modal::Json json = {{"asset", {{"generator", "Khronos glTF Blender I/O v4.2.60"}, {"version", "2.0"}}},
                      {"extensionsUsed", {"KHR_physics_rigid_bodies", "KHR_implicit_shapes", "KHR_audio_rigid_bodies"}},
                      {"scene", 0},
                      {"scenes", {{{"name", "Scene"}, {"nodes", modal::Json::array()}}}},
                      {"nodes", modal::Json::array()},
                      {"meshes", modal::Json::array()},
                      {"accessors", modal::Json::array()},
                      {"bufferViews", modal::Json::array()}};
  std::string binary;

  // A box about the origin, each face with the whole of the texture. Returns the mesh's number.
  std::size_t add_box(const std::string& name, Vec3 size_m) {
    std::vector<float> points, normals, uv;
    std::vector<std::uint16_t> corners;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        const auto first = static_cast<std::uint16_t>(points.size() / 3);
        for (const auto& [u, v] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
          std::array<double, 3> p{};
          p[static_cast<std::size_t>(axis)] = side;
          p[static_cast<std::size_t>((axis + 1) % 3)] = 2 * u - 1;
          p[static_cast<std::size_t>((axis + 2) % 3)] = side * (2 * v - 1);
          points.insert(points.end(),
                        {static_cast<float>(0.5 * size_m.x * p[0]), static_cast<float>(0.5 * size_m.y * p[1]),
                         static_cast<float>(0.5 * size_m.z * p[2])});
          for (int k = 0; k < 3; ++k) normals.push_back(k == axis ? static_cast<float>(side) : 0.F);
          uv.insert(uv.end(), {static_cast<float>(u), static_cast<float>(v)});
        }
        for (const int k : {0, 1, 2, 0, 2, 3}) corners.push_back(static_cast<std::uint16_t>(first + k));
      }
    }
    json["meshes"].push_back({{"name", name},
                              {"primitives",
                               {{{"attributes",
                                  {{"POSITION", add_array(points, 5126, "VEC3", 3, 34962)},
                                   {"NORMAL", add_array(normals, 5126, "VEC3", 3, 34962)},
                                   {"TEXCOORD_0", add_array(uv, 5126, "VEC2", 2, 34962)}}},
                                 {"indices", add_array(corners, 5123, "SCALAR", 1, 34963)}}}}});
    auto& accessor = json["accessors"][json["accessors"].size() - 4];
    const Vec3 half = 0.5 * size_m;
    accessor["min"] = {-half.x, -half.y, -half.z};
    accessor["max"] = {half.x, half.y, half.z};
    return json["meshes"].size() - 1;
  }

  template <class T>
  std::size_t add_array(const std::vector<T>& values, int component, const char* type, std::size_t width,
                        std::optional<int> target = {}) {
    json["accessors"].push_back({{"bufferView", add_view(values.data(), sizeof(T) * values.size(), target)},
                                 {"componentType", component},
                                 {"count", values.size() / width},
                                 {"type", type}});
    return json["accessors"].size() - 1;
  }

  std::size_t add_view(const void* bytes, std::size_t size, std::optional<int> target = {}) {
    binary.resize((binary.size() + 3) / 4 * 4);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}});
    if (target) json["bufferViews"].back()["target"] = *target;
    binary.append(static_cast<const char*>(bytes), size);
    return json["bufferViews"].size() - 1;
  }

  // Adds a node at the top of the scene; returns its number.
  std::size_t add_node(modal::Json node, bool is_root = true) {
    json["nodes"].push_back(std::move(node));
    if (is_root) json["scenes"][0]["nodes"].push_back(json["nodes"].size() - 1);
    return json["nodes"].size() - 1;
  }

  // Adds an element of a list of an extension of the document; returns its number.
  std::size_t add(const char* extension, const char* list, modal::Json element) {
    modal::Json& all = json["extensions"][extension][list];
    all.push_back(std::move(element));
    return all.size() - 1;
  }

  // The file, with `further` chunks at its end.
  [[nodiscard]] std::string glb(const std::string& further = "") const {
    modal::Json document = json;
    std::string bytes = binary;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    document["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string file = "glTF";
    const auto put = [&file](std::size_t value) {
      const auto word = static_cast<std::uint32_t>(value);
      file.append(reinterpret_cast<const char*>(&word), 4);
    };
    put(2), put(28 + text.size() + bytes.size() + further.size());
    put(text.size()), put(0x4E4F534A);
    file += text;
    put(bytes.size()), put(0x004E4942);
    return file + bytes + further;
  }

  // The same as a text; its buffer is the file `uri` beside it, with the bytes of `binary`.
  [[nodiscard]] std::string gltf(const std::string& uri) const {
    modal::Json document = json;
    document["buffers"] = {{{"byteLength", binary.size()}, {"uri", uri}}};
    return document.dump(2);
  }
};

}  // namespace ringdown::test
