#include "engine/scene/scene_text.h"

#include "engine/base/formatted.h"
#include "engine/base/quote.h"

#include <concepts>
#include <utility>

namespace ringdown::scene {
namespace {

const char* name_of(ShapeType shape) {
  static constexpr const char* kNames[] = {"box", "sphere", "convex", "trimesh"};
  return kNames[static_cast<int>(shape)];
}

const char* name_of(Combine way) {
  static constexpr const char* kNames[] = {"average", "minimum", "maximum", "multiply", "geometric_mean"};
  return kNames[static_cast<int>(way)];
}

const char* name_of(JointType type) {
  static constexpr const char* kNames[] = {"hinge", "ball", "slider", "fixed", "free"};
  return kNames[static_cast<int>(type)];
}

std::string text_of(const std::string& text) { return toml_string(text); }
std::string text_of(double number) { return toml_number(number); }
std::string text_of(const Vec3& v) { return toml_vector(v); }
std::string text_of(std::same_as<bool> auto flag) { return flag ? "true" : "false"; }
std::string text_of(std::same_as<std::uint64_t> auto number) { return std::to_string(number); }

class SceneWriter {
 public:
  std::string write(const SceneDescription& scene) {
    heading("[scene]");
    const SceneDescription usual;
    unless("gravity_m_s2", scene.gravity_m_s2, usual.gravity_m_s2);
    unless("step_s", scene.step_s, usual.step_s);
    unless("seed", scene.seed, usual.seed);
    unless("duration_s", scene.duration_s, usual.duration_s);
    write(scene.contact);
    for (const ObjectDescription& object : scene.objects) write(object);
    for (const StaticDescription& item : scene.statics) write(item);
    for (const BodyDescription& body : scene.bodies) write(body, "[[body]]");
    for (const EmitterDescription& emitter : scene.emitters) {
      write(emitter.body, "[[emitter]]");
      line("every_s", emitter.every_s);
      line("count", emitter.count);
    }
    for (const JointDescription& joint : scene.joints) write(joint);
    if (scene.camera) {
      heading("[camera]");
      line("position_m", scene.camera->position_m);
      line("target_m", scene.camera->target_m);
      line("field_of_view_degrees", scene.camera->field_of_view_degrees);
    }
    if (scene.listener) {
      heading("[listener]");
      line("position_m", scene.listener->position_m);
      const ListenerDescription usual_listener;
      const Rotation turn = scene.listener->rotation.value_or(Rotation{});
      if (!scene.listener->rotation) {
        line("target_m", scene.listener->target_m);
      } else if (turn == Rotation{}) {
        line("target_m", scene.listener->position_m + Vec3{1, 0, 0});
      } else {
        write(turn);
      }
      unless("temperature_c", scene.listener->temperature_c, usual_listener.temperature_c);
      unless("humidity_percent", scene.listener->humidity_percent, usual_listener.humidity_percent);
    }
    return std::move(text_);
  }

 private:
  void heading(const char* heading) { text_.append("\n").append(heading).append("\n"); }

  template <class T>
  void line(const char* key, const T& value) {
    text_.append(key).append(" = ").append(text_of(value)).append("\n");
  }

  template <class T>
  void unless(const char* key, const T& value, const T& usual) {
    if (!(value == usual)) line(key, value);
  }

  void write(const ContactSettings& contact) {
    heading("[contact]");
    const ContactSettings usual;
    unless("spring_n_m", contact.spring_n_m, usual.spring_n_m);
    unless("damper_ns_m", contact.damper_ns_m, usual.damper_ns_m);
    unless("bounce_threshold_m_s", contact.bounce_threshold_m_s, usual.bounce_threshold_m_s);
    unless("minimum_repeat_s", contact.minimum_repeat_s, usual.minimum_repeat_s);
    unless("rest_damping_s_m", contact.rest_damping_s_m, usual.rest_damping_s_m);
    unless("clicks", contact.clicks, usual.clicks);
  }

  void write(const ObjectDescription& object) {
    heading("[[object]]");
    line("name", object.name);
    line("bank", object.bank.string());
    unless("group", object.group, {});
    unless("gain", object.gain, 1.0);
    unless("pan", object.pan, 0.0);
    if (object.level_m) line("level_m", *object.level_m);
    if (object.tubes)
      text_ += "resonator = { detune_cents = " + text_of(object.tubes->detune_cents) +
               ", opening = " + text_of(object.tubes->opening) + " }\n";
    if (object.fan.depth > 0)
      text_ += "fan = { rate_hz = " + text_of(object.fan.rate_hz) + ", depth = " + text_of(object.fan.depth) + " }\n";
    const modal::MaterialScale& m = object.material;
    if (m == modal::MaterialScale{}) return;
    text_ += "material = { alpha = " + text_of(m.alpha) + ", beta = " + text_of(m.beta) +
             ", density = " + text_of(m.density) + ", stiffness = " + text_of(m.stiffness) +
             ", size = " + text_of(m.size) + ", heat = " + text_of(m.heat) + ", air = " + text_of(m.air) + " }\n";
  }

