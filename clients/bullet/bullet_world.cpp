#include "clients/bullet/bullet_world.h"

#include "engine/base/quote.h"
#include "engine/scene/check.h"
#include "engine/scene/contact/contact_rules.h"
#include "engine/scene/contact/contact_side.h"
#include "engine/scene/contact/contact_sounds.h"
#include "engine/scene/solid.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

namespace ringdown::bullet {
namespace {

using scene::BodyDescription;
using scene::BodyId;
using scene::ContactPoint;
using scene::Motion;
using scene::MotionPair;
using scene::SceneDescription;
using scene::ShapeType;
using scene::StaticDescription;
using scene::StaticType;

constexpr int kIterations = 20;         // of the solver, so that four corners that land at once share the impulse
constexpr int kMultipoints = 8;         // tilted attempts with which Bullet looks for the corners of a flat landing
constexpr double kHullMargin_m = 1e-4;  // Bullet's default of 4 cm is as thick as many sounding objects
constexpr double kSleepSpeed_m_s = 0.01, kSleepSpin_rad_s = 0.1;

btVector3 to_bullet(Vec3 v) { return {v.x, v.y, v.z}; }
btQuaternion to_bullet(const scene::Rotation& r) { return btQuaternion(r.x, r.y, r.z, r.w).normalized(); }
Vec3 to_vec3(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

// A body or static in Bullet. Bullet turns a body about its centre of mass, along its principal axes of inertia.
struct Item {
  BodyId id = 0;
  scene::FrictionSurface surface;
  double start_s = 0;
  btMatrix3x3 principal = btMatrix3x3::getIdentity();  // principal axes -> object frame
  std::unique_ptr<btCollisionShape> shape;
  std::unique_ptr<btCompoundShape> offset_shape;  // the shape in its position relative to the centre of mass
  std::unique_ptr<btRigidBody> body;

  [[nodiscard]] bool movable() const { return !body->isStaticOrKinematicObject(); }

  [[nodiscard]] Motion motion() const {
    if (id >= scene::kFirstStatic) return {};
    const btTransform& frame = body->getWorldTransform();
    btQuaternion q;
    (frame.getBasis() * principal.transpose()).getRotation(q);
    return {to_vec3(frame.getOrigin()), scene::Rotation::from_xyzw(q.x(), q.y(), q.z(), q.w()),
            to_vec3(body->getLinearVelocity()), to_vec3(body->getAngularVelocity())};
  }
};

// Reads the contacts after Bullet has found them and before it solves them, and their impulses right after.
class ListeningWorld : public btDiscreteDynamicsWorld {
 public:
  ListeningWorld(btDispatcher* dispatcher, btBroadphaseInterface* broadphase, btConstraintSolver* solver,
                 btCollisionConfiguration* configuration, double bounce_threshold_m_s)
      : btDiscreteDynamicsWorld(dispatcher, broadphase, solver, configuration),
        bounce_threshold_m_s_(bounce_threshold_m_s) {}

  void solveConstraints(btContactSolverInfo& info) override {
    contacts_.clear();
    motions_.clear();
    points_.clear();
    for (int m = 0; m < getDispatcher()->getNumManifolds(); ++m) {
      btPersistentManifold& manifold = *getDispatcher()->getManifoldByIndexInternal(m);
      const Item& a = *static_cast<const Item*>(manifold.getBody0()->getUserPointer());
      const Item& b = *static_cast<const Item*>(manifold.getBody1()->getUserPointer());
      if ((a.movable() && a.body->isActive()) || (b.movable() && b.body->isActive())) note(a, b, manifold);
    }
    btDiscreteDynamicsWorld::solveConstraints(info);
    for (std::size_t k = 0; k < contacts_.size(); ++k) contacts_[k].impulse_ns = points_[k].impulse();
  }

  [[nodiscard]] std::span<const ContactPoint> contacts() const { return contacts_; }

 private:
  // A point of the manifold; Bullet's normal and impulses are those on its first body.
  struct Point {
    const btManifoldPoint* in_manifold;
    double sign;  // -1 where our `body` is the second

    [[nodiscard]] Vec3 impulse() const {
      const btManifoldPoint& point = *in_manifold;
      return sign * to_vec3(point.m_appliedImpulse * point.m_normalWorldOnB +
                            point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                            point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2);
    }
  };

  // Bullet solves contacts before the bodies touch, which steadies resting bodies but slows approaching ones. So
  // contact points of bodies that will bounce are removed until they touch.
  void note(const Item& a, const Item& b, btPersistentManifold& manifold) {
    const scene::SurfacePair surface = scene::combine(a.surface, b.surface);
    const Item &body = a.movable() ? a : b, &other = a.movable() ? b : a;
    const MotionPair& motions = motions_.emplace_back(MotionPair{body.motion(), other.motion()});
    for (int k = manifold.getNumContacts() - 1; k >= 0; --k) {
      const btManifoldPoint& point = manifold.getContactPoint(k);
      const bool bounces = contact_of(a, b, point, motions).approach_m_s > bounce_threshold_m_s_;
      if (bounces && point.getDistance() > 0) manifold.removeContactPoint(k);
    }
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      btManifoldPoint& point = manifold.getContactPoint(k);
      point.m_combinedRestitution = surface.restitution;
      point.m_combinedFriction = surface.friction;
      point.m_combinedRollingFriction = point.m_combinedSpinningFriction = surface.rolling_m;
      contacts_.push_back(contact_of(a, b, point, motions));
      points_.push_back({&point, a.movable() ? 1.0 : -1.0});
    }
  }

  static ContactPoint contact_of(const Item& a, const Item& b, const btManifoldPoint& point,
                                 const MotionPair& motions) {
    const bool swap = !a.movable();
    const Item &body = swap ? b : a, &other = swap ? a : b;
    ContactPoint contact{.body = body.id, .other = other.id, .depth_m = std::max(0.0, -point.getDistance())};
    contact.point_m = to_vec3(swap ? point.getPositionWorldOnB() : point.getPositionWorldOnA());
    contact.normal = (swap ? -1 : 1) * to_vec3(point.m_normalWorldOnB);
    contact.motions = &motions;
    contact.approach_m_s = dot(
        motions.of_other.velocity_at(contact.point_m) - motions.of_body.velocity_at(contact.point_m), contact.normal);
    return contact;
  }

  double bounce_threshold_m_s_;
  std::vector<ContactPoint> contacts_;
  std::deque<MotionPair> motions_;  // of the contacts' pairs
  std::vector<Point> points_;
};

std::unique_ptr<btCollisionShape> make_shape(const scene::CollisionShape& shape) {
  if (shape.type == ShapeType::sphere) return std::make_unique<btSphereShape>(shape.radius_m);
  if (shape.type == ShapeType::box) return std::make_unique<btBoxShape>(to_bullet(0.5 * shape.size_m));
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vec3& point : shape.points) hull->addPoint(to_bullet(point), false);
  hull->recalcLocalAabb();
  hull->setMargin(kHullMargin_m);
  return hull;
}

std::unique_ptr<btCollisionShape> make_shape(const StaticDescription& still) {
  if (still.type == StaticType::box) return std::make_unique<btBoxShape>(to_bullet(0.5 * still.size_m));
  const double length_m = length(still.normal);
  return std::make_unique<btStaticPlaneShape>(to_bullet((1 / length_m) * still.normal), still.offset_m);
}

Result<void> check_abilities(const SceneDescription& scene) {
  const std::string cannot = ", which ringdown-bullet cannot do; play the scene with ringdownd --scene";
  if (!scene.joints.empty())
    return fail(ErrorKind::bad_input, "the scene has joint " + quote(scene.joints[0].name) + cannot);
  if (!scene.emitters.empty())
    return fail(ErrorKind::bad_input, "the scene has emitter " + quote(scene.emitters[0].name) + cannot);
  for (const BodyDescription& body : scene.bodies) {
    if (body.scatter_m != 0) return fail(ErrorKind::bad_input, "body {} has scatter_m{}", quote(body.name), cannot);
    if (body.shape.type == ShapeType::trimesh)
      return fail(ErrorKind::bad_input, "body {} is a trimesh{}", quote(body.name), cannot);
    if (body.gravity_factor != 1)
      return fail(ErrorKind::bad_input, "body {} has a gravity_factor{}", quote(body.name), cannot);
    if (body.breaks) return fail(ErrorKind::bad_input, "body {} breaks{}", quote(body.name), cannot);
    if (body.filter != scene::CollisionFilter{})
      return fail(ErrorKind::bad_input, "body {} has a collision filter{}", quote(body.name), cannot);
  }
  return {};
}

}  // namespace

