// A scene as plain data: the content of a scene file (scene_file.h), from which a World is built (world.h).
//
// SI units. By convention z points up; gravity may point elsewhere. An object's pose is the pose of its bank's own
// frame; a silent body's frame has its origin at the body's centre. Functions that take a description check every limit
// named here, so a program may fill in the structs itself. [any thread]
#pragma once

#include "engine/base/range.h"
#include "engine/base/rotation.h"
#include "engine/base/vec3.h"
#include "engine/modal/bank.h"
#include "engine/modal/fracture/strength.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/tubes/tube_tuning.h"
#include "engine/scene/foley/limits.h"
#include "engine/synth/events/event.h"

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

// Maximum counts per scene. Readers and World refuse more.
inline constexpr std::size_t kMaxBodies = 1024;  // described, emitted and spawned together
inline constexpr std::size_t kMaxStatics = 64;
inline constexpr std::size_t kMaxJoints = 256;
inline constexpr std::size_t kMaxJointParts = 32;  // limits of one free joint; also the maximum of its drives
inline constexpr std::size_t kMaxEmitters = 64;
inline constexpr std::size_t kMaxSceneObjects = 1024;
inline constexpr std::size_t kMaxMeshPoints = std::size_t{1} << 16;  // points of one body's own mesh
inline constexpr std::size_t kMaxFilters = 64;                       // distinct collision filters in one scene

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
inline constexpr Range kDampingScale{0, 1e3};  // alpha, beta, heat, air
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
inline constexpr Range kBreakImpulse_ns{1e-9, 1e6};
inline constexpr Range kStrength_pa{1e3, 1e13};
inline constexpr Range kCrackEnergyFactor{0, 1e3};
inline constexpr Range kEvery_s{0.001, 3600};
inline constexpr Range kFieldOfView_degrees{1, 170};
inline constexpr Range kTemperature_c{-50, 60};
inline constexpr Range kHumidity_percent{0, 100};
}  // namespace range

using ringdown::Rotation;

// A rule for combining the values of two surfaces in contact. If the two surfaces name different rules, the one earlier
// in this list applies; the geometric mean is the default.
enum class Combine { average, minimum, maximum, multiply, geometric_mean };

// Contact properties of a body's surface.
struct FrictionSurface {
  double restitution = 0.4;                // speed after an impact over speed before it
  double friction = 0.5;                   // Coulomb's coefficient
  std::optional<double> sliding_friction;  // the coefficient while the bodies slide; unset: friction
  Combine restitution_combine = Combine::geometric_mean, friction_combine = Combine::geometric_mean;
  double rolling_m = 1e-4;  // rolling resistance: a ball of radius r rolls down slopes steeper than this / r
  std::optional<double> contact_time_s;  // duration of a half-sine force pulse; 0: an ideal impulse; unset: Hertz's law
  double edge_radius_m = 1e-3;           // radius of corners and edges; not used for spheres
  std::optional<double> young_pa;        // unset: that of the bank's material, or kDefaultYoung_pa
  std::optional<double> poisson;         // unset: that of the bank's material, or kDefaultPoisson
  synth::Texture texture;                // roughness that sliding and rolling excite
  std::optional<double> waviness;  // height over length of the departure from flatness, which reduces the bearing part
                                   // of a patch; unset: faces hit like corners
  std::shared_ptr<const modal::SurfaceRelief> relief;  // measured relief, in glTF scenes; or null
};

// Elasticity of bodies without another material: hard stone or glass.
inline constexpr double kDefaultYoung_pa = 7e10;
inline constexpr double kDefaultPoisson = 0.25;

enum class ShapeType { box, sphere, convex, trimesh };

// Points in a body's frame, and triangles with counter-clockwise corners seen from outside.
struct ShapeMesh {
  std::vector<Vec3> points_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  friend bool operator==(const ShapeMesh&, const ShapeMesh&) = default;
};

