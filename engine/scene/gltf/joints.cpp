#include "engine/scene/gltf/joints.h"

#include "engine/base/quote.h"
#include "engine/scene/solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace ringdown::scene {
namespace {

using modal::JsonPlace;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLocked = 1e-9;   // m or rad: a narrower limit allows no motion
constexpr double kApart_m = 1e-6;  // farther ends are apart
constexpr double kDegrees = 180 / std::numbers::pi;
constexpr const char* kWidened = "a joint begins beyond its limits; the limits are widened to its beginning";

struct Freedom {
  double low = -kInfinity, high = kInfinity;
  double stiffness = 0, damping = 0;  // of the limits; 0: they are hard
  [[nodiscard]] bool locked() const { return high - low < kLocked && stiffness == 0; }
};

// The freedom that the limits of a joint leave, along and about the axes of its frame.
struct Freedoms {
  std::array<Freedom, 3> along, about;
  std::vector<AxesLimit> wide;  // limits over several axes that leave a width, or are soft
};

std::size_t locked(const std::array<Freedom, 3>& freedoms) {
  return static_cast<std::size_t>(std::ranges::count_if(freedoms, &Freedom::locked));
}

// The first axis that is free.
int free_axis(const std::array<Freedom, 3>& freedoms) {
  return static_cast<int>(std::ranges::find_if_not(freedoms, &Freedom::locked) - freedoms.begin());
}

Vec3 unit(int axis) { return {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0}; }
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

  void make(const JsonPlace& joint, bool collides) {
    Freedoms freedoms;
    const JsonPlace limits = joint["limits"], drives = joint["drives"];
    for (std::size_t k = 0; k < limits.size(); ++k) read_limit(limits[k], freedoms);
    read_drives(drives, freedoms);
    const JointType type = type_of(freedoms);
    if (!document_.result()) return;
    const auto body = std::ranges::find(scene_.bodies, second_.body, &BodyDescription::name);
    swapped_ = body == scene_.bodies.end() || body->fixed;
    made_.type = type;
    made_.body = swapped_ ? first_.body : second_.body;
    made_.other = swapped_ ? second_.body : first_.body;
    made_.collides = collides;
    made_.anchor_m = first_.node.world.shift_m;
    if (type == JointType::hinge) make_hinge(freedoms);
    if (type == JointType::slider) make_slider(freedoms);
    if (type == JointType::free) make_free(freedoms);
    check_ends(freedoms);
    made_.name = first_.node.name;
    for (int k = 2; std::ranges::count(scene_.joints, made_.name, &JointDescription::name) > 0; ++k)
      made_.name = formatted("{}-{}", first_.node.name, k);
    scene_.joints.push_back(made_);
  }