struct BulletWorld::Impl {
  explicit Impl(const SceneDescription& description);
  void add(const StaticDescription& still);
  Result<void> add(const BodyDescription& body, std::span<const std::shared_ptr<const modal::Bank>> banks);
  void place(Item& item, double mass_kg, const btVector3& moments, const btTransform& at);
  void let_in();

  SceneDescription scene;
  scene::ContactSounds sounds{scene};
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  std::vector<std::unique_ptr<Item>> items, waiting;
  ListeningWorld world{&dispatcher, &broadphase, &solver, &configuration, scene::bounce_threshold(scene)};
  std::int64_t steps = 0;
};

BulletWorld::Impl::Impl(const SceneDescription& description) : scene(description) {
  configuration.setPlaneConvexMultipointIterations(kMultipoints, 4);
  configuration.setConvexConvexMultipointIterations(kMultipoints, 4);
  world.setGravity(to_bullet(scene.gravity_m_s2));
  btContactSolverInfo& info = world.getSolverInfo();
  info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
  info.m_numIterations = kIterations;
  info.m_restitutionVelocityThreshold = scene::bounce_threshold(scene);
  info.m_splitImpulsePenetrationThreshold = 0;  // pushing overlapping bodies apart must not look like an impact
}

void BulletWorld::Impl::place(Item& item, double mass_kg, const btVector3& moments, const btTransform& at) {
  btCollisionShape* shape =
      item.offset_shape ? static_cast<btCollisionShape*>(item.offset_shape.get()) : item.shape.get();
  btRigidBody::btRigidBodyConstructionInfo info(mass_kg, nullptr, shape, moments);
  info.m_startWorldTransform = at;
  info.m_linearSleepingThreshold = kSleepSpeed_m_s;
  info.m_angularSleepingThreshold = kSleepSpin_rad_s;
  item.body = std::make_unique<btRigidBody>(info);
  item.body->setUserPointer(&item);
}

