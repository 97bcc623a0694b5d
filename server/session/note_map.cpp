#include "server/session/note_map.h"

#include "engine/base/note.h"
#include "engine/modal/hearing/contact_pulse.h"
#include "engine/modal/material_scale.h"
#include "protocol/defaults.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace ringdown::session {
namespace {

constexpr std::size_t kLeadingModes = 8;

Vec3 as_vector(const modal::Vec3f& v) { return {v[0], v[1], v[2]}; }

// Returns the motion of the leading modes at a sample point.
double motion_at(const modal::Bank& bank, std::size_t point) {
  double sum = 0;
  for (std::size_t mode = 0; mode < std::min(bank.mode_count(), kLeadingModes); ++mode) {
    const Vec3 shape = as_vector(bank.shape(mode, point));
    sum += dot(shape, shape);
  }
  return sum;
}

// Returns the direction in which the first leading mode that has an average share of the motion at a sample point moves
// there. One mode always has such a share. The first mode of all may be at rest, on one of its nodal lines.
Vec3 direction_at(const modal::Bank& bank, std::size_t point) {
  const double share = motion_at(bank, point) / static_cast<double>(kLeadingModes);
  for (std::size_t mode = 0; mode < std::min(bank.mode_count(), kLeadingModes); ++mode) {
    const Vec3 shape = as_vector(bank.shape(mode, point));
    if (const double motion = dot(shape, shape); motion > 0 && motion >= share) return (1 / std::sqrt(motion)) * shape;
  }
  return {};
}

// Returns the sum of the modes' amplitudes after a strike, which the sound pressure at 1 m does not exceed [Pa], for an
// object of gain 1.
double peak_bound_pa(const ObjectState& object, const NoteTable::Strike& strike) {
  const modal::Bank& bank = object.map->bank();
  std::vector<double> velocities(bank.mode_count());
  object.map->excite((1 / object.material.size) * strike.point_m, strike.impulse_ns, velocities);
  double sum_pa = 0;
  for (std::size_t m = 0; m < velocities.size(); ++m) {
    const double frequency_hz = modal::rescale(bank, m, object.material).frequency_hz;
    if (frequency_hz == 0) continue;
    const double share = modal::pulse_spectrum(frequency_hz, strike.contact_time_s);
    sum_pa +=
        std::abs(velocities[m] * share) * object.map->loudness().pressure_pa(bank, m, object.material, frequency_hz);
  }
  return bank.gain * modal::shape_factor(object.material) * sum_pa;
}

// Changes the impulse so that the strike is between kMinDefault_pa and kMaxDefault_pa loud.
void keep_in_range(const ObjectState& object, NoteTable::Strike& strike) {
  const double bound_pa = peak_bound_pa(object, strike);
  if (bound_pa == 0) return;
  strike.impulse_ns = (std::clamp(bound_pa, kMinDefault_pa, kMaxDefault_pa) / bound_pa) * strike.impulse_ns;
}

}  // namespace

NoteTable::Strike best_strike(const ObjectState& object) {
  const modal::Bank& bank = object.map->bank();
  NoteTable::Strike strike{.object = object.number, .contact_time_s = synth::kDefaultContactTime_s};
  if (bank.point_count() == 0 || bank.mode_count() == 0) return strike;
  std::size_t best = 0;
  double max = -1;
  for (std::size_t point = 0; point < bank.point_count(); ++point) {
    if (const double motion = motion_at(bank, point); motion > max) {
      best = point;
      max = motion;
    }
  }
  strike.point_m = object.material.size * as_vector(bank.positions[best]);
  const double mass_kg = bank.mass ? modal::rescale(*bank.mass, object.material).mass_kg : 1;
  strike.impulse_ns = (kDefaultVelocity_m_s * mass_kg) * direction_at(bank, best);
  return strike;
}

