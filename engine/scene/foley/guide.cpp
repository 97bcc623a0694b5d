#include "engine/scene/foley/guide.h"

#include "engine/scene/foley/shooting.h"
#include "engine/scene/ode/simulation.h"
#include "engine/scene/rotation.h"
#include "engine/scene/stillness.h"
#include "engine/scene/world.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>

// In each interval (Guide::simulate_interval):
//
// 1. Every body gets a start (start_of): the velocity at the end of the interval before if that was simulated, rest if
//    the body has not moved, that of a free fall if nothing acted on it around the frame, or around the next one if it
//    has just come. Other bodies stay where they are, and an island with one of them is not accepted.
// 2. Shooting corrects the starts.
// 3. Islands that meet their targets by small corrections are accepted (is_accepted). Their contact points go into the
//    recovery, and their bodies go on with the velocities that they have at the end.
//
// Steps begin at multiples of the scene's step, as those of the simulation that made the animation if it was ours. A
// frame lies within a step; bodies go straight within a step, so each start is moved to the step's end, and the end
// back to the frame (shoot).
namespace ringdown::scene {
namespace {

constexpr double kMaxMiss_m = 1e-3;    // of a target
constexpr double kMaxShift = 0.05;     // correction, as a share of the way in the interval
constexpr double kMaxJitters = 1.5;    // further correction, in FoleyLimits::jitter_m_s
constexpr double kTrust = 0.2;         // of the simulation of the interval before
constexpr double kLittleTrust = 1e-3;  // of a free fall
constexpr double kStill_m = 1e-5;      // a body that moves less in an interval lies still
constexpr double kAsleep_s = 0.3;      // bodies that have stayed in place for this long sleep
constexpr double kRests = 0.05;        // a body that comes, and falls by less than this share of g h^2, is at rest
constexpr double kFree = 0.05;         // change of velocity around a frame in free fall, as a share of g's
constexpr double kMaxWork = 2e6;       // in body-steps, about ten seconds on one core
constexpr double kWorkOfTouch = 26;    // of the recovery, for each touch of a pair in an interval

class Guide {
 public:
  Guide(const SceneDescription& scene, std::span<const GuidedBody> solids, std::size_t frames, Recovery& recovery)
      : recovery_(recovery),
        solids_(solids),
        every_s_(recovery.every_s),
        frames_(frames),
        gravity_m_s2_(length(scene.gravity_m_s2)),
        jitter_m_s_(scene.foley->jitter_m_s),
        step_s_(scene.step_s / std::ceil(scene.step_s / kMaxPart_s - 1e-9)),
        simulation_(in_steps_of(scene, step_s_)),
        tracks_(recovery.bodies.size()) {
    for (std::size_t n = 0; n < tracks_.size(); ++n) {
      const FoleyBody& body = recovery_.bodies[n];
      index_[body.id] = n;
      if (body.id >= kFirstStatic) {
        simulation_.add_static(body.id, scene.statics[body.id - kFirstStatic]);
        simulation_.set_filter(body.id, solids_[n].filter);
      } else if (!body.motion.moves()) {
        put(n, body.motion.between(0, 0));
      }
    }
  }

  void run() {
    work_ = kWorkOfTouch * static_cast<double>(recovery_.touches.size());
    known_.assign(frames_, std::vector<bool>(tracks_.size()));
    for (std::size_t k = 0; k + 1 < frames_ && work_ < kMaxWork; ++k) simulate_interval(k);
    const auto is_known = [this](std::size_t k, std::size_t one, std::size_t two) {
      return k < known_.size() && (known_[k][one] || known_[k][two]);
    };
    std::erase_if(recovery_.blows, [&](const RecoveredBlow& blow) {
      return is_known(static_cast<std::size_t>(blow.time_s / every_s_), index_.at(blow.first), index_.at(blow.second));
    });
    std::erase_if(recovery_.touches,
                  [&](const RecoveredTouch& touch) { return is_known(touch.interval, touch.first, touch.second); });
  }

 private:
  struct Track {
    bool present = false;           // in the simulation
    std::optional<Motion> carried;  // the end of the last interval, if that was accepted
    Stillness stillness;            // of the poses in the frames so far
    bool rested = false;            // the body has not moved in the interval before
    double reach_m = 0;
  };

  static SceneDescription in_steps_of(SceneDescription scene, double step_s) {
    scene.step_s = step_s;
    return scene;
  }
  [[nodiscard]] const KeyedMotion& motion(std::size_t n) const { return recovery_.bodies[n].motion; }
  [[nodiscard]] Motion pose(std::size_t n, std::size_t k) const { return motion(n).between(k, 0); }

  void put(std::size_t n, const Motion& at) {
    const FoleyBody& body = recovery_.bodies[n];
    simulation_.put_body(body.id, solids_[n].solid, at, body.surface, !body.motion.moves(), solids_[n].gravity_factor);
    simulation_.set_filter(body.id, solids_[n].filter);
    tracks_[n].present = true;
    tracks_[n].reach_m = std::max(0.5 * body.radius_m, 1e-4);
  }

