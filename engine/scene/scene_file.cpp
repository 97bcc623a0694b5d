#include "engine/scene/scene_file.h"

#include "engine/base/object_name.h"
#include "engine/base/quote.h"
#include "engine/base/toml_table.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/check.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>

namespace ringdown::scene {
namespace {

// `rotation = { axis = [x, y, z], degrees = a }`, or a unit quaternion, `rotation = { x = 0, y = 0, z = 0, w = 1 }`.
void read_rotation(TomlTable& table, Rotation& rotation) {
  std::optional<TomlTable> turn = table.table("rotation");
  if (!turn) return;
  if (turn->has("w")) {
    turn->require({"x", "y", "z", "w"});
    for (const auto& [key, part] :
         {std::pair("x", &rotation.x), {"y", &rotation.y}, {"z", &rotation.z}, {"w", &rotation.w}})
      turn->number(key, *part, {-1, 1});
    if (std::abs(norm(rotation) - 1) > 1e-6) turn->complain("w", "x, y, z and w must be a quaternion of length 1");
    return;
  }
  Vec3 axis = {0, 0, 1};
  double degrees = 0;
  turn->require({"axis", "degrees"});
  turn->vector("axis", axis, {-1e6, 1e6});
  turn->number("degrees", degrees, {-1e6, 1e6});
  if (!(length(axis) > 1e-6)) return turn->complain("axis", "axis must not be [0, 0, 0]");
  rotation = about(axis, degrees * std::numbers::pi / 180);
}

Vec3 triple(const std::vector<double>& numbers, std::size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

// `mass = { mass_kg = 2, center_of_mass_m = [0, 0, 0], inertia_kg_m2 = [1, 1, 1], orientation = [0, 0, 0, 1] }`.
void read_mass(TomlTable& table, std::optional<modal::MassProperties>& mass) {
  std::optional<TomlTable> own = table.table("mass");
  if (!own) return;
  own->require({"mass_kg", "inertia_kg_m2"});
  modal::MassProperties& m = mass.emplace();
  own->number("mass_kg", m.mass_kg, range::kMass_kg);
  own->vector("center_of_mass_m", m.center_of_mass_m, range::kPosition_m);
  own->vector("inertia_kg_m2", m.inertia_kg_m2, {0, 1e15});
  std::vector<double> turn(m.orientation.begin(), m.orientation.end());
  own->numbers("orientation", turn);
  if (turn.size() != 4) return own->complain("orientation", "orientation must be a quaternion, [x, y, z, w]");
  std::copy_n(turn.begin(), 4, m.orientation.begin());
}

// `points_m = [x, y, z, x, y, z, ...]` and `triangles = [0, 1, 2, ...]`.
void read_mesh(TomlTable& table, std::shared_ptr<const ShapeMesh>& target) {
  std::vector<double> points, corners;
  table.numbers("points_m", points);
  table.numbers("triangles", corners);
  if (points.empty()) return;
  if (points.size() % 3 != 0) return table.complain("points_m", "points_m must hold three numbers for each point");
  if (corners.size() % 3 != 0)
    return table.complain("triangles", "triangles must hold three numbers for each triangle");
  ShapeMesh mesh;
  for (std::size_t k = 0; k < points.size(); k += 3) mesh.points_m.push_back(triple(points, k));
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (!(corners[k] >= 0 && corners[k] < static_cast<double>(points.size() / 3)))
      return table.complain("triangles", "a triangle names a point that does not exist");
    if (k % 3 == 0) mesh.triangles.emplace_back();
    mesh.triangles.back()[k % 3] = static_cast<std::uint32_t>(corners[k]);
  }
  target = std::make_shared<const ShapeMesh>(std::move(mesh));
}

void read_filter(TomlTable& table, CollisionFilter& filter) {
  table.words("systems", filter.systems, true);
  table.words("only_with", filter.only_with, true);
  table.words("not_with", filter.not_with, true);
}

// `breaks = true`, or a table of when and how.
void read_breaks(TomlTable& table, std::optional<Breaks>& target) {
  if (!table.has_table("breaks")) {
    bool breaks = false;
    table.boolean("breaks", breaks);
    if (breaks) target.emplace();
    return;
  }
  TomlTable own = *table.table("breaks");
  Breaks& breaks = target.emplace();
  const auto read_optional = [&own](std::string_view key, std::optional<double>& value, const Range& range) {
    if (own.has(key)) own.number(key, value.emplace(range.low), range);
  };
  read_optional("impulse_ns", breaks.impulse_ns, range::kBreakImpulse_ns);
  read_optional("strength_pa", breaks.strength_pa, range::kStrength_pa);
  own.number("crack_energy_factor", breaks.crack_energy_factor, range::kCrackEnergyFactor);
  own.number("min_mass_kg", breaks.min_mass_kg, {0, range::kMass_kg.high});
}

void read_combine(TomlTable& table, std::string_view key, Combine& target) {
  if (!table.has(key)) return;
  const int way = table.choice(key, {"average", "minimum", "maximum", "multiply", "geometric_mean"});
  if (way >= 0) target = static_cast<Combine>(way);
}

void read_drive(TomlTable& table, JointDrive& drive) {
  table.number("stiffness", drive.stiffness, range::kDriveGain);
  table.number("damping", drive.damping, range::kDriveGain);
  table.number("target", drive.target, range::kDriveTarget);
  table.number("speed", drive.speed, range::kDriveTarget);
  table.number("most", drive.max, range::kDriveMost);
}

// Reads the axes of a limit or a drive of a free joint from `along = "x"` or `about = ["x", "y"]`; `turns` is set for
// `about`.
void read_axes(TomlTable& table, bool& turns, std::vector<std::size_t>& axes) {
  turns = table.has("about");
  if (turns == table.has("along")) return table.complain("along", "it needs either along or about, with its axes");
  std::vector<std::string> names;
  table.words(turns ? "about" : "along", names, true);
  for (const std::string& name : names) {
    if (name != "x" && name != "y" && name != "z") return table.complain("", "an axis is \"x\", \"y\" or \"z\"");
    axes.push_back(static_cast<std::size_t>(name[0] - 'x'));
  }
}

// The frames, limits and drives of a free joint.
void read_free(TomlTable& table, JointDescription& joint) {
  read_rotation(table, joint.rotation);
  joint.end = {joint.anchor_m, joint.rotation};
  if (auto end = table.table("end")) {
    end->vector("position_m", joint.end.position_m, range::kPosition_m);
    read_rotation(*end, joint.end.rotation);
  }
  table.boolean("frame_of_body", joint.frame_of_body);
  for (TomlTable& own : table.tables("limits")) {
    AxesLimit& limit = joint.limits.emplace_back();
    read_axes(own, limit.turns, limit.axes);
    own.number("low", limit.low, range::kAxesLimit);
    own.number("high", limit.high, range::kAxesLimit);
    own.number("stiffness", limit.stiffness, range::kDriveGain);
    own.number("damping", limit.damping, range::kDriveGain);
  }
  for (TomlTable& own : table.tables("drives")) {
    AxisDrive& drive = joint.drives.emplace_back();
    std::vector<std::size_t> axes;
    read_axes(own, drive.turns, axes);
    if (axes.size() > 1) own.complain("", "a drive has one axis");
    if (!axes.empty()) drive.axis = axes[0];
    read_drive(own, drive.drive);
  }
}

// Reads one file; every function adds to `scene_` or leaves its complaint in the file.
class SceneReader {
 public:
  SceneReader(std::filesystem::path path, std::filesystem::path presets)
      : path_(std::move(path)), presets_(std::move(presets)) {}

