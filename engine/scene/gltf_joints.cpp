#include "engine/scene/gltf_joints.h"

#include "engine/scene/solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace ringdown::scene {
namespace {

using modal::Field;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLocked = 1e-9;   // m or rad: a narrower limit allows no motion
constexpr double kApart_m = 1e-6;  // farther ends are apart
constexpr double kDegrees = 180 / std::numbers::pi;

struct Freedom {
  double low = -kInfinity, high = kInfinity;
  double stiffness = 0, damping = 0;  // of the limits; 0: they are hard
  [[nodiscard]] bool locked() const { return high - low < kLocked && stiffness == 0; }
};

// The freedom that the limits of a joint leave, along and about the axes of its frame.
struct Freedoms {
  std::array<Freedom, 3> along, about;
};

std::size_t locked(const std::array<Freedom, 3>& freedoms) {
  return static_cast<std::size_t>(std::ranges::count_if(freedoms, &Freedom::locked));
}

// The first axis that is free.
int free_axis(const std::array<Freedom, 3>& freedoms) {
  return static_cast<int>(std::ranges::find_if_not(freedoms, &Freedom::locked) - freedoms.begin());
}

void read_limit(GltfDocument& document, const Field& limit, Freedoms& freedoms) {
  const bool linear = limit["linearAxes"].present();
  const Field axes = limit[linear ? "linearAxes" : "angularAxes"];
  const double low = document.number(limit["min"], -kInfinity), high = document.number(limit["max"], kInfinity);
  if (axes.size() < 1 || axes.size() > 3) return document.refuse(axes.wrong("one to three axes"));
  const double stiffness = document.number(limit["stiffness"], 0), damping = document.number(limit["damping"], 0);
  if (axes.size() > 1 && stiffness > 0)
    document.notes.add("soft limits of joints are hard where they hold several axes");
  // A limit over several axes is one of a distance or of an angle, which has no sign.
  const bool holds_all = axes.size() > 1 && high < kLocked;
  if (axes.size() > 1 && !holds_all) {
    return document.notes.add("joint limits that hold several axes within a width have no effect");
  }
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const auto axis = axes[k].index();
    if (!axis || *axis > 2) return document.refuse(axes[k].wrong("0, 1 or 2"));
    Freedom& freedom = (linear ? freedoms.along : freedoms.about)[*axis];
    freedom.low = std::max(freedom.low, holds_all ? 0 : low);
    freedom.high = std::min(freedom.high, holds_all ? 0 : high);
    if (axes.size() == 1) freedom.stiffness = std::max(freedom.stiffness, stiffness);
    if (axes.size() == 1) freedom.damping = std::max(freedom.damping, damping);
  }
}

