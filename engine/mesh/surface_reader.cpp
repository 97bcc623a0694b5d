#include "engine/mesh/surface_reader.h"

#include <Eigen/LU>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>
#include <vector>

namespace ringdown::mesh {
namespace {

std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text.empty() ? "it is no such file" : text;
}

struct Soup {
  std::vector<Eigen::RowVector3d> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

void add(Soup& soup, const aiMesh& mesh, const aiMatrix4x4& place) {
  const auto first = static_cast<std::int32_t>(soup.points.size());
  Eigen::Matrix4d transform;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) transform(row, column) = place[row][column];
  }
  const bool mirrored = transform.topLeftCorner<3, 3>().determinant() < 0;
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D& at = mesh.mVertices[v];
    const Eigen::Vector4d moved = transform * Eigen::Vector4d(at.x, at.y, at.z, 1);
    soup.points.emplace_back(moved.head<3>().transpose());
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;
    std::array<std::int32_t, 3> corners{};
    bool known = true;
    for (unsigned i = 0; i < 3; ++i) {
      known = known && face.mIndices[i] < mesh.mNumVertices;
      corners[i] = first + static_cast<std::int32_t>(face.mIndices[i]);
    }
    if (!known) continue;
    if (mirrored) std::swap(corners[1], corners[2]);
    soup.triangles.push_back(corners);
  }
}

struct Placed {
  const aiNode* node;
  aiMatrix4x4 place;
};

Result<Soup> collect(const aiScene& scene, const std::string& name) {
  Soup soup;
  std::vector<Placed> open = {{scene.mRootNode, scene.mRootNode->mTransformation}};
  while (!open.empty()) {
    const auto [node, place] = open.back();
    open.pop_back();
    for (unsigned m = 0; m < node->mNumMeshes; ++m) {
      const aiMesh& mesh = *scene.mMeshes[node->mMeshes[m]];
      if (soup.triangles.size() + mesh.mNumFaces > kMaxTriangles || soup.points.size() > 3 * kMaxTriangles) {
        return fail(ErrorKind::too_large, name + " has more than " + std::to_string(kMaxTriangles) +
                                              " triangles; thin it out in a mesh tool first");
      }
      add(soup, mesh, place);
    }
    for (unsigned c = 0; c < node->mNumChildren; ++c) {
      open.push_back({node->mChildren[c], place * node->mChildren[c]->mTransformation});
    }
  }
  return soup;
}

TriangleMesh packed(const Soup& soup) {
  TriangleMesh mesh;
  mesh.nodes.resize(static_cast<Eigen::Index>(soup.points.size()), 3);
  mesh.triangles.resize(static_cast<Eigen::Index>(soup.triangles.size()), 3);
  for (std::size_t i = 0; i < soup.points.size(); ++i) mesh.nodes.row(static_cast<Eigen::Index>(i)) = soup.points[i];
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) mesh.triangles(static_cast<Eigen::Index>(t), i) = soup.triangles[t][i];
  }
  return mesh;
}

// Of the points that triangles use.
double diagonal(const TriangleMesh& mesh) {
  Eigen::RowVector3d low = Eigen::RowVector3d::Constant(HUGE_VAL), high = -low;
  for (const std::int32_t corner : mesh.triangles.reshaped()) {
    low = low.cwiseMin(mesh.nodes.row(corner));
    high = high.cwiseMax(mesh.nodes.row(corner));
  }
  return (high - low).norm();
}

Result<Soup> import(const std::filesystem::path& path) {
  const std::string name = path.string();
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate | aiProcess_SortByPType);
  if (!scene || !scene->mRootNode)
    return fail(ErrorKind::bad_input, "cannot read " + name + ": " + one_line(importer.GetErrorString()));
  return collect(*scene, name);
}

// assimp reads what is there of a .glb that was cut off.
Result<void> check_length(const std::filesystem::path& path) {
  if (ending_of(path) != ".glb") return {};
  std::ifstream file(path, std::ios::binary);
  std::array<char, 12> head{};
  std::uint32_t length = 0;
  std::error_code error;
  if (file.read(head.data(), head.size())) std::memcpy(&length, &head[8], sizeof length);
  if (length <= std::filesystem::file_size(path, error)) return {};
  return fail(ErrorKind::bad_input,
              path.string() + " was cut off: it says to be " + std::to_string(length) + " bytes long");
}

Result<TriangleMesh> checked(const std::filesystem::path& path) {
  const std::string name = path.string();
  if (auto whole = check_length(path); !whole) return fail(whole.error());
  const Result<Soup> soup = import(path);
  if (!soup) return fail(soup.error());
  if (soup->triangles.empty()) return fail(ErrorKind::bad_input, name + " has no triangles; a body needs a surface");
  const TriangleMesh mesh = packed(*soup);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int i = 0; i < 3; ++i) {
      if (mesh.nodes.row(mesh.triangles(t, i)).allFinite()) continue;
      return fail(ErrorKind::bad_input,
                  name + ": a corner of triangle " + std::to_string(t) + " is not a finite number");
    }
  }
  const double length = diagonal(mesh);
  if (!(length > 0)) return fail(ErrorKind::bad_input, name + ": all its points are one; a body needs a surface");
  return weld(mesh, kWeld * length);
}

}  // namespace

bool is_surface_file(const std::filesystem::path& path) {
  constexpr std::array kEndings = {".obj", ".stl", ".ply", ".off", ".gltf", ".glb"};
  return std::find(kEndings.begin(), kEndings.end(), ending_of(path)) != kEndings.end();
}

Result<TriangleMesh> read_surface(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return fail(ErrorKind::bad_input, "cannot open " + path.string() + ": there is no such file");
  }
  if (std::filesystem::file_size(path, error) > kMaxSurfaceFileBytes) {
    return fail(ErrorKind::too_large, path.string() + " is larger than " + std::to_string(kMaxSurfaceFileBytes >> 20) +
                                          " MiB; thin it out first");
  }
  try {
    return checked(path);
  } catch (const std::exception& exception) {
    return fail(ErrorKind::bad_input, "cannot read " + path.string() + ": " + one_line(exception.what()));
  }
}

}  // namespace ringdown::mesh
