#include "engine/scene/contact_joints.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <utility>

namespace ringdown::scene {
namespace {

// Below this speed the direction of sliding is noise.
constexpr double kMinSlip_m_s = 1e-6;

Vec3 to_vec3(const dReal* v) { return {v[0], v[1], v[2]}; }

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
  dropped_before_ = dropped_;
}

void ContactJoints::collide(dxGeom* first, dxGeom* second, Islands& islands) {
  Collider* a = static_cast<Collider*>(dGeomGetData(first));
  Collider* b = static_cast<Collider*>(dGeomGetData(second));
  if (!a->awake() && !b->awake()) return;
  const std::span<dContactGeom> points = find_contacts(first, second, feedback_->found, part_s_);
  const bool swap = !a->movable();  // the first body of a joint must be one that moves
  Collider &body = swap ? *b : *a, &other = swap ? *a : *b;
  for (dContactGeom geom : points) {
    if (swap) {
      for (int k = 0; k < 3; ++k) geom.normal[k] = -geom.normal[k];
      std::swap(geom.g1, geom.g2);
    }
    add(body, other, geom, islands);
  }
  // Several contact points of bodies with edges resist rolling by themselves.
  if (points.empty() || (points.size() > 1 && !a->round && !b->round)) return;
  const double limit_nm = combine(body.surface, other.surface).rolling_m * loads_.of_n(body.id, other.id);
  if (limit_nm == 0 || points_.empty()) return;
  const ContactPoint& last = points_.back();
  resist_rolling(body, other, last.point_m, last.normal, limit_nm, gravity_m_s2_, part_s_);
}

// The speed at which ODE will push two bodies apart that overlap by `depth_m`.
double ContactJoints::push_speed(double depth_m) const {
  const double out_m_s = dWorldGetERP(world_) * std::max(depth_m - kContactLayer_m, 0.0) / part_s_;
  return std::min(out_m_s, kMaxCorrection_m_s);
}

// Corrects the bounce of a body that has reached a fixed surface within this part.
Landing ContactJoints::land(const Collider& other, double restitution, double approach_m_s,
                            const dContactGeom& geom) const {
  const bool lands = approach_m_s > bounce_threshold_m_s_ && geom.depth <= approach_m_s * part_s_;
  if (other.movable() || !lands) return {restitution, approach_m_s};
  return corrected_landing({.restitution = restitution,
                            .approach_m_s = approach_m_s,
                            .fall_m_s2 = -dot(gravity_m_s2_, to_vec3(geom.normal)),
                            .depth_m = geom.depth,
                            .part_s = part_s_,
                            .threshold_m_s = bounce_threshold_m_s_,
                            .pushed_m_s = push_speed(geom.depth)});
}

// Adds one contact point with its joint. The normal of `geom` points into `body`.
void ContactJoints::add(Collider& body, Collider& other, const dContactGeom& geom, Islands& islands) {
  if (points_.size() == kMaxContactsPerStep) {
    ++dropped_;
    return;
  }
  const Motion of_body = body.motion(), of_other = other.motion();
  const Vec3 point = to_vec3(geom.pos), normal = to_vec3(geom.normal);
  const Vec3 approach = of_other.velocity_at(point) - of_body.velocity_at(point);
  const double approach_m_s = dot(approach, normal);
  SurfacePair surface = combine(body.surface, other.surface);
  if (!body.elastic || !other.elastic) surface.restitution = 0;
  const Landing landing = land(other, surface.restitution, approach_m_s, geom);
  dContact contact{};
  contact.geom = geom;
  contact.surface.mode = dContactBounce | dContactApprox1;
  contact.surface.mu = surface.friction;
  contact.surface.bounce = landing.bounce;
  contact.surface.bounce_vel = bounce_threshold_m_s_;
  set_friction_direction(contact, of_body, of_other, approach);
  dxJoint* joint = dJointCreateContact(world_, joints_.get(), &contact);
  dJointAttach(joint, body.body.get(), other.body.get());
  dJointSetFeedback(joint, &feedback_->joints[points_.size()]);
  impact_shares_[points_.size()] = landing.share;
  const double pushed_m_s = push_speed(geom.depth);
  const double leaves_m_s = approach_m_s > bounce_threshold_m_s_ ? landing.bounce * approach_m_s : 0;
  islands.unite(body, other, pushed_m_s > leaves_m_s ? pushed_m_s : 0);
  points_.push_back(
      {body.id, other.id, point, normal, geom.depth, {}, landing.approach_m_s, found_s_, of_body, of_other});
}

void ContactJoints::read_impulses() {
  for (std::size_t k = part_begin_; k < points_.size(); ++k) {
    points_[k].impulse_ns = part_s_ * to_vec3(feedback_->joints[k].f1);
  }
}

void ContactJoints::undo_part() {
  dJointGroupEmpty(joints_.get());
  points_.resize(part_begin_);
  dropped_ = dropped_before_;
}

// Reduces each impulse to its impact's, and keeps the loads for the rolling resistance of the next part.
void ContactJoints::end_part() {
  for (std::size_t k = part_begin_; k < points_.size(); ++k) {
    points_[k].impulse_ns = impact_shares_[k] * points_[k].impulse_ns;
  }
  loads_.set(part_points(), part_s_);
  dJointGroupEmpty(joints_.get());
}

}  // namespace ringdown::scene