double part(const Rotation& q, int axis) { return axis == 0 ? q.x : axis == 1 ? q.y : q.z; }
double part(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// The angle by which a rotation turns about an axis, -pi to pi: that of its twist.
double twist(const Rotation& turn, int axis) {
  const double angle = 2 * std::atan2(part(turn, axis), turn.w);
  return std::remainder(angle, 2 * std::numbers::pi);
}

// Makes one joint. Our joints begin in the pose of the scene, so everything is counted from where it lies there.
class JointMaker {
 public:
  JointMaker(GltfDocument& document, const JointEnd& first, const JointEnd& second, SceneDescription& scene)
      : document_(document),
        first_(first),
        second_(second),
        scene_(scene),
        frame_(parts_of(first.node.world.linear).rotation) {}

  void make(const Field& joint, bool collides) {
    Freedoms freedoms;
    const Field limits = joint["limits"], drives = joint["drives"];
    for (std::size_t k = 0; k < limits.size(); ++k) read_limit(document_, limits[k], freedoms);
    const auto type = type_of(freedoms);
    if (!document_.result()) return;
    if (!type) {
      return document_.notes.add("a joint that leaves " + std::to_string(3 - locked(freedoms.along)) +
                                 " axes to move along and " + std::to_string(3 - locked(freedoms.about)) +
                                 " to turn about is not supported, and is left out");
    }
    const auto body = std::ranges::find(scene_.bodies, second_.body, &BodyDescription::name);
    swapped_ = body == scene_.bodies.end() || body->fixed;
    made_.type = *type;
    made_.body = swapped_ ? first_.body : second_.body;
    made_.other = swapped_ ? second_.body : first_.body;
    made_.collides = collides;
    made_.anchor_m = first_.node.world.shift_m;
    if (*type == JointType::hinge) make_hinge(freedoms, drives);
    if (*type == JointType::slider) make_slider(freedoms, drives);
    if ((*type == JointType::ball || *type == JointType::fixed) && drives.size() > 0)
      document_.notes.add("drives of ball joints and of rigid joints have no effect");
    check_ends(freedoms);
    made_.name = first_.node.name;
    for (int k = 2; std::ranges::count(scene_.joints, made_.name, &JointDescription::name) > 0; ++k)
      made_.name = first_.node.name + "-" + std::to_string(k);
    scene_.joints.push_back(made_);
  }

 private:
  std::optional<JointType> type_of(const Freedoms& freedoms) {
    const std::size_t along = locked(freedoms.along), about = locked(freedoms.about);
    if (along == 2 && about == 3) return JointType::slider;
    if (along != 3) return {};
    if (about == 3) return JointType::fixed;
    if (about == 2) return JointType::hinge;
    const bool all_free = std::ranges::all_of(
        freedoms.about, [](const Freedom& f) { return f.low == -kInfinity && f.high == kInfinity; });
    if (!all_free) document_.notes.add("limits of a joint that turns about more than one axis have no effect");
    return JointType::ball;
  }

  [[nodiscard]] Vec3 axis(int k) const {
    const Matrix3 m = to_matrix(frame_);
    const Vec3 axis{m[0][static_cast<std::size_t>(k)], m[1][static_cast<std::size_t>(k)],
                    m[2][static_cast<std::size_t>(k)]};
    return swapped_ ? -1 * axis : axis;
  }

  void make_hinge(const Freedoms& freedoms, const Field& drives) {
    const int k = free_axis(freedoms.about);
    const double now = twist(inverse(frame_) * parts_of(second_.node.world.linear).rotation, k);
    const auto& [low, high, stiffness, damping] = within(freedoms.about[static_cast<std::size_t>(k)], now);
    made_.axis = axis(k);
    made_.low_degrees = std::max(kDegrees * low, range::kLimit_degrees.low);
    made_.high_degrees = std::min(kDegrees * high, range::kLimit_degrees.high);
    soften(freedoms.about[static_cast<std::size_t>(k)]);
    add_drive(drives, "angular", k, now);
  }

  void make_slider(const Freedoms& freedoms, const Field& drives) {
    const int k = free_axis(freedoms.along);
    const double now = part(apart(), k);
    const auto& [low, high, stiffness, damping] = within(freedoms.along[static_cast<std::size_t>(k)], now);
    made_.axis = axis(k);
    made_.low_m = std::max(low, range::kPosition_m.low);
    made_.high_m = std::min(high, range::kPosition_m.high);
    soften(freedoms.along[static_cast<std::size_t>(k)]);
    add_drive(drives, "linear", k, now);
  }

  void soften(const Freedom& freedom) {
    made_.limit_stiffness = freedom.stiffness;
    made_.limit_damping = freedom.stiffness > 0 ? freedom.damping : 0;
  }

  // Where the second end lies in the first one's frame.
  [[nodiscard]] Vec3 apart() const {
    return transpose(to_matrix(frame_)) * (second_.node.world.shift_m - first_.node.world.shift_m);
  }

  // A limit counted from the pose of the scene, which it must hold.
  Freedom within(const Freedom& freedom, double now) {
    if (freedom.low > now + kLocked || freedom.high < now - kLocked)
      document_.notes.add("a joint begins beyond its limits; the limits are widened to its beginning");
    return {std::min(freedom.low - now, 0.0), std::max(freedom.high - now, 0.0), freedom.stiffness, freedom.damping};
  }

  void check_ends(const Freedoms& freedoms) {
    const Vec3 way = apart();
    for (int k = 0; k < 3; ++k) {
      const Freedom& along = freedoms.along[static_cast<std::size_t>(k)];
      if (along.locked() && std::abs(part(way, k) - along.low) > kApart_m)
        document_.notes.add("a joint whose ends begin apart holds them as they lie");
    }
  }

  void add_drive(const Field& drives, const std::string& type, int axis, double now) {
    for (std::size_t k = 0; k < drives.size(); ++k) {
      const Field drive = drives[k];
      const auto number = drive["axis"].index();
      if (!number || *number > 2) return document_.refuse(drive["axis"].wrong("0, 1 or 2"));
      if (drive["type"].text_or("") != type || *number != static_cast<std::size_t>(axis) || made_.drive) {
        document_.notes.add("drives along or about what a joint holds, and second ones, have no effect");
        continue;
      }
      JointDrive made{.stiffness = document_.number(drive["stiffness"], 0),
                      .damping = document_.number(drive["damping"], 0),
                      .target = document_.number(drive["positionTarget"], now) - now,
                      .speed = document_.number(drive["velocityTarget"], 0),
                      .most = std::min(document_.number(drive["maxForce"], kInfinity), range::kDriveMost.high)};
      if (drive["mode"].text_or("force") == "acceleration") {
        const double inertia = inertia_of(type == "angular");
        made.stiffness *= inertia;
        made.damping *= inertia;
      }
      made_.drive = made;
    }
  }

  // The mass, or the moment of inertia about the joint's axis, that a drive moves.
  double inertia_of(bool angular) {
    double inverse_sum = 0;
    for (const std::string& name : {made_.body, made_.other}) {
      const auto body = std::ranges::find(scene_.bodies, name, &BodyDescription::name);
      if (name.empty() || body == scene_.bodies.end() || body->fixed) continue;
      if (!body->mass) {
        document_.notes.add("a drive by acceleration of a body without a mass of its own acts as on 1 kg or 1 kg m2");
        return 1;
      }
      const Matrix3 frame = to_matrix(body->rotation);
      const Vec3 unit = (1 / length(made_.axis)) * made_.axis, inner = transpose(frame) * unit;
      const Vec3 center = body->position_m + frame * body->mass->center_of_mass_m;
      const Vec3 arm = cross(center - made_.anchor_m, unit);
      const double moment = dot(inner, inertia_tensor(*body->mass) * inner) + body->mass->mass_kg * dot(arm, arm);
      inverse_sum += 1 / (angular ? moment : body->mass->mass_kg);
    }
    return inverse_sum > 0 ? 1 / inverse_sum : 1;
  }

  GltfDocument& document_;
  const JointEnd &first_, &second_;
  SceneDescription& scene_;
  Rotation frame_;        // of the first end
  bool swapped_ = false;  // whether the body is that of the first end
  JointDescription made_;
};

}  // namespace

void add_joint(GltfDocument& document, const Field& joint, const JointEnd& first, const JointEnd& second,
               SceneDescription& scene) {
  const auto moves = [&scene](const std::string& name) {
    return std::ranges::any_of(scene.bodies, [&](const auto& body) { return body.name == name && !body.fixed; });
  };
  if (first.body == second.body || !(moves(first.body) || moves(second.body)))
    return document.notes.add("a joint between nodes of one body, or of none that moves, has no effect");
  const Field described =
      document.element(joint["joint"], document.root()["extensions"]["KHR_physics_rigid_bodies"]["physicsJoints"]);
  const bool collides = document.flag(joint["enableCollision"], false);
  if (!described.present()) return;
  JointMaker(document, first, second, scene).make(described, collides);
}

}  // namespace ringdown::scene
