#include "engine/scene/contact_life.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

// Step times are sums of steps: without this, a repeat time of exactly n steps would sometimes wait for n + 1.
constexpr double kRounding_s = 1e-9;

Vec3 to_frame(const Motion& motion, Vec3 world_m) {
  return transpose(to_matrix(motion.rotation)) * (world_m - motion.position_m);
}

}  // namespace

ContactLives::ContactLives(double minimum_repeat_s, double step_s)
    : minimum_repeat_s_(minimum_repeat_s),
      step_s_(step_s),
      tell_every_(std::max(1, static_cast<int>(std::lround(kTellEvery_s / step_s)))) {}

bool ContactLives::strikes(BodyPair pair, double approach_m_s, double now_s) {
  Life& life = lives_[pair];
  life.last_touch_s = now_s;
  const bool rested = now_s - life.last_blow_s >= minimum_repeat_s_ - kRounding_s;
  life.last_blow_s = now_s;
  if (!rested && !(approach_m_s > 2 * life.heard_m_s)) return false;
  life.heard_m_s = approach_m_s;
  return true;
}

void ContactLives::touch(const Touching& touching, double now_s) {
  Life& life = lives_[touching.pair];
  life.last_touch_s = now_s;
  life.touches = true;
  const double weight = length(touching.impulse_ns);
  life.impulse_ns = life.impulse_ns + touching.impulse_ns;
  life.moment = life.moment + weight * touching.point_m;
  life.slip += weight * touching.slip_m_s;
  life.weight += weight;
  life.most_roll = std::max(life.most_roll, touching.most_roll_m_s);
  add_way(life, touching);
  life.latest = touching;
}

void ContactLives::add_way(Life& life, const Touching& touching) const {
  const Vec3 on_first = to_frame(touching.first, touching.point_m);
  const Vec3 on_second = to_frame(touching.second, touching.point_m);
  if (life.touched_before) {
    life.over_first_m = life.over_first_m + to_matrix(touching.first.rotation) * (on_first - life.on_first_m);
    life.over_second_m = life.over_second_m + to_matrix(touching.second.rotation) * (on_second - life.on_second_m);
    ++life.rolled;
  }
  life.on_first_m = on_first;
  life.on_second_m = on_second;
}

Telling ContactLives::tell(BodyPair pair, const Life& life) const {
  Telling telling{.pair = pair, .begins = !life.told, .first = life.latest.first, .second = life.latest.second};
  if (life.weight > 0) {
    telling.point_m = (1 / life.weight) * life.moment;
    telling.force_n = (1 / (life.steps * step_s_)) * life.impulse_ns;
    telling.slip_m_s = life.slip / life.weight;
  }
  // What slides leaves one of its surfaces where it is; only rolling takes the contact along on both.
  if (life.rolled > 0) {
    const double way_m = std::min(length(life.over_first_m), length(life.over_second_m));
    telling.roll_m_s = std::min(way_m / (life.rolled * step_s_), life.most_roll);
  }
  const double slowest = life.told ? 0.5 * kMinContactSpeed_m_s : kMinContactSpeed_m_s;
  telling.ends = !(life.weight > 0) || std::max(telling.slip_m_s, telling.roll_m_s) < slowest;
  return telling;
}

std::span<const Telling> ContactLives::advance(double now_s) {
  tellings_.clear();
  for (auto entry = lives_.begin(); entry != lives_.end();) {
    auto& [pair, life] = *entry;
    if (++life.steps >= tell_every_) {
      const Telling telling = tell(pair, life);
      if (!telling.ends || life.told) tellings_.push_back(telling);
      life.told = !telling.ends;
      life.steps = life.rolled = 0;
      life.weight = life.slip = life.most_roll = 0;
      life.impulse_ns = life.moment = life.over_first_m = life.over_second_m = {};
    }
    life.touched_before = std::exchange(life.touches, false);
    const bool over = !life.told && now_s - life.last_touch_s > minimum_repeat_s_;
    entry = over ? lives_.erase(entry) : std::next(entry);
  }
  return tellings_;
}

}  // namespace ringdown::scene
