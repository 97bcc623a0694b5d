#include "engine/scene/foley/push_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::scene {
namespace {

constexpr int kMaxSweeps = 30;     // of one frame at a time
constexpr int kBlowPasses = 6;     // over all frames, with blows alone
constexpr int kPasses = 3;         // with loads
constexpr double kEnough = 1e-3;   // change of an impulse in a sweep, of the largest impulse
constexpr double kSeen = 0.05;     // weight of the moment that geometry sees against that which the frames tell
constexpr double kMaxEarly = 0.3;  // share of the interval by which both may differ

double inverse_mass_of(const PushedBody& body, Vec3 arm_m, Vec3 way) {
  const Vec3 turning = cross(arm_m, way);
  return body.inverse_mass + dot(turning, body.inverse_inertia * turning);
}

Vec3 speed_at(const PushedBody& body, Vec3 arm_m) { return body.speed_m_s + cross(body.spin_rad_s, arm_m); }

void take(PushedBody& body, Vec3 arm_m, Vec3 impulse_ns) {
  if (body.inverse_mass == 0) return;
  body.speed_m_s = body.speed_m_s - body.inverse_mass * impulse_ns;
  body.spin_rad_s = body.spin_rad_s - body.inverse_inertia * cross(arm_m, impulse_ns);
}

}  // namespace

std::size_t PushSystem::add(std::vector<PushContact> points) {
  const std::size_t first = contacts_.size();
  for (PushContact& point : points) {
    if (point.before > 0) contacts_of_[point.frame].push_back(contacts_.size());
    if (point.after > 0) contacts_of_[point.frame + 1].push_back(contacts_.size());
    contacts_.push_back(point);
  }
  return first;
}

// Computes how easily both bodies give way at a contact.
void PushSystem::prepare(std::size_t number) {
  const PushContact& contact = contacts_[number];
  const auto [one, two] = across(contact.normal);
  Yield& yield = yields_[number] = {{contact.normal, one, two}, {}};
  for (std::size_t w = 0; w < 3; ++w) {
    for (const auto& [frame, share] : {std::pair(contact.frame, contact.before), {contact.frame + 1, contact.after}}) {
      if (share > 0) yield.inverse_masses[w] += share * share * inverse_mass_at(contact, frame, yield.ways[w]);
    }
  }
}

std::size_t PushSystem::add_blow(std::vector<PushContact> points, double s) {
  for (PushContact& point : points) point.before = 1 - s, point.after = s;
  const std::size_t count = points.size(), first = add(std::move(points));
  is_load_.resize(contacts_.size(), false);
  moments_.push_back({first, count, s});
  return first;
}

std::size_t PushSystem::add_load(std::vector<PushContact> points) {
  const std::size_t first = add(std::move(points));
  is_load_.resize(contacts_.size(), true);
  return first;
}

void PushSystem::solve() {
  yields_.resize(contacts_.size());
  for (std::size_t k = 0; k < contacts_.size(); ++k) prepare(k);
  for (int pass = 0; pass < kBlowPasses; ++pass) {
    sweep_all(pass % 2 == 0, false);
    for (const Moment& moment : moments_) move(moment);
  }
  for (int pass = 0; pass < kPasses; ++pass) sweep_all(pass % 2 == 0, true);
}

void PushSystem::sweep_all(bool forward, bool loads) {
  const std::size_t frames = contacts_of_.size();
  for (std::size_t k = 0; k < frames; ++k) sweep(forward ? k : frames - 1 - k, loads);
}

void PushSystem::sweep(std::size_t frame, bool loads) {
  for (int round = 0; round < kMaxSweeps; ++round) {
    double change = 0, largest = 0;
    for (const std::size_t number : contacts_of_[frame]) {
      if (is_load_[number] && !loads) continue;
      change = std::max(change, improve(number));
      largest = std::max(largest, length(contacts_[number].impulse_ns));
    }
    if (change <= kEnough * largest) break;
  }
}

// Returns the speed of the two bodies against each other at the contact that is unexplained around a frame.
Vec3 PushSystem::unexplained_m_s(const PushContact& contact, std::size_t frame) const {
  return speed_at(slots_[frame * bodies_ + contact.first], contact.first_arm_m) -
         speed_at(slots_[frame * bodies_ + contact.second], contact.second_arm_m);
}

