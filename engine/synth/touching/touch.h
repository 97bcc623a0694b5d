// A two-way contact as the mixer plays it, whichever verb it comes from: what touches the object feels how the object's
// surface moves under it, sample by sample (engine/contact). Directions are unit vectors in the object's frame. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/rotation.h"
#include "engine/base/vec3.h"
#include "engine/synth/events/verbs.h"

#include <cstdint>

namespace ringdown::synth {

struct Touch {
  enum class Kind : std::uint8_t { bow, mallet, couple, rub } kind = Kind::bow;
  std::uint32_t number = 0;  // which bow, coupling or rub of the object; every mallet is a new one
  Vec3 point_m;
  // bow: the hair moves that way; mallet: it flies that way; couple, rub: the object is pushed that way by the other.
  Vec3 direction;
  double speed_m_s = 0;  // bow, mallet
  Vec3 slide_m_s;        // rub: velocity of the other along the surface
  // bow, rub: pressed so hard, 0 ends it; couple: the other's weight, 0: both are held
  double force_n = 0;
  double mass_kg = 0;              // mallet, rub; couple: the other's, where it rests on the object by its weight
  double friction = 0;             // coefficient of static friction
  double sliding = 0.375;          // the share of it that is left at high speed
  double width_m = 0;              // bow
  double stiffness = 0;            // mallet, couple, rub: Hertz's k [N / m^1.5]; 0 ends a coupling
  double bounce = 1;               // mallet, couple: speed after over speed before an impact, 0.01 to 1
  double gap_m = 0;                // couple: between the surfaces at rest; negative: pressed together so deep
  ObjectNumber other = kNoObject;  // whose surface is on the other side, if any
  Vec3 other_point_m;              // in the other object's frame
  Vec3 other_direction;            // mallet: the way it is pushed, in its own frame; 0 0 0: against `direction`
  Rotation to_other;               // rub: turns the object's frame into the other's; couple: their axes are parallel
  Contact contact;                 // rub: how it sounds one-way
};

[[nodiscard]] Touch touch_of(const verb::Bow& bow) REALTIME;
[[nodiscard]] Touch touch_of(const verb::Mallet& mallet) REALTIME;
[[nodiscard]] Touch touch_of(const verb::Couple& couple) REALTIME;
[[nodiscard]] Touch touch_of(const verb::Collision& collision) REALTIME;
[[nodiscard]] Touch touch_of(const verb::Rub& rub) REALTIME;

template <class One>
concept TwoWay = requires(const One& one) {
  touch_of(one);
};

}  // namespace ringdown::synth
