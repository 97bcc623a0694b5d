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
#include <tuple>
#include <utility>

// In each interval (Guide::simulate_interval):
//
// 1. Every body gets a start (start_of): the velocity at the end of the interval before if that was simulated, rest if
//    the body has not moved, that of a free fall if nothing acted on it around the frame, or around the next one if it
//    has just come. For other bodies it is a guess from the frames.
// 2. Shooting corrects the starts. Its first shot goes on from the end of the interval before, which keeps what a
//    simulation knows beside the motions, such as for how long a body has been still.
// 3. Islands that meet their targets by small corrections are accepted (accept), and their bodies go on with the
//    velocities that they have at the end. An island with a guessed start may need a large correction; it counts once
//    the next interval confirms the velocities, which then need a small one only.
// 4. The contact points of what is accepted go into the recovery (publish).
//
// Steps begin at multiples of the scene's step, as those of the simulation that made the animation if it was ours. A
// frame lies within a step; bodies go straight within a step, so each start is moved to the step's end (place), and the
// end back to the frame (shoot). Contacts move bodies apart besides, so that a body whose last step was simulated goes
// on as that step did.
namespace ringdown::scene {
namespace {

constexpr double kMaxMiss_m = 1e-3;  // of a target
constexpr double kExact_m = 2e-7;    // a body that misses by less goes on without being placed anew
constexpr double kMaxShift = 0.05;   // correction, as a share of the way in the interval
constexpr double kMaxJitters = 1.5;  // further correction, in FoleyLimits::jitter_m_s
constexpr double kOfMany = 2;   // islands of more than Shooting::kSmall bodies may be off by this many times as much
constexpr double kTrust = 0.2;  // of the simulation of the interval before
constexpr double kLittleTrust = 1e-3;  // of a free fall or a guess
constexpr double kStill_m = 1e-5;      // a body that moves less in an interval lies still
constexpr double kAsleep_s = 0.3;      // bodies that have stayed in place for this long sleep
constexpr double kRests = 0.05;        // a body that comes, and falls by less than this share of g h^2, is at rest
constexpr double kFree = 0.05;         // change of velocity around a frame in free fall, as a share of g's
constexpr double kMaxWork = 2.35e6;    // in body-steps, some forty seconds on one core
constexpr double kWorkOfMet = 0.5;     // share that counts of an interval's work if all bodies are met
constexpr double kWorkOfTouch = 34;    // of the recovery, for each touch of a pair in an interval

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
    struck_ = known_;
    for (const RecoveredBlow& blow : recovery_.blows) {
      for (const BodyId id : {blow.first, blow.second}) struck_[interval_of(blow)][index_.at(id)] = true;
    }
    for (std::size_t k = 0; k + 1 < frames_ && work_ < kMaxWork; ++k) simulate_interval(k);
    publish();
    const auto is_known = [this](std::size_t k, std::size_t one, std::size_t two) {
      return k < known_.size() && (known_[k][one] || known_[k][two]);
    };
    std::erase_if(recovery_.blows, [&](const RecoveredBlow& blow) {
      const std::size_t k = interval_of(blow), one = index_.at(blow.first), two = index_.at(blow.second);
      return is_known(k, one, two) || (stays(one, k) && stays(two, k));
    });
    std::erase_if(recovery_.touches,
                  [&](const RecoveredTouch& touch) { return is_known(touch.interval, touch.first, touch.second); });
  }

 private:
  struct Track {
    bool present = false;           // in the simulation
    std::optional<Motion> carried;  // the end of the last interval, if that was accepted
    Vec3 way_on_m, turn_on_rad;     // from there to the end of the step in which the frame lies
    bool unconfirmed = false;       // `carried` comes from a guess that no interval has confirmed
    bool smooth = false;            // `carried` comes from a guess, and the frames show no blow since
    std::size_t island = 0;         // Shooter::island of the interval before
    Stillness stillness;            // of the poses in the frames so far
    bool rested = false;            // the body has not moved in the interval before
    bool moved = false;             // in the simulation of the interval before
    bool awake = false;             // at its end
    bool is_exact = false;          // `carried` met the frame within kExact_m
    double reach_m = 0;
  };

