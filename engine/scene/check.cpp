#include "engine/scene/check.h"

#include "engine/base/object_name.h"
#include "engine/base/quote.h"
#include "engine/base/range.h"
#include "engine/scene/motion_path.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace ringdown::scene {
namespace {

// Collects checks of one thing's fields; the first that fails is the answer.
class Fields {
 public:
  explicit Fields(std::string owner) : owner_(std::move(owner)) {}

  Fields& number(std::string_view field, double value, const Range& range) {
    if (const auto ok = check_range(value, range); !ok) refuse(formatted("{} {}", field, ok.error().message));
    return *this;
  }
  Fields& vector(std::string_view field, Vec3 v, const Range& range) {
    return number(field, v.x, range).number(field, v.y, range).number(field, v.z, range);
  }
  Fields& rotation(const Rotation& q) {
    return require(norm(q) > 1e-3 && norm(q) < 1e3, "its rotation is not a quaternion of length 1");
  }
  Fields& surface(const FrictionSurface& s) {
    return number("restitution", s.restitution, range::kRestitution)
        .number("friction", s.friction, range::kFriction)
        .number("sliding_friction", s.sliding_friction.value_or(s.friction), range::kFriction)
        .number("rolling_m", s.rolling_m, range::kRolling_m)
        .number("contact_time_s", s.contact_time_s.value_or(0), range::kContactTime_s)
        .number("edge_radius_m", s.edge_radius_m, range::kEdgeRadius_m)
        .number("young_pa", s.young_pa.value_or(kDefaultYoung_pa), range::kYoung_pa)
        .number("poisson", s.poisson.value_or(kDefaultPoisson), range::kPoisson)
        .number("roughness_m", s.texture.roughness_m, range::kRoughness_m)
        .number("correlation_m", s.texture.correlation_m, range::kCorrelation_m)
        .number("spectral_slope", s.texture.spectral_slope, range::kSpectralSlope)
        .number("shortest_m", s.texture.shortest_m, range::kShortest_m)
        .number("waviness", s.waviness.value_or(0), range::kWaviness);
  }
  Fields& require(bool holds, const std::string& otherwise) {
    if (!holds) refuse(otherwise);
    return *this;
  }
  Fields& breaks(const BodyDescription& body) {
    if (!body.breaks) return *this;
    const Breaks& breaks = *body.breaks;
    return number("breaks.impulse_ns", breaks.impulse_ns.value_or(1), range::kBreakImpulse_ns)
        .number("breaks.strength_pa", breaks.strength_pa.value_or(range::kStrength_pa.low), range::kStrength_pa)
        .number("breaks.crack_energy_factor", breaks.crack_energy_factor, range::kCrackEnergyFactor)
        .number("breaks.min_mass_kg", breaks.min_mass_kg, {0, range::kMass_kg.high})
        .require(!body.object.empty(), "it breaks, so it needs an object whose bank has pieces")
        .require(!body.fixed, "it is fixed, and a fixed body cannot break; remove fixed or breaks")
        .require(!body.two_way,
                 "it breaks, and the contacts of such a body cannot be two-way; remove contact or breaks")
        .require(!body.mass && body.density_kg_m3 == 0,
                 "it breaks, so its mass is that of its bank; remove mass or density_kg_m3");
  }
  [[nodiscard]] Result<void> result() const { return result_; }