// A body's shape for collisions. Size and position left at their defaults come from the surface of the object's bank.
struct Shape {
  ShapeType type = ShapeType::box;
  Vec3 size_m;                            // box: edge lengths; 0 0 0 is the bank's bounding box
  double radius_m = 0;                    // sphere; 0 is the sphere about the centre of mass that encloses the bank
  std::optional<Vec3> center_m;           // centre of a box or sphere with a size; unset: that of the bank's surface
  std::shared_ptr<const ShapeMesh> mesh;  // convex: the hull of its points; trimesh: the mesh; null: the bank's surface
};

// Which other bodies a body collides with. Two bodies collide unless one refuses the other. A body refuses another if
// all systems of the other are in `not_with`. If `only_with` is not empty, the body also refuses bodies with a system
// outside of `only_with`, and bodies without any system.
struct CollisionFilter {
  std::vector<std::string> systems;  // collision systems to which the body belongs
  std::vector<std::string> only_with, not_with;
  friend bool operator==(const CollisionFilter&, const CollisionFilter&) = default;
};

// An object that can sound, and its settings for the mixer.
struct ObjectDescription {
  std::string name;  // must satisfy engine/base/object_name.h
  std::filesystem::path bank;
  std::string group;                   // empty: no group
  double gain = 1;                     // linear
  double pan = 0;                      // -1 left ... +1 right
  modal::MaterialScale material;       // the mixer rescales the modes; a World scales mass and geometry
  std::optional<double> level_m = {};  // of the liquid in it; unset: as baked. The liquid's weight is not moved
  std::optional<modal::TubeTuning> tubes = {};  // unset: as baked
  synth::verb::Fan fan;                         // in the tubes' mouths
};

// When a body breaks into the pieces that its object's bank has (fracture/breaking_bodies.h): at the first blow that
// reaches the impulse, or that strains the body's skin up to its strength.
struct Breaks {
  std::optional<double> impulse_ns;   // unset: no impulse by itself breaks the body
  std::optional<double> strength_pa;  // unset: drawn from what the bank knows of its material, for each body of a scene
  double crack_energy_factor = modal::kFractureEnergyFactor;  // energy of a crack over that of its material; 0: cracks
                                                              // cost nothing
  double min_mass_kg = 5e-5;  // lighter pieces are heard as they break off, and then are gone
  friend bool operator==(const Breaks&, const Breaks&) = default;
};

struct BodyDescription {
  std::string name;
  std::string object;  // the object that sounds; empty: a silent body, which still strikes others
  Shape shape;
  double density_kg_m3 = 0;  // 0: mass and inertia come from the bank; else those of a solid box or sphere
  std::optional<modal::MassProperties> mass;  // explicit mass and inertia, used in place of bank and density
  Vec3 position_m;
  Rotation rotation;
  Vec3 velocity_m_s;                       // of the centre of mass
  Vec3 spin_rad_s;                         // about the centre of mass, world axes
  bool two_way = false;                    // contacts are computed sample by sample and feel the object's vibration
  bool fixed = false;                      // immovable, but still sounds when struck
  double gravity_factor = 1;               // multiplies the scene's gravity
  std::shared_ptr<const MotionPath> path;  // prescribed motion of a fixed body; null: it stays in place
  CollisionFilter filter;
  double start_s = 0;    // time at which the body enters the scene, moving as described; until then it touches nothing
  double scatter_m = 0;  // maximum random shift of the start position along each axis, drawn from the scene's seed
  FrictionSurface surface;
  std::optional<Breaks> breaks;  // absent: the body does not break
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

// A spring with a damper, or a motor, along a slider's axis or about a hinge's axis. Its force is `stiffness` times the
// distance to `target` plus `damping` times the difference to `speed`, limited to `max`. Metres and newtons for a
// slider, radians and newton metres for a hinge.
struct JointDrive {
  double stiffness = 0, damping = 0;  // per unit of displacement, per unit of speed
  double target = 0, speed = 0;       // `target` is counted from the pose described
  double max = 1e6;                   // maximum force or torque
  friend bool operator==(const JointDrive&, const JointDrive&) = default;
};

// A limit of a free joint. With one axis it bounds the displacement along the axis or the twist about it. With two axes
// it bounds the distance from the third axis, or the angle between the third axes of both frames (a cone). With three
// axes it bounds the distance of the frames' origins, or the whole angle between the frames.
struct AxesLimit {
  bool turns = false;                 // true: bounds rotation [rad]; false: bounds displacement [m]
  std::vector<std::size_t> axes;      // one to three axes of the joint's frame: 0, 1, 2 for x, y, z
  double low = -1000, high = 1000;    // the widest values are no limits
  double stiffness = 0, damping = 0;  // of the spring beyond the limit, as in JointDrive; 0: the limit is hard
  friend bool operator==(const AxesLimit&, const AxesLimit&) = default;
};

// A drive of a free joint, along an axis of its frame [m, N] or about the axis [rad, N m]. Targets are counted from the
// pose in which both frames coincide.
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
  double low_degrees = -179, high_degrees = 179;  // hinge: from the pose described; widest values: no limits
  double low_m = -1000, high_m = 1000;            // slider: from the pose described; widest values: no limits
  double limit_stiffness = 0, limit_damping = 0;  // of the limits' springs, as in JointDrive; 0: the limits are hard
  double friction_nm = 0;                         // torque that resists turning
  std::optional<JointDrive> drive;                // hinge, slider

