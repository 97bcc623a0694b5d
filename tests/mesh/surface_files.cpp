#include "tests/mesh/surface_files.h"

#include <cstdio>
#include <cstring>

namespace ringdown::test {
namespace {

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string numbers(const char* format, double x, double y, double z) {
  char text[120];
  std::snprintf(text, sizeof text, format, x, y, z);
  return text;
}

struct Writer {
  const mesh::TriangleMesh& mesh;
  double scale;

  [[nodiscard]] Eigen::Index points() const { return mesh.nodes.rows(); }
  [[nodiscard]] Eigen::Index faces() const { return mesh.triangles.rows(); }
  [[nodiscard]] double at(Eigen::Index n, int axis) const { return mesh.nodes(n, axis) / scale; }
  [[nodiscard]] std::string line(const char* format, Eigen::Index n) const {
    return numbers(format, at(n, 0), at(n, 1), at(n, 2));
  }
  [[nodiscard]] std::string face(const std::string& before, Eigen::Index t, int first) const {
    std::string text = before;
    for (int i = 0; i < 3; ++i) text += " " + std::to_string(mesh.triangles(t, i) + first);
    return text + "\n";
  }
  void floats(std::string& bytes, Eigen::Index n) const {
    for (int axis = 0; axis < 3; ++axis) put(bytes, static_cast<float>(at(n, axis)));
  }

  [[nodiscard]] std::string obj() const {
    std::string text = "# a surface\no body\n";
    for (Eigen::Index n = 0; n < points(); ++n) text += line("v %.9g %.9g %.9g\n", n);
    for (Eigen::Index t = 0; t < faces(); ++t) text += face("f", t, 1);
    return text;
  }

  [[nodiscard]] std::string off() const {
    std::string text = "OFF\n" + std::to_string(points()) + " " + std::to_string(faces()) + " 0\n";
    for (Eigen::Index n = 0; n < points(); ++n) text += line("%.9g %.9g %.9g\n", n);
    for (Eigen::Index t = 0; t < faces(); ++t) text += face("3", t, 0);
    return text;
  }

  [[nodiscard]] std::string ascii_stl() const {
    std::string text = "solid body\n";
    for (Eigen::Index t = 0; t < faces(); ++t) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (int i = 0; i < 3; ++i) text += line("vertex %.9g %.9g %.9g\n", mesh.triangles(t, i));
      text += "endloop\nendfacet\n";
    }
    return text + "endsolid body\n";
  }

  [[nodiscard]] std::string binary_stl() const {
    std::string bytes(80, ' ');
    put(bytes, static_cast<std::uint32_t>(faces()));
    for (Eigen::Index t = 0; t < faces(); ++t) {
      for (int axis = 0; axis < 3; ++axis) put(bytes, 0.0f);
      for (int i = 0; i < 3; ++i) floats(bytes, mesh.triangles(t, i));
      put(bytes, std::uint16_t{0});
    }
    return bytes;
  }

  [[nodiscard]] std::string ply(bool binary) const {
    std::string text = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") +
                       " 1.0\nelement vertex " + std::to_string(points()) +
                       "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                       std::to_string(faces()) + "\nproperty list uchar int vertex_indices\nend_header\n";
    for (Eigen::Index n = 0; n < points(); ++n) {
      if (binary) floats(text, n);
      if (!binary) text += line("%.9g %.9g %.9g\n", n);
    }
    for (Eigen::Index t = 0; t < faces(); ++t) {
      if (!binary) text += face("3", t, 0);
      if (!binary) continue;
      put(text, std::uint8_t{3});
      for (int i = 0; i < 3; ++i) put(text, mesh.triangles(t, i));
    }
    return text;
  }

  [[nodiscard]] std::string glb() const {
    std::string data;
    const Writer unscaled{mesh, scale};
    for (Eigen::Index n = 0; n < points(); ++n) unscaled.floats(data, n);
    const std::size_t corners = data.size();
    for (Eigen::Index t = 0; t < faces(); ++t) {
      for (int i = 0; i < 3; ++i) put(data, static_cast<std::uint32_t>(mesh.triangles(t, i)));
    }
    const Eigen::RowVector3d low = mesh.nodes.colwise().minCoeff() / scale,
                             high = mesh.nodes.colwise().maxCoeff() / scale;
    const auto count = [](auto n) { return std::to_string(n); };
    std::string json =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"scale":)" +
        numbers("[%.9g,%.9g,%.9g]", scale, scale, scale) + R"(},{"mesh":0}],)" +
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)" +
        R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":)" + count(points()) + R"(,"min":)" +
        numbers("[%.9g,%.9g,%.9g]", low[0], low[1], low[2]) + R"(,"max":)" +
        numbers("[%.9g,%.9g,%.9g]", high[0], high[1], high[2]) +
        R"(},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)" + count(3 * faces()) +
        R"(}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" + count(corners) +
        R"(},{"buffer":0,"byteOffset":)" + count(corners) + R"(,"byteLength":)" + count(data.size() - corners) +
        R"(}],"buffers":[{"byteLength":)" + count(data.size()) + "}]}";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string bytes = "glTF";
    put(bytes, std::uint32_t{2});
    put(bytes, static_cast<std::uint32_t>(28 + json.size() + data.size()));
    put(bytes, static_cast<std::uint32_t>(json.size()));
    bytes += "JSON" + json;
    put(bytes, static_cast<std::uint32_t>(data.size()));
    bytes.append("BIN\0", 4);
    return bytes + data;
  }
};

}  // namespace

std::string file_of(const mesh::TriangleMesh& mesh, const std::string& ending, double scale) {
  const Writer writer{mesh, scale};
  if (ending == ".obj") return writer.obj();
  if (ending == ".off") return writer.off();
  if (ending == ".stl") return writer.binary_stl();
  if (ending == "ascii.stl") return writer.ascii_stl();
  if (ending == ".ply") return writer.ply(true);
  if (ending == "ascii.ply") return writer.ply(false);
  return writer.glb();
}

}  // namespace ringdown::test
