#include "server/session/variation.h"

#include <cmath>
#include <initializer_list>

namespace ringdown::session {
namespace {

// Numbers that follow from keys alone, by the mixing steps of SplitMix64 (Steele, Lea & Flood, OOPSLA 2014).
class Dice {
 public:
  Dice(std::initializer_list<std::uint64_t> keys) {
    for (const std::uint64_t key : keys) state_ = mixed(state_ ^ key);
  }
  std::uint64_t bits() { return mixed(state_ += 0x9e3779b97f4a7c15u); }
  double number() { return static_cast<double>(static_cast<std::int64_t>(bits())) * 0x1p-63; }  // in [-1, 1)

 private:
  static std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  std::uint64_t state_ = 0x9e3779b97f4a7c15u;
};

// Evenly spread in a ball of radius 1.
Vec3 in_ball(Dice& dice) {
  for (;;) {
    const Vec3 point{dice.number(), dice.number(), dice.number()};
    if (length(point) <= 1) return point;
  }
}

}  // namespace

void Variation::operator()(synth::Event& event) const {
  using namespace synth::verb;
  const auto frame = static_cast<std::uint64_t>(event.frame);
  // One blow is several events at one frame, whose contact times and impulses change alike.
  Dice blow{range_.seed, frame}, object{range_.seed, frame, event.object};
  const double longer = std::exp(std::log1p(range_.contact_time) * blow.number());
  const double harder = std::exp(std::log1p(range_.impulse) * blow.number());
  const Vec3 aside_m = range_.point_m * in_ball(object);
  if (auto* strike = event.verb.get_if<Strike>()) {
    strike->point_m = strike->point_m + aside_m;
    strike->contact_time_s *= longer;
    strike->impulse_ns = harder * strike->impulse_ns;
  } else if (auto* click = event.verb.get_if<Click>()) {
    click->contact_time_s *= longer;
    click->impulse_ns = harder * click->impulse_ns;
  } else if (auto* hit = event.verb.get_if<Collision>()) {
    hit->point_m = hit->point_m + aside_m;
    hit->contact_time_s *= longer;
    hit->impulse_ns = harder * hit->impulse_ns;
    hit->speed_m_s *= harder;
  }
  // The number of a contact is the seed of its roughness (engine/synth/contact/rubbing.h).
  const auto numbered = [&](std::uint32_t number) {
    return number + (static_cast<std::uint32_t>(Dice{range_.seed, 7}.bits()) & 0xffff0000u);
  };
  if (auto* contact = event.verb.get_if<Contact>()) contact->contact.number = numbered(contact->contact.number);
  if (auto* rub = event.verb.get_if<Rub>()) rub->contact.number = numbered(rub->contact.number);
}

}  // namespace ringdown::session
