// Animations of the nodes of a glTF document. [worker]
//
// All animations of the file play at once, from the scene's beginning, over and over, as viewers play them.
#pragma once

#include "engine/scene/gltf/document.h"
#include "engine/scene/motion_path.h"

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

namespace ringdown::scene {

class GltfAnimations {
 public:
  static constexpr double kEvery_s = 1.0 / 240;  // between the poses of a path
  static constexpr std::size_t kMaxPoses =
      std::size_t{1} << 20;  // of all paths of a scene together, each times the nodes from its own up to the root
  static constexpr std::size_t kMaxKeys = std::size_t{1} << 16;     // of one channel
  static constexpr std::size_t kMaxAllKeys = std::size_t{1} << 22;  // of all channels together

  // Reads the channels that move or turn nodes. What is refused or left out, the document notes.
  explicit GltfAnimations(GltfDocument& document);

  // The path of a node's frame in the world; null where neither the node nor one above it is animated, and where the
  // paths of the scene have too many poses already, which the notes then say.
  std::shared_ptr<const MotionPath> path_of(std::size_t node);

 private:
  enum class Target { translation, rotation, scale };
  enum class Way { linear, step, cubic };
  struct Channel {
    Target target;
    Way way;
    std::vector<float> times_s, values;
  };
  void add(const modal::Field& animation);
  [[nodiscard]] Affine local_at(std::size_t node, double time_s) const;
  static std::vector<double> value_at(const Channel& channel, double time_s);

  GltfDocument& document_;
  std::map<std::size_t, std::vector<Channel>> channels_;  // by their nodes
  double length_s_ = 0;
  std::size_t keys_ = 0, poses_ = 0;
};

}  // namespace ringdown::scene