 private:
  void read_limit(const JsonPlace& limit, Freedoms& freedoms) {
    const bool linear = limit["linearAxes"].present();
    const JsonPlace axes = limit[linear ? "linearAxes" : "angularAxes"];
    const double low = document_.number(limit["min"], -kInfinity), high = document_.number(limit["max"], kInfinity);
    if (axes.size() < 1 || axes.size() > 3) return document_.refuse(axes.wrong("one to three axes"));
    const double stiffness = document_.number(limit["stiffness"], 0), damping = document_.number(limit["damping"], 0);
    // A limit over several axes is one of a distance or of an angle, which has no sign.
    const bool holds_all = axes.size() > 1 && high < kLocked && stiffness == 0;
    AxesLimit wide{.turns = !linear, .axes = {}, .stiffness = stiffness};
    if (low > 0) wide.low = std::min(low, range::kAxesLimit.high);
    wide.high = std::clamp(high, std::max(wide.low, 0.0), range::kAxesLimit.high);
    wide.damping = stiffness > 0 ? damping : 0;
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const auto axis = axes[k].index();
      if (!axis || *axis > 2) return document_.refuse(axes[k].wrong("0, 1 or 2"));
      wide.axes.push_back(*axis);
      if (axes.size() > 1 && !holds_all) continue;
      Freedom& freedom = (linear ? freedoms.along : freedoms.about)[*axis];
      freedom.low = std::max(freedom.low, holds_all ? 0 : low);
      freedom.high = std::min(freedom.high, holds_all ? 0 : high);
      if (axes.size() == 1) freedom.stiffness = std::max(freedom.stiffness, stiffness);
      if (axes.size() == 1) freedom.damping = std::max(freedom.damping, damping);
    }
    if (axes.size() > 1 && !holds_all) freedoms.wide.push_back(std::move(wide));
  }

  // A joint with freedom for which ODE has one joint, and at most one drive in this freedom, is that joint.
  [[nodiscard]] JointType type_of(const Freedoms& freedoms) const {
    const std::size_t along = locked(freedoms.along), about = locked(freedoms.about), count = drives_.size();
    if (!freedoms.wide.empty() || count > 1) return JointType::free;
    if (along == 2 && about == 3) return JointType::slider;
    if (along != 3) return JointType::free;
    if (about == 3) return JointType::fixed;
    if (about == 2) return JointType::hinge;
    const bool all_free = std::ranges::all_of(
        freedoms.about, [](const Freedom& f) { return f.low == -kInfinity && f.high == kInfinity; });
    return all_free && count == 0 ? JointType::ball : JointType::free;
  }

  [[nodiscard]] Vec3 axis(int k) const {
    const Vec3 axis = rotated(frame_, unit(k));
    return swapped_ ? -1 * axis : axis;
  }

  void make_hinge(const Freedoms& freedoms) {
    const int k = free_axis(freedoms.about);
    const double now = twist(turned(), k);
    const auto& [low, high, stiffness, damping] = within(freedoms.about[static_cast<std::size_t>(k)], now);
    made_.axis = axis(k);
    made_.low_degrees = std::max(kDegrees * low, range::kLimit_degrees.low);
    made_.high_degrees = std::min(kDegrees * high, range::kLimit_degrees.high);
    soften(freedoms.about[static_cast<std::size_t>(k)]);
    if (!drives_.empty()) made_.drive = drive_of(drives_[0], now);
  }

  void make_slider(const Freedoms& freedoms) {
    const int k = free_axis(freedoms.along);
    const double now = part(apart(), k);
    const auto& [low, high, stiffness, damping] = within(freedoms.along[static_cast<std::size_t>(k)], now);
    made_.axis = axis(k);
    made_.low_m = std::max(low, range::kPosition_m.low);
    made_.high_m = std::min(high, range::kPosition_m.high);
    soften(freedoms.along[static_cast<std::size_t>(k)]);
    if (!drives_.empty()) made_.drive = drive_of(drives_[0], now);
  }

  void soften(const Freedom& freedom) {
    made_.limit_stiffness = freedom.stiffness;
    made_.limit_damping = freedom.stiffness > 0 ? freedom.damping : 0;
  }

  // Returns the position of the second end in the first one's frame.
  [[nodiscard]] Vec3 apart() const {
    return transpose(to_matrix(frame_)) * (second_.node.world.shift_m - first_.node.world.shift_m);
  }

  // Returns the rotation of the second end in the first one's frame.
  [[nodiscard]] Rotation turned() const { return inverse(frame_) * parts_of(second_.node.world.linear).rotation; }

  // A limit counted from the pose of the scene, which it must hold.
  Freedom within(const Freedom& freedom, double now) {
    if (freedom.low > now + kLocked || freedom.high < now - kLocked) document_.notes.add(kWidened);
    return {std::min(freedom.low - now, 0.0), std::max(freedom.high - now, 0.0), freedom.stiffness, freedom.damping};
  }

  void check_ends(const Freedoms& freedoms) {
    const Vec3 way = apart();
    for (int k = 0; k < 3; ++k) {
      const Freedom& along = freedoms.along[static_cast<std::size_t>(k)];
      if (along.locked() && std::abs(part(way, k) - along.low) > kApart_m)
        document_.notes.add("a joint whose ends begin apart holds them as they are");
    }
  }

  struct Drive {
    JsonPlace field;
    bool turns;
    int axis;
  };

  void read_drives(const JsonPlace& drives, const Freedoms& freedoms) {
    for (std::size_t k = 0; k < drives.size(); ++k) {
      const JsonPlace drive = drives[k];
      const auto number = drive["axis"].index();
      if (!number || *number > 2) return document_.refuse(drive["axis"].wrong("0, 1 or 2"));
      const std::string type = drive["type"].text_or("");
      const bool turns = type == "angular";
      if (!turns && type != "linear") {
        document_.notes.add("drives that are neither linear nor angular have no effect");
      } else if ((turns ? freedoms.about : freedoms.along)[*number].locked()) {
        document_.notes.add("drives on an axis that a joint locks have no effect");
      } else {
        drives_.push_back({drive, turns, static_cast<int>(*number)});
      }
    }
  }

  // Targets are counted from `from`. A drive without one has the place or the angle in which the scene begins.
  JointDrive drive_of(const Drive& drive, double from, std::optional<double> now = {}) {
    const JsonPlace& field = drive.field;
    JointDrive made{.stiffness = document_.number(field["stiffness"], 0),
                    .damping = document_.number(field["damping"], 0),
                    .target = document_.number(field["positionTarget"], now.value_or(from)) - from,
                    .speed = document_.number(field["velocityTarget"], 0),
                    .max = std::min(document_.number(field["maxForce"], kInfinity), range::kDriveMost.high)};
    if (field["mode"].text_or("force") == "acceleration") {
      const double inertia = inertia_of(drive.turns, axis(drive.axis));
      made.stiffness *= inertia;
      made.damping *= inertia;
    }
    return made;
  }

  // A free joint takes the limits unchanged. Locked freedoms are held at their present pose, and hard limits are
  // widened to include it.
  void make_free(const Freedoms& freedoms) {
    made_.frame_of_body = swapped_;
    made_.rotation = frame_;
    locked_turns_ = locked(freedoms.about);
    Rotation turn = turned();
    if (locked_turns_ == 3) turn = {};
    if (locked_turns_ == 2) turn = about(unit(free_axis(freedoms.about)), twist(turn, free_axis(freedoms.about)));
    made_.end = {second_.node.world.shift_m, normalized(frame_ * turn)};
    turns_freely_ = locked(freedoms.along) < 3;
    for (const bool turns : {false, true}) {
      for (int k = 0; k < 3; ++k)
        add_limit((turns ? freedoms.about : freedoms.along)[static_cast<std::size_t>(k)], turns, k);
    }
    for (const AxesLimit& limit : freedoms.wide) {
      made_.limits.push_back(limit);
      widen(made_.limits.back(), size_now(limit));
    }
    for (const Drive& drive : drives_) {
      made_.drives.push_back({.turns = drive.turns,
                              .axis = static_cast<std::size_t>(drive.axis),
                              .drive = drive_of(drive, 0, now(drive.turns, drive.axis))});
    }
    if (made_.limits.size() > kMaxJointParts || made_.drives.size() > kMaxJointParts)
      document_.refuse(fail(ErrorKind::too_large, "joint {} has more than {} limits or drives", quote(first_.node.name),
                            kMaxJointParts));
  }

  // The way along an axis, or the twist about it, with which the scene begins.
  [[nodiscard]] double now(bool turns, int k) const { return turns ? twist(turned(), k) : part(apart(), k); }

  // The distance or the angle that a limit over several axes bounds, as the scene begins.
  [[nodiscard]] double size_now(const AxesLimit& limit) const {
    if (!limit.turns) {
      Vec3 way;
      for (const std::size_t k : limit.axes) way = way + part(apart(), static_cast<int>(k)) * unit(static_cast<int>(k));
      return length(way);
    }
    if (limit.axes.size() == 3) return length(to_rotation_vector(turned()));
    const Vec3 axis = unit(static_cast<int>(3 - limit.axes[0] - limit.axes[1])), tilted = rotated(turned(), axis);
    return std::atan2(length(cross(axis, tilted)), dot(axis, tilted));
  }

  void add_limit(const Freedom& freedom, bool turns, int k) {
    AxesLimit limit{.turns = turns, .axes = {static_cast<std::size_t>(k)}};
    limit.low = std::max(freedom.low, range::kAxesLimit.low);
    limit.high = std::max(std::min(freedom.high, range::kAxesLimit.high), limit.low);
    limit.stiffness = freedom.stiffness;
    limit.damping = freedom.stiffness > 0 ? freedom.damping : 0;
    if (limit.low == range::kAxesLimit.low && limit.high == range::kAxesLimit.high) return;
    if (freedom.locked()) {
      limit.low = limit.high = turns && locked_turns_ > 1 ? 0 : now(turns, k);
    } else {
      widen(limit, now(turns, k));
    }
    made_.limits.push_back(limit);
  }

  void widen(AxesLimit& limit, double now) {
    if (limit.stiffness > 0) return;
    if (limit.low > now + kLocked || limit.high < now - kLocked) document_.notes.add(kWidened);
    if (limit.low > range::kAxesLimit.low) limit.low = std::min(limit.low, now);
    limit.high = std::max(limit.high, now);
  }

  // The mass, or the moment of inertia about the joint's axis, that a drive moves.
  double inertia_of(bool angular, Vec3 axis) {
    double inverse_sum = 0;
    for (const std::string& name : {made_.body, made_.other}) {
      const auto body = std::ranges::find(scene_.bodies, name, &BodyDescription::name);
      if (name.empty() || body == scene_.bodies.end() || body->fixed) continue;
      if (!body->mass) {
        document_.notes.add("a drive by acceleration acts on a body without its own mass as on 1 kg or 1 kg m2");
        return 1;
      }
      const Matrix3 frame = to_matrix(body->rotation);
      const Vec3 inner = transpose(frame) * axis;
      const Vec3 center = body->position_m + frame * body->mass->center_of_mass_m;
      const Vec3 arm = turns_freely_ ? Vec3{} : cross(center - made_.anchor_m, axis);
      const double moment = dot(inner, inertia_tensor(*body->mass) * inner) + body->mass->mass_kg * dot(arm, arm);
      inverse_sum += 1 / (angular ? moment : body->mass->mass_kg);
    }
    return inverse_sum > 0 ? 1 / inverse_sum : 1;
  }

  GltfDocument& document_;
  const JointEnd &first_, &second_;
  SceneDescription& scene_;
  Rotation frame_;                // of the first end
  bool swapped_ = false;          // whether the body is that of the first end
  bool turns_freely_ = false;     // about the bodies' own centres, not about the joint
  std::size_t locked_turns_ = 0;  // axes that the joint does not turn about
  std::vector<Drive> drives_;     // in freedom that the joint leaves
  JointDescription made_;
};

}  // namespace

void add_joint(GltfDocument& document, const JsonPlace& joint, const JointEnd& first, const JointEnd& second,
               SceneDescription& scene) {
  const auto moves = [&scene](const std::string& name) {
    return std::ranges::any_of(scene.bodies, [&](const auto& body) { return body.name == name && !body.fixed; });
  };
  if (first.body == second.body || !(moves(first.body) || moves(second.body)))
    return document.notes.add("a joint between nodes of one body, or without a body that moves, has no effect");
  const JsonPlace described =
      document.element(joint["joint"], document.root()["extensions"]["KHR_physics_rigid_bodies"]["physicsJoints"]);
  const bool collides = document.flag(joint["enableCollision"], false);
  if (!described.present()) return;
  JointMaker(document, first, second, scene).make(described, collides);
}

}  // namespace ringdown::scene