double PushSystem::inverse_mass_at(const PushContact& contact, std::size_t frame, Vec3 way) const {
  return inverse_mass_of(slots_[frame * bodies_ + contact.first], contact.first_arm_m, way) +
         inverse_mass_of(slots_[frame * bodies_ + contact.second], contact.second_arm_m, way);
}

// Explains more of the frames' pushes by these shares of an impulse.
void PushSystem::apply(PushContact& contact, Vec3 impulse_ns, double before, double after) {
  for (const auto& [frame, share] : {std::pair(contact.frame, before), {contact.frame + 1, after}}) {
    if (share == 0) continue;
    take(body(frame, contact.first), contact.first_arm_m, share * impulse_ns);
    take(body(frame, contact.second), contact.second_arm_m, -share * impulse_ns);
  }
}

// Returns the size of the change of the contact's impulse.
double PushSystem::improve(std::size_t number) {
  PushContact& contact = contacts_[number];
  const Yield& yield = yields_[number];
  const double b = contact.before, a = contact.after;
  const auto wanted_m_s = [&] {
    Vec3 wanted;
    if (b > 0) wanted = wanted + b * unexplained_m_s(contact, contact.frame);
    if (a > 0) wanted = wanted + a * unexplained_m_s(contact, contact.frame + 1);
    return wanted;
  };
  const auto step = [&](Vec3 speed_m_s, std::size_t way) {
    const double mass = yield.inverse_masses[way];
    return mass > 0 ? dot(speed_m_s, yield.ways[way]) / mass : 0;
  };
  const Vec3 start = contact.impulse_ns;
  const auto set = [&](Vec3 impulse_ns) {
    if (impulse_ns == contact.impulse_ns) return;
    apply(contact, impulse_ns - contact.impulse_ns, b, a);
    contact.impulse_ns = impulse_ns;
  };
  const Vec3 n = contact.normal;
  const double along = dot(contact.impulse_ns, n);
  const Vec3 aside = contact.impulse_ns - along * n;
  const double pressed = std::max(along + step(wanted_m_s(), 0), 0.0);
  set(pressed * n + aside);
  const Vec3 speed_m_s = wanted_m_s();
  const Vec3 wanted = aside + step(speed_m_s, 1) * yield.ways[1] + step(speed_m_s, 2) * yield.ways[2];
  const double max = contact.friction * pressed, size = length(wanted);
  set(pressed * n + (size > max ? max / size : 1.0) * wanted);
  return length(contact.impulse_ns - start);
}

// Moves a blow in time, so that both frames are explained better.
void PushSystem::move(const Moment& moment) {
  double more = 0;
  Push first, second;  // what the blow does to both
  for (std::size_t k = moment.first; k < moment.first + moment.count; ++k) {
    const PushContact& contact = contacts_[k];
    const Vec3 j = contact.impulse_ns;
    more += dot(j, unexplained_m_s(contact, contact.frame + 1) - unexplained_m_s(contact, contact.frame));
    first.linear_ns = first.linear_ns + j;
    first.angular_nms = first.angular_nms + cross(contact.first_arm_m, j);
    second.linear_ns = second.linear_ns + j;
    second.angular_nms = second.angular_nms + cross(contact.second_arm_m, j);
  }
  double stiffness = 0;
  for (const std::size_t frame : {contacts_[moment.first].frame, contacts_[moment.first].frame + 1}) {
    for (const auto& [push, number] :
         {std::pair(first, contacts_[moment.first].first), {second, contacts_[moment.first].second}}) {
      const PushedBody& slot = slots_[frame * bodies_ + number];
      stiffness += slot.inverse_mass * dot(push.linear_ns, push.linear_ns) +
                   dot(push.angular_nms, slot.inverse_inertia * push.angular_nms);
    }
  }
  if (!(stiffness > 0)) return;
  const double now = contacts_[moment.first].after;
  const double wanted = now + (more / stiffness - kSeen * (now - moment.seen)) / (1 + kSeen);
  const double s = std::clamp(wanted, std::max(0.0, moment.seen - kMaxEarly), std::min(1.0, moment.seen + kMaxEarly));
  for (std::size_t k = moment.first; k < moment.first + moment.count; ++k) {
    apply(contacts_[k], contacts_[k].impulse_ns, now - s, s - now);
    contacts_[k].before = 1 - s, contacts_[k].after = s;
    prepare(k);
  }
}

}  // namespace ringdown::scene
