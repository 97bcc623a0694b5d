#include "engine/scene/scene_file.h"

#include "engine/base/atomic_file.h"
#include "engine/scene/check.h"
#include "engine/scene/toml_table.h"
#include "protocol/names.h"

#include <algorithm>
#include <map>
#include <system_error>

namespace ringdown::scene {
namespace {

// Reads one file; every function adds to `scene_` or leaves an error in `result_`.
class SceneReader {
 public:
  SceneReader(std::filesystem::path path, std::filesystem::path presets)
      : path_(std::move(path)), presets_(std::move(presets)) {}

  Result<SceneDescription> read(const toml::table& file) {
    TomlTable root(file, path_.string(), "");
    if (const auto* table = root.table("scene")) read_settings({*table, path_.string(), "[scene]"});
    if (const auto* table = root.table("contact")) read_contact({*table, path_.string(), "[contact]"});
    for_each(root, "object", kMostObjects, [this](TomlTable table) { read_object(table); });
    for_each(root, "static", kMostStatics, [this](TomlTable table) { read_static(table); });
    for_each(root, "body", kMostBodies, [this](TomlTable table) { read_body(table); });
    keep(root.finish());
    if (!result_) return fail(result_.error());
    return std::move(scene_);
  }

 private:
  void keep(const Result<void>& done) {
    if (result_) result_ = done;
  }

  // Reads every [[kind]]; a name stands in all sentences about its table and is given once.
  template <class Read>
  void for_each(TomlTable& root, const std::string& kind, std::size_t most, const Read& read) {
    const toml::array* tables = root.tables(kind);
    if (!tables) return;
    std::map<std::string, std::uint32_t> names;
    for (const toml::node& node : *tables) {
      const toml::table& table = *node.as_table();
      const std::string name = table["name"].value_or(std::string());
      const std::string what = name.empty() ? "[[" + kind + "]]" : kind + " " + protocol::quoted(name);
      TomlTable reader(table, path_.string(), what);
      const auto [first, is_new] = names.try_emplace(name, reader.line_of("name"));
      if (!is_new && !name.empty()) {
        reader.complain(reader.line_of("name"), "the name is taken by line " + std::to_string(first->second));
      }
      if (names.size() > most) reader.complain(reader.line(), "a scene has at most " + std::to_string(most));
      read(std::move(reader));
    }
  }

  void read_settings(TomlTable table) {
    table.vector("gravity_m_s2", scene_.gravity_m_s2, range::kGravity_m_s2);
    table.number("step_s", scene_.step_s, range::kStep_s);
    table.number("duration_s", scene_.duration_s, range::kDuration_s);
    table.seed("seed", scene_.seed);
    keep(table.finish());
  }

  void read_contact(TomlTable table) {
    ContactSettings& contact = scene_.contact;
    table.number("spring_n_m", contact.spring_n_m, range::kSpring_n_m);
    table.number("damper_ns_m", contact.damper_ns_m, range::kDamper_ns_m);
    table.number("bounce_threshold_m_s", contact.bounce_threshold_m_s, range::kBounceThreshold_m_s);
    table.number("minimum_repeat_s", contact.minimum_repeat_s, range::kMinimumRepeat_s);
    keep(table.finish());
  }

  void read_object(TomlTable& table) {
    ObjectDescription object;
    std::string bank;
    table.require({"name", "bank"});
    table.text("name", object.name);
    table.text("bank", bank);
    table.number("gain", object.gain, range::kGain);
    table.number("pan", object.pan, range::kPan);
    if (const auto* material = table.table("material")) read_material({*material, path_.string(), "material"}, object);
    if (!object.name.empty() && !protocol::is_object_name(object.name)) {
      table.complain(table.line_of("name"), "a name is 1 to 64 of A-Z a-z 0-9 _ . - and not digits only");
    }
    if (!bank.empty()) object.bank = find_bank(bank, table);
    keep(table.finish());
    scene_.objects.push_back(std::move(object));
  }

  void read_material(TomlTable table, ObjectDescription& object) {
    table.number("alpha", object.material.alpha, range::kDampingScale);
    table.number("beta", object.material.beta, range::kDampingScale);
    table.number("density", object.material.density, range::kMaterialScale);
    table.number("stiffness", object.material.stiffness, range::kMaterialScale);
    keep(table.finish());
  }

