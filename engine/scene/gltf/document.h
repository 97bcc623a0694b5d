// The nodes of a glTF document with their places, and its numbers with the first error kept. For the reader of scenes
// (gltf/scene.h). [worker]
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

// A linear map and a shift: a point p of the inner frame lies at linear p + shift_m.
struct Affine {
  Matrix3 linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 shift_m;
};
Affine operator*(const Affine& outer, const Affine& inner);
Vec3 operator*(const Affine& map, Vec3 point_m);

// The map that a pose is, and back from a pose's frame: a point of the world in that frame.
Affine to_affine(const Pose& pose);
Affine inverse(const Pose& pose);

// A map of the file, whose y points up, in our axes, whose z does.
Affine upright(const Affine& map);

// A linear map as lengths along its columns and a rotation, and whether that is all of it: the columns of a sheared
// map are not at right angles. A mirror's rotation has one column turned round.
struct Parts {
  Vec3 scale;  // >= 0
  Rotation rotation;
  bool mirrored = false, sheared = false;
};
Parts parts_of(const Matrix3& linear);

struct GltfNode {
  modal::Field field;
  std::string name;  // never empty
  std::optional<std::size_t> parent;
  std::vector<std::size_t> children;
  Affine local, world;    // in its parent; in the scene, whose z points up as ours does
  bool in_scene = false;  // below a root of the scene that is played
};

// Sentences about what a scene has and Ringdown does not play, each once.
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
  // Reads the nodes. Fails on indices that name nothing, on nodes with two parents or within themselves, and on places
  // that are not finite.
  static Result<GltfDocument> read(const modal::Glb& glb);

  [[nodiscard]] const std::vector<GltfNode>& nodes() const { return nodes_; }
  [[nodiscard]] modal::Field root() const { return glb_->root(); }
  [[nodiscard]] const modal::Glb& glb() const { return *glb_; }

  // Each returns the fallback when the field is absent, and notes an error when it is wrong.
  double number(const modal::Field& field, double fallback);
  bool flag(const modal::Field& field, bool fallback);
  Vec3 vector(const modal::Field& field, Vec3 fallback);
  Rotation rotation(const modal::Field& field);
  std::vector<std::string> texts(const modal::Field& field);

  // The element of `list` that the field names; absent when the field is.
  modal::Field element(const modal::Field& field, const modal::Field& list);

  // Notes the first error.
  void refuse(const tl::unexpected<Error>& error);
  [[nodiscard]] Result<void> result() const;

  GltfNotes notes;

 private:
  explicit GltfDocument(const modal::Glb& glb) : glb_(&glb) {}
  void link_nodes();
  void place_nodes();
  [[nodiscard]] Affine local_of(std::size_t number_of_node);
  std::vector<std::size_t> roots();

  const modal::Glb* glb_;
  std::vector<GltfNode> nodes_;
  std::optional<Error> error_;
};

}  // namespace ringdown::scene
