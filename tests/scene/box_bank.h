// A bank of a solid box, with the surface and mass properties that a box has by formula. For scene tests.
#pragma once

#include "engine/modal/bank.h"
#include "engine/scene/world.h"

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::test {

// Edges `size`, centre of mass at `center` in the object frame, mass `mass_kg`; one mode.
inline modal::Bank box_bank(Vec3 size, double mass_kg, Vec3 center = {}) {
  modal::Bank bank;
  bank.name = "box";
  bank.frequency_hz = {440};
  bank.decay_per_s = {3};
  for (int corner = 0; corner < 8; ++corner) {
    const auto place = [&](double middle, double edge, int bit) {
      return static_cast<float>(middle + ((corner & bit) ? 0.5 : -0.5) * edge);
    };
    bank.positions.push_back({place(center.x, size.x, 1), place(center.y, size.y, 2), place(center.z, size.z, 4)});
    bank.shapes.push_back({0, 0, 1});
  }
  bank.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const double k = mass_kg / 12;
  modal::MassProperties mass;
  mass.mass_kg = mass_kg;
  mass.center_of_mass_m = center;
  mass.inertia_kg_m2 = {k * (size.y * size.y + size.z * size.z), k * (size.x * size.x + size.z * size.z),
                        k * (size.x * size.x + size.y * size.y)};
  bank.mass = mass;
  return bank;
}

inline scene::SoundingObject sounding(const std::string& name, synth::ObjectNumber number, modal::Bank bank) {
  return {name, number, std::make_shared<const modal::Bank>(std::move(bank))};
}

// A body of object `name` named the same.
inline scene::BodyDescription body_of(const std::string& name, scene::ShapeType shape, Vec3 position) {
  scene::BodyDescription body;
  body.name = body.object = name;
  body.shape.type = shape;
  body.position_m = position;
  return body;
}

// A scene with these bodies and a floor at z = 0 of the given restitution; one object for each body that names one.
inline scene::SceneDescription scene_of(std::vector<scene::BodyDescription> bodies, double restitution = 0.5) {
  scene::SceneDescription scene;
  scene::StaticDescription floor;
  floor.name = "floor";
  floor.surface.restitution = restitution;
  scene.statics = {floor};
  for (auto& body : bodies) {
    body.surface.restitution = restitution;
    if (body.object.empty()) continue;
    scene::ObjectDescription object;
    object.name = body.object;
    scene.objects.push_back(object);
  }
  scene.bodies = std::move(bodies);
  return scene;
}

inline scene::World world_of(const scene::SceneDescription& scene, std::vector<scene::SoundingObject> objects) {
  auto world = scene::World::create(scene, objects, 48000);
  if (!world) throw std::runtime_error(world.error().message);  // the test reports it
  return std::move(*world);
}

// Every event of the next `seconds`.
inline std::vector<synth::Event> run_all(scene::World& world, double seconds) {
  std::vector<synth::Event> all;
  const double end = world.time_s() + seconds;
  while (world.time_s() < end) {
    const auto report = world.step();
    all.insert(all.end(), report.events.begin(), report.events.end());
  }
  return all;
}

// A verb with the frame and the object of its event.
template <class Verb>
struct Told : Verb {
  synth::Frame frame = 0;
  synth::ObjectNumber object = 0;
};
using Struck = Told<synth::verb::Strike>;

// The events of one verb.
template <class Verb>
std::vector<Told<Verb>> only(std::span<const synth::Event> events) {
  std::vector<Told<Verb>> all;
  for (const synth::Event& event : events) {
    if (const Verb* verb = event.verb.get_if<Verb>()) all.push_back({*verb, event.frame, event.object});
  }
  return all;
}

// Every strike of the next `seconds`.
inline std::vector<Struck> run(scene::World& world, double seconds) {
  return only<synth::verb::Strike>(run_all(world, seconds));
}

// Every telling of a contact that lasts.
inline std::vector<Told<synth::verb::Contact>> contacts(scene::World& world, double seconds) {
  return only<synth::verb::Contact>(run_all(world, seconds));
}

inline bool same_bits(const synth::Event& a, const synth::Event& b) {
  if (a.frame != b.frame || a.object != b.object || a.verb.index() != b.verb.index()) return false;
  const auto same = [&]<class Verb>(const Verb& one) {
    const Verb& other = b.verb.get<Verb>();
    bool all = true;
    if constexpr (requires { one.point_m; }) all = all && one.point_m == other.point_m;
    if constexpr (requires { one.impulse_ns; }) all = all && one.impulse_ns == other.impulse_ns;
    if constexpr (requires { one.contact_time_s; }) all = all && one.contact_time_s == other.contact_time_s;
    if constexpr (requires { one.contact; }) {
      all = all && one.contact.number == other.contact.number && one.contact.force_n == other.contact.force_n &&
            one.contact.slip_m_s == other.contact.slip_m_s && one.contact.roll_m_s == other.contact.roll_m_s;
    }
    return all;
  };
  return visit(same, a.verb);
}

inline Vec3 total_impulse(const std::vector<Struck>& strikes, synth::ObjectNumber object) {
  Vec3 sum;
  for (const auto& strike : strikes) {
    if (strike.object == object) sum = sum + strike.impulse_ns;
  }
  return sum;
}

}  // namespace ringdown::test