  static SceneDescription in_steps_of(SceneDescription scene, double step_s) {
    scene.step_s = step_s;
    return scene;
  }
  [[nodiscard]] std::size_t interval_of(const RecoveredBlow& blow) const {
    return std::min(static_cast<std::size_t>(blow.time_s / every_s_), frames_ - 1);
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

  // Returns whether a body lies still in an interval and the one before, so that it cannot strike what lies still, too.
  [[nodiscard]] bool stays(std::size_t n, std::size_t k) const {
    return !motion(n).moves() || (lies_still(n, k) && (k == 0 || lies_still(n, k - 1)));
  }

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
                    .asleep = track.carried ? !track.awake : track.rested && track.stillness.still_s() > kAsleep_s,
                    .rested = track.rested};
    if (track.carried) {
      shooter.start.velocity_m_s = track.carried->velocity_m_s;
      shooter.start.spin_rad_s = track.carried->spin_rad_s;
    } else if (shooter.rested) {
      return shooter;
    } else if (comes && way_m(n, k) < kRests * gravity_m_s2_ * every_s_ * every_s_) {
      shooter.trust = kLittleTrust;
    } else if (comes ? motion(n).has_interval(k + 1) && falls_freely(n, k + 1) : falls_freely(n, k)) {
      shooter.start = motion(n).free_start(k, step_s_);
      shooter.trust = kLittleTrust;
    } else {
      const Motion guess = motion(n).onward(k, 0);
      shooter.start.velocity_m_s = guess.velocity_m_s;
      shooter.start.spin_rad_s = guess.spin_rad_s;
      shooter.trust = kLittleTrust;
      shooter.guessed = true;
    }
    return shooter;
  }

  // The first step that begins in a frame or after it.
  [[nodiscard]] long first_step(std::size_t k) const {
    return std::lround(std::ceil(static_cast<double>(k) * every_s_ / step_s_ - 1e-6));
  }

  static bool goes_on_as_before(const Shooter& shooter, const Track& track) {
    return track.carried && track.is_exact && !shooter.asleep && track.awake &&
           shooter.start.velocity_m_s == track.carried->velocity_m_s &&
           shooter.start.spin_rad_s == track.carried->spin_rad_s;
  }

  // Places the bodies for the first step, which begins `early_s` after their frame. Those that go on as the interval
  // before has left them stay as they are.
  void place(std::span<const Shooter> shooters, double early_s, Shot& shot) {
    for (std::size_t i = 0; i < shooters.size(); ++i) {
      const Track& track = tracks_[present_[i]];
      Motion start = shooters[i].start;
      if (!shooters[i].asleep) {
        Vec3 way_m = early_s * start.velocity_m_s, turn_rad = early_s * start.spin_rad_s;
        if (track.carried) {
          way_m = way_m - early_s * track.carried->velocity_m_s + track.way_on_m;
          turn_rad = turn_rad - early_s * track.carried->spin_rad_s + track.turn_on_rad;
        }
        start.position_m = start.position_m + way_m;
        start.rotation = normalized(from_rotation_vector(turn_rad) * start.rotation);
      }
      shot.ends.push_back(start);
      if (goes_on_as_before(shooters[i], track)) continue;
      if (shooters[i].asleep) {
        simulation_.rest(id_of(i), start);
      } else if (track.carried && track.awake) {
        simulation_.correct(id_of(i), start);
      } else {
        simulation_.set_motion(id_of(i), start);
      }
    }
  }

  // Simulates interval `k` and stores its steps. `goes_on`: from where the interval before has ended.
  Shot shoot(std::size_t k, std::span<const Shooter> shooters, bool goes_on) {
    const long from = first_step(k), to = first_step(k + 1);
    const double early_s = static_cast<double>(from) * step_s_ - static_cast<double>(k) * every_s_;
    const double late_s = static_cast<double>(to) * step_s_ - static_cast<double>(k + 1) * every_s_;
    if (memory_ && !goes_on) simulation_.recall(*memory_);
    Shot shot;
    place(shooters, early_s, shot);
    shot_steps_.clear();
    std::vector<Motion> before;
    moved_.assign(shooters.size(), false);
    awake_.assign(shooters.size(), false);
    for (long step = from; step < to; ++step) {
      if (step + 1 == to) before = shot.ends;
      simulation_.number_step(static_cast<std::uint64_t>(step));
      const std::span<const ContactPoint> points = simulation_.step();
      for (const MovedBody& moved : simulation_.moved()) {
        const std::size_t i = place_[index_.at(moved.id)];
        shot.ends[i] = moved.motion;
        moved_[i] = true;
        awake_[i] = step + 1 == to;
      }
      work_ += 1 + static_cast<double>(simulation_.moved().size());
      note_pairs(points, shot);
      shot_steps_.push_back(copy_of(points, static_cast<double>(step) * step_s_));
    }
    steps_on_.assign(shooters.size(), {});
    for (std::size_t i = 0; i < shooters.size() && late_s > 0; ++i) {
      Motion& end = shot.ends[i];
      const double share = late_s / step_s_;
      const auto& [way_m, turn_rad] = steps_on_[i] = {share * (end.position_m - before[i].position_m),
                                                      share * turn_between(before[i].rotation, end.rotation)};
      end.position_m = end.position_m - way_m;
      end.rotation = normalized(from_rotation_vector(-1 * turn_rad) * end.rotation);
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
      shooters.back().tracked = motion(n).has_interval(k);
      const bool goes_on = track.carried && !track.rested;
      track.unconfirmed = track.unconfirmed && goes_on;
      track.smooth = track.smooth && goes_on;
    }
    if (!any_moves && simulation_.asleep()) return;
    const double work = work_;
    int shots = 0;
    Shot last;
    Shooting shooting(std::move(shooters), every_s_,
                      [&](std::span<const Shooter> bodies) { return last = shoot(k, bodies, shots++ == 0); });
    shooting.aim();
    if (shots > 1) last = shoot(k, shooting.bodies(), false);
    const bool all_met = accept(k, shooting.bodies(), last);
    if (all_met) work_ = work + kWorkOfMet * (work_ - work);
  }

  // Returns whether a body of an island of so many bodies, in which no way is longer than `way_m`, meets its target by
  // a small correction.
  [[nodiscard]] bool is_met(const Shooter& shooter, std::size_t bodies, double way_m) const {
    const double factor = bodies > Shooting::kSmall ? kOfMany : 1;
    return shooter.tracked && shooter.miss_m < factor * kMaxMiss_m &&
           (shooter.guessed || shooter.shift_m < kMaxShift * way_m + factor * kMaxJitters * jitter_m_s_ * every_s_);
  }

  // Says which bodies the last simulation of the interval is right for. Nothing is known of bodies that slept all
  // the time: their forces are those of the frames. Returns whether all bodies are met.
  bool accept(std::size_t k, std::span<const Shooter> shooters, const Shot& last) {
    memory_ = simulation_.memory();
    struct Island {
      std::size_t bodies = 0;
      double way_m = 0;  // longest
      bool refused = false, guessed = false, smooth = false, struck = false;
    };
    std::vector<Island> islands(shooters.size());
    std::vector<bool> doubted(tracks_.size());  // islands of the interval before
    for (const Shooter& shooter : shooters) {
      Island& island = islands[shooter.island];
      const double way_m =
          every_s_ * (length(shooter.start.velocity_m_s) + shooter.reach_m * length(shooter.start.spin_rad_s));
      island.way_m = std::max(island.way_m, way_m);
      ++island.bodies;
    }
    for (std::size_t i = 0; i < shooters.size(); ++i) {
      Island& island = islands[shooters[i].island];
      island.refused = island.refused || !is_met(shooters[i], island.bodies, island.way_m);
      island.guessed = island.guessed || shooters[i].guessed;
      island.smooth = island.smooth || shooters[i].guessed || tracks_[present_[i]].smooth;
      island.struck = island.struck || struck_[k][present_[i]];
    }
    for (std::size_t i = 0; i < shooters.size(); ++i) {
      const Island& island = islands[shooters[i].island];
      if (island.refused || island.guessed) doubted[tracks_[present_[i]].island] = true;
    }
    for (std::size_t i = 0; i < shooters.size(); ++i) {
      Track& track = tracks_[present_[i]];
      const Island& island = islands[shooters[i].island];
      const bool accepted = !island.refused, smooth = island.smooth && !island.struck;
      if (track.unconfirmed && !doubted[track.island]) known_[k - 1][present_[i]] = track.moved && !track.smooth;
      known_[k][present_[i]] = accepted && !island.guessed && !smooth && moved_[i];
      track.unconfirmed = accepted && island.guessed;
      track.smooth = accepted && smooth;
      track.island = shooters[i].island;
      track.carried.reset();
      if (accepted) {
        track.carried = last.ends[i];
        std::tie(track.way_on_m, track.turn_on_rad) = steps_on_[i];
      }
      track.awake = awake_[i];
      track.is_exact = shooters[i].miss_m < kExact_m;
      track.moved = moved_[i];
    }
    publish();
    steps_ = std::exchange(shot_steps_, {});
    steps_of_ = k;
    return std::ranges::none_of(islands, &Island::refused);
  }

  // Takes the contacts of the interval that was simulated last.
  void publish() {
    for (GuidedStep& step : steps_) {
      std::erase_if(step.points, [&](const ContactPoint& point) {
        const std::size_t one = index_.at(point.body), two = index_.at(point.other);
        const auto unknown = [&](std::size_t n) { return motion(n).moves() && !known_[steps_of_][n]; };
        return unknown(one) || unknown(two);
      });
      if (!step.points.empty()) recovery_.steps.push_back(std::move(step));
    }
    steps_.clear();
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
  // The last shot left these: for each body that was shot, whether it moved, whether it was awake at the end, and what
  // its Track::way_on_m and turn_on_rad become; then the shot's steps.
  std::vector<bool> moved_, awake_;
  std::vector<std::pair<Vec3, Vec3>> steps_on_;
  std::vector<GuidedStep> shot_steps_;
  std::vector<GuidedStep> steps_;  // of the interval that was accepted last, before publish()
  std::size_t steps_of_ = 0;       // its index
  // For each interval and body, these say whether its contacts are those of the simulation, and whether the frames
  // alone show a blow.
  std::vector<std::vector<bool>> known_, struck_;
  double work_ = 0;  // body-steps so far
};

}  // namespace

void guide(const SceneDescription& scene, std::span<const GuidedBody> bodies, std::size_t frames, Recovery& recovery) {
  bool any = false;
  std::vector<BodyId> moving;
  for (std::size_t n = 0; n < bodies.size(); ++n) {
    if (!recovery.bodies[n].motion.moves()) continue;
    any = any || bodies[n].solid.shape.type != ShapeType::sphere;
    moving.push_back(recovery.bodies[n].id);
  }
  const auto moves = [&](BodyId id) { return std::ranges::find(moving, id) != moving.end(); };
  for (const RecoveredBlow& blow : recovery.blows) any = any || (moves(blow.first) && moves(blow.second));
  if (any && scene.joints.empty() && frames > 2) Guide(scene, bodies, frames, recovery).run();
}

}  // namespace ringdown::scene
