#include "engine/scene/contact/lasting_events.h"

#include "engine/scene/contact/contact_rules.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {

void StepEvents::push(const synth::Event& event) {
  if (events.size() == kMaxEventsPerStep) {
    ++dropped;
    return;
  }
  events.push_back(event);
}

void LastingEvents::add(const ContactReport& report, const ContactSides& sides, synth::Frame frame,
                        StepEvents& events) {
  const ContactSide *first = find(sides, report.pair.first), *second = find(sides, report.pair.second);
  const Felt both = first && second ? felt(report, *first, *second) : Felt{};
  const std::array<Half, 2> halves{Half{first, report.first, report.force_n, report.normal, -1 * report.slide_m_s},
                                   {second, report.second, -1 * report.force_n, -1 * report.normal, report.slide_m_s}};
  Numbers& numbers = numbers_[report.pair];
  if (!numbers.of[0] && !numbers.of[1]) {
    numbers.two_way = first && second && (first->two_way || second->two_way) && (first->mass || second->mass);
  }
  const std::size_t struck = first && first->object ? 0 : 1;
  for (std::size_t k = 0; k < halves.size(); ++k) {
    if (numbers.two_way && !numbers.of[k] && k != struck) continue;
    const std::optional<Heard> heard = contact_of(report, halves[k], numbers.of[k], both);
    if (!heard) continue;
    synth::Event event{.frame = frame, .object = heard->object, .verb = heard->contact};
    if (numbers.two_way) event.verb = feel_back(*heard, report.point_m, halves[k], halves[1 - k]);
    events.push(event);
  }
  if (!numbers.of[0] && !numbers.of[1]) numbers_.erase(report.pair);
}

LastingEvents::Felt LastingEvents::felt(const ContactReport& report, const ContactSide& first,
                                        const ContactSide& second) {
  Felt both{.texture = combine(first.surface, second.surface).texture};
  both.surfaces[0] = {first.surface.relief.get(), report.over_first_m_s};
  both.surfaces[1] = {second.surface.relief.get(), report.over_second_m_s};
  both.widths = filter_widths(first, second, length(report.force_n));
  return both;
}

std::optional<LastingEvents::Heard> LastingEvents::contact_of(const ContactReport& report, const Half& half,
                                                              std::optional<Number>& number, const Felt& felt) {
  const bool sounds = half.side && half.side->object;
  if (!number && (!sounds || report.ends)) return {};
  if (!number) number = Number{*half.side->object, take_number(*half.side->object)};
  Heard heard{number->object, {}};
  synth::Contact& contact = heard.contact.contact;
  contact.number = number->number;
  if (!report.ends && sounds && half.side->object == number->object) {
    heard.contact.point_m = to_object(half.motion, *half.side, report.point_m);
    contact.force_n = transpose(to_matrix(half.motion.rotation)) * half.force_n;
    contact.slip_m_s = report.slip_m_s;
    contact.roll_m_s = report.roll_m_s;
    contact.texture = felt.texture;
    contact.surfaces = felt.surfaces;
    contact.finish_width_m = felt.widths.finish_m;
    contact.relief_width_m = felt.widths.relief_m;
  } else {
    taken_[number->object][number->number] = false;
    number.reset();
  }
  return heard;
}

// The bodies' common mass lies on the struck one, pressed on by the normal part of the force.
synth::verb::Rub LastingEvents::feel_back(const Heard& heard, Vec3 point_m, const Half& struck, const Half& other) {
  synth::verb::Rub rub{.point_m = heard.contact.point_m, .contact = heard.contact.contact};
  const double load_n = dot(struck.force_n, struck.push);
  if (length(rub.contact.force_n) == 0 || !(load_n > 0)) return rub;  // it ends
  const Matrix3 to_frame = transpose(to_matrix(struck.motion.rotation));
  const double inverse = inverse_mass(*struck.side, struck.motion, point_m, struck.push) +
                         inverse_mass(*other.side, other.motion, point_m, struck.push);
  const double depth_m = pressed_depth(*struck.side, *other.side, inverse, load_n);
  const SurfacePair surfaces = combine(struck.side->surface, other.side->surface);
  rub.direction = to_frame * struck.push;
  rub.slide_m_s = to_frame * struck.passing_m_s;
  rub.load_n = load_n;
  rub.mass_kg = 1 / inverse;
  rub.stiffness = std::clamp(load_n / std::pow(depth_m, 1.5), 1.0, 1e15);
  rub.friction = std::min(surfaces.friction, 10.0);
  if (surfaces.friction > 0) rub.sliding = std::min(surfaces.sliding_friction / surfaces.friction, 1.0);
  if (!other.side->object || *other.side->object == heard.object) return rub;
  rub.other = *other.side->object;
  rub.other_point_m = to_object(other.motion, *other.side, point_m);
  rub.to_other = ringdown::inverse(other.motion.rotation) * struck.motion.rotation;
  return rub;
}

// Takes the smallest number that none of the object's lasting contacts has.
std::uint32_t LastingEvents::take_number(synth::ObjectNumber object) {
  std::vector<bool>& taken = taken_[object];
  const auto free = std::ranges::find(taken, false);
  const auto number = static_cast<std::uint32_t>(free - taken.begin());
  if (free == taken.end()) taken.push_back(false);
  taken[number] = true;
  return number;
}

}  // namespace ringdown::scene