  // A quaternion, because axis and angle would not come back to the last bit.
  static std::string text_of_turn(const Rotation& q) {
    return "rotation = { x = " + text_of(q.x) + ", y = " + text_of(q.y) + ", z = " + text_of(q.z) +
           ", w = " + text_of(q.w) + " }";
  }

  void write(const Rotation& q) {
    if (q != Rotation{}) text_ += text_of_turn(q) + "\n";
  }

  void write(const FrictionSurface& surface) {
    const FrictionSurface usual;
    unless("restitution", surface.restitution, usual.restitution);
    unless("friction", surface.friction, usual.friction);
    if (surface.sliding_friction) line("sliding_friction", *surface.sliding_friction);
    if (surface.restitution_combine != usual.restitution_combine)
      line("restitution_combine", std::string(name_of(surface.restitution_combine)));
    if (surface.friction_combine != usual.friction_combine)
      line("friction_combine", std::string(name_of(surface.friction_combine)));
    unless("rolling_m", surface.rolling_m, usual.rolling_m);
    if (surface.contact_time_s) line("contact_time_s", *surface.contact_time_s);
    unless("edge_radius_m", surface.edge_radius_m, usual.edge_radius_m);
    if (surface.young_pa) line("young_pa", *surface.young_pa);
    if (surface.poisson) line("poisson", *surface.poisson);
    unless("roughness_m", surface.texture.roughness_m, usual.texture.roughness_m);
    unless("correlation_m", surface.texture.correlation_m, usual.texture.correlation_m);
    unless("spectral_slope", surface.texture.spectral_slope, usual.texture.spectral_slope);
    unless("shortest_m", surface.texture.shortest_m, usual.texture.shortest_m);
    if (surface.waviness) line("waviness", *surface.waviness);
  }

  void write(const StaticDescription& item) {
    heading("[[static]]");
    line("name", item.name);
    if (item.type == StaticType::plane) {
      line("shape", std::string("plane"));
      unless("normal", item.normal, {0, 0, 1});
      unless("offset_m", item.offset_m, 0.0);
    } else {
      line("shape", std::string("box"));
      line("size_m", item.size_m);
      unless("position_m", item.position_m, {});
      write(item.rotation);
    }
    write(item.surface);
    write(item.filter);
  }

  // Any number of texts or numbers, as a TOML list.
  template <class Things>
  void list(const char* key, const Things& things) {
    if (things.empty()) return;
    text_.append(key).append(" = [");
    for (const auto& thing : things) text_.append(&thing == things.data() ? "" : ", ").append(text_of(thing));
    text_ += "]\n";
  }

  void write(const CollisionFilter& filter) {
    list("systems", filter.systems);
    list("only_with", filter.only_with);
    list("not_with", filter.not_with);
  }