  // A free joint measures position and rotation of a second frame relative to a first one. Both are given in world
  // coordinates, with the bodies as described. The first frame, at anchor_m, is fixed to `other`, or to `body` if
  // `frame_of_body` is set. The second frame is fixed to the remaining body.
  Rotation rotation;  // of the first frame
  Pose end;           // the second frame
  bool frame_of_body = false;
  std::vector<AxesLimit> limits;
  std::vector<AxisDrive> drives;
};

// Adds copies of a template body to the scene one after the other: the first at the template's start_s, each with its
// own scatter.
struct EmitterDescription {
  std::string name;  // bodies are named after it, with "-1", "-2" ... appended
  BodyDescription body;
  double every_s = 0.1;
  std::uint64_t count = 1;
};

// The camera for pictures of a scene.
struct CameraDescription {
  Vec3 position_m = {0, -2, 1}, target_m;
  double field_of_view_degrees = 50;  // vertical
};

// The listener of a scene, and the air between sources and listener.
struct ListenerDescription {
  Vec3 position_m = {0, -2, 1}, target_m;  // by default the listener faces the target, with the head upright
  std::optional<Rotation> rotation;        // if set, replaces that direction: x is in front, y left, z up
  double temperature_c = 20, humidity_percent = 50;
  std::shared_ptr<const MotionPath> path;  // if set, moves the listener; only from glTF
};

// Contacts act as springs with dampers. For a body of mass m, their softness absorbs the share m CFM/h of an impulse:
// with the defaults, 1 % at 20 kg and a step of 1/4000 s, and 0.1 % at 1/500 s.
struct ContactSettings {
  double spring_n_m = 1e9;
  double damper_ns_m = 8e6;
  double bounce_threshold_m_s = 0.05;  // a contact that approaches faster is a strike
  double minimum_repeat_s = 0.02;      // a pair that touches again within this time continues its contact
  // Mutual damping of bodies that rest on each other: damping force per speed and per newton of normal force, before
  // the factor of one minus the restitution. Hunt and Crossley's damping (1975), linearised about a static load.
  double rest_damping_s_m = 1.5;
  bool clicks = true;  // whether a struck body also sounds as a rigid body (engine/synth/modes/click.h)
};

struct SceneDescription {
  Vec3 gravity_m_s2 = {0, 0, -9.81};
  double step_s = 1.0 / 500;
  std::uint64_t seed = 1;
  double duration_s = 10;  // suggested length of a rendering
  ContactSettings contact;
  std::vector<ObjectDescription> objects;
  std::vector<BodyDescription> bodies;
  std::vector<StaticDescription> statics;
  std::vector<JointDescription> joints;
  std::vector<EmitterDescription> emitters;
  std::optional<CameraDescription> camera;
  std::optional<ListenerDescription> listener;
  std::optional<FoleyLimits> foley;  // set: contacts of animated bodies are recovered from their motion
};

}  // namespace ringdown::scene
