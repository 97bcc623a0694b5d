#include "engine/bake/makeup_file.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace ringdown::bake {
namespace {

constexpr Range kPlace_m{-1e6, 1e6}, kDirection{-1e6, 1e6};
constexpr Range kStiffness_n_m3{0, 1e18}, kDamping_ns_m3{0, 1e12}, kSpringLoss{0, 2}, kMass_kg{1e-9, 1e6};
constexpr Range kPointDamping_ns_m{0, 1e6}, kPointMass_kg{0, 1e3};
constexpr std::size_t kMaxPoints = 1000;  // of one cord

std::optional<Vec3> direction(TomlTable& table, const char* key) {
  if (!table.has(key)) return std::nullopt;
  Vec3 value{1, 0, 0};
  table.vector(key, value, kDirection);
  if (!(length(value) > 0)) table.complain(key, std::string(key) + " must have a length");
  return value;
}

std::optional<Grain> read_grain(TomlTable& file) {
  std::optional<TomlTable> table = file.table("grain");
  if (!table) return std::nullopt;
  Grain grain;
  const std::optional<Vec3> along = direction(*table, "along");
  grain.radial = direction(*table, "radial");
  grain.axis = direction(*table, "axis");
  table->vector("through", grain.through_m, kPlace_m);
  table->boolean("winds", grain.winds);
  if (along.has_value() == grain.axis.has_value())
    table->complain("along", "a grain has either a direction, along = [x, y, z], or an axis = [x, y, z]");
  if (grain.axis && grain.radial)
    table->complain("radial", "around an axis, the radial direction points away from the axis; leave radial out");
  if (!grain.axis && (table->has("through") || grain.winds))
    table->complain("axis", "through and winds belong to an axis = [x, y, z]");
  if (along) grain.along = *along;
  return grain;
}

void read_place(TomlTable& table, Place& place) {
  const auto six = [&table](const char* key, std::optional<std::array<Vec3, 2>>& target, const char* what) {
    if (!table.has(key)) return;
    std::vector<double> n;
    table.numbers(key, n);
    if (n.size() != 6) return table.complain(key, formatted("{} must be six numbers: {}", key, what));
    target = {Vec3{n[0], n[1], n[2]}, Vec3{n[3], n[4], n[5]}};
  };
  six("box", place.box_m, "two opposite corners, in metres");
  six("plane", place.plane, "a point in metres, and a normal");
  table.text("group", place.group);
  if (place.box_m.has_value() + place.plane.has_value() + !place.group.empty() != 1)
    table.complain("box", "the place is missing: give one of box, plane and group");
  if (place.plane && !(length((*place.plane)[1]) > 0)) table.complain("plane", "the plane's normal must have a length");
}

// A word for a support, as the damping that it stands for on an area and at points. The figures of cords, felt, foam
// and hands are our choice (docs/use/materials.md).
struct SupportWord {
  SupportKind kind = SupportKind::kSprings;
  double damping_ns_m3 = 0, point_damping_ns_m = 0;  // 0: not at points
};
constexpr std::array<SupportWord, 7> kWords{{{SupportKind::kClamped},
                                             {SupportKind::kSlides},
                                             {SupportKind::kSprings},
                                             {SupportKind::kPoints, 0, 1},
                                             {SupportKind::kSprings, 2e3, 1},
                                             {SupportKind::kSprings, 5e2, 0.3},
                                             {SupportKind::kSprings, 2e4, 10}}};

void read_points(TomlTable& table, Support& support) {
  std::vector<double> numbers;
  table.require({"points"});
  table.numbers("points", numbers);
  if (numbers.empty() || numbers.size() % 3 != 0 || numbers.size() > 3 * kMaxPoints)
    table.complain("points", "points must be three numbers for each point, in metres, of 1 to 1000 points");
  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
    support.points_m.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  table.number("damping", support.point_damping_ns_m, kPointDamping_ns_m);
  table.number("mass", support.point_mass_kg, kPointMass_kg);
}

Support read_support(TomlTable& table) {
  table.require({"kind"});
  const int kind = table.choice("kind", {"clamped", "slides", "springs", "cord", "felt", "foam", "hand"});
  const SupportWord& word = kWords[static_cast<std::size_t>(std::max(kind, 0))];
  Support support{.kind = word.kind};
  if (word.kind == SupportKind::kPoints || (word.point_damping_ns_m > 0 && table.has("points"))) {
    support.kind = SupportKind::kPoints;
    support.point_damping_ns_m = word.point_damping_ns_m;
    read_points(table, support);
    return support;
  }
  support.damping_ns_m3 = word.damping_ns_m3;
  read_place(table, support.place);
  table.number("stiffness", support.stiffness_n_m3, kStiffness_n_m3);
  support.stiffness_along_n_m3 = support.stiffness_n_m3;
  table.number("stiffness_along", support.stiffness_along_n_m3, kStiffness_n_m3);
  table.number("damping", support.damping_ns_m3, kDamping_ns_m3);
  table.number("loss_factor", support.loss_factor, kSpringLoss);
  if (support.kind != SupportKind::kSprings) {
    for (const char* key : {"stiffness", "stiffness_along", "damping", "loss_factor"}) {
      if (table.has(key)) table.complain(key, std::string(key) + " belongs to springs, felt, foam and hands");
    }
  }
  return support;
}

}  // namespace

void read_makeup(TomlTable& file, Makeup& makeup) {
  makeup.grain = read_grain(file);
  for (TomlTable& table : file.tables("part")) {
    Part& part = makeup.parts.emplace_back();
    table.require({"material"});
    table.text("group", part.group);
    table.text("surface", part.surface);
    if (part.group.empty() == part.surface.empty())
      table.complain("group", "the part's place is missing: give one of group and surface");
    table.text("material", part.material.name);
    part.grain = read_grain(table);
  }
  for (TomlTable& table : file.tables("support")) makeup.supports.push_back(read_support(table));
  for (TomlTable& table : file.tables("mass")) {
    GluedMass& mass = makeup.masses.emplace_back();
    table.require({"mass_kg"});
    table.number("mass_kg", mass.mass_kg, kMass_kg);
    read_place(table, mass.place);
  }
}

Result<Support> parse_support(const std::string& text) {
  Result<TomlTable> file = TomlTable::parse("support = { " + text + " }", "--support");
  if (!file) return fail(file);
  Support support;
  if (auto table = file->table("support")) support = read_support(*table);
  if (auto good = file->finish(); !good) return fail(good);
  return support;
}

}  // namespace ringdown::bake
