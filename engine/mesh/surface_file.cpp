#include "engine/mesh/surface_file.h"

#include <Eigen/LU>
#include <assimp/DefaultIOSystem.h>
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
#include <string>
#include <unordered_map>
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

// Lets assimp open the file itself and, for glTF, what lies beside it or below: an OBJ names a file of materials, which
// has no place in a body, and may name any.
class FolderOnly : public Assimp::DefaultIOSystem {
 public:
  explicit FolderOnly(const std::filesystem::path& path)
      : path_(path), whole_folder_(ending_of(path) == ".gltf"), folder_(resolved(path).parent_path()) {}

  [[nodiscard]] bool Exists(const char* name) const override { return may(name) && DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    return may(name) && std::string_view(mode).starts_with("r") ? DefaultIOSystem::Open(name, mode) : nullptr;
  }

 private:
  static std::filesystem::path resolved(const std::filesystem::path& path) {
    std::error_code error;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path), error);
  }
  [[nodiscard]] bool may(const char* name) const {
    if (path_ == name) return true;
    const std::filesystem::path named = resolved(name);
    return whole_folder_ &&
           std::mismatch(folder_.begin(), folder_.end(), named.begin(), named.end()).first == folder_.end();
  }

  std::filesystem::path path_;
  bool whole_folder_;
  std::filesystem::path folder_;
};

Result<Soup> import(const std::filesystem::path& path) {
  const std::string name = path.string();
  Assimp::Importer importer;
  importer.SetIOHandler(new FolderOnly(path));  // the importer's own from here on
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
  const double length = diagonal_of(mesh);
  if (!(length > 0)) return fail(ErrorKind::bad_input, name + ": all its points are one; a body needs a surface");
  return weld(mesh, kWeld * length);
}

}  // namespace

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

namespace {

// Welding
//
// Points are taken in the order in which triangles name them. Each is looked up among the points kept so far; when one
// of them lies within the tolerance, the point becomes that one, otherwise it is kept. Kept points lie in the cells of
// a hash grid. A cell is 64 tolerances wide, so that a ball of one tolerance mostly lies in one cell and rarely touches
// eight; looking up a point costs a constant, and welding O(V).
using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0x9e3779b97f4a7c15;
    for (const std::int64_t c : cell) hash = (hash ^ static_cast<std::uint64_t>(c)) * 0xff51afd7ed558ccd + (hash >> 29);
    return hash;
  }
};

// Points in cells much larger than the tolerance: most need to look into one only.
class PointGrid {
 public:
  explicit PointGrid(double tolerance) : tolerance_(tolerance), cell_(64 * tolerance) {}

  // The number of a point within the tolerance; else `number`, which is then in the grid.
  std::int32_t find_or_add(const Eigen::RowVector3d& at, std::int32_t number) {
    Cell low, high;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = cell_of(at[axis] - tolerance_);
      high[axis] = cell_of(at[axis] + tolerance_);
    }
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto found = cells_.find({x, y, z});
          if (found == cells_.end()) continue;
          for (const auto& [other, place] : found->second) {
            if ((place - at).norm() <= tolerance_) return other;
          }
        }
      }
    }
    cells_[{cell_of(at[0]), cell_of(at[1]), cell_of(at[2])}].push_back({number, at});
    return number;
  }

 private:
  struct Entry {
    std::int32_t number;
    Eigen::RowVector3d at;
  };
  [[nodiscard]] std::int64_t cell_of(double x) const { return static_cast<std::int64_t>(std::floor(x / cell_)); }

  double tolerance_, cell_;
  std::unordered_map<Cell, std::vector<Entry>, CellHash> cells_;
};

}  // namespace

TriangleMesh weld(const TriangleMesh& mesh, double tolerance) {
  PointGrid grid(tolerance);
  std::vector<std::int32_t> number(static_cast<std::size_t>(mesh.nodes.rows()), -1);
  std::vector<Eigen::RowVector3d> kept;
  TriangleMesh welded{.nodes = {}, .triangles = mesh.triangles};
  for (std::int32_t& corner : welded.triangles.reshaped<Eigen::RowMajor>()) {
    std::int32_t& known = number[static_cast<std::size_t>(corner)];
    if (known < 0) {
      const Eigen::RowVector3d at = mesh.nodes.row(corner);
      const auto next = static_cast<std::int32_t>(kept.size());
      known = grid.find_or_add(at, next);
      if (known == next) kept.push_back(at);
    }
    corner = known;
  }
  welded.nodes.resize(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t i = 0; i < kept.size(); ++i) welded.nodes.row(static_cast<Eigen::Index>(i)) = kept[i];
  return welded;
}

}  // namespace ringdown::mesh
