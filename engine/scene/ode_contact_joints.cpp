#include "engine/scene/ode_contact_joints.h"

#include "engine/scene/ode_contact_search.h"
#include "engine/scene/overlap.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ringdown::scene {
namespace {

// The bodies of a joint are pushed apart by ODE, because it also corrects the joint: a correction of positions alone
// would pull the joint's two ends apart.
bool pushed_by_ode(const Collider& body, const Collider& other) { return body.joined || other.joined; }

// Below this speed the direction of sliding is noise.
constexpr double kMinSlip_m_s = 1e-6;

// ODE's friction acts along two directions, each up to its limit. With the first one along the sliding, or the rolling
// where nothing slides, both together obey Coulomb's cone.
void set_friction_direction(dContact& contact, const Motion& of_body, const Motion& of_other, Vec3 approach) {
  const Vec3 normal = to_vec3(contact.geom.normal);
  Vec3 along = approach - dot(approach, normal) * normal;
  if (length(along) < kMinSlip_m_s) along = cross(of_body.spin_rad_s - of_other.spin_rad_s, normal);
  const double speed = length(along);
  if (speed < kMinSlip_m_s) return;
  contact.surface.mode |= dContactFDir1;
  for (int k = 0; const double component : {along.x, along.y, along.z}) contact.fdir1[k++] = component / speed;
}

}  // namespace

struct ContactJoints::Joint {
  dContact contact{};
  Collider *body = nullptr, *other = nullptr;
  double friction = 0;   // coefficient
  bool bounces = false;  // between bodies of which none is a sphere
};

struct ContactJoints::Touching {
  Collider &body, &other;  // `body` can move
  Motion of_body, of_other;
  SurfacePair surface;
};

struct ContactJoints::Feedback {
  std::array<dContactGeom, kMaxContactsFound> found{};  // of one pair of geometries
  std::vector<dJointFeedback> joints{kMaxContactsPerStep};
};

void ContactJoints::JointGroupDeleter::operator()(dxJointGroup* joints) const { dJointGroupDestroy(joints); }

ContactJoints::ContactJoints(dxWorld* world, const SceneDescription& scene)
    : world_(world),
      bounce_threshold_m_s_(bounce_threshold(scene)),
      gravity_m_s2_(scene.gravity_m_s2),
      joints_(dJointGroupCreate(0)),
      feedback_(std::make_unique<Feedback>()),
      impact_shares_(kMaxContactsPerStep) {
  points_.reserve(kMaxContactsPerStep);
}

ContactJoints::~ContactJoints() = default;

void ContactJoints::begin_step() {
  points_.clear();
  dropped_ = 0;
}

void ContactJoints::begin_part(double found_s, double part_s) {
  found_s_ = found_s;
  part_s_ = part_s;
  part_begin_ = points_.size();
  bounds_n_.clear();
  lands_aslant_ = false;
  solver_pushes_ = false;
  dropped_before_ = dropped_;
}

void ContactJoints::collide(dxGeom* first, dxGeom* second, Islands& islands) {
  Collider* a = static_cast<Collider*>(dGeomGetData(first));
  Collider* b = static_cast<Collider*>(dGeomGetData(second));
  if (!a->awake() && !b->awake()) return;
  if (points_.size() == kMaxContactsPerStep) {  // a thousand meshes in one place have half a million pairs
    ++dropped_;
    return;
  }
  const FoundContacts found = find_contacts(first, second, pairs_, feedback_->found, part_s_);
  const std::span<dContactGeom> points = found.carry;
  const bool swap = !a->movable();  // the first body of a joint must be one that moves
  Collider &body = swap ? *b : *a, &other = swap ? *a : *b;
  if (points.empty() && found.move.empty()) return;
  const auto into_body = [swap](dContactGeom geom) {
    if (!swap) return geom;
    for (int k = 0; k < 3; ++k) geom.normal[k] = -geom.normal[k];
    std::swap(geom.g1, geom.g2);
    return geom;
  };
  Touching pair{body, other, body.motion(), other.motion(), combine(body.surface, other.surface)};
  pair.surface.restitution *= std::min(body.elasticity, other.elasticity);
  for (const dContactGeom& geom : points) add(pair, into_body(geom), islands);
  if (pushed_by_ode(body, other)) return;
  for (const dContactGeom& further : found.move) {
    const dContactGeom geom = into_body(further);
    ContactPoint point{body.id, other.id, to_vec3(geom.pos), to_vec3(geom.normal), geom.depth};
    point.of_body = pair.of_body;
    point.of_other = pair.of_other;
    overlaps_.push_back(overlap(body, other, point));
  }
  // Several contact points of bodies with edges resist rolling by themselves.
  if (points.empty() || (points.size() > 1 && !a->round && !b->round)) return;
  const double limit_nm = pair.surface.rolling_m * loads_.of_n(body.id, other.id);
  if (limit_nm == 0 || points_.empty()) return;
  const ContactPoint& last = points_.back();
  resist_rolling(body, other, last.point_m, last.normal, limit_nm, gravity_m_s2_, part_s_);
}

