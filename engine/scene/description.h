// A scene as plain data: the content of a scene file (scene_file.h), from which a World is built (world.h).
//
// SI units, z upwards by convention (gravity decides). An object's pose is the pose of its bank's own frame; a silent
// body's frame has its origin at the body's centre. Every limit named here is checked by the functions that take a
// description, so a program may fill in the structs itself. [any thread]
#pragma once

#include "engine/base/range.h"
#include "engine/base/rotation.h"
#include "engine/base/vec3.h"
#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"
#include "engine/synth/event.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::modal {
struct SurfaceRelief;  // surface_relief.h
}

namespace ringdown::scene {

struct MotionPath;  // motion_path.h

// The most of each kind in one scene. Readers and World refuse more.
inline constexpr std::size_t kMaxBodies = 1024;  // described, emitted and spawned together
inline constexpr std::size_t kMaxStatics = 64;
inline constexpr std::size_t kMaxJoints = 256;
inline constexpr std::size_t kMaxJointParts = 32;  // limits, and drives, of one free joint
inline constexpr std::size_t kMaxEmitters = 64;
inline constexpr std::size_t kMaxObjects = 256;
inline constexpr std::size_t kMaxMeshPoints = std::size_t{1} << 16;  // of one body's own mesh
inline constexpr std::size_t kMaxFilters = 64;                       // that differ, in one scene

// Closed ranges of a scene's numbers.
namespace range {
inline constexpr Range kGravity_m_s2{-1000, 1000};  // each component
inline constexpr Range kStep_s{1e-5, 0.05};
inline constexpr Range kDuration_s{0.01, 36000};
inline constexpr Range kSpring_n_m{1, 1e12};
inline constexpr Range kDamper_ns_m{1, 1e12};
inline constexpr Range kBounceThreshold_m_s{0, 100};
inline constexpr Range kMinimumRepeat_s{0, 10};
inline constexpr Range kRestDamping_s_m{0, 1000};
inline constexpr Range kGain{0, 1000};
inline constexpr Range kPan{-1, 1};
inline constexpr Range kMaterialScale{1e-3, 1e3};  // density, stiffness
inline constexpr Range kSizeScale{1e-2, 1e2};
inline constexpr Range kDampingScale{0, 1e3};  // alpha, beta
inline constexpr Range kDensity_kg_m3{0.1, 1e5};
inline constexpr Range kSize_m{1e-4, 1000};
inline constexpr Range kMass_kg{1e-7, 1e7};
inline constexpr Range kPosition_m{-1000, 1000};    // each component; a body farther out has left the scene
inline constexpr Range kVelocity_m_s{-1000, 1000};  // each component; a larger one is an error
inline constexpr Range kSpin_rad_s{-3000, 3000};    // each component; a 10 cm bar then has tips at 150 m/s
inline constexpr Range kPush_ns{-1e6, 1e6};         // each component
inline constexpr Range kGravityFactor{-100, 100};
inline constexpr Range kScatter_m{0, 100};
inline constexpr Range kStart_s{0, 86400};
inline constexpr Range kRestitution{0, 1};
inline constexpr Range kFriction{0, 10};
inline constexpr Range kContactTime_s{0, 0.1};
inline constexpr Range kRolling_m{0, 0.1};
inline constexpr Range kEdgeRadius_m{1e-6, 10};
inline constexpr Range kYoung_pa{1e3, 1e13};
inline constexpr Range kPoisson{-0.9, 0.499};
inline constexpr Range kRoughness_m{0, 0.01};
inline constexpr Range kCorrelation_m{1e-7, 1};
inline constexpr Range kSpectralSlope{-10, 0};
inline constexpr Range kShortest_m{0, 1};
inline constexpr Range kWaviness{0, 10};
inline constexpr Range kLimit_degrees{-179, 179};
inline constexpr Range kJointFriction_nm{0, 1e6};
inline constexpr Range kDriveGain{0, 1e9};
inline constexpr Range kDriveTarget{-1000, 1000};
inline constexpr Range kDriveMost{0, 1e9};
inline constexpr Range kAxesLimit{-1000, 1000};  // m or rad
inline constexpr Range kEvery_s{0.001, 3600};
inline constexpr Range kFieldOfView_degrees{1, 170};
inline constexpr Range kTemperature_c{-50, 60};
inline constexpr Range kHumidity_percent{0, 100};
}  // namespace range

using ringdown::Rotation;

// How the numbers of two surfaces in contact make one number. Of the ways that two surfaces ask for, the first in this
// list is taken; the geometric mean is the default.
enum class Combine { average, minimum, maximum, multiply, geometric_mean };

// The surface of a body in contacts.
struct FrictionSurface {
  double restitution = 0.4;                // speed after : speed before
  double friction = 0.5;                   // Coulomb's coefficient
  std::optional<double> sliding_friction;  // the coefficient while the bodies slide; unset: friction
  Combine restitution_combine = Combine::geometric_mean, friction_combine = Combine::geometric_mean;
  double rolling_m = 1e-4;  // rolling resistance: a ball of radius r rolls down slopes steeper than this / r
  std::optional<double> contact_time_s;  // half-sine force pulse; 0 is an ideal impulse; unset: from Hertz's law
  double edge_radius_m = 1e-3;           // of corners and edges; not used for spheres
  std::optional<double> young_pa;        // unset: of the bank's material, else kDefaultYoung_pa
  std::optional<double> poisson;         // unset: of the bank's material, else kDefaultPoisson
  synth::Texture texture;                // what sliding and rolling excite
  std::optional<double> waviness;  // height over length of the departure from flat, which leaves flat faces so much of
                                   // their patch to bear; unset: impacts of faces are those of their corners
  std::shared_ptr<const modal::SurfaceRelief> relief;  // measured heights and mesoscale relief, in glTF scenes; or null
};

// Hard stone or glass: the elasticity of bodies without another material.
inline constexpr double kDefaultYoung_pa = 7e10;
inline constexpr double kDefaultPoisson = 0.25;

enum class ShapeType { box, sphere, convex, trimesh };

// Points in a body's frame, and triangles between them, counter-clockwise from outside.
struct ShapeMesh {
  std::vector<Vec3> points_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  friend bool operator==(const ShapeMesh&, const ShapeMesh&) = default;
};

// A body's shape for collisions. Sizes left at 0 come from the surface of the object's bank, in its position there.
struct Shape {
  ShapeType type = ShapeType::box;
  Vec3 size_m;                            // box: edge lengths; 0 0 0 is the bank's bounding box
  double radius_m = 0;                    // sphere; 0 is the sphere about the centre of mass that encloses the bank
  std::optional<Vec3> center_m;           // box or sphere with a size: its centre; unset: where the bank has its own
  std::shared_ptr<const ShapeMesh> mesh;  // convex: the hull of its points; trimesh: the mesh; null: the bank's surface
};

// Which others a body collides with. Two bodies collide if neither refuses the other. A body refuses another one all of
// whose systems are in `not_with`, and, unless `only_with` is empty, another one with a system outside of `only_with`
// or with none.
struct CollisionFilter {
  std::vector<std::string> systems;  // to which the body belongs
  std::vector<std::string> only_with, not_with;
  friend bool operator==(const CollisionFilter&, const CollisionFilter&) = default;
};

// An object that can sound, and what the mixer should set for it.
struct ObjectDescription {
  std::string name;  // engine/base/object_name.h says what a name is
  std::filesystem::path bank;
  std::string group;              // empty: in none
  double gain = 1;                // linear
  double pan = 0;                 // -1 left ... +1 right
  modal::MaterialScale material;  // the mixer rescales the modes; a World scales mass and geometry
};

struct BodyDescription {
  std::string name;
  std::string object;  // the object that sounds; empty: a silent body, which still strikes others
  Shape shape;
  double density_kg_m3 = 0;  // 0: mass and inertia from the bank; else of a solid box or sphere of this density
  std::optional<modal::MassProperties> mass;  // the body's own mass and inertia, instead of both
  Vec3 position_m;
  Rotation rotation;
  Vec3 velocity_m_s;                       // of the centre of mass
  Vec3 spin_rad_s;                         // about it, world axes
  bool two_way = false;                    // impacts feel how it vibrates: the object feels them sample by sample
  bool fixed = false;                      // does not move, and still sounds when struck
  double gravity_factor = 1;               // of the scene's gravity
  std::shared_ptr<const MotionPath> path;  // of a fixed body: how it moves, whatever touches it; null: not at all
  CollisionFilter filter;
  double start_s = 0;    // enters the scene at this time, moving as described; until then it touches nothing
  double scatter_m = 0;  // shifts the start by up to this along each axis, at random from the scene's seed
  FrictionSurface surface;
};

enum class StaticType { plane, box };

// A thing that never moves and never sounds.
struct StaticDescription {
  std::string name;
  StaticType type = StaticType::plane;
  Vec3 normal = {0, 0, 1};  // plane: the half-space normal . x < offset is solid; any length but zero
  double offset_m = 0;
  Vec3 size_m, position_m;  // box: edge lengths and centre
  Rotation rotation;
  FrictionSurface surface;
  CollisionFilter filter;
};

// Two bodies, or a body and the world, held together at a point.
enum class JointType {
  hinge,   // allows turning about one axis
  ball,    // allows turning about every axis
  slider,  // allows moving along one axis, without turning
  fixed,   // allows nothing
  free     // allows moving along and turning about every axis, as far as its limits let it
};

// A spring with a damper, or a motor, along a slider's axis or about a hinge's: its force is stiffness times what is
// missing to `target`, plus damping times what is missing to `speed`, at most `most`. Metres and newtons for a slider,
// radians and newton metres for a hinge.
struct JointDrive {
  double stiffness = 0, damping = 0;  // per unit of way, per unit of speed
  double target = 0, speed = 0;       // from the pose described
  double most = 1e6;                  // of force or torque
  friend bool operator==(const JointDrive&, const JointDrive&) = default;
};

// A limit of a free joint. Over one axis it bounds the way along the axis, or the twist about it. Over several axes it
// bounds a distance, or an angle: over two axes, the distance from the third axis, or the angle between the third axes
// of both frames (a cone); over three axes, the distance of the frames, or the whole angle between them.
struct AxesLimit {
  bool turns = false;                 // whether it bounds turning [rad] or moving [m]
  std::vector<std::size_t> axes;      // of the joint's frame: one to three of 0, 1 and 2, which are x, y and z
  double low = -1000, high = 1000;    // the widest are no limits
  double stiffness = 0, damping = 0;  // of a spring beyond the limit, as of a drive; 0: the limit is hard
  friend bool operator==(const AxesLimit&, const AxesLimit&) = default;
};

// A drive of a free joint, along an axis of its frame [m, N] or about the axis [rad, N m]. Targets are counted from
// where both frames agree.
struct AxisDrive {
  bool turns = false;
  std::size_t axis = 0;
  JointDrive drive;
  friend bool operator==(const AxisDrive&, const AxisDrive&) = default;
};

struct JointDescription {
  std::string name;
  JointType type = JointType::hinge;
  std::string body, other;  // an empty `other` is the world
  bool collides = true;     // whether the two bodies can touch
  Vec3 anchor_m;            // world, with both bodies as the scene describes them
  Vec3 axis = {0, 0, 1};    // hinge, slider: world, of any length but zero; `body` turns about it by the right hand,
                            // or moves along it
  double low_degrees = -179, high_degrees = 179;  // hinge: from the pose described; the widest are no limits
  double low_m = -1000, high_m = 1000;            // slider: from the pose described; the widest are no limits
  double limit_stiffness = 0, limit_damping = 0;  // of the limits, as of a drive; 0: they are hard
  double friction_nm = 0;                         // torque that resists turning
  std::optional<JointDrive> drive;                // hinge, slider