  void write(const ShapeMesh& mesh) {
    std::vector<double> points;
    std::vector<std::uint64_t> corners;
    for (const Vec3& p : mesh.points_m) points.insert(points.end(), {p.x, p.y, p.z});
    for (const auto& triangle : mesh.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    list("points_m", points);
    list("triangles", corners);
  }

  void write(const modal::MassProperties& mass) {
    text_ += "mass = { mass_kg = " + text_of(mass.mass_kg) + ", center_of_mass_m = " + text_of(mass.center_of_mass_m) +
             ", inertia_kg_m2 = " + text_of(mass.inertia_kg_m2) + ", orientation = [" + text_of(mass.orientation[0]) +
             ", " + text_of(mass.orientation[1]) + ", " + text_of(mass.orientation[2]) + ", " +
             text_of(mass.orientation[3]) + "] }\n";
  }

  static std::string text_of_drive(const JointDrive& drive) {
    return formatted("stiffness = {}, damping = {}, target = {}, speed = {}, most = {}", text_of(drive.stiffness),
                     text_of(drive.damping), text_of(drive.target), text_of(drive.speed), text_of(drive.max));
  }

  static std::string text_of_axes(bool turns, std::span<const std::size_t> axes) {
    std::string text = turns ? "about = [" : "along = [";
    for (const std::size_t k : axes) text += formatted("{}\"{}\"", k == axes[0] ? "" : ", ", "xyz"[k]);
    return text + "]";
  }

  void write_free(const JointDescription& joint) {
    write(joint.rotation);
    if (joint.end != Pose{joint.anchor_m, joint.rotation}) {
      text_ +=
          "end = { position_m = " + text_of(joint.end.position_m) + ", " + text_of_turn(joint.end.rotation) + " }\n";
    }
    unless("frame_of_body", joint.frame_of_body, false);
    if (!joint.limits.empty()) text_ += "limits = [\n";
    for (const AxesLimit& limit : joint.limits) {
      text_ += "  { " + text_of_axes(limit.turns, limit.axes) + ", low = " + text_of(limit.low) +
               ", high = " + text_of(limit.high) + ", stiffness = " + text_of(limit.stiffness) +
               ", damping = " + text_of(limit.damping) + " },\n";
    }
    if (!joint.limits.empty()) text_ += "]\n";
    if (!joint.drives.empty()) text_ += "drives = [\n";
    for (const AxisDrive& drive : joint.drives)
      text_ += "  { " + text_of_axes(drive.turns, {&drive.axis, 1}) + ", " + text_of_drive(drive.drive) + " },\n";
    if (!joint.drives.empty()) text_ += "]\n";
  }

  void write(const BodyDescription& body, const char* kind) {
    heading(kind);
    line("name", body.name);
    unless("object", body.object, {});
    line("shape", std::string(name_of(body.shape.type)));
    unless("size_m", body.shape.size_m, {});
    unless("radius_m", body.shape.radius_m, 0.0);
    if (body.shape.center_m) line("center_m", *body.shape.center_m);
    if (body.shape.mesh) write(*body.shape.mesh);
    unless("density_kg_m3", body.density_kg_m3, 0.0);
    if (body.mass) write(*body.mass);
    unless("position_m", body.position_m, {});
    write(body.rotation);
    unless("velocity_m_s", body.velocity_m_s, {});
    unless("spin_rad_s", body.spin_rad_s, {});
    unless("fixed", body.fixed, false);
    if (body.two_way) line("contact", std::string("two-way"));
    unless("start_s", body.start_s, 0.0);
    unless("scatter_m", body.scatter_m, 0.0);
    unless("gravity_factor", body.gravity_factor, 1.0);
    write(body.surface);
    write(body.filter);
    if (body.breaks) write(*body.breaks);
  }

  void write(const Breaks& breaks) {
    if (breaks == Breaks{}) return line("breaks", true);
    text_ += "breaks = { crack_energy_factor = " + text_of(breaks.crack_energy_factor) +
             ", min_mass_kg = " + text_of(breaks.min_mass_kg);
    if (breaks.impulse_ns) text_ += ", impulse_ns = " + text_of(*breaks.impulse_ns);
    if (breaks.strength_pa) text_ += ", strength_pa = " + text_of(*breaks.strength_pa);
    text_ += " }\n";
  }

  void write(const JointDescription& joint) {
    const bool hinge = joint.type == JointType::hinge, slider = joint.type == JointType::slider;
    const JointDescription usual;
    heading("[[joint]]");
    line("name", joint.name);
    line("type", std::string(name_of(joint.type)));
    text_ +=
        formatted("bodies = [{}{}]\n", text_of(joint.body), joint.other.empty() ? "" : ", " + text_of(joint.other));
    line("anchor_m", joint.anchor_m);
    unless("collides", joint.collides, true);
    unless("friction_nm", joint.friction_nm, 0.0);
    if (joint.type == JointType::free) write_free(joint);
    if (!hinge && !slider) return;
    line("axis", joint.axis);
    if (joint.drive) text_ += "drive = { " + text_of_drive(*joint.drive) + " }\n";
    unless("limit_stiffness", joint.limit_stiffness, usual.limit_stiffness);
    unless("limit_damping", joint.limit_damping, usual.limit_damping);
    if (hinge) {
      unless("low_degrees", joint.low_degrees, usual.low_degrees);
      unless("high_degrees", joint.high_degrees, usual.high_degrees);
    } else {
      unless("low_m", joint.low_m, usual.low_m);
      unless("high_m", joint.high_m, usual.high_m);
    }
  }

  std::string text_;
};

}  // namespace

std::string to_toml(const SceneDescription& scene) { return SceneWriter().write(scene); }

}  // namespace ringdown::scene