  Result<SceneDescription> read(TomlTable file) {
    if (auto table = file.table("scene")) read_settings(*table);
    if (auto table = file.table("contact")) read_contact(*table);
    for_each(file, "object", kMaxSceneObjects, [this](TomlTable& table) { read_object(table); });
    for_each(file, "static", kMaxStatics, [this](TomlTable& table) { read_static(table); });
    for_each(file, "body", kMaxBodies, [this](TomlTable& table) { read_body(table); });
    for_each(file, "emitter", kMaxEmitters, [this](TomlTable& table) { read_emitter(table); });
    for_each(file, "joint", kMaxJoints, [this](TomlTable& table) { read_joint(table); });
    if (auto table = file.table("camera")) read_camera(*table);
    if (auto table = file.table("listener")) read_listener(*table);
    if (auto good = file.finish(); !good) return fail(good);
    return std::move(scene_);
  }

 private:
  // Reads every [[kind]]; a name is given once.
  template <class Read>
  void for_each(TomlTable& file, std::string_view kind, std::size_t max, const Read& read) {
    std::map<std::string, std::uint32_t> names;
    std::size_t count = 0;
    for (TomlTable& table : file.tables(kind)) {
      if (++count > max) return table.complain("", formatted("a scene has at most {}", max));
      std::string name;
      table.text("name", name);
      const auto [first, is_new] = names.try_emplace(name, table.line_of("name"));
      if (!is_new && !name.empty()) {
        table.complain("name", formatted("the name is taken by line {}", first->second));
      }
      read(table);
    }
  }