  // A free joint measures the place and the turn of one frame in another. Both are given in the world, as the bodies
  // are described. The first frame, at anchor_m, is fixed to `other`, or to `body` where `frame_of_body` says so. The
  // second frame is fixed to the remaining one of the two.
  Rotation rotation;  // of the first frame
  Pose end;           // the second frame
  bool frame_of_body = false;
  std::vector<AxesLimit> limits;
  std::vector<AxisDrive> drives;
};

// Lets bodies into the scene one after the other: the first at the template's start_s, each with its own scatter.
struct EmitterDescription {
  std::string name;  // its bodies have this name with "-1", "-2" ... appended
  BodyDescription body;
  double every_s = 0.1;
  std::uint64_t count = 1;
};

// The camera for pictures of the scene.
struct CameraDescription {
  Vec3 position_m = {0, -2, 1}, target_m;
  double field_of_view_degrees = 50;  // vertical
};

// The listener of a scene, and the air between.
struct ListenerDescription {
  Vec3 position_m = {0, -2, 1}, target_m;  // faces the target, the head upright,
  std::optional<Rotation> rotation;        // unless this says how it is turned: x is in front, y left, z up
  double temperature_c = 20, humidity_percent = 50;
};

// Contacts act as springs with dampers. Their softness takes the share m CFM/h of the impulse of a body of mass m: with
// the defaults, 1 % at 20 kg and a step of 1/4000 s, and 0.1 % at 1/500 s.
struct ContactSettings {
  double spring_n_m = 1e9;
  double damper_ns_m = 8e6;
  double bounce_threshold_m_s = 0.05;  // a contact that approaches faster is a strike
  double minimum_repeat_s = 0.02;      // a pair that touches again sooner goes on with the same contact
  // How much bodies at rest on each other damp each other: damping force per speed, per newton of normal force, before
  // the factor of one minus the restitution. Hunt and Crossley's damping (1975), linearised about a static load.
  double rest_damping_s_m = 1.5;
  bool clicks = true;  // a struck body also sounds as a rigid body (engine/synth/modes/click.h)
};

struct SceneDescription {
  Vec3 gravity_m_s2 = {0, 0, -9.81};
  double step_s = 1.0 / 500;
  std::uint64_t seed = 1;
  double duration_s = 10;  // how long is worth listening to: a hint for rendering
  ContactSettings contact;
  std::vector<ObjectDescription> objects;
  std::vector<BodyDescription> bodies;
  std::vector<StaticDescription> statics;
  std::vector<JointDescription> joints;
  std::vector<EmitterDescription> emitters;
  std::optional<CameraDescription> camera;
  std::optional<ListenerDescription> listener;
};

}  // namespace ringdown::scene
