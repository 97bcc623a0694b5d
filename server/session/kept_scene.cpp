#include "server/session/kept_scene.h"

#include "engine/base/formatted.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace ringdown::session {
namespace {

// Moves the things that fit to the end of `target`.
template <class Thing, class Fits>
void move_if(std::vector<Thing>& things, std::vector<Thing>& target, Fits fits) {
  const auto gone = std::stable_partition(things.begin(), things.end(), [&](const Thing& one) { return !fits(one); });
  target.insert(target.end(), std::make_move_iterator(gone), std::make_move_iterator(things.end()));
  things.erase(gone, things.end());
}

template <class Thing>
void append(std::vector<Thing>& things, const std::vector<Thing>& more) {
  things.insert(things.end(), more.begin(), more.end());
}

}  // namespace

KeptScene::KeptScene(scene::SceneDescription description) : description_(std::move(description)) {
  scene::BodyId id = 0;
  for (const scene::BodyDescription& body : description_.bodies) names_[id++] = body.name;
}

// A dropped body is a [[body]]. If emitters scatter their bodies at random, a further body before the emitters would
// change the random places, so the dropped body becomes an emitter of one body after them.
void KeptScene::add(scene::BodyId id, scene::BodyDescription body, double now_s) {
  const auto is_taken = [this](const std::string& name) {
    return std::ranges::any_of(names_, [&](const auto& entry) { return entry.second == name; }) ||
           std::ranges::count(description_.emitters, name, &scene::EmitterDescription::name) > 0;
  };
  const std::string kind = std::exchange(body.name, body.name + "-1");
  for (int number = 2; is_taken(body.name); ++number) body.name = formatted("{}-{}", kind, number);
  body.start_s = now_s;
  names_[id] = body.name;
  const bool scatters =
      std::ranges::any_of(description_.emitters, [](const auto& emitter) { return emitter.body.scatter_m > 0; });
  if (scatters) {
    description_.emitters.push_back({.name = body.name, .body = body});
  } else {
    description_.bodies.push_back(std::move(body));
  }
}

void KeptScene::remove(scene::BodyId id) {
  const auto name = names_.find(id);
  if (name == names_.end()) return;
  Removed& removed = removed_[id];
  const auto has_name = [&](const auto& thing) { return thing.name == name->second; };
  move_if(description_.bodies, removed.bodies, has_name);
  if (removed.bodies.empty()) move_if(description_.emitters, removed.emitters, has_name);
  move_if(description_.joints, removed.joints, [&](const scene::JointDescription& joint) {
    return joint.body == name->second || joint.other == name->second;
  });
}

// If the other body of a joint is also out, the joint comes back with that body.
void KeptScene::restore(scene::BodyId id) {
  const auto found = removed_.find(id);
  if (found == removed_.end()) return;
  const Removed removed = std::move(found->second);
  removed_.erase(found);
  append(description_.bodies, removed.bodies);
  append(description_.emitters, removed.emitters);
  for (const scene::JointDescription& joint : removed.joints) {
    const auto still_out = std::ranges::find_if(removed_, [&](const auto& entry) {
      return names_.at(entry.first) == joint.body || names_.at(entry.first) == joint.other;
    });
    (still_out == removed_.end() ? description_.joints : still_out->second.joints).push_back(joint);
  }
}

void KeptScene::place(scene::BodyId id, const Pose& pose) {
  const auto name = names_.find(id);
  if (name == names_.end()) return;
  for (scene::BodyDescription& body : description_.bodies) {
    if (body.name == name->second) put_at_rest(body, pose);
  }
  for (scene::EmitterDescription& emitter : description_.emitters) {
    if (emitter.name == name->second) put_at_rest(emitter.body, pose);
  }
}

void KeptScene::clear() {
  description_.bodies.clear();
  description_.emitters.clear();
  description_.joints.clear();
  names_.clear();
  removed_.clear();
}

}  // namespace ringdown::session
