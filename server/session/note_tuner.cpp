#include "server/session/note_tuner.h"

#include "server/session/note_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace ringdown::session {
namespace {

constexpr double kMinSize = 0.01, kMaxSize = 100;  // what messages may set

}  // namespace

NoteTuner::Pitches NoteTuner::read_pitches() {
  const bool has_own = map_ && map_->tuning;
  const auto of_master = has_own ? std::nullopt : mts_esp_.tuning();
  tuning_.set_base(has_own ? *map_->tuning : of_master.value_or(microtuning::KeyTuning{}));
  Pitches pitches;
  for (std::size_t note = 0; note < kNotes; ++note) pitches[note] = tuning_.semitones(note);
  return pitches;
}

void NoteTuner::catch_up() {
  const Pitches pitches = read_pitches();
  const std::uint64_t version = rack_.observers().version();
  if (pitches == pitches_ && version == version_) return;
  const std::vector<ObjectSnapshot> objects = rack_.objects();
  std::map<std::string, std::size_t> lowest;  // notes, by the object that they strike
  for (const NoteMap::Entry& entry : map_ ? map_->notes : default_notes(objects)) {
    std::size_t& note = lowest.try_emplace(entry.object, entry.note).first->second;
    note = std::min(note, entry.note);
  }
  bool is_done = true;
  for (const ObjectSnapshot& object : objects) {
    if (const auto note = lowest.find(object->name); note != lowest.end()) {
      is_done = retune(*object, pitches[note->second]) && is_done;
    }
  }
  pitches_ = pitches;
  version_ = is_done ? version : ~version;  // what had to wait is tried again
}

// Returns false if the mixer has no room for another voice now.
bool NoteTuner::retune(const ObjectState& object, double semitones) {
  const double own_size = object.untuned_size.value_or(object.material.size);
  modal::MaterialScale material = object.material;
  if (semitones == 0) {
    material.size = own_size;
  } else {
    material.size = std::clamp(own_size * std::exp2(-semitones / 12), kMinSize, kMaxSize);
  }
  if (material.size == object.material.size) return true;
  return rack_.set_material({.number = object.number}, material, own_size).has_value();
}

}  // namespace ringdown::session
