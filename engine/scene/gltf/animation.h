// Animations of the nodes of a glTF document. [worker]
//
// All animations of the file play at once, from the scene's beginning, over and over, as viewers play them.
#pragma once

#include "engine/scene/foley/limits.h"
#include "engine/scene/gltf/document.h"
#include "engine/scene/motion_path.h"

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace ringdown::scene {

class GltfAnimations {
 public:
  static constexpr double kEvery_s = 1.0 / 240;  // between the poses of a path
  static constexpr std::size_t kMaxPoses =
      std::size_t{1} << 20;  // limit for all paths of a scene, each counted times its number of nodes up to the root
  static constexpr std::size_t kMaxKeys = std::size_t{1} << 16;     // keys of one channel
  static constexpr std::size_t kMaxAllKeys = std::size_t{1} << 22;  // keys of all channels together

  // Reads the channels that move or turn nodes. The document's notes name everything that is left out. With `foley`,
  // paths are played once, and have their poses at the frames of the file or as often as its limits say.
  explicit GltfAnimations(GltfDocument& document, const std::optional<FoleyLimits>& foley = {});

  [[nodiscard]] GltfDocument& document() { return document_; }
  [[nodiscard]] double length_s() const { return length_s_; }

  // Returns the path of a node's frame in the world. Null if neither the node nor any node above it is animated. Also
  // null, with a note, if the scene's paths already have too many poses.
  std::shared_ptr<const MotionPath> path_of(std::size_t node);

  // Returns from when on a node is to be seen: programs scale what is not there yet to nothing. 0: from the beginning.
  [[nodiscard]] double appears_s(std::size_t node) const;

 private:
  enum class Target { translation, rotation, scale };
  enum class Way { linear, step, cubic };
  struct Channel {
    Target target;
    Way way;
    std::vector<float> times_s, values;
  };
  void add(const modal::JsonPlace& animation);
  static bool is_hidden(const Channel& channel, std::size_t key);  // of a channel of scales, as changes_size()
  static bool changes_size(const Channel& channel);
  [[nodiscard]] Affine local_at(std::size_t node, double time_s) const;
  static std::vector<double> value_at(const Channel& channel, double time_s);

  GltfDocument& document_;
  std::map<std::size_t, std::vector<Channel>> channels_;  // indexed by node
  [[nodiscard]] double frame_s() const;

  bool once_ = false;
  double every_s_ = kEvery_s;
  double length_s_ = 0;
  std::size_t keys_ = 0, poses_ = 0;
};

}  // namespace ringdown::scene