 private:
  void refuse(const std::string& why) {
    if (result_) result_ = fail(ErrorKind::bad_input, owner_ + ": " + why);
  }
  std::string owner_;
  Result<void> result_;
};

void check_drive(const JointDrive& drive, Fields& fields) {
  fields.number("drive.stiffness", drive.stiffness, range::kDriveGain)
      .number("drive.damping", drive.damping, range::kDriveGain)
      .number("drive.target", drive.target, range::kDriveTarget)
      .number("drive.speed", drive.speed, range::kDriveTarget)
      .number("drive.most", drive.max, range::kDriveMost);
}

void check_free(const JointDescription& joint, Fields& fields) {
  fields.rotation(joint.rotation)
      .rotation(joint.end.rotation)
      .vector("end.position_m", joint.end.position_m, range::kPosition_m)
      .require(joint.limits.size() <= kMaxJointParts && joint.drives.size() <= kMaxJointParts,
               formatted("it has more than {} limits or drives", kMaxJointParts));
  for (const AxesLimit& limit : joint.limits) {
    std::vector<std::size_t> axes = limit.axes;
    std::ranges::sort(axes);
    const bool distinct = std::ranges::adjacent_find(axes) == axes.end();
    fields.require(!axes.empty() && distinct && axes.back() <= 2, "a limit holds one to three of its axes, each once")
        .number("limits.low", limit.low, range::kAxesLimit)
        .number("limits.high", limit.high, range::kAxesLimit)
        .require(limit.low <= limit.high, "the low end of a limit must not be above its high end")
        .number("limits.stiffness", limit.stiffness, range::kDriveGain)
        .number("limits.damping", limit.damping, range::kDriveGain);
  }
  for (const AxisDrive& drive : joint.drives) {
    fields.require(drive.axis <= 2, "a drive has one of the axes 0, 1 and 2");
    check_drive(drive.drive, fields);
  }
}

// Every element passes its own check, and no two share a name.
template <class Things>
Result<void> check_all(const Things& things, std::string_view kind, std::size_t max) {
  if (things.size() > max) {
    return fail(ErrorKind::too_large, "the scene has {} {}, more than the {} it may have", things.size(), kind, max);
  }
  std::set<std::string_view> names;
  for (const auto& thing : things) {
    if (const auto ok = check(thing); !ok) return ok;
    if (!thing.name.empty() && !names.insert(thing.name).second) {
      return fail(ErrorKind::bad_input, "two {} are named {}; names are unique", kind, quote(thing.name));
    }
  }
  return {};
}

// Returns whether the mass is in its range and all radii of gyration lie between a nanometre and 10,000 km, which
// represents infinite moments.
bool is_sound(const modal::MassProperties& mass) {
  const Vec3 c = mass.center_of_mass_m, i = mass.inertia_kg_m2;
  const Range moment{1e-18 * mass.mass_kg, 1e14 * mass.mass_kg};
  return range::kMass_kg.holds(mass.mass_kg) && moment.holds(i.x) && moment.holds(i.y) && moment.holds(i.z) &&
         range::kPosition_m.holds(c.x) && range::kPosition_m.holds(c.y) && range::kPosition_m.holds(c.z);
}

bool is_sound(const MotionPath& path) {
  const auto near = [](Vec3 v, const Range& range) { return range.holds(v.x) && range.holds(v.y) && range.holds(v.z); };
  const auto good = [&](const Pose& pose) {
    return near(pose.position_m, range::kPosition_m) && norm(pose.rotation) > 1e-3 && norm(pose.rotation) < 1e3;
  };
  return path.poses.size() <= kMaxPathPoses && (path.poses.empty() || path.every_s > 0) &&
         near(path.velocity_m_s, range::kVelocity_m_s) && near(path.spin_rad_s, range::kSpin_rad_s) &&
         std::ranges::all_of(path.poses, good);
}

Result<void> check_object(const BodyDescription& body, const SceneDescription& scene) {
  if (body.object.empty() || std::ranges::count(scene.objects, body.object, &ObjectDescription::name)) return {};
  return fail(ErrorKind::bad_input, "body {}: the scene has no object {}", quote(body.name), quote(body.object));
}

// A body that breaks is alone with its object, because the object falls silent, and has no joints.
Result<void> check_breaking(const SceneDescription& scene) {
  const auto players = [&](const std::string& object) {
    std::uint64_t count =
        static_cast<std::uint64_t>(std::ranges::count(scene.bodies, object, &BodyDescription::object));
    for (const EmitterDescription& emitter : scene.emitters) count += emitter.body.object == object ? emitter.count : 0;
    return count;
  };
  const auto check_alone = [&](const BodyDescription& body) -> Result<void> {
    if (!body.breaks || players(body.object) <= 1) return {};
    return fail(
        ErrorKind::bad_input,
        "body {}: it breaks, and other bodies play its object {}, too; give each body that breaks an object of its own",
        quote(body.name), quote(body.object));
  };
  for (const BodyDescription& body : scene.bodies) {
    if (auto ok = check_alone(body); !ok) return ok;
  }
  for (const EmitterDescription& emitter : scene.emitters) {
    if (auto ok = check_alone(emitter.body); !ok) return ok;
  }
  for (const JointDescription& joint : scene.joints) {
    for (const BodyDescription& body : scene.bodies) {
      if (!body.breaks || (body.name != joint.body && body.name != joint.other)) continue;
      return fail(ErrorKind::bad_input,
                  "joint {}: body {} breaks, and such a body cannot be joined; remove the joint or breaks",
                  quote(joint.name), quote(body.name));
    }
  }
  return {};
}

Result<void> check_world(const SceneDescription& scene) {
  return Fields("scene")
      .vector("gravity_m_s2", scene.gravity_m_s2, range::kGravity_m_s2)
      .number("step_s", scene.step_s, range::kStep_s)
      .number("duration_s", scene.duration_s, range::kDuration_s)
      .number("spring_n_m", scene.contact.spring_n_m, range::kSpring_n_m)
      .number("damper_ns_m", scene.contact.damper_ns_m, range::kDamper_ns_m)
      .number("bounce_threshold_m_s", scene.contact.bounce_threshold_m_s, range::kBounceThreshold_m_s)
      .number("minimum_repeat_s", scene.contact.minimum_repeat_s, range::kMinimumRepeat_s)
      .number("rest_damping_s_m", scene.contact.rest_damping_s_m, range::kRestDamping_s_m)
      .result();
}

}  // namespace