  void read_settings(TomlTable& table) {
    table.vector("gravity_m_s2", scene_.gravity_m_s2, range::kGravity_m_s2);
    table.number("step_s", scene_.step_s, range::kStep_s);
    table.number("duration_s", scene_.duration_s, range::kDuration_s);
    table.whole("seed", scene_.seed);
    table.number("gain", gain_, range::kGain);
  }

  void read_contact(TomlTable& table) {
    ContactSettings& contact = scene_.contact;
    table.number("spring_n_m", contact.spring_n_m, range::kSpring_n_m);
    table.number("damper_ns_m", contact.damper_ns_m, range::kDamper_ns_m);
    table.number("bounce_threshold_m_s", contact.bounce_threshold_m_s, range::kBounceThreshold_m_s);
    table.number("minimum_repeat_s", contact.minimum_repeat_s, range::kMinimumRepeat_s);
    table.number("rest_damping_s_m", contact.rest_damping_s_m, range::kRestDamping_s_m);
    table.boolean("clicks", contact.clicks);
  }

  void read_object(TomlTable& table) {
    ObjectDescription object;
    std::string bank;
    table.require({"name", "bank"});
    table.text("name", object.name);
    table.text("bank", bank);
    table.text("group", object.group);
    table.number("gain", object.gain, range::kGain);
    object.gain *= gain_;
    if (!range::kGain.holds(object.gain))
      table.complain("gain", "gain times that of [scene] is too high; lower one of them");
    table.number("pan", object.pan, range::kPan);
    if (auto material = table.table("material")) read_material(*material, object);
    if (table.has("level_m")) table.number("level_m", object.level_m.emplace(), range::kPosition_m);
    if (auto tubes = table.table("resonator")) {
      modal::TubeTuning& tuning = object.tubes.emplace();
      tubes->number("detune_cents", tuning.detune_cents, modal::kTubeDetune_cents);
      tubes->number("opening", tuning.opening, modal::kTubeOpening);
    }
    if (auto fan = table.table("fan")) {
      fan->number("rate_hz", object.fan.rate_hz, synth::verb::Fan::kRate_hz);
      fan->number("depth", object.fan.depth, synth::verb::Fan::kDepth);
    }
    if (!object.name.empty() && !is_object_name(object.name)) {
      table.complain("name", "a name is 1 to 64 of A-Z a-z 0-9 _ . - and not digits only");
    }
    if (!object.group.empty() && !is_object_name(object.group)) {
      table.complain("group", "a group is 1 to 64 of A-Z a-z 0-9 _ . - and not digits only");
    }
    if (!bank.empty()) object.bank = find_bank(bank, table);
    scene_.objects.push_back(std::move(object));
  }

  void read_material(TomlTable& table, ObjectDescription& object) {
    table.number("alpha", object.material.alpha, range::kDampingScale);
    table.number("beta", object.material.beta, range::kDampingScale);
    table.number("density", object.material.density, range::kMaterialScale);
    table.number("stiffness", object.material.stiffness, range::kMaterialScale);
    table.number("size", object.material.size, range::kSizeScale);
    table.number("heat", object.material.heat, range::kDampingScale);
    table.number("air", object.material.air, range::kDampingScale);
  }

  std::filesystem::path find_bank(const std::string& bank, TomlTable& table) {
    const std::filesystem::path inside = path_.string() + bank;  // of the scene's own file: #2 is its model 2
    if (bank.starts_with('#') && modal::split_bank_path(inside).model.number) return inside;
    std::error_code ignored;
    const std::filesystem::path beside = path_.parent_path() / bank, preset = presets_ / bank;
    const auto exists = [&ignored](const std::filesystem::path& path) {
      return std::filesystem::is_regular_file(modal::split_bank_path(path).file, ignored);
    };
    if (exists(beside)) return beside;
    if (!presets_.empty() && exists(preset)) return preset;
    table.complain("bank", formatted("no bank {}{}; bake it with `ringdown bake`", beside.string(),
                                     presets_.empty() ? "" : " or " + preset.string()));
    return {};
  }

