// Finds how much resting contacts damp the objects of the bodies in contact. Free of any physics engine. [one thread
// at a time]
#pragma once

#include "engine/modal/damper.h"
#include "engine/scene/contact/contact_side.h"
#include "engine/scene/contact/resting_contacts.h"
#include "engine/synth/events/event.h"

#include <set>
#include <span>
#include <vector>

namespace ringdown::scene {

// All resting contacts of an object in its scene, as dampers numbered from modal::kFirstSceneDamper. A contact that has
// ended is listed with zero damping.
struct RestDamping {
  synth::Frame frame = 0;
  synth::ObjectNumber object = 0;
  modal::Dampers dampers;
};

// Finds the objects whose resting contacts have changed, and their dampers. A contact point with normal force F between
// surfaces with the restitution e damps by c (1 - e) F, with the scene's coefficient c (ContactSettings). An object
// that several bodies share is not damped, because the bodies share its modes.
class RestDampings {
 public:
  explicit RestDampings(const SceneDescription& scene);

  // Call when the body that plays an object was added, changed or removed.
  void side_changed(const ContactSide& side);
  void remove(BodyId id) { resting_.remove(id); }
  void silence(synth::ObjectNumber object) { damped_.erase(object); }

  // Adds the contact of a pair that touches without striking, and its points.
  void add(const PairContact& contact, std::span<const ContactPoint* const> points);

  // Ends a step in which the bodies `moved` moved. Returns the objects whose dampers have changed, valid until the next
  // call.
  std::span<const RestDamping> advance(std::span<const MovedBody> moved, const ContactSides& sides, synth::Frame frame);

  // Returns whether an object must be checked at the next advance() even if nothing moves.
  [[nodiscard]] bool has_unchecked() const { return !to_check_.empty(); }
  [[nodiscard]] bool pending() const { return has_unchecked() || resting_.pending(); }

 private:
  [[nodiscard]] std::vector<modal::Damper> dampers_of(synth::ObjectNumber object, const ContactSides& sides) const;
  void check(synth::ObjectNumber object, const ContactSides& sides, synth::Frame frame);

  double coefficient_s_m_;
  RestingContacts resting_;
  std::set<synth::ObjectNumber> damped_,
      to_check_;  // objects last reported with dampers; objects to check
  std::vector<RestDamping> changed_;
};

}  // namespace ringdown::scene