Result<void> check(const ObjectDescription& object) {
  const modal::MaterialScale& material = object.material;
  return Fields("object " + quote(object.name))
      .require(is_object_name(object.name), "a name is 1 to 64 of A-Z a-z 0-9 _ . - and not digits only")
      .require(object.group.empty() || is_object_name(object.group),
               "a group is 1 to 64 of A-Z a-z 0-9 _ . - and not digits only")
      .number("gain", object.gain, range::kGain)
      .number("pan", object.pan, range::kPan)
      .number("material.alpha", material.alpha, range::kDampingScale)
      .number("material.beta", material.beta, range::kDampingScale)
      .number("material.density", material.density, range::kMaterialScale)
      .number("material.stiffness", material.stiffness, range::kMaterialScale)
      .number("material.size", material.size, range::kSizeScale)
      .result();
}

Result<void> check(const BodyDescription& body) {
  const std::shared_ptr<const ShapeMesh>& mesh = body.shape.mesh;
  const auto in_range = [](Vec3 p) {
    return range::kPosition_m.holds(p.x) && range::kPosition_m.holds(p.y) && range::kPosition_m.holds(p.z);
  };
  const auto corners_exist = [&mesh](const std::array<std::uint32_t, 3>& corners) {
    return std::ranges::all_of(corners, [&](std::uint32_t corner) { return corner < mesh->points_m.size(); });
  };
  return Fields("body " + quote(body.name))
      .require(!body.mass || is_sound(*body.mass),
               "its mass, its centre or its moments of inertia are impossible for a body")
      .require(!body.path || body.fixed, "only a fixed body follows a path")
      .require(!body.path || is_sound(*body.path), "its path has poses or velocities that no body can have")
      .require(!mesh || mesh->points_m.size() <= kMaxMeshPoints,
               formatted("its mesh has more than {} points", kMaxMeshPoints))
      .require(!mesh || mesh->triangles.size() <= 4 * kMaxMeshPoints, "its mesh has too many triangles")
      .require(!mesh || std::ranges::all_of(mesh->points_m, in_range),
               "a point of its mesh is outside -1000 ... 1000 m")
      .require(!mesh || std::ranges::all_of(mesh->triangles, corners_exist), "a triangle of its mesh lacks a point")
      .vector("center_m", body.shape.center_m.value_or(Vec3{}), range::kPosition_m)
      .number("gravity_factor", body.gravity_factor, range::kGravityFactor)
      .vector("position_m", body.position_m, range::kPosition_m)
      .rotation(body.rotation)
      .vector("velocity_m_s", body.velocity_m_s, range::kVelocity_m_s)
      .vector("spin_rad_s", body.spin_rad_s, range::kSpin_rad_s)
      .number("start_s", body.start_s, range::kStart_s)
      .number("scatter_m", body.scatter_m, range::kScatter_m)
      .surface(body.surface)
      .breaks(body)
      .result();
}

Result<void> check(const StaticDescription& description) {
  Fields fields("static " + quote(description.name));
  if (description.type == StaticType::plane) {
    const double size = length(description.normal);
    fields.require(size > 1e-6 && size < 1e6, "its normal has no direction")
        .number("offset_m", description.offset_m, range::kPosition_m);
  } else {
    fields.vector("size_m", description.size_m, range::kSize_m)
        .vector("position_m", description.position_m, range::kPosition_m)
        .rotation(description.rotation);
  }
  return fields.surface(description.surface).result();
}