  void read_surface(TomlTable& table, FrictionSurface& surface) {
    table.number("restitution", surface.restitution, range::kRestitution);
    table.number("friction", surface.friction, range::kFriction);
    read_optional(table, "sliding_friction", surface.sliding_friction, range::kFriction);
    read_combine(table, "restitution_combine", surface.restitution_combine);
    read_combine(table, "friction_combine", surface.friction_combine);
    table.number("rolling_m", surface.rolling_m, range::kRolling_m);
    read_optional(table, "contact_time_s", surface.contact_time_s, range::kContactTime_s);
    table.number("edge_radius_m", surface.edge_radius_m, range::kEdgeRadius_m);
    read_optional(table, "young_pa", surface.young_pa, range::kYoung_pa);
    read_optional(table, "poisson", surface.poisson, range::kPoisson);
    table.number("roughness_m", surface.texture.roughness_m, range::kRoughness_m);
    table.number("correlation_m", surface.texture.correlation_m, range::kCorrelation_m);
    table.number("spectral_slope", surface.texture.spectral_slope, range::kSpectralSlope);
    table.number("shortest_m", surface.texture.shortest_m, range::kShortest_m);
    read_optional(table, "waviness", surface.waviness, range::kWaviness);
  }

  static void read_optional(TomlTable& table, std::string_view key, std::optional<double>& target, const Range& range) {
    double value = range.low;
    table.number(key, value, range);
    if (table.has(key)) target = value;
  }

  void read_static(TomlTable& table) {
    StaticDescription item;
    table.require({"name", "shape"});
    table.text("name", item.name);
    const int shape = table.choice("shape", {"plane", "box"});
    item.type = shape == 1 ? StaticType::box : StaticType::plane;
    if (shape == 0) {
      table.vector("normal", item.normal, {-1e6, 1e6});
      table.number("offset_m", item.offset_m, range::kPosition_m);
      if (!(length(item.normal) > 1e-6)) table.complain("normal", "normal must not be [0, 0, 0]");
    } else if (shape == 1) {
      table.require({"size_m"});
      table.vector("size_m", item.size_m, range::kSize_m);
      table.vector("position_m", item.position_m, range::kPosition_m);
      read_rotation(table, item.rotation);
    }
    read_surface(table, item.surface);
    read_filter(table, item.filter);
    scene_.statics.push_back(std::move(item));
  }

  void read_body(TomlTable& table) {
    BodyDescription body = read_motion(table);
    table.boolean("fixed", body.fixed);
    scene_.bodies.push_back(std::move(body));
  }

  // All keys of a body that may move.
  BodyDescription read_motion(TomlTable& table) {
    BodyDescription body;
    table.require({"name"});
    table.text("name", body.name);
    table.text("object", body.object);
    read_shape(table, body);
    table.vector("position_m", body.position_m, range::kPosition_m);
    read_rotation(table, body.rotation);
    table.vector("velocity_m_s", body.velocity_m_s, range::kVelocity_m_s);
    table.vector("spin_rad_s", body.spin_rad_s, range::kSpin_rad_s);
    body.two_way = table.choice("contact", {"one-way", "two-way"}) == 1;
    table.number("start_s", body.start_s, range::kStart_s);
    table.number("scatter_m", body.scatter_m, range::kScatter_m);
    table.number("gravity_factor", body.gravity_factor, range::kGravityFactor);
    read_surface(table, body.surface);
    read_filter(table, body.filter);
    read_breaks(table, body.breaks);
    const bool known = std::ranges::count(scene_.objects, body.object, &ObjectDescription::name) > 0;
    if (!body.object.empty() && !known) {
      table.complain("object", "the scene has no object " + quote(body.object));
    }
    return body;
  }

  void read_emitter(TomlTable& table) {
    EmitterDescription emitter;
    emitter.body = read_motion(table);
    emitter.name = emitter.body.name;
    table.require({"every_s", "count"});
    table.number("every_s", emitter.every_s, range::kEvery_s);
    table.whole("count", emitter.count, 1, kMaxBodies);
    scene_.emitters.push_back(std::move(emitter));
  }

  void read_joint(TomlTable& table) {
    JointDescription joint;
    std::vector<std::string> bodies;
    table.require({"name", "type", "bodies", "anchor_m"});
    table.text("name", joint.name);
    const int type = table.choice("type", {"hinge", "ball", "slider", "fixed", "free"});
    if (type >= 0) joint.type = static_cast<JointType>(type);
    const bool hinge = joint.type == JointType::hinge, slider = joint.type == JointType::slider;
    table.words("bodies", bodies, true);
    table.vector("anchor_m", joint.anchor_m, range::kPosition_m);
    table.boolean("collides", joint.collides);
    if (hinge || joint.type == JointType::ball)
      table.number("friction_nm", joint.friction_nm, range::kJointFriction_nm);
    if (hinge || slider) {
      table.require({"axis"});
      table.vector("axis", joint.axis, {-1e6, 1e6});
      if (auto own = table.table("drive")) read_drive(*own, joint.drive.emplace());
      table.number("limit_stiffness", joint.limit_stiffness, range::kDriveGain);
      table.number("limit_damping", joint.limit_damping, range::kDriveGain);
    }
    if (hinge) {
      table.number("low_degrees", joint.low_degrees, range::kLimit_degrees);
      table.number("high_degrees", joint.high_degrees, range::kLimit_degrees);
    } else if (slider) {
      table.number("low_m", joint.low_m, range::kPosition_m);
      table.number("high_m", joint.high_m, range::kPosition_m);
    }
    if (joint.type == JointType::free) read_free(table, joint);
    if (bodies.empty() || bodies.size() > 2) table.complain("bodies", "bodies must name one body or two");
    if (!bodies.empty()) joint.body = bodies[0];
    if (bodies.size() > 1) joint.other = bodies[1];
    if (const auto ok = check(joint, scene_.bodies); !ok && !joint.body.empty()) {
      table.complain("bodies", ok.error().message);
    }
    scene_.joints.push_back(std::move(joint));
  }

