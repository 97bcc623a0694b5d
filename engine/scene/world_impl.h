// What a World holds, and what becomes of its bodies in a step (world_bodies.cpp); world.cpp is what others see of it.
// [one thread]
#pragma once

#include "engine/scene/rotation.h"
#include "engine/scene/simulation.h"
#include "engine/scene/solid.h"
#include "engine/scene/sounding.h"
#include "engine/scene/world.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::scene {

// Numbers from a seed, the same on every machine (Steele, Lea, Flood 2014: SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  // In [-1, 1).
  double next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return std::ldexp(static_cast<double>((z ^ (z >> 31)) >> 11), -52) - 1;
  }
  Vec3 next_vec3() {
    const double x = next(), y = next(), z = next();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

struct Body {
  BodyDescription description;  // with its scatter applied
  std::optional<synth::ObjectNumber> object;
  RigidMass mass;
  Vec3 size_m;
  bool spawned = false;
  std::optional<Solid> waiting;  // until start_s, when the simulation gets it
  Motion motion;                 // at the end of the last step
  int resets = 0;

  // Between the object's frame and the centre of mass, about which physics turns a body.
  [[nodiscard]] Motion start() const {
    const Vec3 center = description.position_m + to_matrix(normalized(description.rotation)) * mass.center_m;
    return {center, description.rotation, description.velocity_m_s, description.spin_rad_s};
  }
};

inline bool within(Vec3 v, const Range& range) { return range.holds(v.x) && range.holds(v.y) && range.holds(v.z); }

struct WaitingJoint {
  BodyId body = 0;
  std::optional<BodyId> other;
  JointDescription description;
};

struct World::Impl {
  Impl(const SceneDescription& scene, double rate);

  [[nodiscard]] const SoundingObject* find(const std::string& name) const;
  [[nodiscard]] modal::MaterialScale scale_of(const std::string& object) const;
  Result<BodyId> add(BodyDescription description, bool spawned);
  void let_in(double now_s);
  void put(BodyId id, const Body& body, const Solid& solid);
  void note_joints(const SceneDescription& scene);
  Result<void> add_all(const EmitterDescription& emitter);
  void join_those_in();
  void check_bodies();
  void remove(BodyId id);
  void do_part();
  [[nodiscard]] double time_s() const { return static_cast<double>(steps) * step_s + part * part_s; }

  double step_s;
  int parts;  // of each step
  double part_s;
  Simulation simulation;
  Sounding sounding;
  Timeline timeline;
  Vec3 gravity_m_s2;
  Random random;
  std::int64_t steps = 0;
  int part = 0;  // of the step that is being done
  BodyId next_id = 0;
  std::map<BodyId, Body> bodies;
  double next_start_s = 0;  // no waiting body enters before
  std::vector<WaitingJoint> joints;
  std::vector<SoundingObject> objects;
  std::map<std::string, modal::MaterialScale> material_scale;
  std::vector<synth::Event> events;
  std::vector<Leaning> leanings;  // of the step, as are the next three
  std::vector<std::string> notices;
  std::size_t dropped_events = 0, dropped_contacts = 0;
};

}  // namespace ringdown::scene
