#include "server/session/note_map.h"

#include "engine/base/toml_table.h"
#include "protocol/defaults.h"
#include "engine/base/object_name.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace ringdown::session {
namespace {

constexpr Range kPoint_m{-1e4, 1e4}, kImpulse_ns{-1e4, 1e4}, kContactTime_s{0, 0.1}, kDamping_s{0.005, 60};
constexpr std::size_t kLeadingModes = 8;

template <class Value, class Read>
void optional(TomlTable& table, std::string_view key, std::optional<Value>& target, Read read) {
  if (table.has(key)) read(target.emplace());
}

NoteMap::Entry read_entry(TomlTable& table) {
  NoteMap::Entry entry;
  std::uint64_t note = 0;
  table.require({"note", "object"});
  table.whole("note", note, 0, kNotes - 1);
  table.text("object", entry.object);
  if (!entry.object.empty() && !is_object_name(entry.object)) {
    table.complain("object", "an object's name is 1 to 64 of A-Z a-z 0-9 _ . - and not digits only");
  }
  entry.note = note;
  optional(table, "point_m", entry.point_m, [&](Vec3& point) { table.vector("point_m", point, kPoint_m); });
  optional(table, "impulse_ns", entry.impulse_ns, [&](Vec3& j) { table.vector("impulse_ns", j, kImpulse_ns); });
  optional(table, "contact_time_s", entry.contact_time_s,
           [&](double& time) { table.number("contact_time_s", time, kContactTime_s); });
  return entry;
}

Vec3 as_vector(const modal::Vec3f& v) { return {v[0], v[1], v[2]}; }

// How much the leading modes move at a sample point.
double motion_at(const modal::Bank& bank, std::size_t point) {
  double sum = 0;
  for (std::size_t mode = 0; mode < std::min(bank.mode_count(), kLeadingModes); ++mode) {
    const Vec3 shape = as_vector(bank.shape(mode, point));
    sum += dot(shape, shape);
  }
  return sum;
}

}  // namespace

NoteTable::Strike best_strike(const ObjectState& object) {
  const modal::Bank& bank = object.map->bank();
  NoteTable::Strike strike{.object = object.number, .contact_time_s = protocol::kDefaultContactTimeS};
  if (bank.point_count() == 0 || bank.mode_count() == 0) return strike;
  std::size_t best = 0;
  double most = -1;
  for (std::size_t point = 0; point < bank.point_count(); ++point) {
    if (const double motion = motion_at(bank, point); motion > most) best = point, most = motion;
  }
  strike.point_m = object.material.size * as_vector(bank.positions[best]);
  const Vec3 direction = as_vector(bank.shape(0, best));
  const double mass_kg = bank.mass ? modal::rescale(*bank.mass, object.material).mass_kg : 1, size = length(direction);
  strike.impulse_ns = size > 0 ? (kDefaultVelocity_m_s * mass_kg / size) * direction : Vec3{};
  return strike;
}

Result<NoteMap> read_note_map(const std::filesystem::path& path) {
  auto file = TomlTable::read(path);
  if (!file) return fail(file.error());
  NoteMap map;
  optional(*file, "release_s", map.release_s, [&](double& time) { file->number("release_s", time, kDamping_s); });
  file->number("damp_s", map.damp_s, kDamping_s);
  std::set<std::size_t> seen;
  for (TomlTable& table : file->tables("note")) {
    map.notes.push_back(read_entry(table));
    if (!seen.insert(map.notes.back().note).second) table.complain("note", "this note has a [[note]] above already");
  }
  if (const auto good = file->finish(); !good) return fail(good.error());
  return map;
}

NoteTable resolve(const std::optional<NoteMap>& map, const std::vector<ObjectSnapshot>& objects) {
  NoteTable table;
  if (!map) {
    std::vector<ObjectSnapshot> ordered = objects;
    std::ranges::sort(ordered, {}, [](const ObjectSnapshot& object) { return object->number; });
    for (std::size_t i = 0; i < ordered.size() && kFirstDefaultNote + i < kNotes; ++i) {
      table.notes[kFirstDefaultNote + i] = best_strike(*ordered[i]);
    }
    return table;
  }
  table.release_s = map->release_s;
  table.damp_s = map->damp_s;
  for (const NoteMap::Entry& entry : map->notes) {
    const auto object =
        std::ranges::find(objects, entry.object, [](const ObjectSnapshot& o) -> const std::string& { return o->name; });
    if (object == objects.end()) continue;  // the object may be loaded later
    NoteTable::Strike strike = best_strike(**object);
    strike.point_m = entry.point_m.value_or(strike.point_m);
    strike.impulse_ns = entry.impulse_ns.value_or(strike.impulse_ns);
    strike.contact_time_s = entry.contact_time_s.value_or(strike.contact_time_s);
    table.notes[entry.note] = strike;
  }
  return table;
}

std::shared_ptr<const NoteTable> Notes::table() {
  const std::uint64_t version = rack_.observers().version();
  if (version_ != version) table_ = std::make_shared<const NoteTable>(resolve(map_, rack_.objects()));
  version_ = version;
  return table_;
}

}  // namespace ringdown::session