  std::filesystem::path find_bank(const std::string& bank, TomlTable& table) {
    std::error_code ignored;
    const std::filesystem::path beside = path_.parent_path() / bank, preset = presets_ / bank;
    if (std::filesystem::is_regular_file(beside, ignored)) return beside;
    if (!presets_.empty() && std::filesystem::is_regular_file(preset, ignored)) return preset;
    table.complain(table.line_of("bank"), "no bank " + beside.string() +
                                              (presets_.empty() ? "" : " or " + preset.string()) +
                                              "; bake it with `ringdown bake`");
    return {};
  }

  void read_surface(TomlTable& table, Surface& surface) {
    table.number("restitution", surface.restitution, range::kRestitution);
    table.number("friction", surface.friction, range::kFriction);
    table.number("contact_time_s", surface.contact_time_s, range::kContactTime_s);
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
      if (!(length(item.normal) > 1e-6)) table.complain(table.line_of("normal"), "normal must not be [0, 0, 0]");
    } else if (shape == 1) {
      table.require({"size_m"});
      table.vector("size_m", item.size_m, range::kSize_m);
      table.vector("position_m", item.position_m, range::kPosition_m);
      table.rotation("rotation", item.rotation);
    }
    read_surface(table, item.surface);
    keep(table.finish());
    scene_.statics.push_back(std::move(item));
  }

  void read_body(TomlTable& table) {
    BodyDescription body;
    table.require({"name"});
    table.text("name", body.name);
    table.text("object", body.object);
    read_shape(table, body);
    table.vector("position_m", body.position_m, range::kPosition_m);
    table.rotation("rotation", body.rotation);
    table.vector("velocity_m_s", body.velocity_m_s, range::kVelocity_m_s);
    table.vector("spin_rad_s", body.spin_rad_s, range::kSpin_rad_s);
    table.boolean("fixed", body.fixed);
    table.number("scatter_m", body.scatter_m, range::kScatter_m);
    read_surface(table, body.surface);
    const bool known = std::ranges::count(scene_.objects, body.object, &ObjectDescription::name) > 0;
    if (!body.object.empty() && !known) {
      table.complain(table.line_of("object"), "the scene has no object " + protocol::quoted(body.object));
    }
    keep(table.finish());
    scene_.bodies.push_back(std::move(body));
  }

  void read_shape(TomlTable& table, BodyDescription& body) {
    const int shape = table.choice("shape", {"box", "sphere", "convex", "trimesh"});
    body.shape.type = shape < 0 ? ShapeType::box : static_cast<ShapeType>(shape);
    const bool box = body.shape.type == ShapeType::box, sphere = body.shape.type == ShapeType::sphere;
    if (box) table.vector("size_m", body.shape.size_m, range::kSize_m);
    if (sphere) table.number("radius_m", body.shape.radius_m, range::kSize_m);
    if (box || sphere) table.number("density_kg_m3", body.density_kg_m3, range::kDensity_kg_m3);
    if (!body.object.empty()) return;
    if (!box && !sphere) table.complain(table.line_of("shape"), "a body without an object is a box or a sphere");
    table.require({box ? "size_m" : "radius_m"});
    if (!table.has("fixed")) table.require({"density_kg_m3"});
  }

  std::filesystem::path path_, presets_;
  SceneDescription scene_;
  Result<void> result_;
};

}  // namespace

Result<SceneDescription> read_scene(const std::filesystem::path& path, const std::filesystem::path& presets) {
  const Result<std::string> text = read_whole_file(path, kLargestSceneFile);
  if (!text) return fail(text.error());
  return parse_scene(*text, path, presets);
}

Result<SceneDescription> parse_scene(std::string_view text, const std::filesystem::path& path,
                                     const std::filesystem::path& presets) {
  const toml::parse_result file = toml::parse(text, path.string());
  if (!file) {
    const toml::parse_error& error = file.error();
    return fail(path.string() + ":" + std::to_string(error.source().begin.line) +
                ": not TOML: " + std::string(error.description()));
  }
  return SceneReader(path, presets).read(file.table());
}

}  // namespace ringdown::scene
