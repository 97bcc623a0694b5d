#include "engine/scene/ode/posed_colliders.h"

#include "engine/scene/ode/collider.h"
#include "engine/scene/ode/contact_search.h"
#include "engine/scene/ode/lock.h"
#include "engine/scene/ode/surface_pairs.h"

#include <ode/ode.h>

#include <array>
#include <map>
#include <memory>
#include <utility>

namespace ringdown::scene {
struct PosedColliders::State {
  std::unique_ptr<dxWorld, WorldDeleter> world{dWorldCreate()};
  std::unique_ptr<dxSpace, SpaceDeleter> space{dSimpleSpaceCreate(nullptr)};
  std::map<BodyId, Collider> colliders;
  SurfacePairs pairs;
  std::array<dContactGeom, kMaxContactsFound> room{};

  Collider& at(BodyId id, const Motion& motion) {
    Collider& collider = colliders.at(id);
    if (collider.body) collider.move({motion.position_m, motion.rotation, {}, {}});
    return collider;
  }
};

PosedColliders::PosedColliders() {
  const OdeLock lock;
  state_ = std::make_unique<State>();
  dSpaceSetCleanup(state_->space.get(), 0);
}

PosedColliders::~PosedColliders() {
  const OdeLock lock;
  state_.reset();
}

void PosedColliders::add(BodyId id, const Solid& solid) {
  const OdeLock lock;
  state_->colliders.try_emplace(id, id, solid, FrictionSurface{}, false, 1.0, state_->world.get(), state_->space.get());
}

void PosedColliders::add(BodyId id, const StaticDescription& description) {
  const OdeLock lock;
  state_->colliders.try_emplace(id, id, description, state_->space.get());
}

std::vector<PosedContact> PosedColliders::find(BodyId first, const Motion& of_first, BodyId second,
                                               const Motion& of_second) {
  const OdeLock lock;
  Collider &one = state_->at(first, of_first), &two = state_->at(second, of_second);
  const FoundContacts found = find_contacts(one.shape.geom.get(), two.shape.geom.get(), state_->pairs, state_->room, 0);
  std::vector<PosedContact> contacts;
  for (const dContactGeom& contact : found.carry)
    contacts.push_back({to_vec3(contact.pos), to_vec3(contact.normal), contact.depth});
  return contacts;
}

PosedBox PosedColliders::box_of(BodyId id, const Motion& motion) {
  const OdeLock lock;
  dReal box[6];
  dGeomGetAABB(state_->at(id, motion).shape.geom.get(), box);
  return {{box[0], box[2], box[4]}, {box[1], box[3], box[5]}};
}

double PosedColliders::half_thickness_m(BodyId id) const { return state_->colliders.at(id).half_thickness_m; }

}  // namespace ringdown::scene