  void read_camera(TomlTable& table) {
    CameraDescription camera;
    table.vector("position_m", camera.position_m, range::kPosition_m);
    table.vector("target_m", camera.target_m, range::kPosition_m);
    table.number("field_of_view_degrees", camera.field_of_view_degrees, range::kFieldOfView_degrees);
    if (camera.position_m == camera.target_m) table.complain("target_m", "target_m must not be position_m");
    scene_.camera = camera;
  }

  void read_listener(TomlTable& table) {
    ListenerDescription listener;
    table.vector("position_m", listener.position_m, range::kPosition_m);
    table.vector("target_m", listener.target_m, range::kPosition_m);
    if (!table.has("rotation") && listener.position_m == listener.target_m)
      table.complain("target_m", "target_m must not be position_m");
    if (table.has("rotation")) read_rotation(table, listener.rotation.emplace());
    if (table.has("rotation") && table.has("target_m")) {
      table.complain("rotation", "a listener has a target_m or a rotation, not both");
    }
    table.number("temperature_c", listener.temperature_c, range::kTemperature_c);
    table.number("humidity_percent", listener.humidity_percent, range::kHumidity_percent);
    scene_.listener = listener;
  }

  void read_shape(TomlTable& table, BodyDescription& body) {
    const int shape = table.choice("shape", {"box", "sphere", "convex", "trimesh"});
    body.shape.type = shape < 0 ? ShapeType::box : static_cast<ShapeType>(shape);
    const bool box = body.shape.type == ShapeType::box, sphere = body.shape.type == ShapeType::sphere;
    if (box) table.vector("size_m", body.shape.size_m, range::kSize_m);
    if (sphere) table.number("radius_m", body.shape.radius_m, range::kSize_m);
    if (box || sphere) table.number("density_kg_m3", body.density_kg_m3, range::kDensity_kg_m3);
    if ((box || sphere) && table.has("center_m"))
      table.vector("center_m", body.shape.center_m.emplace(), range::kPosition_m);
    if (!box && !sphere) read_mesh(table, body.shape.mesh);
    read_mass(table, body.mass);
    if (!body.object.empty() || body.shape.mesh) return;
    if (!box && !sphere) table.complain("shape", "a body without an object is a box or a sphere, or has points_m");
    table.require({box ? "size_m" : "radius_m"});
    if (!table.has("fixed") && !body.mass) table.require({"density_kg_m3"});
  }

  std::filesystem::path path_, presets_;
  SceneDescription scene_;
  double gain_ = 1;  // of all objects
};

}  // namespace

Pose listener_pose(const ListenerDescription& listener) {
  if (listener.rotation) return {listener.position_m, normalized(*listener.rotation)};
  const Vec3 way = listener.target_m - listener.position_m;
  const double level = std::hypot(way.x, way.y);
  const double yaw = level > 0 ? std::atan2(way.y, way.x) : 0, pitch = std::atan2(way.z, level);
  return {listener.position_m, about({0, 0, 1}, yaw) * about({0, 1, 0}, -pitch)};
}

Result<SceneDescription> read_scene(const std::filesystem::path& path, const std::filesystem::path& presets) {
  Result<TomlTable> file = TomlTable::read(path);
  if (!file) return fail(file);
  return SceneReader(path, presets).read(std::move(*file));
}

Result<SceneDescription> parse_scene(std::string_view text, const std::filesystem::path& path,
                                     const std::filesystem::path& presets) {
  Result<TomlTable> file = TomlTable::parse(text, path);
  if (!file) return fail(file);
  return SceneReader(path, presets).read(std::move(*file));
}

}  // namespace ringdown::scene