std::vector<NoteMap::Entry> default_notes(std::vector<ObjectSnapshot> objects) {
  std::ranges::sort(objects, {}, [](const ObjectSnapshot& object) { return object->number; });
  std::vector<NoteMap::Entry> notes;
  for (std::size_t i = 0; i < objects.size() && kFirstDefaultNote + i < kNotes; ++i) {
    notes.push_back({.note = kFirstDefaultNote + i, .object = objects[i]->name});
  }
  return notes;
}

NoteTable resolve(const std::optional<NoteMap>& map, const std::vector<ObjectSnapshot>& objects) {
  NoteTable table;
  if (map) {
    table.release_s = map->release_s;
    table.damp_s = map->damp_s;
  }
  for (const NoteMap::Entry& entry : map ? map->notes : default_notes(objects)) {
    const auto object =
        std::ranges::find(objects, entry.object, [](const ObjectSnapshot& o) -> const std::string& { return o->name; });
    if (object == objects.end()) continue;  // the object may be loaded later
    NoteTable::Strike strike = best_strike(**object);
    const double tuned = (*object)->material.size / (*object)->untuned_size.value_or((*object)->material.size);
    if (entry.point_m) strike.point_m = tuned * *entry.point_m;
    strike.contact_time_s = entry.contact_time_s.value_or(strike.contact_time_s);
    keep_in_range(**object, strike);
    strike.impulse_ns = entry.impulse_ns.value_or(strike.impulse_ns);
    if (entry.is_bowed()) {
      const Vec3 way = entry.bow_direction.value_or(strike.impulse_ns);
      const double size = length(way);
      strike.bow = {.direction = size > 0 ? (1 / size) * way : Vec3{0, 0, 1},
                    .speed_m_s = entry.bow_speed_m_s.value_or(kDefaultBow_m_s),
                    .force_n = entry.bow_force_n.value_or(kDefaultBow_n)};
    }
    table.notes[entry.note] = strike;
  }
  return table;
}

std::string key_list(const std::optional<NoteMap>& map, const std::vector<ObjectSnapshot>& objects) {
  constexpr std::size_t kMaxNamed = 12, kFirst = 3;
  std::map<std::size_t, std::string> keys;
  for (const NoteMap::Entry& entry : map ? map->notes : default_notes(objects)) {
    const bool is_there =
        std::ranges::any_of(objects, [&](const auto& object) { return object->name == entry.object; });
    if (is_there) keys[entry.note] = key_name(static_cast<int>(entry.note)) + " = " + entry.object;
  }
  const bool all = keys.size() <= kMaxNamed;
  std::string text;
  std::size_t count = 0;
  for (const auto& [note, name] : keys) {
    const bool is_last = ++count == keys.size();
    if (!all && count > kFirst && !is_last) continue;
    if (count > 1) text += is_last && !all ? " ... " : ", ";
    text += name;
  }
  return text.empty() ? "" : "keys: " + text;
}

std::shared_ptr<const NoteTable> Notes::table() {
  const std::uint64_t version = rack_.observers().version();
  if (version_ != version) table_ = std::make_shared<const NoteTable>(resolve(map_, rack_.objects()));
  version_ = version;
  return table_;
}

std::vector<std::string> Notes::set_levels(Rack& rack) {
  std::vector<std::string> obstacles;
  if (!map_) return obstacles;
  for (const NoteMap::Entry& entry : map_->notes) {
    if (!entry.level_m) continue;
    const auto object = rack.find({.name = entry.object});
    if (!object) continue;  // the object may be loaded later
    const auto [known, is_new] = leveled_.try_emplace(entry.object, (*object)->bank_version);
    if (!is_new && std::exchange(known->second, (*object)->bank_version) == (*object)->bank_version) continue;
    if (const auto set = rack.set_level({.name = entry.object}, *entry.level_m); !set)
      obstacles.push_back(formatted("note {}: object {}: {}", entry.note, entry.object, set.error().message));
  }
  return obstacles;
}

}  // namespace ringdown::session