  // The way of a body from a frame to the next one, turning included.
  [[nodiscard]] double way_m(std::size_t n, std::size_t k) const {
    const Motion one = pose(n, k), two = pose(n, k + 1);
    return length(two.position_m - one.position_m) +
           tracks_[n].reach_m * length(turn_between(one.rotation, two.rotation));
  }
  [[nodiscard]] bool lies_still(std::size_t n, std::size_t k) const { return way_m(n, k) < kStill_m; }

  [[nodiscard]] bool falls_freely(std::size_t n, std::size_t k) const {
    const Push push = motion(n).push(k);
    const double change_m_s = motion(n).inverse_mass() * length(push.linear_ns) +
                              tracks_[n].reach_m * length(motion(n).inverse_inertia(k) * push.angular_nms);
    return !motion(n).turns_fast(k) && change_m_s < jitter_m_s_ + kFree * gravity_m_s2_ * every_s_;
  }

  [[nodiscard]] Shooter start_of(std::size_t n, std::size_t k, bool comes) const {
    const Track& track = tracks_[n];
    const Motion here = pose(n, k), next = pose(n, k + 1);
    Shooter shooter{.start = {here.position_m, here.rotation, {}, {}},
                    .target = {next.position_m, next.rotation},
                    .reach_m = track.reach_m,
                    .trust = kTrust,
                    .asleep = track.rested && track.stillness.still_s() > kAsleep_s,
                    .rested = track.rested};
    if (shooter.rested) return shooter;
    if (track.carried) {
      shooter.start.velocity_m_s = track.carried->velocity_m_s;
      shooter.start.spin_rad_s = track.carried->spin_rad_s;
    } else if (comes && way_m(n, k) < kRests * gravity_m_s2_ * every_s_ * every_s_) {
      shooter.trust = kLittleTrust;
    } else if (comes ? motion(n).has_interval(k + 1) && falls_freely(n, k + 1) : falls_freely(n, k)) {
      shooter.start = motion(n).free_start(k, step_s_);
      shooter.trust = kLittleTrust;
    } else {
      shooter.tracked = false;
      shooter.asleep = true;
    }
    return shooter;
  }

  // The first step that begins in a frame or after it.
  [[nodiscard]] long first_step(std::size_t k) const {
    return std::lround(std::ceil(static_cast<double>(k) * every_s_ / step_s_ - 1e-6));
  }

  Shot shoot(std::size_t k, std::span<const Shooter> shooters, std::vector<GuidedStep>* record) {
    const long from = first_step(k), to = first_step(k + 1);
    const double early_s = static_cast<double>(from) * step_s_ - static_cast<double>(k) * every_s_;
    const double late_s = static_cast<double>(to) * step_s_ - static_cast<double>(k + 1) * every_s_;
    if (memory_) simulation_.recall(*memory_);
    Shot shot;
    for (std::size_t i = 0; i < shooters.size(); ++i) {
      Motion start = shooters[i].start;
      if (shooters[i].asleep) {
        simulation_.rest(id_of(i), start);
      } else {
        start.position_m = start.position_m + early_s * start.velocity_m_s;
        start.rotation = normalized(from_rotation_vector(early_s * start.spin_rad_s) * start.rotation);
        simulation_.set_motion(id_of(i), start);
      }
      shot.ends.push_back(start);
    }
    std::vector<Motion> before;
    moved_.assign(shooters.size(), false);
    for (long step = from; step < to; ++step) {
      if (step + 1 == to) before = shot.ends;
      const std::span<const ContactPoint> points = simulation_.step();
      for (const MovedBody& moved : simulation_.moved()) {
        const std::size_t i = place_[index_.at(moved.id)];
        shot.ends[i] = moved.motion;
        moved_[i] = true;
      }
      work_ += 1 + static_cast<double>(simulation_.moved().size());
      note_pairs(points, shot);
      if (record) record->push_back(copy_of(points, static_cast<double>(step) * step_s_));
    }
    for (std::size_t i = 0; i < shooters.size() && late_s > 0; ++i) {
      Motion& end = shot.ends[i];
      const double share = late_s / step_s_;
      end.position_m = end.position_m + share * (before[i].position_m - end.position_m);
      end.rotation =
          normalized(from_rotation_vector(share * turn_between(end.rotation, before[i].rotation)) * end.rotation);
    }
    return shot;
  }

  [[nodiscard]] BodyId id_of(std::size_t shooter) const { return recovery_.bodies[present_[shooter]].id; }

