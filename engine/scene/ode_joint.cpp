#include "engine/scene/ode_joint.h"

#include "engine/scene/contact_rules.h"

#include <ode/ode.h>

#include <algorithm>
#include <numbers>

namespace ringdown::scene {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

// The widest limits of a description, just below half a turn, stand for no limit.
double limit(double degrees, const Range& range) {
  if (degrees <= range.low) return -dInfinity;
  return degrees >= range.high ? dInfinity : degrees * kRadians;
}

}  // namespace

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
  set(joint_.get(), dParamFMax, drive.most);
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
