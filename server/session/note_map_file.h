// Reads the file that maps notes of a MIDI keyboard to objects (docs/use/midi.md). note_map.h makes the played table
// from it.
#pragma once

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/microtuning/key_tuning.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::session {

inline constexpr std::size_t kNotes = microtuning::kKeys;

// A map as written in its file. Values that the file leaves out are chosen from the object's bank.
struct NoteMap {
  struct Entry {
    std::size_t note = 0;
    std::string object;
    std::string bank;                // without a scene, the object's bank is BANK.glb; "": named like the object
    std::optional<double> level_m;   // of the liquid in the object; the same in all notes of one object
    std::optional<Vec3> point_m;     // object frame
    std::optional<Vec3> impulse_ns;  // at full velocity
    std::optional<double> contact_time_s;
    std::optional<double> bow_speed_m_s;  // at full velocity; the note is bowed while its key is down
    std::optional<double> bow_force_n;    // at full pressure
    std::optional<Vec3> bow_direction;    // the way the hair moves; of any length but 0
    [[nodiscard]] std::string bank_file() const { return (bank.empty() ? object : bank) + ".glb"; }
    [[nodiscard]] bool is_bowed() const { return bow_speed_m_s || bow_force_n || bow_direction; }
  };
  std::vector<Entry> notes;
  std::optional<double> release_s;               // a released note is damped within this time; nullopt: it rings on
  double damp_s = 0.15;                          // the damp pedal damps within this time
  std::optional<microtuning::KeyTuning> tuning;  // that of the files `scale` and `mapping`
  std::string banks;                             // folder with the banks, used without a scene; "": the map's own
};

// The bow of a note, where the map does not say, and the pressure on it before any message.
inline constexpr double kDefaultBow_m_s = 0.4, kDefaultBow_n = 2;
inline constexpr float kFirstBowPressure = 0.5F;

// Reads a map and the files of its tuning. Values out of range and two entries for one note are refused, with the line.
// [worker]
Result<NoteMap> read_note_map(const std::filesystem::path& path);

}  // namespace ringdown::session