  void note_pairs(std::span<const ContactPoint> points, Shot& shot) const {
    for (const ContactPoint& point : points) {
      const std::size_t one = index_.at(point.body), two = index_.at(point.other);
      if (!motion(one).moves() || !motion(two).moves() || !(length(point.impulse_ns) > 0)) continue;
      const std::pair<std::size_t, std::size_t> pair = std::minmax(place_[one], place_[two]);
      if (std::ranges::find(shot.pairs, pair) == shot.pairs.end()) shot.pairs.push_back(pair);
    }
  }

  static GuidedStep copy_of(std::span<const ContactPoint> points, double time_s) {
    GuidedStep step{.time_s = time_s, .points = {points.begin(), points.end()}};
    const MotionPair* last = nullptr;
    step.motions = std::make_shared<std::deque<MotionPair>>();
    for (ContactPoint& point : step.points) {
      if (point.motions != last) step.motions->push_back(*point.motions);
      last = point.motions;
      point.motions = &step.motions->back();
    }
    return step;
  }

  void simulate_interval(std::size_t k) {
    present_.clear();
    place_.assign(tracks_.size(), 0);
    std::vector<Shooter> shooters;
    bool any_moves = false;
    for (std::size_t n = 0; n < tracks_.size() && motion(n).moves(); ++n) {
      Track& track = tracks_[n];
      if (!motion(n).has_interval(k)) {
        track.carried.reset();
        track.stillness.reset();
        if (!track.present) continue;
      }
      const bool comes = !track.present;
      if (comes) put(n, pose(n, k));
      track.rested = !comes && lies_still(n, k - 1);
      track.stillness.step({pose(n, k).position_m, pose(n, k).rotation}, recovery_.bodies[n].radius_m, every_s_);
      any_moves = any_moves || !lies_still(n, k);
      place_[n] = present_.size();
      present_.push_back(n);
      shooters.push_back(start_of(n, k, comes));
      shooters.back().tracked = shooters.back().tracked && motion(n).has_interval(k);
    }
    if (!any_moves) return;
    Shooting shooting(std::move(shooters), every_s_,
                      [&](std::span<const Shooter> bodies) { return shoot(k, bodies, nullptr); });
    shooting.aim();
    accept(k, shooting.bodies());
  }

  [[nodiscard]] bool is_accepted(const Shooter& shooter) const {
    const double way_m =
        every_s_ * (length(shooter.start.velocity_m_s) + shooter.reach_m * length(shooter.start.spin_rad_s));
    return shooter.tracked && shooter.miss_m < kMaxMiss_m &&
           shooter.shift_m < kMaxShift * way_m + kMaxJitters * jitter_m_s_ * every_s_;
  }

  // Simulates the interval once more, and takes the contacts of the islands that are right. Nothing is taken of bodies
  // that slept all the time: their forces are those of the frames.
  void accept(std::size_t k, std::span<const Shooter> shooters) {
    std::vector<GuidedStep> steps;
    const Shot last = shoot(k, shooters, &steps);
    memory_ = simulation_.memory();
    std::vector<bool> refused(shooters.size());  // islands
    for (const Shooter& shooter : shooters) refused[shooter.island] = refused[shooter.island] || !is_accepted(shooter);
    for (std::size_t i = 0; i < shooters.size(); ++i) {
      const bool accepted = !refused[shooters[i].island];
      known_[k][present_[i]] = accepted && moved_[i];
      tracks_[present_[i]].carried.reset();
      if (accepted) tracks_[present_[i]].carried = last.ends[i];
    }
    for (GuidedStep& step : steps) {
      std::erase_if(step.points, [&](const ContactPoint& point) {
        const std::size_t one = index_.at(point.body), two = index_.at(point.other);
        const auto unknown = [&](std::size_t n) { return motion(n).moves() && !known_[k][n]; };
        return unknown(one) || unknown(two);
      });
      if (!step.points.empty()) recovery_.steps.push_back(std::move(step));
    }
  }

  Recovery& recovery_;
  std::span<const GuidedBody> solids_;
  double every_s_;
  std::size_t frames_;
  double gravity_m_s2_, jitter_m_s_, step_s_;
  Simulation simulation_;
  std::shared_ptr<const SimulationMemory> memory_;  // of the end of the last interval
  std::map<BodyId, std::size_t> index_;
  std::vector<Track> tracks_;
  std::vector<std::size_t> present_, place_;  // the bodies that are shot, and for each body its place there
  std::vector<bool> moved_;                   // of the bodies that are shot, in the last shot
  std::vector<std::vector<bool>> known_;      // of each interval, of each body
  double work_ = 0;                           // body-steps so far
};

}  // namespace

void guide(const SceneDescription& scene, std::span<const GuidedBody> bodies, std::size_t frames, Recovery& recovery) {
  bool any = false;
  for (std::size_t n = 0; n < bodies.size(); ++n)
    any = any || (recovery.bodies[n].motion.moves() && bodies[n].solid.shape.type != ShapeType::sphere);
  if (any && scene.joints.empty() && frames > 2) Guide(scene, bodies, frames, recovery).run();
}

}  // namespace ringdown::scene
