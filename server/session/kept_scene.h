// The description of a scene as it would be saved: that of its file, with bodies that were dropped into the scene
// since, and without bodies that were taken out. [one thread at a time]
#pragma once

#include "engine/scene/body_store.h"
#include "engine/scene/description.h"

#include <map>
#include <string>
#include <vector>

namespace ringdown::session {

class KeptScene {
 public:
  KeptScene() = default;
  // The bodies of a file are numbered in the order of the file.
  explicit KeptScene(scene::SceneDescription description);

  // Adds a dropped body, which enters the scene at `now_s`.
  void add(scene::BodyId id, scene::BodyDescription body, double now_s);

  // Takes a body out, with its joints, or puts it back. Single bodies of a file's emitters stay in the description.
  void remove(scene::BodyId id);
  void restore(scene::BodyId id);
  // Lets a body begin elsewhere, at rest.
  void place(scene::BodyId id, const Pose& pose);
  void clear();  // removes all bodies

  [[nodiscard]] const scene::SceneDescription& description() const { return description_; }

 private:
  // A body that was taken out, as a body or as an emitter of one body, with its joints.
  struct Removed {
    std::vector<scene::BodyDescription> bodies;
    std::vector<scene::EmitterDescription> emitters;
    std::vector<scene::JointDescription> joints;
  };
  scene::SceneDescription description_;
  std::map<scene::BodyId, std::string> names_;  // of bodies in the description, also of those that were taken out
  std::map<scene::BodyId, Removed> removed_;
};

}  // namespace ringdown::session