// The speed at which ODE pushes two bodies apart that overlap by `depth_m`.
double ContactJoints::push_speed(double depth_m) const {
  const double out_m_s = dWorldGetERP(world_) * std::max(depth_m - kContactLayer_m, 0.0) / part_s_;
  return std::min(out_m_s, kMaxCorrection_m_s);
}

// Corrects the bounce of a body that has reached a fixed surface within this part.
Landing ContactJoints::land(const Collider& body, const Collider& other, double restitution, double approach_m_s,
                            const dContactGeom& geom) const {
  const bool lands = approach_m_s > bounce_threshold_m_s_ && geom.depth <= approach_m_s * part_s_;
  if (other.movable() || !lands) return {restitution, approach_m_s};
  return corrected_landing({.restitution = restitution,
                            .approach_m_s = approach_m_s,
                            .fall_m_s2 = -dot(gravity_m_s2_, to_vec3(geom.normal)),
                            .depth_m = geom.depth,
                            .part_s = part_s_,
                            .threshold_m_s = bounce_threshold_m_s_,
                            .pushed_m_s = pushed_by_ode(body, other) ? push_speed(geom.depth) : 0});
}

// Adds one contact point with its joint. The normal of `geom` points into the body that can move.
void ContactJoints::add(const Touching& pair, const dContactGeom& geom, Islands& islands) {
  if (points_.size() == kMaxContactsPerStep) {
    ++dropped_;
    return;
  }
  const auto& [body, other, of_body, of_other, surface] = pair;
  const Vec3 point = to_vec3(geom.pos), normal = to_vec3(geom.normal);
  const Vec3 approach = of_other.velocity_at(point) - of_body.velocity_at(point);
  const double approach_m_s = dot(approach, normal);
  if (geom.depth < 0 && approach_m_s > bounce_threshold_m_s_) return;  // they bounce when they have met
  const Landing landing = land(body, other, surface.restitution, approach_m_s, geom);
  made_.resize(points_.size());
  Joint& made = made_.emplace_back();
  made.contact.geom = geom;
  made.contact.surface.mode = dContactBounce | dContactApprox1;
  made.contact.surface.mu = surface.friction;
  made.contact.surface.bounce = landing.bounce;
  made.contact.surface.bounce_vel = bounce_threshold_m_s_;
  set_friction_direction(made.contact, of_body, of_other, approach);
  if (geom.depth < 0) {  // may come as close as this
    made.contact.geom.depth = 0;
    made.contact.surface.mode |= dContactMotionN;
    made.contact.surface.motionN = geom.depth / part_s_;
  }
  made.body = &body;
  made.other = &other;
  made.friction = surface.friction;
  made.bounces = approach_m_s > bounce_threshold_m_s_ && !body.round && !other.round;
  lands_aslant_ |= made.bounces && made.friction > 0;
  join(points_.size(), std::nullopt);
  impact_shares_[points_.size()] = landing.share;
  const double pushed_m_s = push_speed(geom.depth);
  const double leaves_m_s = approach_m_s > bounce_threshold_m_s_ ? landing.bounce * approach_m_s : 0;
  islands.unite(body, other, pushed_m_s > leaves_m_s ? pushed_m_s : 0, leaves_m_s > 0);
  points_.push_back(
      {body.id, other.id, point, normal, geom.depth, {}, landing.approach_m_s, found_s_, of_body, of_other});
}

