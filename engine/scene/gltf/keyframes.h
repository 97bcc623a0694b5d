// Writes paths of bodies as an animation of glTF nodes. For the writer of scenes (gltf/writer.h). [worker]
#pragma once

#include "engine/gltf/glb.h"
#include "engine/scene/motion_path.h"

#include <cstddef>
#include <map>
#include <utility>

namespace ringdown::scene {

class KeyframeWriter {
 public:
  explicit KeyframeWriter(modal::GlbWriter& writer) : writer_(writer) {}

  // Adds translation and rotation of a node without a parent, one linear key for each pose. If `start_s` is positive,
  // the node is scaled to nothing until then.
  void add(std::size_t node, const MotionPath& path, double start_s);

  // Returns the document's list of animations; empty if no path was added.
  [[nodiscard]] modal::Json finished() const;

 private:
  void add_channel(std::size_t node, const char* target, std::size_t times, std::size_t values, const char* way);
  std::size_t times_of(const MotionPath& path);

  modal::GlbWriter& writer_;
  std::map<std::pair<double, std::size_t>, std::size_t> times_;  // accessors, by interval and number of poses
  modal::Json channels_ = modal::Json::array(), samplers_ = modal::Json::array();
};

}  // namespace ringdown::scene
