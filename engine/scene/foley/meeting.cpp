#include "engine/scene/foley/meeting.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

constexpr int kHalvings = 5;       // of the step in which two bodies begin to overlap
constexpr int kMaxSteps = 12;      // of the way to a blow
constexpr double kSame_m = 0.005;  // distance of points that count as one

enum class Way { onward, between, backward };

class Search {
 public:
  Search(PosedColliders& colliders, const Meeter& first, const Meeter& second, std::size_t k)
      : colliders_(colliders), first_(first), second_(second), k_(k) {}

  // The contacts at the share `s` of the interval, with the first body moved by `shift_m`.
  [[nodiscard]] Meeting at(Way way, double s, Vec3 shift_m = {}) const {
    Meeting met{.first = motion_of(first_, way, s), .second = motion_of(second_, way, s), .share = s};
    Motion moved = met.first;
    moved.position_m = moved.position_m + shift_m;
    met.points = colliders_.find(first_.id, moved, second_.id, met.second);
    return met;
  }

  // Goes from one share of the interval to another, and returns where the two begin to overlap.
  [[nodiscard]] Meeting first_touch(Way way, double from, double to) const {
    const Meeting begin = at(way, from);
    if (!begin.points.empty() || from == to) return begin;
    const int steps = steps_for(way, from, to);
    double before = from;
    for (int k = 1; k <= steps; ++k) {
      const double here = from + (to - from) * k / steps;
      Meeting met = at(way, here);
      if (met.points.empty()) {
        before = here;
        continue;
      }
      double touching = here;
      for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (before + touching);
        Meeting closer = at(way, middle);
        if (closer.points.empty()) {
          before = middle;
        } else {
          met = std::move(closer);
          touching = middle;
        }
      }
      return met;
    }
    return {};
  }

 private:
  [[nodiscard]] Motion motion_of(const Meeter& meeter, Way way, double s) const {
    if (way == Way::between) return meeter.motion->between(k_, s);
    return way == Way::onward ? meeter.motion->onward(k_, s) : meeter.motion->backward(k_, s);
  }

  // Steps in which the bodies move by no more than the thinner one's half thickness.
  [[nodiscard]] int steps_for(Way way, double from, double to) const {
    const auto way_m = [&](const Meeter& meeter) {
      return motion_of(meeter, way, to).position_m - motion_of(meeter, way, from).position_m;
    };
    const double thin_m = std::min(colliders_.half_thickness_m(first_.id), colliders_.half_thickness_m(second_.id));
    const double steps = length(way_m(first_) - way_m(second_)) / std::max(thin_m, 1e-4);
    return static_cast<int>(std::clamp(std::ceil(steps), 1.0, static_cast<double>(kMaxSteps)));
  }

  PosedColliders& colliders_;
  const Meeter &first_, &second_;
  std::size_t k_;
};

}  // namespace

Meeting find_meeting(PosedColliders& colliders, const Meeter& first, const Meeter& second, std::size_t k,
                     Vec3 pushed_before, Vec3 pushed_after, double gap_m) {
  const Vec3 pushed = pushed_before + pushed_after;
  const double size2 = dot(pushed, pushed);
  const double share = size2 > 0 ? std::clamp(dot(pushed_after, pushed) / size2, 0.0, 1.0) : 0.5;
  const Search search(colliders, first, second, k);
  Meeting met = search.first_touch(Way::onward, 0, share);
  const Meeting later = search.first_touch(Way::backward, 1, share);
  met.onward = !met.points.empty(), met.backward = !later.points.empty();
  if (met.points.empty() && !later.points.empty()) {
    met = later;
    met.backward = true;
    met.first = first.motion->onward(k, share);
    met.second = second.motion->onward(k, share);
    return met;
  }
  const auto is_known = [&](const PosedContact& point) {
    return std::ranges::any_of(met.points, [&](const PosedContact& known) {
      return length(known.point_m - point.point_m) < kSame_m && dot(known.normal, point.normal) > 0.9;
    });
  };
  // Points move with the first body, so that a ball that rolls touches at one point of its circle.
  for (PosedContact point : later.points) {
    point.point_m = point.point_m + met.first.position_m - later.first.position_m;
    if (!met.points.empty() && !is_known(point)) met.points.push_back(point);
  }
  if (!met.points.empty()) return met;
  if (!(size2 > 0)) return {};
  const Vec3 against = (-1 / std::sqrt(size2)) * pushed;
  for (const double part : {0.1, 0.4, 1.0}) {
    met = search.at(Way::onward, share, part * gap_m * against);
    if (met.points.empty()) met = search.at(Way::between, share, part * gap_m * against);
    if (!met.points.empty()) return met;
  }
  return {};
}

}  // namespace ringdown::scene