// Without a bound, ODE bounds friction by the impulse that the contact would have without friction. With one, `mu` is
// taken for the largest force.
void ContactJoints::join(std::size_t point, std::optional<double> bound_n) {
  const Joint& made = made_[point];
  dContact contact = made.contact;
  if (bound_n) {
    contact.surface.mode &= ~dContactApprox1;
    contact.surface.mu = *bound_n;
  }
  if (!solver_pushes_ && !pushed_by_ode(*made.body, *made.other)) {
    contact.geom.depth = std::min(contact.geom.depth, kContactLayer_m);
  }
  dxJoint* joint = dJointCreateContact(world_, joints_.get(), &contact);
  dJointAttach(joint, made.body->body.get(), made.other->body.get());
  dJointSetFeedback(joint, &feedback_->joints[point]);
}

double ContactJoints::bound_friction() {
  const std::size_t count = points_.size() - part_begin_;
  const bool first = bounds_n_.size() != count;
  if (first) bounds_n_.assign(count, 0);
  double largest = 0, change = 0;
  dJointGroupEmpty(joints_.get());
  for (std::size_t k = 0; k < count; ++k) {
    const ContactPoint& point = points_[part_begin_ + k];
    const double bound = made_[part_begin_ + k].friction * std::max(dot(point.impulse_ns, point.normal), 0.0) / part_s_;
    largest = std::max(largest, bound);
    change = std::max(change, std::abs(bound - bounds_n_[k]));
    bounds_n_[k] = bound;
    join(part_begin_ + k, bound);
  }
  return first ? 1 : change / std::max(largest, 1e-30);
}

void ContactJoints::free_friction() {
  dJointGroupEmpty(joints_.get());
  for (std::size_t k = part_begin_; k < points_.size(); ++k) join(k, std::nullopt);
}

void ContactJoints::read_impulses() {
  for (std::size_t k = part_begin_; k < points_.size(); ++k) {
    points_[k].impulse_ns = part_s_ * to_vec3(feedback_->joints[k].f1);
  }
}

Overlap ContactJoints::overlap(Collider& body, Collider& other, const ContactPoint& point) const {
  return {&body, &other, point, kContactLayer_m, kMaxCorrection_m_s * part_s_, dWorldGetERP(world_)};
}

void ContactJoints::let_solver_push() {
  solver_pushes_ = true;
  free_friction();
}

void ContactJoints::move_bodies_apart() {
  if (solver_pushes_) return overlaps_.clear();
  for (std::size_t k = part_begin_; k < points_.size(); ++k) {
    const Joint& made = made_[k];
    if (!pushed_by_ode(*made.body, *made.other)) overlaps_.push_back(overlap(*made.body, *made.other, points_[k]));
  }
  move_apart(overlaps_, gravity_m_s2_);
  overlaps_.clear();
}

void ContactJoints::undo_part() {
  dJointGroupEmpty(joints_.get());
  bounds_n_.clear();
  lands_aslant_ = false;
  solver_pushes_ = false;
  overlaps_.clear();
  points_.resize(part_begin_);
  dropped_ = dropped_before_;
}

// Reduces each impulse to its impact's, and keeps the loads for the rolling resistance of the next part.
void ContactJoints::end_part() {
  for (std::size_t k = part_begin_; k < points_.size(); ++k) {
    points_[k].impulse_ns = impact_shares_[k] * points_[k].impulse_ns;
  }
  loads_.set(part_points(), part_s_);
  pairs_.end_part();
  dJointGroupEmpty(joints_.get());
}

}  // namespace ringdown::scene
