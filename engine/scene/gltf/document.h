// The nodes of a glTF document with their poses, and checked access to its numbers, which keeps the first error. Used
// by the reader of scenes (gltf/scene.h). [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/glb.h"
#include "engine/scene/rotation.h"

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::scene {

inline constexpr std::size_t kMaxNodes = 16384;
inline constexpr const char* kPhysicsExtension = "KHR_physics_rigid_bodies";
inline constexpr const char* kAudioExtension = "KHR_audio_rigid_bodies";
inline constexpr const char* kShapesExtension = "KHR_implicit_shapes";

// An affine map: a point p of the inner frame lies at linear p + shift_m.
struct Affine {
  Matrix3 linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 shift_m;
};
Affine operator*(const Affine& outer, const Affine& inner);
Vec3 operator*(const Affine& map, Vec3 point_m);

// Returns the affine map of a pose, and the inverse: from world coordinates to the pose's frame.
Affine to_affine(const Pose& pose);
Affine inverse(const Pose& pose);

// Converts a map of the file, in which y points up, to our axes, in which z points up.
Affine upright(const Affine& map);

// A linear map as lengths along its columns and a rotation, and whether these represent it exactly: the columns of a
// sheared map are not at right angles. For a mirror, one column of the rotation is reversed.
struct Parts {
  Vec3 scale;  // >= 0
  Rotation rotation;
  bool mirrored = false, sheared = false;
};
Parts parts_of(const Matrix3& linear);

struct GltfNode {
  modal::JsonPlace field;
  std::string name;  // never empty
  std::optional<std::size_t> parent;
  std::vector<std::size_t> children;
  Affine local, world;    // relative to the parent; relative to the scene, with z up
  bool in_scene = false;  // whether the node is below a root of the scene that is played
};

// Sentences about parts of a scene that Ringdown does not play, each listed once.
class GltfNotes {
 public:
  void add(const std::string& sentence);
  [[nodiscard]] const std::vector<std::string>& sentences() const { return sentences_; }

 private:
  std::set<std::string> known_;
  std::vector<std::string> sentences_;
};

class GltfDocument {
 public:
  // Reads the nodes. A mesh whose skin follows one bone rigidly becomes a node below that bone; a mesh that several
  // bones bend stays where it is, which the notes say. Fails on indices that refer to nothing, on nodes with two
  // parents or within themselves, and on poses that are not finite.
  static Result<GltfDocument> read(const modal::Glb& glb);

  [[nodiscard]] const std::vector<GltfNode>& nodes() const { return nodes_; }
  [[nodiscard]] modal::JsonPlace root() const { return glb_->root(); }
  [[nodiscard]] const modal::Glb& glb() const { return *glb_; }

  // Each returns the fallback when the field is absent, and notes an error when it is wrong.
  double number(const modal::JsonPlace& field, double fallback);
  bool flag(const modal::JsonPlace& field, bool fallback);
  Vec3 vector(const modal::JsonPlace& field, Vec3 fallback);
  Rotation rotation(const modal::JsonPlace& field);
  std::vector<std::string> texts(const modal::JsonPlace& field);

  // Returns the element of `list` that the field refers to; absent if the field is absent.
  modal::JsonPlace element(const modal::JsonPlace& field, const modal::JsonPlace& list);

  // Notes the first error.
  void refuse(const tl::unexpected<Error>& error);
  [[nodiscard]] Result<void> result() const;

  GltfNotes notes;

 private:
  explicit GltfDocument(const modal::Glb& glb) : glb_(&glb) {}
  void link_nodes();
  void place_nodes();
  void place_skins();
  [[nodiscard]] Affine local_of(std::size_t number_of_node);

  const modal::Glb* glb_;
  std::vector<GltfNode> nodes_;
  std::optional<Error> error_;
};

}  // namespace ringdown::scene
