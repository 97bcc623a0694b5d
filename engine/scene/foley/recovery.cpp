#include "engine/scene/foley/recovery.h"

#include "engine/base/quote.h"
#include "engine/scene/contact/contact_rules.h"
#include "engine/scene/foley/push_solver.h"
#include "engine/scene/foley/series.h"
#include "engine/scene/foley/touches.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::scene {
namespace {

struct Span {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void hold(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  [[nodiscard]] bool meets(const Span& other, double gap_m) const {
    return low.x <= other.high.x + gap_m && other.low.x <= high.x + gap_m && low.y <= other.high.y + gap_m &&
           other.low.y <= high.y + gap_m && low.z <= other.high.z + gap_m && other.low.z <= high.z + gap_m;
  }
};

class Recoverer {
 public:
  Recoverer(std::vector<FoleyBody> bodies, PosedColliders& colliders, const PairFilter& filter,
            const FoleyLimits& limits, double gravity_m_s2, double every_s, std::size_t frames)
      : colliders_(colliders),
        filter_(filter),
        limits_(limits),
        gravity_m_s2_(gravity_m_s2),
        every_s_(every_s),
        frames_(frames) {
    result_.every_s = every_s;
    result_.bodies = std::move(bodies);
  }

  Recovery recover() {
    place_fixed();
    touches_.resize(frames_);
    spans_.resize(count());
    for (int round = 0; round < kRounds; ++round) {
      series_.clear();
      unexplained_.assign(count(), 0);
      for (std::size_t k = 0; k + 1 < frames_; ++k) find_touches(k);
      solve();
      for (FoleyBody& body : result_.bodies) body.motion.begin_explaining();
      result_.blows.clear();
      result_.touches.clear();
      for (const auto& [pair, series] : series_) divide(pair, series);
    }
    std::ranges::stable_sort(result_.blows, {}, &RecoveredBlow::time_s);
    std::ranges::stable_sort(result_.touches, {}, &RecoveredTouch::interval);
    note();
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::size_t count() const { return result_.bodies.size(); }
  [[nodiscard]] const FoleyBody& body(std::size_t n) const { return result_.bodies[n]; }
  [[nodiscard]] const KeyedMotion& motion(std::size_t n) const { return result_.bodies[n].motion; }

  void place_fixed() {
    fixed_.resize(count());
    for (std::size_t n = 0; n < count(); ++n) {
      if (motion(n).moves()) continue;
      const PosedBox box = colliders_.box_of(body(n).id, motion(n).between(0, 0));
      fixed_[n].hold(box.low_m);
      fixed_[n].hold(box.high_m);
    }
  }

  // The change of a body's velocity around a frame that gravity does not explain, with that of its surface by turning.
  [[nodiscard]] double change_m_s(std::size_t n, std::size_t k) const {
    const Push push = motion(n).push(k);
    return motion(n).inverse_mass() * length(push.linear_ns) +
           body(n).radius_m * length(motion(n).inverse_inertia(k) * push.angular_nms);
  }

  void find_touches(std::size_t k) {
    touches_[k].clear();
    std::vector<bool> pushed(count());
    for (std::size_t n = 0; n < count(); ++n) {
      const KeyedMotion& moving = motion(n);
      spans_[n] = fixed_[n];
      if (!moving.moves() || !moving.has_interval(k)) continue;
      pushed[n] = std::max(change_m_s(n, k), change_m_s(n, k + 1)) > limits_.jitter_m_s;
      Span span;
      for (const Motion& pose :
           {moving.between(k, 0), moving.between(k, 1), moving.onward(k, 1), moving.backward(k, 0)}) {
        const double r = body(n).radius_m;
        span.hold(pose.position_m - Vec3{r, r, r});
        span.hold(pose.position_m + Vec3{r, r, r});
      }
      spans_[n] = span;
    }
    for (std::size_t one = 0; one < count() && motion(one).moves(); ++one) {
      for (std::size_t two = one + 1; two < count(); ++two) {
        if (pushed[one] || pushed[two]) find_touch(k, {one, two});
      }
    }
  }

  void find_touch(std::size_t k, BodyIndices pair) {
    const FoleyBody &one = body(pair.first), &two = body(pair.second);
    double gap_m = (touched(pair, k) ? 2 : 1) * limits_.gap_m;
    for (const std::size_t n : {pair.first, pair.second}) {
      if (motion(n).turns_fast(k) || motion(n).turns_fast(k + 1)) gap_m = std::max(gap_m, kFastGap * body(n).radius_m);
    }
    if (!one.motion.has_interval(k) || !two.motion.has_interval(k)) return;
    if (!spans_[pair.first].meets(spans_[pair.second], gap_m) || !filter_.may_touch(one.id, two.id)) return;
    const auto relative = [&](std::size_t frame) {
      return one.motion.inverse_mass() * one.motion.push(frame).linear_ns -
             two.motion.inverse_mass() * two.motion.push(frame).linear_ns;
    };
    Meeting met =
        find_meeting(colliders_, {one.id, &one.motion}, {two.id, &two.motion}, k, relative(k), relative(k + 1), gap_m);
    if (met.points.empty()) return;
    const std::size_t points = met.points.size();
    touches_[k].push_back({.pair = pair,
                           .met = std::move(met),
                           .before_ns = std::vector<Vec3>(points),
                           .after_ns = std::vector<Vec3>(points)});
  }

  // True if the pair touched in the interval before.
  [[nodiscard]] bool touched(BodyIndices pair, std::size_t k) const {
    return k > 0 && std::ranges::any_of(touches_[k - 1], [&](const Touch& touch) { return touch.pair == pair; });
  }
  [[nodiscard]] const Touch* touch_of(BodyIndices pair, std::size_t k) const {
    if (k >= touches_.size()) return nullptr;
    const auto found = std::ranges::find(touches_[k], pair, &Touch::pair);
    return found == touches_[k].end() ? nullptr : &*found;
  }

  [[nodiscard]] std::vector<PushContact> contacts_of(const Touch& touch, std::size_t k) const {
    const auto [one, two] = touch.pair;
    const double friction = combine(body(one).surface, body(two).surface).friction;
    std::vector<PushContact> contacts;
    for (const PosedContact& point : touch.met.points) {
      contacts.push_back({.frame = k,
                          .first = one,
                          .second = two,
                          .first_arm_m = point.point_m - touch.met.first.position_m,
                          .second_arm_m = point.point_m - touch.met.second.position_m,
                          .normal = point.normal,
                          .friction = friction});
    }
    return contacts;
  }

  // Around a frame act the contacts of the intervals before and after it.
  void solve() {
    PushSystem system(frames_, count());
    for (std::size_t k = 1; k + 1 < frames_; ++k) {
      for (std::size_t n = 0; n < count(); ++n) {
        if (!motion(n).moves()) continue;
        const Push push = motion(n).push(k);
        PushedBody& pushed = system.body(k, n);
        pushed.inverse_mass = motion(n).inverse_mass();
        pushed.speed_m_s = pushed.inverse_mass * push.linear_ns;
        if (motion(n).turns_fast(k)) continue;
        pushed.inverse_inertia = motion(n).inverse_inertia(k);
        pushed.spin_rad_s = pushed.inverse_inertia * push.angular_nms;
      }
    }
    for (std::size_t k = 0; k + 1 < frames_; ++k) {
      find_blows(result_.bodies, touches_[k], k, limits_.strike_m_s);
      for (Touch& touch : touches_[k]) {
        std::vector<PushContact> before = contacts_of(touch, k), after = before;
        for (PushContact& contact : after) contact.before = 0, contact.after = 1;
        touch.loads_before = system.add_load(before);
        touch.loads_after = system.add_load(std::move(after));
        if (touch.blow || touch.answers) touch.contacts = system.add_blow(std::move(before), touch.share);
      }
    }
    system.solve();
    for (std::size_t k = 0; k + 1 < frames_; ++k) {
      for (Touch& touch : touches_[k]) take_solution(system, k, touch);
    }
    for (std::size_t k = 1; k + 1 < frames_; ++k) {
      for (std::size_t n = 0; n < count(); ++n) {
        if (length(system.body(k, n).speed_m_s) > kUnexplained_m_s) ++unexplained_[n];
      }
    }
  }

  void take_solution(const PushSystem& system, std::size_t k, Touch& touch) {
    Vec3 before, after;
    touch.blow_ns.clear();
    for (std::size_t p = 0; p < touch.met.points.size(); ++p) {
      touch.before_ns[p] = system.contact(touch.loads_before + p).impulse_ns;
      touch.after_ns[p] = system.contact(touch.loads_after + p).impulse_ns;
      if (touch.blow || touch.answers) {
        const PushContact& blow = system.contact(touch.contacts + p);
        touch.before_ns[p] = touch.before_ns[p] + blow.before * blow.impulse_ns;
        touch.after_ns[p] = touch.after_ns[p] + blow.after * blow.impulse_ns;
        touch.blow_ns.push_back(blow.impulse_ns);
        touch.share = blow.after;
      }
      before = before + touch.before_ns[p];
      after = after + touch.after_ns[p];
    }
    PushSeries& series = series_[touch.pair];
    if (k > 0) series[k] = series[k] + before;
    if (k + 2 < frames_) series[k + 1] = series[k + 1] + after;
  }

  void divide(BodyIndices pair, PushSeries series) {
    hold_ends(series);
    std::map<std::size_t, Approach> approaches;
    std::map<std::size_t, double> speeds;
    for (const auto& [frame, push] : series) {
      for (const std::size_t k : {std::max<std::size_t>(frame, 1) - 1, frame}) {
        const Touch* touch = touch_of(pair, k);
        if (!touch || approaches.contains(k)) continue;
        const auto [approach_m_s, parting_m_s, normal, inverse_mass] = touch->closing;
        const double fastest_m_s =
            touch->answers ? std::max(approach_m_s, sent_m_s(result_.bodies, touches_[k], *touch, k)) : approach_m_s;
        const bool strikes = fastest_m_s > limits_.strike_m_s;
        if (!(inverse_mass > 0) || !(strikes || parting_m_s > kBurst_m_s)) continue;
        approaches[k] = {normal, (strikes ? fastest_m_s : 2 * kBurst_m_s) / inverse_mass, touch->share};
        speeds[k] = std::max(fastest_m_s, kBurst_m_s);
      }
    }
    for (const Blow& blow : take_blows(series, approaches, weight_ns(pair))) {
      add_blow(pair, blow, speeds.at(blow.interval));
      explain(pair, blow.interval, (1 - blow.share) * blow.impulse_ns, blow.share * blow.impulse_ns);
    }
    for (const auto& [frame, push] : series) {
      const bool before = frame > 0 && touch_of(pair, frame - 1), after = touch_of(pair, frame);
      const Vec3 part = (before && after ? 0.5 : 1.0) * push;
      if (before) explain(pair, frame - 1, {}, part);
      if (after) explain(pair, frame, part, {});
    }
    add_touches(pair, series);
  }

  // Beyond the first and the last frame that tell something, a load goes on if it was steady.
  void hold_ends(PushSeries& series) const {
    constexpr double kSteady = 0.8;
    const auto held = [&](std::size_t k, std::size_t other) {
      const auto one = series.find(k), two = series.find(other);
      if (one == series.end() || two == series.end()) return Vec3{};
      const auto [low, high] = std::minmax({length(one->second), length(two->second)});
      return low > kSteady * high ? 0.5 * (one->second + two->second) : Vec3{};
    };
    if (frames_ < 4) return;
    series[0] = held(1, 2);
    series[frames_ - 1] = series[frames_] = series[frames_ + 1] = held(frames_ - 2, frames_ - 3);
  }

  // Tells both bodies what a contact of interval `k` did to them, around the frames before and after it.
  void explain(BodyIndices pair, std::size_t k, Vec3 before_ns, Vec3 after_ns) {
    const Touch& touch = *touch_of(pair, k);
    const std::vector<double> shares = shares_of(touch);
    const auto tell = [&](std::size_t n, const Motion& moving, double sign) {
      Vec3 arm;
      for (std::size_t p = 0; p < shares.size(); ++p)
        arm = arm + shares[p] * (touch.met.points[p].point_m - moving.position_m);
      const auto push = [&](Vec3 impulse_ns) { return Push{sign * impulse_ns, sign * cross(arm, impulse_ns)}; };
      result_.bodies[n].motion.explain(k, push(before_ns), push(after_ns));
    };
    tell(pair.first, touch.met.first, 1);
    tell(pair.second, touch.met.second, -1);
  }

  void add_blow(BodyIndices pair, const Blow& found, double approach_m_s) {
    const Touch& touch = *touch_of(pair, found.interval);
    RecoveredBlow blow{.time_s = (static_cast<double>(found.interval) + found.share) * every_s_,
                       .first = body(pair.first).id,
                       .second = body(pair.second).id,
                       .motions = {touch.met.first, touch.met.second},
                       .approach_m_s = approach_m_s};
    const std::vector<double> shares = shares_of(touch);
    for (std::size_t p = 0; p < shares.size(); ++p) {
      if (!(shares[p] > 0)) continue;
      blow.points.push_back(touch.met.points[p]);
      blow.impulses_ns.push_back(shares[p] * found.impulse_ns);
    }
    result_.blows.push_back(std::move(blow));
  }

  [[nodiscard]] double lighter_kg(BodyIndices pair) const {
    return 1 / std::max(motion(pair.first).inverse_mass(), motion(pair.second).inverse_mass());
  }
  [[nodiscard]] double weight_ns(BodyIndices pair) const { return lighter_kg(pair) * gravity_m_s2_ * every_s_; }

  void add_touches(BodyIndices pair, const PushSeries& series) {
    const auto force_at = [&](std::size_t k) {
      const auto found = series.find(k);
      return found == series.end() ? Vec3{} : (1 / every_s_) * found->second;
    };
    const double noise_n = lighter_kg(pair) * limits_.jitter_m_s / every_s_;
    for (const auto& [frame, push] : series) {
      for (const std::size_t k : {std::max<std::size_t>(frame, 1) - 1, frame}) {
        const Touch* touch = touch_of(pair, k);
        if (!touch || (k + 1 == frame && series.contains(k))) continue;
        const Vec3 start = force_at(k), end = force_at(k + 1);
        if (!(std::max(length(start), length(end)) > noise_n)) continue;
        RecoveredTouch lasting{.interval = k,
                               .first = pair.first,
                               .second = pair.second,
                               .points = touch->met.points,
                               .shares = shares_of(*touch),
                               .start_force_n = start,
                               .end_force_n = end};
        const Touch *before = k > 0 ? touch_of(pair, k - 1) : nullptr, *after = touch_of(pair, k + 1);
        const Vec3 here = mean_point(*touch);
        const double at = touch->met.share;
        if (before) {
          const double way = at + 1 - before->met.share;
          if (way > 1e-3) lasting.start_shift_m = (at / way) * (mean_point(*before) - here);
        }
        if (after) {
          const double way = after->met.share + 1 - at;
          if (way > 1e-3) lasting.end_shift_m = ((1 - at) / way) * (mean_point(*after) - here);
        }
        result_.touches.push_back(std::move(lasting));
      }
    }
  }

  void note() {
    for (std::size_t n = 0; n < count(); ++n) {
      const std::string who = "body " + quote(body(n).name);
      if (motion(n).jumps() > 0)
        result_.notes.push_back(who + " jumps " + std::to_string(motion(n).jumps()) +
                                " times, faster than it could move, which makes no sound");
      if (unexplained_[n] > 0)
        result_.notes.push_back(who + " changes its velocity in " + std::to_string(unexplained_[n]) + " of " +
                                std::to_string(frames_) +
                                " frames more than by falling, with nothing near that could push it");
    }
  }

  static constexpr double kFastGap = 0.5;    // of the radius of a body whose rotation between the frames is not known
  static constexpr double kBurst_m_s = 0.2;  // a change of velocity beside a steady load that is a blow, or several
  static constexpr int kRounds = 3;          // of search and solution; each knows the velocities better
  static constexpr double kUnexplained_m_s = 0.5;  // changes of velocity worth a sentence

  PosedColliders& colliders_;
  const PairFilter& filter_;
  FoleyLimits limits_;
  double gravity_m_s2_, every_s_;
  std::size_t frames_;
  std::vector<Span> fixed_, spans_;          // of the bodies, in the interval that is looked at
  std::vector<std::vector<Touch>> touches_;  // of the intervals
  std::map<BodyIndices, PushSeries> series_;
  std::vector<std::size_t> unexplained_;
  Recovery result_;
};

}  // namespace

Recovery recover(std::vector<FoleyBody> bodies, PosedColliders& colliders, const PairFilter& filter,
                 const FoleyLimits& limits, double gravity_m_s2, double every_s, std::size_t frames) {
  return Recoverer(std::move(bodies), colliders, filter, limits, gravity_m_s2, every_s, frames).recover();
}

}  // namespace ringdown::scene
