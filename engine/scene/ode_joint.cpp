#include "engine/scene/ode_joint.h"

#include <ode/ode.h>

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
  if (description_.type == JointType::hinge) {
    add_hinge(world, body, other);
  } else {
    add_ball(world, body, other);
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

JointDescription OdeJoint::now() const {
  JointDescription moved = description_;
  dVector3 vector;
  if (moved.type == JointType::ball) {
    dJointGetBallAnchor(joint_.get(), vector);
    moved.anchor_m = {vector[0], vector[1], vector[2]};
    return moved;
  }
  dJointGetHingeAnchor(joint_.get(), vector);
  moved.anchor_m = {vector[0], vector[1], vector[2]};
  dJointGetHingeAxis(joint_.get(), vector);
  moved.axis = {vector[0], vector[1], vector[2]};
  const double turned = dJointGetHingeAngle(joint_.get()) / kRadians;
  if (moved.low_degrees > range::kLimit_degrees.low) moved.low_degrees -= turned;
  if (moved.high_degrees < range::kLimit_degrees.high) moved.high_degrees -= turned;
  return moved;
}

}  // namespace ringdown::scene
