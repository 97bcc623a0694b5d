#include "engine/scene/ode/joint.h"

#include "engine/scene/contact/contact_rules.h"
#include "engine/scene/rotation.h"

#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <numbers>

// Free joints
//
// ODE's ready-made joints leave one or three axes free. A joint with any other freedom is made of single rows of the
// solver, each a bound or a motor for one velocity, which are made anew for every part of a step:
//
// - A row on the spin about an axis is an angular motor (AMotor) with that one axis.
// - A row on the velocity of a point along an axis is a contact joint at the point. Its normal row bounds a velocity on
//   one side; its first friction row, with the bound `mu` of its force, is a motor. ODE's linear motor (LMotor) would
//   act at the centres of mass.
//
// A hard limit lets its quantity close at most the gap in one part, v <= gap / h, and corrects a share of any excess.
// Thus a limit is reached but not passed. A soft limit is a spring with a damper (contact_rules.h). A drive is one too;
// its row asks for the force at the end of the part.
namespace ringdown::scene {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

// The widest limits of a description, just below half a turn, stand for no limit.
double limit(double degrees, const Range& range) {
  if (degrees <= range.low) return -dInfinity;
  return degrees >= range.high ? dInfinity : degrees * kRadians;
}

constexpr double kLocked = 1e-9;   // m or rad: a narrower hard limit allows no motion
constexpr double kNoWay = 1e-9;    // m or rad: a distance or an angle below has no direction
constexpr double kNoForce = 1e12;  // a constraint as soft as this takes no force [m/(N s)]
constexpr double kAnyForce = 1e9;  // finite: ODE solves rows without a bound apart from the others [N or N m]
constexpr double kMaxReturn = 10;  // at which a lock takes back what it has lost [m/s or rad/s]

Pose of(dxBody* body) {
  if (!body) return {};
  const double* q = dBodyGetQuaternion(body);
  return {to_vec3(dBodyGetPosition(body)), Rotation::from_wxyz(q[0], q[1], q[2], q[3])};
}

Pose within(const Pose& outer, const Pose& inner) {
  return {outer.position_m + rotated(outer.rotation, inner.position_m), normalized(outer.rotation * inner.rotation)};
}

Pose seen_from(const Pose& outer, const Pose& pose) {
  const Rotation back = inverse(outer.rotation);
  return {rotated(back, pose.position_m - outer.position_m), normalized(back * pose.rotation)};
}

double part(Vec3 v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// The twist of a rotation about an axis, -pi to pi.
double twist(const Rotation& turn, std::size_t axis) {
  return std::remainder(2 * std::atan2(part({turn.x, turn.y, turn.z}, axis), turn.w), 2 * std::numbers::pi);
}

Vec3 unit(std::size_t axis) { return {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0}; }

bool is_lock(const AxesLimit& limit) {
  return limit.axes.size() == 1 && limit.stiffness == 0 && limit.high - limit.low < kLocked;
}

}  // namespace

Pose OdeFreeJoint::Frame::world() const { return within(of(body), in_body); }

OdeFreeJoint::OdeFreeJoint(dxWorld* world, dxBody* body, dxBody* other, const JointDescription& description)
    : world_(world), body_(body), other_(other), description_(description) {
  description_.rotation = normalized(description_.rotation);
  description_.end.rotation = normalized(description_.end.rotation);
  side_ = description_.frame_of_body ? -1 : 1;
  dxBody *const one = description_.frame_of_body ? body : other, *const two = description_.frame_of_body ? other : body;
  first_ = {one, seen_from(of(one), {description_.anchor_m, description_.rotation})};
  second_ = {two, seen_from(of(two), description_.end)};
  std::vector<std::size_t> way_locks;
  for (const AxesLimit& limit : description_.limits) {
    std::vector<std::size_t>& locks = limit.turns ? turn_locks_ : way_locks;
    if (is_lock(limit) && std::ranges::count(locks, limit.axes[0]) == 0) locks.push_back(limit.axes[0]);
  }
  if (way_locks.size() < 3) return;
  const Vec3 anchor = description_.end.position_m;
  ball_.reset(dJointCreateBall(world, nullptr));
  dJointAttach(ball_.get(), body, other);
  dJointSetBallAnchor(ball_.get(), anchor.x, anchor.y, anchor.z);
}

OdeFreeJoint::Place OdeFreeJoint::place() const {
  const Pose first = first_.world(), second = second_.world();
  Place place;
  for (std::size_t k = 0; k < 3; ++k) place.axes[k] = rotated(first.rotation, unit(k));
  place.point_m = second.position_m;
  const Pose inner = seen_from(first, second);
  place.way_m = inner.position_m;
  place.turn = inner.rotation;
  return place;
}

// Returns the coordinate that a limit bounds, if its direction is defined now. A twist about axis k grows with the spin
// along the mean of the axis in both frames, by 1 / cos(s/2) if the axes stand at an angle s: for the quaternion q,
// from d/dt 2 atan2(q_k, w).
std::optional<OdeFreeJoint::Coordinate> OdeFreeJoint::coordinate(const AxesLimit& limit, const Place& place) const {
  const std::size_t first = limit.axes[0], count = limit.axes.size();
  const auto into_world = [&](Vec3 v) { return v.x * place.axes[0] + v.y * place.axes[1] + v.z * place.axes[2]; };
  Vec3 way;
  if (!limit.turns) {
    if (count == 1) return Coordinate{place.axes[first], part(place.way_m, first)};
    for (const std::size_t k : limit.axes) way = way + part(place.way_m, k) * unit(k);
  } else if (count == 1) {
    const Vec3 both = unit(first) + rotated(place.turn, unit(first));
    const double size = length(both);
    if (size < kNoWay) return {};
    return Coordinate{into_world((1 / size) * both), twist(place.turn, first), 2 / size};
  } else if (count == 2) {
    const Vec3 axis = unit(3 - limit.axes[0] - limit.axes[1]), tilted = rotated(place.turn, axis);
    const Vec3 about_axis = cross(axis, tilted);
    const double sine = length(about_axis);
    if (sine < kNoWay) return {};
    return Coordinate{into_world((1 / sine) * about_axis), std::atan2(sine, dot(axis, tilted))};
  } else {
    way = to_rotation_vector(place.turn);
  }
  const double size = length(way);
  if (size < kNoWay) return {};
  return Coordinate{into_world((1 / size) * way), size};
}

void OdeFreeJoint::make_rows(double part_s) {
  part_s_ = part_s;
  hard_ = {dWorldGetERP(world_), dWorldGetCFM(world_)};
  rows_.clear();
  const Place now = place();
  for (const AxesLimit& limit : description_.limits) add_limit(limit, now);
  add_turn_locks(now);
  for (const AxisDrive& drive : description_.drives) add_drive(drive, now);
}

void OdeFreeJoint::add_limit(const AxesLimit& limit, const Place& place) {
  const bool lock = is_lock(limit);
  if (lock && (limit.turns ? turn_locks_.size() > 1 : ball_ != nullptr)) return;  // held otherwise
  const std::optional<Coordinate> at = coordinate(limit, place);
  if (!at) return;
  const auto returning = [&](double way) { return std::clamp(hard_.erp * way / part_s_, -kMaxReturn, kMaxReturn); };
  if (lock) {
    const double off = limit.low - at->value;
    return pull(limit.turns, at->direction, place.point_m, returning(off) / at->scale, hard_.cfm, kAnyForce);
  }
  const SoftConstraint soft = soft_constraint(limit.stiffness, limit.damping, part_s_);
  for (const double sign : {1.0, -1.0}) {
    const double end = sign > 0 ? limit.high : limit.low;
    if (std::abs(end) >= range::kAxesLimit.high) continue;
    const Vec3 outward = sign * at->direction;
    const double gap = sign * (end - at->value) / at->scale;
    if (limit.stiffness == 0) {
      keep_below(limit.turns, outward, place.point_m, gap > 0 ? gap / part_s_ : returning(gap), hard_.cfm);
    } else if (gap < 0) {
      pull(limit.turns, outward, place.point_m, soft.erp * gap / part_s_, soft.cfm, kAnyForce);
    }
  }
}

// Two locked axes hold the third one where it is in both frames, three hold all. A single one is a limit of its twist.
void OdeFreeJoint::add_turn_locks(const Place& place) {
  if (turn_locks_.size() < 2) return;
  Vec3 off = to_rotation_vector(place.turn);
  if (turn_locks_.size() == 2) {
    const Vec3 axis = unit(3 - turn_locks_[0] - turn_locks_[1]), tilted = rotated(place.turn, axis);
    off = cross(axis, tilted);
  }
  for (const std::size_t k : turn_locks_) {
    const double back = std::clamp(-hard_.erp * part(off, k) / part_s_, -kMaxReturn, kMaxReturn);
    pull(true, place.axes[k], place.point_m, back, hard_.cfm, kAnyForce);
  }
}

void OdeFreeJoint::add_drive(const AxisDrive& axis, const Place& place) {
  const JointDrive& drive = axis.drive;
  const double gain = part_s_ * drive.stiffness + drive.damping;
  const auto at = coordinate({.turns = axis.turns, .axes = {axis.axis}}, place);
  if (!(gain > 0 && drive.max > 0) || !at) return;
  const double speed = (drive.stiffness * (drive.target - at->value) + drive.damping * drive.speed) / gain;
  pull(axis.turns, at->direction, place.point_m, speed / at->scale, 1 / gain, drive.max);
}

// Limits the speed of the second frame along the direction, relative to the first one, to at most this speed, which may
// be negative.
void OdeFreeJoint::keep_below(bool turns, Vec3 direction, Vec3 point_m, double max, double cfm) {
  const Vec3 inward = -side_ * direction;
  if (turns) {
    // A motor beyond its limit asks for the spin -ERP (angle - limit) / h on one side of it. An ERP of 1 makes that a
    // negative bound, an ERP of -1 a positive one.
    dxJoint* motor = add_motor(-1.0 * inward);
    dJointSetAMotorAngle(motor, 0, std::abs(max) * part_s_);
    dJointSetAMotorParam(motor, dParamHiStop, 0);
    dJointSetAMotorParam(motor, dParamStopERP, max > 0 ? -1 : 1);
    dJointSetAMotorParam(motor, dParamStopCFM, cfm);
    return;
  }
  dContact contact{};
  contact.surface.mode = dContactMotionN | dContactSoftCFM;
  contact.surface.motionN = -max;
  contact.surface.soft_cfm = cfm;
  for (int k = 0; k < 3; ++k) {
    contact.geom.pos[k] = part(point_m, static_cast<std::size_t>(k));
    contact.geom.normal[k] = part(inward, static_cast<std::size_t>(k));
  }
  rows_.emplace_back(dJointCreateContact(world_, nullptr, &contact));
  dJointAttach(rows_.back().get(), body_, other_);
}

// Asks for a speed of the second frame along the direction, relative to the first one, with at most this force or
// torque.
void OdeFreeJoint::pull(bool turns, Vec3 direction, Vec3 point_m, double speed, double cfm, double max) {
  const Vec3 along = side_ * direction;
  if (turns) {
    dxJoint* motor = add_motor(along);
    dJointSetAMotorParam(motor, dParamVel, speed);
    dJointSetAMotorParam(motor, dParamCFM, cfm);
    dJointSetAMotorParam(motor, dParamFMax, max);
    return;
  }
  dContact contact{};
  contact.surface.mode =
      dContactMu2 | dContactFDir1 | dContactMotion1 | dContactSlip1 | dContactSoftERP | dContactSoftCFM;
  contact.surface.mu = max;
  contact.surface.motion1 = speed;
  contact.surface.slip1 = cfm;
  contact.surface.soft_cfm = kNoForce;
  dVector3 across, other;
  const dVector3 axis = {along.x, along.y, along.z, 0};
  dPlaneSpace(axis, across, other);
  for (int k = 0; k < 3; ++k) {
    contact.geom.pos[k] = part(point_m, static_cast<std::size_t>(k));
    contact.geom.normal[k] = across[k];
    contact.fdir1[k] = axis[k];
  }
  rows_.emplace_back(dJointCreateContact(world_, nullptr, &contact));
  dJointAttach(rows_.back().get(), body_, other_);
}

dxJoint* OdeFreeJoint::add_motor(Vec3 direction) {
  dxJoint* motor = dJointCreateAMotor(world_, nullptr);
  rows_.emplace_back(motor);
  dJointAttach(motor, body_, other_);
  dJointSetAMotorNumAxes(motor, 1);
  dJointSetAMotorAxis(motor, 0, 0, direction.x, direction.y, direction.z);
  return motor;
}

JointDescription OdeFreeJoint::now() const {
  JointDescription moved = description_;
  const Pose first = first_.world();
  moved.anchor_m = first.position_m;
  moved.rotation = first.rotation;
  moved.end = second_.world();
  return moved;
}

OdeJoint::OdeJoint(dxWorld* world, dxBody* body, dxBody* other, const JointDescription& description)
    : description_(description) {
  switch (description_.type) {
    case JointType::hinge:
      add_hinge(world, body, other);
      break;
    case JointType::ball:
      add_ball(world, body, other);
      break;
    case JointType::slider:
      add_slider(world, body, other);
      break;
    case JointType::fixed:
      add_fixed(world, body, other);
      break;
    case JointType::free:
      free_.emplace(world, body, other, description_);
      break;
  }
}

void OdeJoint::add_hinge(dxWorld* world, dxBody* body, dxBody* other) {
  const Vec3 anchor = description_.anchor_m, axis = description_.axis;
  dxJoint* hinge = dJointCreateHinge(world, nullptr);
  joint_.reset(hinge);
  dJointAttach(hinge, body, other);
  dJointSetHingeAnchor(hinge, anchor.x, anchor.y, anchor.z);
  dJointSetHingeAxis(hinge, axis.x, axis.y, axis.z);
  dJointSetHingeParam(hinge, dParamLoStop, limit(description_.low_degrees, range::kLimit_degrees));
  dJointSetHingeParam(hinge, dParamHiStop, limit(description_.high_degrees, range::kLimit_degrees));
  dJointSetHingeParam(hinge, dParamVel, 0);
  dJointSetHingeParam(hinge, dParamFMax, description_.friction_nm);
}

void OdeJoint::add_ball(dxWorld* world, dxBody* body, dxBody* other) {
  const Vec3 anchor = description_.anchor_m;
  joint_.reset(dJointCreateBall(world, nullptr));
  dJointAttach(joint_.get(), body, other);
  dJointSetBallAnchor(joint_.get(), anchor.x, anchor.y, anchor.z);
  if (description_.friction_nm == 0) return;
  dxJoint* motor = dJointCreateAMotor(world, nullptr);
  friction_motor_.reset(motor);
  dJointAttach(motor, body, other);
  dJointSetAMotorNumAxes(motor, 3);
  for (int k = 0; k < 3; ++k) {
    dJointSetAMotorAxis(motor, k, 0, k == 0, k == 1, k == 2);
    dJointSetAMotorParam(motor, dParamVel + dParamGroup * k, 0);
    dJointSetAMotorParam(motor, dParamFMax + dParamGroup * k, description_.friction_nm);
  }
}

void OdeJoint::add_slider(dxWorld* world, dxBody* body, dxBody* other) {
  const Vec3 axis = description_.axis;
  dxJoint* slider = dJointCreateSlider(world, nullptr);
  joint_.reset(slider);
  dJointAttach(slider, body, other);
  dJointSetSliderAxis(slider, axis.x, axis.y, axis.z);
  const double low = description_.low_m, high = description_.high_m;
  dJointSetSliderParam(slider, dParamLoStop, low <= range::kPosition_m.low ? -dInfinity : low);
  dJointSetSliderParam(slider, dParamHiStop, high >= range::kPosition_m.high ? dInfinity : high);
}

void OdeJoint::add_fixed(dxWorld* world, dxBody* body, dxBody* other) {
  joint_.reset(dJointCreateFixed(world, nullptr));
  dJointAttach(joint_.get(), body, other);
  dJointSetFixed(joint_.get());
}

double OdeJoint::way() const {
  return description_.type == JointType::hinge ? dJointGetHingeAngle(joint_.get())
                                               : dJointGetSliderPosition(joint_.get());
}

// A soft limit is a spring with a damper (contact_rules.h). The force of the drive at the end of a part of length h, F
// = k (target - x - h v) + d (speed - v), is that of a motor for the speed (k (target - x) + d speed) / (h k + d) with
// the compliance 1 / (h k + d). Such a force stays stable however stiff the drive is.
void OdeJoint::drive(double part_s) {
  if (free_) return free_->make_rows(part_s);
  const bool turns = description_.type == JointType::hinge, slides = description_.type == JointType::slider;
  if (description_.limit_stiffness > 0 && (turns || slides)) {
    const SoftConstraint soft = soft_constraint(description_.limit_stiffness, description_.limit_damping, part_s);
    const auto set = turns ? dJointSetHingeParam : dJointSetSliderParam;
    set(joint_.get(), dParamStopERP, soft.erp);
    set(joint_.get(), dParamStopCFM, soft.cfm);
  }
  if (!description_.drive) return;
  const JointDrive& drive = *description_.drive;
  const double gain = part_s * drive.stiffness + drive.damping;
  if (!(gain > 0)) return;
  const auto set = description_.type == JointType::hinge ? dJointSetHingeParam : dJointSetSliderParam;
  set(joint_.get(), dParamVel, (drive.stiffness * (drive.target - way()) + drive.damping * drive.speed) / gain);
  set(joint_.get(), dParamCFM, 1 / gain);
  set(joint_.get(), dParamFMax, drive.max);
}

bool OdeJoint::keeps_moving() const {
  const auto moves = [](const JointDrive& drive) { return drive.damping * drive.speed != 0; };
  return (description_.drive && moves(*description_.drive)) ||
         std::ranges::any_of(description_.drives, moves, &AxisDrive::drive);
}

JointDescription OdeJoint::now() const {
  if (free_) return free_->now();
  JointDescription moved = description_;
  dVector3 vector;
  if (moved.type == JointType::fixed) return moved;
  if (moved.type == JointType::ball) {
    dJointGetBallAnchor(joint_.get(), vector);
    moved.anchor_m = to_vec3(vector);
    return moved;
  }
  const double went = way();
  if (moved.drive) moved.drive->target -= went;
  if (moved.type == JointType::slider) {
    dJointGetSliderAxis(joint_.get(), vector);
    moved.axis = to_vec3(vector);
    if (moved.low_m > range::kPosition_m.low) moved.low_m -= went;
    if (moved.high_m < range::kPosition_m.high) moved.high_m -= went;
    return moved;
  }
  dJointGetHingeAnchor(joint_.get(), vector);
  moved.anchor_m = to_vec3(vector);
  dJointGetHingeAxis(joint_.get(), vector);
  moved.axis = to_vec3(vector);
  const double turned = went / kRadians;
  if (moved.low_degrees > range::kLimit_degrees.low) moved.low_degrees -= turned;
  if (moved.high_degrees < range::kLimit_degrees.high) moved.high_degrees -= turned;
  return moved;
}

}  // namespace ringdown::scene
