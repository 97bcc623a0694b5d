#include "engine/scene/lasting_events.h"

#include "engine/scene/contact_rules.h"
#include "engine/scene/rotation.h"

#include <algorithm>

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
  Numbers& numbers = numbers_[report.pair];
  add_half(report, {first, report.first, report.force_n}, numbers.first, both, frame, events);
  add_half(report, {second, report.second, -1 * report.force_n}, numbers.second, both, frame, events);
  if (!numbers.first && !numbers.second) numbers_.erase(report.pair);
}

LastingEvents::Felt LastingEvents::felt(const ContactReport& report, const ContactSide& first,
                                        const ContactSide& second) {
  Felt both{.texture = combine(first.surface, second.surface).texture};
  both.surfaces[0] = {first.surface.relief.get(), report.over_first_m_s};
  both.surfaces[1] = {second.surface.relief.get(), report.over_second_m_s};
  both.widths = filter_widths(first, second, length(report.force_n));
  return both;
}

void LastingEvents::add_half(const ContactReport& report, const Half& half, std::optional<Number>& number,
                             const Felt& felt, synth::Frame frame, StepEvents& events) {
  const bool sounds = half.side && half.side->object;
  if (!number && (!sounds || report.ends)) return;
  if (!number) number = Number{*half.side->object, take_number(*half.side->object)};
  synth::Event event;
  event.frame = frame;
  event.type = synth::EventType::contact;
  event.object = number->object;
  event.contact.number = number->number;
  if (!report.ends && sounds && half.side->object == number->object) {
    event.point_m = to_object(half.motion, *half.side, report.point_m);
    event.contact.force_n = transpose(to_matrix(half.motion.rotation)) * half.force_n;
    event.contact.slip_m_s = report.slip_m_s;
    event.contact.roll_m_s = report.roll_m_s;
    event.contact.texture = felt.texture;
    event.contact.surfaces = felt.surfaces;
    event.contact.finish_width_m = felt.widths.finish_m;
    event.contact.relief_width_m = felt.widths.relief_m;
  } else {
    taken_[number->object][number->number] = false;
    number.reset();
  }
  events.push(event);
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
