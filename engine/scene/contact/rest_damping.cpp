#include "engine/scene/contact/rest_damping.h"

#include "engine/scene/contact/contact_rules.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace ringdown::scene {

RestDampings::RestDampings(const SceneDescription& scene)
    : coefficient_s_m_(scene.contact.rest_damping_s_m), resting_(scene.step_s) {}

void RestDampings::side_changed(const ContactSide& side) {
  if (side.object) to_check_.insert(*side.object);
}

void RestDampings::add(const PairContact& contact, std::span<const ContactPoint* const> points) {
  if (coefficient_s_m_ > 0) resting_.add(contact, points);
}

std::span<const RestDamping> RestDampings::advance(std::span<const MovedBody> moved, const ContactSides& sides,
                                                   synth::Frame frame) {
  changed_.clear();
  for (const BodyId id : resting_.advance(moved)) {
    if (const ContactSide* side = find(sides, id)) side_changed(*side);
  }
  for (const synth::ObjectNumber object : std::exchange(to_check_, {})) check(object, sides, frame);
  return changed_;
}

std::vector<modal::Damper> RestDampings::dampers_of(synth::ObjectNumber object, const ContactSides& sides) const {
  std::vector<modal::Damper> dampers;
  const auto plays = [object](const auto& entry) { return entry.second.object == object; };
  if (std::ranges::count_if(sides, plays) != 1) return dampers;
  const auto& [id, side] = *std::ranges::find_if(sides, plays);
  resting_.each_of(id, [&, id = id, &side = side](const RestingContact& contact) {
    const bool is_first = contact.pair.first == id;
    const ContactSide* const other = find(sides, is_first ? contact.pair.second : contact.pair.first);
    if (!other) return;
    const Motion& motion = is_first ? contact.first : contact.second;
    const double lost = 1 - combine(side.surface, other->surface).restitution;
    const double each_n = contact.force_n / static_cast<double>(contact.points.size());
    for (const RestingContact::Point& point : contact.points) {
      dampers.push_back({to_object(motion, side, point.point_m), transpose(to_matrix(motion.rotation)) * point.normal,
                         coefficient_s_m_ * lost * each_n});
    }
  });
  return dampers;
}

// Reports an object's dampers, the strongest first. An object without any is reported once more, to end them.
void RestDampings::check(synth::ObjectNumber object, const ContactSides& sides, synth::Frame frame) {
  std::vector<modal::Damper> dampers = dampers_of(object, sides);
  if (dampers.empty() && damped_.erase(object) == 0) return;
  if (!dampers.empty()) damped_.insert(object);
  std::ranges::stable_sort(dampers, std::greater{}, &modal::Damper::damping_ns_m);
  RestDamping damping{.frame = frame, .object = object, .dampers = {}};
  for (std::uint32_t i = 0; i < modal::kMaxDampers - modal::kFirstSceneDamper; ++i) {
    damping.dampers[modal::kFirstSceneDamper + i] = i < dampers.size() ? dampers[i] : modal::Damper{};
  }
  changed_.push_back(std::move(damping));
}

}  // namespace ringdown::scene
