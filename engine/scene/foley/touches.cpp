#include "engine/scene/foley/touches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ringdown::scene {
namespace {

constexpr double kMaxGuess = 2;  // approach before a blow, of the fastest that the frames show

double inverse_mass_at(const KeyedMotion& motion, std::size_t k, Vec3 arm_m, Vec3 way) {
  const Vec3 turning = cross(arm_m, way);
  return motion.inverse_mass() + dot(turning, motion.inverse_inertia(k) * turning);
}

// The fastest that the two go towards or away from each other at a point, by the frames around interval k alone.
double seen_m_s(const KeyedMotion& one, const KeyedMotion& two, std::size_t k, const PosedContact& point) {
  double fastest = 0;
  for (std::size_t near = k == 0 ? 0 : k - 1; near <= k + 1; ++near) {
    const Motion first = one.between(near, 0.5), second = two.between(near, 0.5);
    const Vec3 apart = first.velocity_at(point.point_m) - second.velocity_at(point.point_m);
    fastest = std::max(fastest, std::abs(dot(apart, point.normal)));
  }
  return fastest;
}

Closing closing_of(std::span<const FoleyBody> bodies, const Touch& touch, std::size_t k) {
  const KeyedMotion &one = bodies[touch.pair.first].motion, &two = bodies[touch.pair.second].motion;
  const Motion first = one.backward(k, touch.met.share), second = two.backward(k, touch.met.share);
  Closing fastest{.approach_m_s = -1e300};
  for (const PosedContact& point : touch.met.points) {
    const Vec3 apart = touch.met.first.velocity_at(point.point_m) - touch.met.second.velocity_at(point.point_m);
    const double approach = -dot(apart, point.normal);
    if (!(approach > fastest.approach_m_s)) continue;
    const double inverse_mass = inverse_mass_at(one, k, point.point_m - touch.met.first.position_m, point.normal) +
                                inverse_mass_at(two, k, point.point_m - touch.met.second.position_m, point.normal);
    const double parting = dot(first.velocity_at(point.point_m) - second.velocity_at(point.point_m), point.normal);
    const double max = kMaxGuess * seen_m_s(one, two, k, point);
    fastest = {std::min(approach, max), std::min(parting, max), point.normal, inverse_mass};
  }
  return fastest;
}

// Returns whether two pairs have a body in common that moves.
bool share_a_body(std::span<const FoleyBody> bodies, BodyIndices a, BodyIndices b) {
  return std::ranges::any_of(std::array{a.first, a.second}, [&](std::size_t n) {
    return bodies[n].motion.moves() && (n == b.first || n == b.second);
  });
}

// Returns true if the touch lies on the way that the bodies would have gone without another blow, and only there.
bool is_led_away(std::span<const FoleyBody> bodies, std::span<const Touch> touches, const Touch& touch) {
  if (touch.met.onward == touch.met.backward) return false;
  return std::ranges::any_of(touches, [&](const Touch& other) {
    return other.blow && other.met.onward && other.met.backward && other.pair != touch.pair &&
           share_a_body(bodies, touch.pair, other.pair) &&
           (touch.met.onward ? other.share < touch.share : other.share > touch.share);
  });
}

}  // namespace

std::vector<double> shares_of(const Touch& touch) {
  std::vector<double> shares;
  double sum = 0;
  for (std::size_t p = 0; p < touch.met.points.size(); ++p) {
    shares.push_back(length(touch.before_ns[p] + touch.after_ns[p]));
    sum += shares.back();
  }
  for (double& share : shares) share = sum > 0 ? share / sum : 1 / static_cast<double>(shares.size());
  return shares;
}

Vec3 mean_point(const Touch& touch) {
  const std::vector<double> shares = shares_of(touch);
  Vec3 mean;
  for (std::size_t p = 0; p < shares.size(); ++p) mean = mean + shares[p] * touch.met.points[p].point_m;
  return mean;
}

void find_blows(std::span<const FoleyBody> bodies, std::vector<Touch>& touches, std::size_t k, double strike_m_s) {
  for (Touch& touch : touches) {
    touch.closing = closing_of(bodies, touch, k);
    touch.blow = touch.closing.inverse_mass > 0 && touch.closing.approach_m_s > strike_m_s;
    touch.share = touch.met.share;
  }
  std::vector<Touch> kept;
  for (const Touch& touch : touches) {
    if (!is_led_away(bodies, touches, touch)) kept.push_back(touch);
  }
  touches = std::move(kept);
  for (Touch& touch : touches) {
    if (touch.blow || bodies[touch.pair.second].motion.moves()) continue;
    double fastest_m_s = 0;
    for (const Touch& cause : touches) {
      if (!cause.blow || !(cause.closing.approach_m_s > fastest_m_s)) continue;
      if (cause.pair.first != touch.pair.first && cause.pair.second != touch.pair.first) continue;
      fastest_m_s = cause.closing.approach_m_s;
      touch.answers = true;
      touch.share = cause.share;
    }
  }
}

double sent_m_s(std::span<const FoleyBody> bodies, std::span<const Touch> touches, const Touch& touch, std::size_t k) {
  const Vec3 point = mean_point(touch);
  Vec3 apart_m_s;
  for (const Touch& other : touches) {
    if (&other == &touch) continue;
    for (std::size_t p = 0; p < other.blow_ns.size(); ++p) {
      // Adds what the other blow's impulse on one of its bodies does at the point, if the body is one of this pair.
      const auto add = [&](std::size_t number, const Motion& struck, double sign) {
        const bool first = number == touch.pair.first;
        if (!first && number != touch.pair.second) return;
        const KeyedMotion& motion = bodies[number].motion;
        const Vec3 impulse_ns = sign * other.blow_ns[p];
        const Vec3 spin =
            motion.inverse_inertia(k) * cross(other.met.points[p].point_m - struck.position_m, impulse_ns);
        const Motion& own = first ? touch.met.first : touch.met.second;
        const Vec3 speed_m_s = motion.inverse_mass() * impulse_ns + cross(spin, point - own.position_m);
        apart_m_s = first ? apart_m_s + speed_m_s : apart_m_s - speed_m_s;
      };
      add(other.pair.first, other.met.first, 1);
      add(other.pair.second, other.met.second, -1);
    }
  }
  return -dot(apart_m_s, touch.closing.normal);
}

}  // namespace ringdown::scene