void BulletWorld::Impl::add(const StaticDescription& still) {
  Item& item = *waiting.emplace_back(std::make_unique<Item>());
  item.id = scene::kFirstStatic + static_cast<BodyId>(waiting.size());
  item.surface = still.surface;
  item.shape = make_shape(still);
  btTransform at = btTransform::getIdentity();
  if (still.type == StaticType::box) at = btTransform(to_bullet(still.rotation), to_bullet(still.position_m));
  place(item, 0, {0, 0, 0}, at);
  sounds.set_side(item.id, scene::side_of(still));
}

Result<void> BulletWorld::Impl::add(const BodyDescription& body,
                                    std::span<const std::shared_ptr<const modal::Bank>> banks) {
  const auto object = std::ranges::find(scene.objects, body.object, &scene::ObjectDescription::name);
  const bool plays = object != scene.objects.end();
  const auto number = static_cast<synth::ObjectNumber>(object - scene.objects.begin());
  const modal::Bank* bank = plays ? banks[number].get() : nullptr;
  const modal::MaterialScale scale = plays ? object->material : modal::MaterialScale{};
  const Result<scene::Solid> solid = scene::make_solid(body, bank, scale);
  if (!solid) return fail("body " + quote(body.name), solid);

  Item& item = *waiting.emplace_back(std::make_unique<Item>());
  item.id = static_cast<BodyId>(waiting.size());
  item.surface = body.surface;
  item.start_s = body.start_s;
  const auto& i = solid->mass.inertia_kg_m2;
  btMatrix3x3 inertia(i[0][0], i[0][1], i[0][2], i[1][0], i[1][1], i[1][2], i[2][0], i[2][1], i[2][2]);
  inertia.diagonalize(item.principal, 1e-12, 50);
  item.shape = make_shape(solid->shape);
  item.offset_shape = std::make_unique<btCompoundShape>();
  const btTransform to_principal(item.principal.transpose());
  const bool hull = solid->shape.type == ShapeType::convex;  // the points of a hull already include the offset
  const btVector3 center = to_bullet(hull ? Vec3{} : solid->shape.center_m);
  item.offset_shape->addChildShape(to_principal * btTransform(btMatrix3x3::getIdentity(), center), item.shape.get());

  const btMatrix3x3 turn(to_bullet(body.rotation));
  const btTransform at(turn * item.principal, to_bullet(body.position_m) + turn * to_bullet(solid->mass.center_m));
  place(item, body.fixed ? 0 : solid->mass.mass_kg, {inertia[0][0], inertia[1][1], inertia[2][2]}, at);
  if (!body.fixed) {
    // A step moves a body by its velocity at the end of the step. Starting with the velocity of half a step earlier
    // makes a fall follow the true parabola.
    item.body->setLinearVelocity(to_bullet(body.velocity_m_s - (0.5 * scene.step_s) * scene.gravity_m_s2));
    item.body->setAngularVelocity(to_bullet(body.spin_rad_s));
  }
  scene::ContactSide side = scene::side_of(body, *solid, bank, scale);
  if (plays) side.object = number;
  sounds.set_side(item.id, std::move(side));
  return {};
}

