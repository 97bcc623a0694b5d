// Maps notes of a MIDI keyboard to strikes: which object, where, and how hard (docs/use/midi.md).
#pragma once

#include "engine/base/vec3.h"
#include "engine/synth/events/event.h"
#include "server/session/note_map_file.h"
#include "server/session/rack.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::session {

inline constexpr std::size_t kFirstDefaultNote = 60;  // without a map, middle C strikes the first object

// The map with every value chosen, which the audio thread reads.
struct NoteTable {
  struct Strike {
    synth::ObjectNumber object = 0;
    Vec3 point_m;
    Vec3 impulse_ns;            // at full velocity
    double contact_time_s = 0;  // at full velocity
    struct Bow {                // a bow instead of a blow
      Vec3 direction;           // of length 1
      double speed_m_s = 0;     // at full velocity
      double force_n = 0;       // at full pressure
    };
    std::optional<Bow> bow;
  };
  std::array<std::optional<Strike>, kNotes> notes;
  std::optional<double> release_s;
  double damp_s = 0.15;
};

// Returns the default strike of an object: at the point where its eight most important modes move most, in the
// direction in which the first of these modes that takes an average part in this motion moves there, with an impulse of
// kDefaultVelocity_m_s times the object's mass.
NoteTable::Strike best_strike(const ObjectState& object);
inline constexpr double kDefaultVelocity_m_s = 0.1;
// The sound pressures at 1 m between which a full blow of a note lies if the map states no impulse. They are 1 and 30
// dB below the default full scale, so one note neither reaches the limiter nor is lost.
inline constexpr double kMaxDefault_pa = 17.8, kMinDefault_pa = 0.63;

// Returns what notes strike without a map: note kFirstDefaultNote the object of the lowest number, the next note the
// next object, and so on.
std::vector<NoteMap::Entry> default_notes(std::vector<ObjectSnapshot> objects);

// Makes the note table. Without a map it has the default notes. Values that the map does not name are those of
// best_strike(), with the impulse raised or lowered so that the sum of the modes' amplitudes lies between
// kMinDefault_pa and kMaxDefault_pa.
NoteTable resolve(const std::optional<NoteMap>& map, const std::vector<ObjectSnapshot>& objects);

// Returns which key strikes what, for people: "keys: C4 = bell, C#4 = cup". Of many keys only the first and the last
// are named. "": no key strikes anything.
std::string key_list(const std::optional<NoteMap>& map, const std::vector<ObjectSnapshot>& objects);

// Keeps the note table for a rack's present objects, and makes it anew after they have changed.
class Notes {
 public:
  Notes(const Rack& rack, std::optional<NoteMap> map) : rack_(rack), map_(std::move(map)) {}
  std::shared_ptr<const NoteTable> table();  // [one thread, not audio]
  [[nodiscard]] const std::optional<NoteMap>& map() const { return map_; }

  // Sets the levels that the map states, once for each bank that an object gets. Returns a sentence for each one that
  // is impossible. [worker]
  std::vector<std::string> set_levels(Rack& rack);

 private:
  const Rack& rack_;
  const std::optional<NoteMap> map_;
  std::optional<std::uint64_t> version_;
  std::shared_ptr<const NoteTable> table_;
  std::map<std::string, std::int32_t> leveled_;  // worker: the banks of objects whose levels were set
};

}  // namespace ringdown::session
