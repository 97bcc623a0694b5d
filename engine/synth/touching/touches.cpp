#include "engine/synth/touching/touches.h"

#include <algorithm>
#include <cmath>

namespace ringdown::synth {
namespace {

constexpr double kMaxTouchForce_n = 1e6, kMaxTouchSpeed_m_s = 1e3;

// Not-a-number lies in no range.
bool is_sane(const Touch& t) REALTIME {
  const auto within = [](double value, double min, double max) REALTIME { return value >= min && value <= max; };
  if (t.kind == Touch::Kind::rub && t.force_n == 0) return true;  // it ends, wherever it was
  const bool common = std::abs(dot(t.direction, t.direction) - 1) < 1e-6 && within(t.force_n, 0, kMaxTouchForce_n) &&
                      within(t.friction, 0, 10) && within(t.bounce, 0.01, 1);
  if (t.kind == Touch::Kind::bow) {
    return common && within(t.speed_m_s, -kMaxTouchSpeed_m_s, kMaxTouchSpeed_m_s) && within(t.width_m, 0, 1);
  }
  const bool pressed = t.stiffness == 0 || within(t.stiffness, 1, 1e15);
  const bool whole = pressed && t.stiffness > 0 && std::isfinite(dot(t.other_point_m, t.other_point_m));
  if (t.kind == Touch::Kind::rub) {
    return common && whole && within(t.mass_kg, 1e-9, 1e6) && within(t.sliding, 0, 1) &&
           length(t.slide_m_s) <= kMaxTouchSpeed_m_s;
  }
  if (t.kind == Touch::Kind::mallet) {
    return common && whole && within(t.mass_kg, 1e-6, 1e3) && within(t.speed_m_s, 0, kMaxTouchSpeed_m_s);
  }
  return common && pressed && within(t.mass_kg, 0, 1e6) && within(t.gap_m, -0.1, 1) && t.other < kMaxObjects &&
         std::isfinite(dot(t.other_point_m, t.other_point_m));
}

}  // namespace

Touch touch_of(const verb::Bow& bow) REALTIME {
  Touch touch{.kind = Touch::Kind::bow, .number = bow.number, .point_m = bow.point_m, .direction = bow.direction};
  touch.speed_m_s = bow.speed_m_s;
  touch.force_n = bow.force_n;
  touch.friction = bow.rosin;
  touch.width_m = bow.width_m;
  return touch;
}

Touch touch_of(const verb::Mallet& mallet) REALTIME {
  Touch touch{.kind = Touch::Kind::mallet, .point_m = mallet.point_m};
  touch.speed_m_s = length(mallet.velocity_m_s);
  touch.direction = (1 / touch.speed_m_s) * mallet.velocity_m_s;
  touch.mass_kg = mallet.mass_kg;
  touch.stiffness = mallet.head;
  touch.bounce = mallet.bounce;
  return touch;
}

Touch touch_of(const verb::Couple& couple) REALTIME {
  Touch touch{.kind = Touch::Kind::couple, .number = couple.number, .point_m = couple.point_m};
  touch.direction = couple.direction;
  touch.force_n = couple.weight_n;
  touch.mass_kg = couple.mass_kg;
  touch.gap_m = couple.gap_m;
  touch.stiffness = couple.stiffness;
  touch.friction = couple.friction;
  touch.bounce = couple.bounce;
  touch.other = couple.other;
  touch.other_point_m = couple.other_point_m;
  return touch;
}

Touch touch_of(const verb::Collision& hit) REALTIME {
  Touch touch{.kind = Touch::Kind::mallet, .point_m = hit.point_m, .direction = hit.direction};
  touch.speed_m_s = hit.speed_m_s;
  touch.mass_kg = hit.mass_kg;
  touch.stiffness = hit.stiffness;
  touch.bounce = hit.bounce;
  touch.other = hit.other;
  touch.other_point_m = hit.other_point_m;
  touch.other_direction = hit.other_direction;
  return touch;
}

Touch touch_of(const verb::Rub& rub) REALTIME {
  Touch touch{.kind = Touch::Kind::rub, .number = rub.contact.number, .point_m = rub.point_m};
  touch.direction = rub.direction;
  touch.slide_m_s = rub.slide_m_s;
  touch.force_n = rub.load_n;
  touch.mass_kg = rub.mass_kg;
  touch.friction = rub.friction;
  touch.sliding = rub.sliding;
  touch.stiffness = rub.stiffness;
  touch.other = rub.other;
  touch.other_point_m = rub.other_point_m;
  touch.to_other = rub.to_other;
  touch.contact = rub.contact;
  return touch;
}

Touches::Answer Touches::accept(const Touch& how, Frame frame, Object& object, Object* other, bool tight) REALTIME {
  if (!is_sane(how) || !std::isfinite(dot(how.point_m, how.point_m))) return Answer::refused;
  const bool couple = how.kind == Touch::Kind::couple, two = couple || other;
  if (how.kind != Touch::Kind::mallet) {
    const bool known = std::ranges::any_of(slots_, [&](const TouchSlot& slot) REALTIME {
      return slot.used && slot.sides[0].object == &object && slot.touch.kind == how.kind &&
             slot.touch.number == how.number && (!couple || how.stiffness == 0 || slot.sides[1].object == other);
    });
    if (known) return Answer::taken;
  }
  const bool ends = couple ? how.stiffness == 0 : how.kind != Touch::Kind::mallet && how.force_n == 0;
  if (ends) return Answer::nothing;
  if (tight || !can_touch(&object) || (two && (!can_touch(other) || other == &object))) return Answer::one_way;
  const auto slot = std::ranges::find_if(slots_, [](const TouchSlot& one) REALTIME { return !one.used; });
  if (slot == slots_.end()) return Answer::one_way;
  for (const TouchSlot::Side& side : slot->sides) {  // of a contact that ended in the last chunk
    if (side.object) side.object->touched = touches(*side.object);
  }
  slot->used = slot->stale = slot->fresh = true;
  slot->open = false;
  slot->touch = how;
  slot->sides[0].object = &object;
  slot->sides[1].object = two ? other : nullptr;
  slot->contact = {};
  slot->contact.on = false;
  slot->rigid = {};
  slot->speed_m_s = slot->force_n = {};
  slot->since = frame;
  if (how.kind == Touch::Kind::mallet || how.kind == Touch::Kind::rub) slot->rigid.kg = how.mass_kg;
  if (couple && how.force_n > 0) {
    slot->rigid.kg = how.mass_kg > 0 ? how.mass_kg : how.force_n / 9.81;
    slot->rigid.load_n = -how.force_n;
  }
  any_ = true;
  return Answer::taken;
}

// Contacts that share an object belong to one group, and so do those that share one with any of these.
void Touches::regroup() REALTIME {
  active_count_ = 0;
  if (!any_) return;
  for (TouchSlot& slot : slots_) {
    for (TouchSlot::Side& side : slot.sides) {
      if (side.object) side.object->touched = false;
      if (slot.used && side.object && !can_touch(side.object)) slot.used = slot.open = false;
    }
  }
  std::array<std::size_t, kMaxTouches> group{};
  for (std::size_t i = 0; i < kMaxTouches; ++i) group[i] = i;
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < kMaxTouches; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (!slots_[i].used || !slots_[j].used || group[i] == group[j]) continue;
        const bool share = std::ranges::any_of(slots_[j].sides, [&](const TouchSlot::Side& side) REALTIME {
          return side.object && slots_[i].involves(*side.object);
        });
        if (!share) continue;
        group[i] = group[j] = std::min(group[i], group[j]);
        again = true;
      }
    }
  }
  any_ = false;
  for (std::size_t g = 0; g < kMaxTouches; ++g) {
    std::array<TouchSlot*, kMaxTouches> members{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < kMaxTouches; ++i) {
      TouchSlot& slot = slots_[i];
      if (!slot.used) {
        slot.sides[0].object = slot.sides[1].object = nullptr;
      } else if (group[i] == g) {
        members[count++] = &slot;
        for (const TouchSlot::Side& side : slot.sides) {
          if (side.object) side.object->touched = true;
        }
      }
    }
    groups_[g].set({members.data(), count});
    if (count > 0) active_[active_count_++] = &groups_[g];
    any_ = any_ || count > 0;
  }
}

verb::Strike Touches::strike_of(const Touch& mallet, const Object& object) REALTIME {
  const Voice* const voice = object.voices.current();
  double kg = mallet.mass_kg;
  if (voice && voice->table().bank().mass && voice->table().bank().mass->mass_kg > 0) {
    kg = 1 / (1 / kg + 1 / voice->table().bank().mass->mass_kg);
  }
  const double speed = std::max(mallet.speed_m_s, 1e-3);
  return {.point_m = mallet.point_m,
          .impulse_ns = 2 * kg * mallet.speed_m_s * mallet.direction,
          .contact_time_s = std::min(0.1, 2.94 * std::pow(1.25 * kg * speed * speed / mallet.stiffness, 0.4) / speed)};
}

}  // namespace ringdown::synth