void BulletWorld::Impl::let_in() {
  std::erase_if(waiting, [this](std::unique_ptr<Item>& item) {
    if (item->start_s > static_cast<double>(steps) * scene.step_s) return false;
    world.addRigidBody(item->body.get());
    items.push_back(std::move(item));
    return true;
  });
}

BulletWorld::BulletWorld(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
BulletWorld::BulletWorld(BulletWorld&&) noexcept = default;
BulletWorld::~BulletWorld() = default;

Result<BulletWorld> BulletWorld::create(const SceneDescription& scene,
                                        std::span<const std::shared_ptr<const modal::Bank>> banks) {
  if (const auto ok = scene::check(scene); !ok) return fail(ok);
  if (const auto ok = check_abilities(scene); !ok) return fail(ok);
  auto impl = std::make_unique<Impl>(scene);
  for (const StaticDescription& still : scene.statics) impl->add(still);
  for (const BodyDescription& body : scene.bodies) {
    if (const auto added = impl->add(body, banks); !added) return fail(added);
  }
  return BulletWorld(std::move(impl));
}

BulletWorld::StepEvents BulletWorld::step() {
  impl_->let_in();
  impl_->world.stepSimulation(impl_->scene.step_s, 0);
  const double began_s = time_s();
  ++impl_->steps;
  std::vector<scene::MovedBody> moved;
  for (const auto& item : impl_->items) {
    if (item->body->isActive()) moved.push_back({.id = item->id, .motion = {}});
  }
  const auto events = impl_->sounds.process(impl_->world.contacts(), moved, began_s, {.sample_rate_hz = kFrameRate_hz});
  return {events, impl_->sounds.rest_dampings()};
}

double BulletWorld::time_s() const { return static_cast<double>(impl_->steps) * impl_->scene.step_s; }

}  // namespace ringdown::bullet
