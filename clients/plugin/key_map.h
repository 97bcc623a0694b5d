// The map from keys to the objects they strike: made by the worker, read by the audio thread, never changed in between.
//
// One bank across the keyboard: each key is an object of that bank, as large as its pitch asks for. Frequencies go as
// sqrt(stiffness / density) / size, exactly. Or a note map (docs/use/midi.md): each key strikes an object of its own
// bank, in the size that the bank has.
#pragma once

#include "clients/library/ringdown.h"
#include "clients/plugin/parameters.h"
#include "clients/plugin/sources.h"
#include "engine/base/realtime.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "server/session/note_map_file.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::plugin {

inline constexpr std::size_t kKeys = session::kNotes;
inline constexpr std::size_t kStations = 101;  // of the parameter "Strike point", one per percent

struct BankRelease {
  void operator()(ringdown_bank* bank) const { ringdown_bank_release(bank); }
};
using Bank = std::unique_ptr<ringdown_bank, BankRelease>;

// The numbers of a bank that blows are computed from, in the size it was baked.
struct Body {
  // A sample point where the object may be struck, and the direction in which its main mode moves there.
  struct Station {
    std::uint32_t point = 0;
    Vec3 position_m, direction;
  };
  std::array<Station, kStations> stations;  // from where the main modes move most to the middle of the object
  double pitch_hz = 1;                      // as ringdown_bank_pitch() has it
  double mass_kg = 1;
  double even_impulse_ns = 0;  // a blow at the first station that gives kEvenLevel_pa
};
inline constexpr double kEvenLevel_pa = 2;  // rms of what rings first, at 1 m: 20 dB below full scale

// Measures a bank. [worker]
Result<Body> measure(const ringdown_bank* bank);

struct KeyMap {
  struct Key {
    bool sounds = false;
    std::uint32_t object = 0;                 // position in `objects`
    std::optional<Vec3> point_m, impulse_ns;  // of a note map that says them
    std::optional<double> contact_time_s;
  };
  struct Object {
    std::uint32_t number = 0;  // of the mixer
    std::size_t body = 0;      // position in `bodies`
    std::size_t key = 0;       // the lowest that strikes it
  };
  std::uint64_t generation = 0;  // another number for every map
  bool is_note_map = false;
  std::array<Key, kKeys> keys;
  std::vector<Object> objects;
  std::vector<Body> bodies;
  std::optional<double> release_s;  // of a note map
  double damp_s = 0.15;
  double evening = 1;  // on all impulses that a note map says, which makes it as loud as other sources on the whole

  [[nodiscard]] const Body& body_of(const Object& object) const RINGDOWN_REALTIME { return bodies.data()[object.body]; }
};

// A map and the bank of each of its objects, which are not in the mixer yet.
struct KeyPlan {
  KeyMap map;
  std::vector<std::shared_ptr<ringdown_bank>> banks;  // one for each of map.bodies
  std::string notice;  // a sentence for who plays a single bank at concert pitch; or empty
};

// Reads what the source names; `embedded`: the bytes of its bank, instead of the file. [worker]
Result<KeyPlan> plan_keys(const Source& source, std::string_view embedded);

// The factor on the object's lengths when it is bent by so many semitones.
double size_of(const KeyMap& map, const KeyMap::Object& object, const ParameterValues& parameters,
               double bend_semitones) RINGDOWN_REALTIME;

// The impulse of full velocity [N s] on an object of that size, unless a note map says it.
double full_impulse_ns(const Body& body, const ParameterValues& parameters, double size) RINGDOWN_REALTIME;

}  // namespace ringdown::plugin
