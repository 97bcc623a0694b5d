#include "engine/scene/contact/contact_life.h"

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
      report_every_(std::max(1, static_cast<int>(std::lround(kReportEvery_s / step_s)))) {}

bool ContactLives::strikes(BodyPair pair, double approach_m_s, double now_s) {
  Life& life = lives_[pair];
  life.last_contact_s = now_s;
  const bool paused = now_s - life.last_impact_s >= minimum_repeat_s_ - kRounding_s;
  life.last_impact_s = now_s;
  if (!paused && !(approach_m_s > 2 * life.last_strike_m_s)) return false;
  life.last_strike_m_s = approach_m_s;
  return true;
}

void ContactLives::add(const PairContact& contact, double now_s) {
  Life& life = lives_[contact.pair];
  life.last_contact_s = now_s;
  life.touches = true;
  const double weight = length(contact.impulse_ns);
  life.impulse_ns = life.impulse_ns + contact.impulse_ns;
  life.moment = life.moment + weight * contact.point_m;
  life.normals = life.normals + weight * contact.normal;
  life.slides = life.slides + weight * contact.slide_m_s;
  life.slip += weight * length(contact.slide_m_s);
  life.weight += weight;
  life.max_roll = std::max(life.max_roll, contact.max_roll_m_s);
  add_way(life, contact);
  life.latest = contact;
}

void ContactLives::add_way(Life& life, const PairContact& contact) const {
  const Vec3 on_first = to_frame(contact.first, contact.point_m);
  const Vec3 on_second = to_frame(contact.second, contact.point_m);
  if (life.touched_before) {
    life.over_first_m = life.over_first_m + to_matrix(contact.first.rotation) * (on_first - life.on_first_m);
    life.over_second_m = life.over_second_m + to_matrix(contact.second.rotation) * (on_second - life.on_second_m);
    ++life.rolled;
  }
  life.on_first_m = on_first;
  life.on_second_m = on_second;
}

// Force is the mean over the time since the last report; point and slip are means weighted by force. The rolling speed
// comes from the way of the contact point over the surfaces: of the two bodies' ways, the shorter one.
ContactReport ContactLives::report(BodyPair pair, const Life& life) const {
  ContactReport result{
      .pair = pair, .begins = !life.reported, .first = life.latest.first, .second = life.latest.second};
  if (life.weight > 0) {
    result.point_m = (1 / life.weight) * life.moment;
    result.force_n = (1 / (life.steps * step_s_)) * life.impulse_ns;
    if (length(life.normals) > 0) result.normal = (1 / length(life.normals)) * life.normals;
    result.slide_m_s = (1 / life.weight) * life.slides;
    result.slip_m_s = life.slip / life.weight;
  }
  // The contact point of a sliding body stays where it is on one of the surfaces; only rolling moves it over both.
  if (life.rolled > 0) {
    const double way_m = std::min(length(life.over_first_m), length(life.over_second_m));
    result.roll_m_s = std::min(way_m / (life.rolled * step_s_), life.max_roll);
    const double max = life.max_roll + result.slip_m_s;
    result.over_first_m_s = std::min(length(life.over_first_m) / (life.rolled * step_s_), max);
    result.over_second_m_s = std::min(length(life.over_second_m) / (life.rolled * step_s_), max);
  }
  const double slowest = life.reported ? 0.5 * kMinContactSpeed_m_s : kMinContactSpeed_m_s;
  result.ends = !(life.weight > 0) || std::max(result.slip_m_s, result.roll_m_s) < slowest;
  return result;
}

std::span<const ContactReport> ContactLives::end(BodyId body) {
  reports_.clear();
  lives_.erase_if([&](BodyPair pair, Life& life) {
    if (pair.first != body && pair.second != body) return false;
    if (life.reported) reports_.push_back({.pair = pair, .ends = true});
    life = {.last_contact_s = life.last_contact_s,
            .last_impact_s = life.last_impact_s,
            .last_strike_m_s = life.last_strike_m_s};
    return false;
  });
  return reports_;
}

void ContactLives::pass_on(BodyPair from, BodyPair to) {
  const Life& before = lives_[from];
  const Life after{.last_contact_s = before.last_contact_s,
                   .last_impact_s = before.last_impact_s,
                   .last_strike_m_s = before.last_strike_m_s};
  lives_[to] = after;
  lives_.erase(from);
}

// A contact's life ends when it has not been touched for the minimum repeat time, after its end has been reported.
std::span<const ContactReport> ContactLives::advance(double now_s) {
  reports_.clear();
  lives_.erase_if([&](BodyPair pair, Life& life) {
    if (++life.steps >= report_every_) {
      const ContactReport latest = report(pair, life);
      if (!latest.ends || life.reported) reports_.push_back(latest);
      life.reported = !latest.ends;
      life.steps = life.rolled = 0;
      life.weight = life.slip = life.max_roll = 0;
      life.impulse_ns = life.moment = life.normals = life.slides = life.over_first_m = life.over_second_m = {};
    }
    life.touched_before = std::exchange(life.touches, false);
    return !life.reported && now_s - life.last_contact_s > minimum_repeat_s_;
  });
  return reports_;
}

}  // namespace ringdown::scene
