#include "tests/scene/keyframes.h"

#include "engine/scene/motion_path.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <set>

namespace ringdown::test {

using namespace scene;
namespace {

// The scene with the bodies of its emitters among the others, all in the places where they start.
SceneDescription with_all_bodies(const SceneDescription& scene, const World& world) {
  SceneDescription all = scene;
  all.emitters.clear();
  for (const EmitterDescription& emitter : scene.emitters) {
    for (std::uint64_t k = 0; k < emitter.count; ++k) {
      BodyDescription body = emitter.body;
      body.name = emitter.name + "-" + std::to_string(k + 1);
      body.start_s = emitter.body.start_s + static_cast<double>(k) * emitter.every_s;
      all.bodies.push_back(body);
    }
  }
  const auto states = world.bodies();
  for (std::size_t k = 0; k < all.bodies.size(); ++k) {
    all.bodies[k].scatter_m = 0;
    all.bodies[k].position_m = states[k].position_m;
    all.bodies[k].rotation = states[k].rotation;
  }
  return all;
}

Pose pose_between(const BodyState& a, const BodyState& b, double share) {
  Rotation turn = b.rotation * inverse(a.rotation);
  if (turn.w < 0) turn = Rotation::from_xyzw(-turn.x, -turn.y, -turn.z, -turn.w);
  const Vec3 way = to_rotation_vector(normalized(turn));
  const Rotation rotation = normalized(from_rotation_vector(share * way) * a.rotation);
  // The centre of mass goes straight, not the frame's origin.
  const Vec3 center = a.center_m + share * (b.center_m - a.center_m);
  const Vec3 arm = rotated(inverse(a.rotation), a.center_m - a.position_m);
  return {center - rotated(rotation, arm), rotation};
}

double db(double ratio) { return 20 * std::log10(ratio); }

double median(std::vector<double> values, double share = 0.5) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

}  // namespace

Played simulate(const SceneDescription& scene, const std::vector<SoundingObject>& objects, double fps) {
  auto world = World::create(scene, objects, 48000);
  if (!world) return {};
  Played played;
  played.animated = with_all_bodies(scene, *world);
  const auto frames = static_cast<std::size_t>(scene.duration_s * fps) + 1;
  std::vector<std::shared_ptr<MotionPath>> paths;
  std::vector<BodyState> before = world->bodies();
  for (const BodyState& state : before) {
    paths.push_back(std::make_shared<MotionPath>(MotionPath{.every_s = 1 / fps, .once = true}));
    paths.back()->poses.push_back({state.position_m, state.rotation});
  }
  double before_s = 0;
  for (std::size_t frame = 1; frame < frames;) {
    const StepReport report = world->step();
    played.contacts.insert(played.contacts.end(), report.contacts.begin(), report.contacts.end());
    std::vector<BodyState> after = world->bodies();
    if (after.size() != before.size()) break;
    for (; frame < frames && static_cast<double>(frame) / fps <= world->time_s(); ++frame) {
      const double share = (static_cast<double>(frame) / fps - before_s) / (world->time_s() - before_s);
      for (std::size_t n = 0; n < after.size(); ++n)
        paths[n]->poses.push_back(pose_between(before[n], after[n], share));
    }
    before = std::move(after);
    before_s = world->time_s();
  }
  for (std::size_t n = 0; n < paths.size(); ++n) {
    BodyDescription& body = played.animated.bodies[n];
    if (body.fixed) continue;
    body.fixed = true;
    body.velocity_m_s = body.spin_rad_s = {};
    body.path = paths[n];
  }
  played.animated.joints.clear();
  played.animated.foley.emplace();
  return played;
}

std::vector<HeardContact> play(const SceneDescription& animated, const std::vector<SoundingObject>& objects) {
  std::vector<HeardContact> contacts;
  auto world = World::create(animated, objects, 48000);
  if (!world) std::printf("%s\n", world.error().message.c_str());
  while (world && world->time_s() < animated.duration_s) {
    const StepReport report = world->step();
    contacts.insert(contacts.end(), report.contacts.begin(), report.contacts.end());
    for (const std::string& notice : report.notices) std::printf("%s\n", notice.c_str());
  }
  return contacts;
}

Comparison compare(const std::vector<HeardContact>& truth, const std::vector<HeardContact>& recovered, double fps,
                   bool verbose) {
  std::map<BodyPair, std::vector<HeardContact>> real, found;
  double loudest = 0;
  for (const HeardContact& c : truth) {
    if (c.kind != HeardContact::blow) continue;
    real[c.pair].push_back(c);
    loudest = std::max(loudest, length(c.push));
  }
  for (const HeardContact& c : recovered)
    if (c.kind == HeardContact::blow) found[c.pair].push_back(c);
  Comparison result;
  std::vector<double> times, impulses, sums;
  const double frame_s = 1 / fps;
  for (const auto& [pair, blows] : real) {
    const auto& mine = found[pair];
    for (std::size_t k = 0; k < blows.size();) {
      std::size_t end = k + 1;
      while (end < blows.size() && blows[end].time_s - blows[end - 1].time_s < 2 * frame_s) ++end;
      if (end == k + 1) {
        const HeardContact& blow = blows[k];
        if (db(length(blow.push) / loudest) > -30 && blow.time_s > 2 * frame_s) {
          ++result.alone;
          const HeardContact* best = nullptr;
          for (const HeardContact& other : mine) {
            const double off = std::abs(other.time_s - blow.time_s);
            if (off < frame_s && (!best || off < std::abs(best->time_s - blow.time_s))) best = &other;
          }
          if (best) {
            ++result.found;
            times.push_back(1000 * std::abs(best->time_s - blow.time_s));
            impulses.push_back(std::abs(db(length(best->push) / length(blow.push))));
          }
          if (verbose)
            std::printf("%u-%u at %.4f s, %.1f dB, %.2f m/s: %s %+.2f ms %+.2f dB\n", pair.first, pair.second & 0xffff,
                        blow.time_s, db(length(blow.push) / loudest), blow.speed_m_s, best ? "found" : "missed",
                        best ? 1000 * (best->time_s - blow.time_s) : 0,
                        best ? db(length(best->push) / length(blow.push)) : 0);
        }
      } else {
        double real_sum = 0, found_sum = 0;
        for (std::size_t n = k; n < end; ++n) real_sum += length(blows[n].push);
        for (const HeardContact& other : mine) {
          if (other.time_s > blows[k].time_s - frame_s && other.time_s < blows[end - 1].time_s + frame_s)
            found_sum += length(other.push);
        }
        if (db(real_sum / loudest) > -30) {
          ++result.groups;
          sums.push_back(std::abs(db(std::max(found_sum, 1e-9) / real_sum)));
          if (verbose)
            std::printf("%u-%u at %.4f s: %zu blows, sum %.1f dB: %+.2f dB\n", pair.first, pair.second & 0xffff,
                        blows[k].time_s, end - k, db(real_sum / loudest), db(std::max(found_sum, 1e-9) / real_sum));
        }
      }
      k = end;
    }
  }
  for (const auto& [pair, blows] : found) {
    for (const HeardContact& blow : blows) {
      if (!(db(length(blow.push) / loudest) > -40)) continue;
      const auto& all = real[pair];
      const bool known = std::ranges::any_of(
          all, [&](const HeardContact& c) { return std::abs(c.time_s - blow.time_s) < 2 * frame_s; });
      if (known) continue;
      ++result.false_ones;
      if (verbose)
        std::printf("%u-%u at %.4f s: false, %.1f dB, %.2f m/s\n", pair.first, pair.second & 0xffff, blow.time_s,
                    db(length(blow.push) / loudest), blow.speed_m_s);
    }
  }
  result.time_ms = median(times, 0.9);
  result.worst_ms = median(times, 1);
  result.impulse_db = median(impulses);
  result.group_db = median(sums);
  return result;
}

}  // namespace ringdown::test
