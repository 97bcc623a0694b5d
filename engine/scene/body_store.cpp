#include "engine/scene/body_store.h"

#include "engine/base/quote.h"
#include "engine/scene/check.h"
#include "engine/scene/outline.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::scene {

double Random::next() {
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return std::ldexp(static_cast<double>((z ^ (z >> 31)) >> 11), -52) - 1;
}

Vec3 Random::next_vec3() {
  const double x = next(), y = next(), z = next();
  return {x, y, z};
}

// Descriptions place the object's frame; the physics engine turns a body about its centre of mass.
Motion Body::start() const {
  const Vec3 center = description.position_m + to_matrix(normalized(description.rotation)) * mass.center_m;
  return {center, description.rotation, description.velocity_m_s, description.spin_rad_s};
}

void put_at_rest(BodyDescription& body, const Pose& pose) {
  body.position_m = pose.position_m;
  body.rotation = normalized(pose.rotation);
  body.velocity_m_s = body.spin_rad_s = {};
  body.scatter_m = 0;
}

BodyStore::BodyStore(const SceneDescription& scene) : random_(scene.seed) {
  for (const ObjectDescription& object : scene.objects) material_scale_[object.name] = object.material;
}

Result<BodyId> BodyStore::add(BodyDescription description, bool spawned, std::optional<BodyId> old_id) {
  const std::string who = "body " + quote(description.name) + ": ";
  if (bodies_.size() >= kMaxBodies) {
    return fail(ErrorKind::refused, "{}the scene is full with {} bodies; clear some first", who, kMaxBodies);
  }
  if (const auto ok = check(description); !ok) return fail(ok);
  const SoundingObject* object = description.object.empty() ? nullptr : find_object(description.object);
  if (!description.object.empty() && !object) {
    return fail(ErrorKind::bad_input, "{}no object {} is loaded", who, quote(description.object));
  }
  Result<Solid> solid = make_solid(description, object ? object->bank.get() : nullptr, scale_of(description.object));
  if (!solid) return fail(solid.error().kind, who + solid.error().message);
  description.position_m = description.position_m + description.scatter_m * random_.next_vec3();
  const BodyId id = old_id ? *old_id : next_id_++;
  const Vec3 size_m = size_of(solid->shape);
  Body body{std::move(description), {}, solid->mass, size_m, spawned, std::move(*solid)};
  body.motion = body.start();
  if (object) body.object = object->number;
  bodies_.emplace(id, std::move(body));
  return id;
}

BodyId BodyStore::add_moving(const BodyDescription& description, const Solid& solid, const Motion& motion) {
  const BodyId id = next_id_++;
  Body body{description, {}, solid.mass, size_of(solid.shape), true, {}, motion};
  if (const SoundingObject* object = find_object(description.object)) body.object = object->number;
  bodies_.emplace(id, std::move(body));
  return id;
}

void BodyStore::put_object(const SoundingObject& object) {
  std::erase_if(objects_, [&](const SoundingObject& known) { return known.name == object.name; });
  objects_.push_back(object);
}

void BodyStore::remove_object(synth::ObjectNumber number) {
  std::erase_if(objects_, [&](const SoundingObject& known) { return known.number == number; });
  for (auto& [id, body] : bodies_) {
    if (body.object == number) body.object.reset();
  }
}

const SoundingObject* BodyStore::find_object(const std::string& name) const {
  const auto found = std::ranges::find(objects_, name, &SoundingObject::name);
  return found == objects_.end() ? nullptr : &*found;
}

modal::MaterialScale BodyStore::scale_of(const std::string& object) const {
  const auto found = material_scale_.find(object);
  return found == material_scale_.end() ? modal::MaterialScale{} : found->second;
}

Result<std::map<BodyId, Solid>> BodyStore::solids_of(const SoundingObject& object) const {
  std::map<BodyId, Solid> solids;
  for (const auto& [id, body] : bodies_) {
    if (body.description.object != object.name) continue;
    Result<Solid> solid = make_solid(body.description, object.bank.get(), scale_of(object.name));
    if (!solid) return fail("body " + quote(body.description.name), solid);
    solids.emplace(id, std::move(*solid));
  }
  return solids;
}

void BodyStore::reshape(Body& body, const Solid& solid) {
  body.motion.position_m =
      body.motion.position_m + to_matrix(body.motion.rotation) * (solid.mass.center_m - body.mass.center_m);
  body.mass = solid.mass;
  body.size_m = size_of(solid.shape);
  if (body.waiting) body.waiting = solid;
}

}  // namespace ringdown::scene
