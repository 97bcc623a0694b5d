#include "engine/scene/foley/push_solver.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::scene {
namespace {

constexpr int kMaxSweeps = 200;
constexpr double kEnough = 1e-4;  // change of an impulse in a sweep, of the largest impulse

double inverse_mass_at(const PushedBody& body, Vec3 arm_m, Vec3 way) {
  const Vec3 turning = cross(arm_m, way);
  return body.inverse_mass + dot(turning, body.inverse_inertia * turning);
}

Vec3 speed_at(const PushedBody& body, Vec3 arm_m) {
  return body.inverse_mass * body.push.linear_ns + cross(body.inverse_inertia * body.push.angular_nms, arm_m);
}

void take(PushedBody& body, Vec3 arm_m, Vec3 impulse_ns) {
  if (body.inverse_mass == 0) return;
  body.push.linear_ns = body.push.linear_ns - impulse_ns;
  body.push.angular_nms = body.push.angular_nms - cross(arm_m, impulse_ns);
}

}  // namespace

void solve_pushes(std::span<PushedBody> bodies, std::span<PushContact> contacts) {
  for (PushContact& contact : contacts) contact.impulse_ns = {};
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double change = 0, largest = 0;
    for (PushContact& contact : contacts) {
      PushedBody &one = bodies[contact.first], &two = bodies[contact.second];
      const auto step = [&](Vec3 way) {
        const double mass =
            inverse_mass_at(one, contact.first_arm_m, way) + inverse_mass_at(two, contact.second_arm_m, way);
        const double wanted = dot(speed_at(one, contact.first_arm_m) - speed_at(two, contact.second_arm_m), way);
        return mass > 0 ? wanted / mass : 0;
      };
      const auto apply = [&](Vec3 impulse_ns) {
        const Vec3 more = impulse_ns - contact.impulse_ns;
        contact.impulse_ns = impulse_ns;
        take(one, contact.first_arm_m, more);
        take(two, contact.second_arm_m, -1 * more);
        change = std::max(change, length(more));
      };
      const Vec3 n = contact.normal;
      const double along = dot(contact.impulse_ns, n);
      const Vec3 aside = contact.impulse_ns - along * n;
      const double pressed = std::max(along + step(n), 0.0);
      apply(pressed * n + aside);
      Vec3 wanted = aside;
      for (const Vec3& way : across(n)) wanted = wanted + step(way) * way;
      const double max = contact.friction * pressed, size = length(wanted);
      apply(pressed * n + (size > max ? max / size : 1.0) * wanted);
      largest = std::max(largest, length(contact.impulse_ns));
    }
    if (change <= kEnough * largest) break;
  }
}

}  // namespace ringdown::scene