Result<void> check(const EmitterDescription& emitter) {
  if (auto ok = check(emitter.body); !ok) return ok;
  return Fields("emitter " + quote(emitter.name))
      .number("every_s", emitter.every_s, range::kEvery_s)
      .require(emitter.count >= 1 && emitter.count <= kMaxBodies,
               formatted("its count is outside 1 ... {}", kMaxBodies))
      .require(!emitter.body.fixed, "its bodies must be free to move")
      .result();
}

Result<void> check(const JointDescription& joint, std::span<const BodyDescription> bodies) {
  const auto moves = [&](const std::string& name) {
    return std::ranges::any_of(bodies, [&](const BodyDescription& body) { return body.name == name && !body.fixed; });
  };
  Fields fields("joint " + quote(joint.name));
  const auto known = [&](const std::string& name) {
    return std::ranges::count(bodies, name, &BodyDescription::name) > 0;
  };
  fields.require(known(joint.body), "the scene has no body " + quote(joint.body))
      .require(joint.other.empty() || known(joint.other), "the scene has no body " + quote(joint.other));
  fields.require(joint.body != joint.other, "it joins a body to itself")
      .require(moves(joint.body) || moves(joint.other), "one of its bodies must be free to move")
      .vector("anchor_m", joint.anchor_m, range::kPosition_m)
      .number("friction_nm", joint.friction_nm, range::kJointFriction_nm);
  const bool hinge = joint.type == JointType::hinge, slider = joint.type == JointType::slider;
  if (hinge || slider) {
    const double size = length(joint.axis);
    fields.require(size > 1e-6 && size < 1e7, "its axis has no direction");
  }
  fields.number("limit_stiffness", joint.limit_stiffness, range::kDriveGain)
      .number("limit_damping", joint.limit_damping, range::kDriveGain);
  if (joint.drive) {
    fields.require(hinge || slider, "only a hinge or a slider has a drive; a free joint has drives");
    check_drive(*joint.drive, fields);
  }
  if (joint.type == JointType::free) check_free(joint, fields);
  if (slider) {
    fields.number("low_m", joint.low_m, range::kPosition_m)
        .number("high_m", joint.high_m, range::kPosition_m)
        .require(joint.low_m <= 0 && joint.high_m >= 0, "its limits must hold the pose described, 0 m");
  }
  if (hinge) {
    fields.number("low_degrees", joint.low_degrees, range::kLimit_degrees)
        .number("high_degrees", joint.high_degrees, range::kLimit_degrees)
        .require(joint.low_degrees <= 0 && joint.high_degrees >= 0,
                 "its limits must hold the pose described, 0 degrees");
  }
  return fields.result();
}

Result<void> check(const SceneDescription& scene) {
  if (auto ok = check_world(scene); !ok) return ok;
  if (auto ok = check_all(scene.objects, "objects", kMaxSceneObjects); !ok) return ok;
  if (auto ok = check_all(scene.bodies, "bodies", kMaxBodies); !ok) return ok;
  if (auto ok = check_all(scene.statics, "statics", kMaxStatics); !ok) return ok;
  if (auto ok = check_all(scene.emitters, "emitters", kMaxEmitters); !ok) return ok;
  if (scene.joints.size() > kMaxJoints) {
    return fail(ErrorKind::too_large, "the scene has more than the {} joints it may have", kMaxJoints);
  }
  for (const JointDescription& joint : scene.joints) {
    if (auto ok = check(joint, scene.bodies); !ok) return ok;
  }
  if (auto ok = check_breaking(scene); !ok) return ok;
  std::vector<CollisionFilter> filters;
  const auto note = [&filters](const auto& thing) {
    if (!std::ranges::count(filters, thing.filter) && filters.size() <= kMaxFilters) filters.push_back(thing.filter);
  };
  std::ranges::for_each(scene.bodies, note);
  std::ranges::for_each(scene.statics, note);
  if (filters.size() > kMaxFilters) {
    return fail(ErrorKind::too_large, "the scene has more than the {} collision filters it may have", kMaxFilters);
  }
  std::uint64_t count = scene.bodies.size();
  for (const BodyDescription& body : scene.bodies) {
    if (auto ok = check_object(body, scene); !ok) return ok;
  }
  for (const EmitterDescription& emitter : scene.emitters) {
    if (auto ok = check_object(emitter.body, scene); !ok) return ok;
    count += emitter.count;
  }
  if (count > kMaxBodies) {
    return fail(ErrorKind::too_large, "the scene's bodies and emitters make {} bodies, more than the {} it may have",
                count, kMaxBodies);
  }
  return {};
}

}  // namespace ringdown::scene
