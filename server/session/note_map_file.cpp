#include "server/session/note_map_file.h"

#include "engine/base/object_name.h"
#include "engine/base/toml_table.h"
#include "engine/microtuning/scala.h"

#include <cstdint>
#include <map>
#include <set>
#include <string_view>

namespace ringdown::session {
namespace {

constexpr Range kPoint_m{-1e4, 1e4}, kImpulse_ns{-1e4, 1e4}, kContactTime_s{0, 0.1}, kDamping_s{0.005, 60};
constexpr Range kBowSpeed_m_s{-10, 10}, kBowForce_n{0, 1000}, kDirection{-1e4, 1e4};

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
  table.text("bank", entry.bank);
  optional(table, "level_m", entry.level_m, [&](double& level) { table.number("level_m", level, kPoint_m); });
  optional(table, "point_m", entry.point_m, [&](Vec3& point) { table.vector("point_m", point, kPoint_m); });
  optional(table, "impulse_ns", entry.impulse_ns, [&](Vec3& j) { table.vector("impulse_ns", j, kImpulse_ns); });
  optional(table, "contact_time_s", entry.contact_time_s,
           [&](double& time) { table.number("contact_time_s", time, kContactTime_s); });
  optional(table, "bow_speed_m_s", entry.bow_speed_m_s,
           [&](double& speed) { table.number("bow_speed_m_s", speed, kBowSpeed_m_s); });
  optional(table, "bow_force_n", entry.bow_force_n,
           [&](double& force) { table.number("bow_force_n", force, kBowForce_n); });
  optional(table, "bow_direction", entry.bow_direction, [&](Vec3& way) {
    table.vector("bow_direction", way, kDirection);
    if (length(way) == 0)
      table.complain("bow_direction", "bow_direction must not be 0 0 0; it is the direction in which the hair moves");
  });
  if (entry.is_bowed() && (entry.impulse_ns || entry.contact_time_s))
    table.complain("note", "this note is struck and bowed; leave out either impulse_ns and contact_time_s or the bow");
  return entry;
}

// Reads the scale and the keyboard mapping that a map names, relative to its own folder.
void read_tuning(TomlTable& table, const std::filesystem::path& folder, NoteMap& map) {
  const auto path_of = [&](const char* key) {
    std::string name;
    if (table.has(key)) table.text(key, name);
    return name.empty() ? std::filesystem::path() : folder / name;
  };
  const std::filesystem::path scale = path_of("scale"), mapping = path_of("mapping");
  if (scale.empty() && mapping.empty()) return;
  auto tuning = microtuning::read_tuning(scale, mapping);
  if (tuning) {
    map.tuning = *tuning;
  } else {
    table.complain(scale.empty() ? "mapping" : "scale", tuning.error().message);
  }
}

}  // namespace

Result<NoteMap> read_note_map(const std::filesystem::path& path) {
  auto file = TomlTable::read(path);
  if (!file) return fail(file);
  NoteMap map;
  optional(*file, "release_s", map.release_s, [&](double& time) { file->number("release_s", time, kDamping_s); });
  file->number("damp_s", map.damp_s, kDamping_s);
  if (file->has("banks")) file->text("banks", map.banks);
  read_tuning(*file, path.parent_path(), map);
  std::set<std::size_t> seen;
  std::map<std::string, const NoteMap::Entry> first;  // of each object
  for (TomlTable& table : file->tables("note")) {
    map.notes.push_back(read_entry(table));
    const NoteMap::Entry& entry = map.notes.back();
    if (!seen.insert(entry.note).second) table.complain("note", "this note already has a [[note]] above");
    const NoteMap::Entry& before = first.try_emplace(entry.object, entry).first->second;
    if (before.level_m != entry.level_m || before.bank != entry.bank)
      table.complain(
          before.bank != entry.bank ? "bank" : "level_m",
          "another [[note]] of this object states another bank or level; give each level an object of its own");
  }
  if (const auto good = file->finish(); !good) return fail(good);
  return map;
}

}  // namespace ringdown::session
