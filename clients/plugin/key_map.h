// The map from keys to the objects they strike: made by the worker, read by the audio thread, and immutable.
//
// With one bank across the keyboard, each key is an object of that bank, in the size that its pitch requires;
// frequencies are exactly proportional to sqrt(stiffness / density) / size. With a note map (docs/use/midi.md), each
// key strikes an object of its own bank, in the bank's size. A tuning (tunings.h) moves each key away from equal
// temperament by semitones, and changes the size of its object like a bend.
#pragma once

#include "clients/library/ringdown.h"
#include "clients/plugin/parameters.h"
#include "clients/plugin/sources.h"
#include "clients/plugin/strike_point.h"
#include "engine/base/realtime.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/microtuning/key_tuning.h"
#include "server/session/note_map_file.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::plugin {

inline constexpr std::size_t kKeys = session::kNotes;
inline constexpr std::size_t kStations = 101;  // positions of the parameter "Strike point", one per percent

struct BankRelease {
  void operator()(ringdown_bank* bank) const { ringdown_bank_release(bank); }
};
using Bank = std::unique_ptr<ringdown_bank, BankRelease>;

// The mode that sounds under a bow: one over its mass, as the bow feels it, and its frequency.
struct BowedMode {
  double per_kg = 0, omega_rad_s = 0;
};

// The values of a bank from which blows are computed, in the size in which it was baked.
struct Body {
  // A sample point where the object may be struck, and the direction in which its main mode moves there.
  struct Station {
    std::uint32_t point = 0;
    Vec3 position_m, direction;
  };
  std::array<Station, kStations> stations;  // from the place where the main modes move most to the middle of the object
  double pitch_hz = 1;                      // pitch by ringdown_bank_pitch()
  double mass_kg = 1;
  double even_impulse_ns = 0;  // impulse at the first station that gives kEvenLevel_pa
  double ring_s = 0;           // time in which the slowest mode falls by kInaudible_db
  BowedMode bowed;
};
inline constexpr double kInaudible_db = 100;
inline constexpr double kEvenLevel_pa = 2;  // rms of the first sound, at 1 m: 20 dB below full scale

// Measures a bank. [worker]
Result<Body> measure(const ringdown_bank* bank);

struct KeyMap {
  struct Key {
    bool sounds = false;
    std::uint32_t object = 0;                 // position in `objects`
    std::optional<Vec3> point_m, impulse_ns;  // only if a note map states them
    std::optional<double> contact_time_s;
    struct Bow {
      std::optional<Vec3> direction;  // a unit vector
      double speed_m_s, force_n;      // at full velocity and full pressure
    };
    std::optional<Bow> bow;  // instead of a blow
  };
  struct Object {
    std::uint32_t number = 0;            // number in the mixer
    std::size_t body = 0;                // position in `bodies`
    std::size_t key = 0;                 // lowest key that strikes it
    std::string name = {};               // only in note maps
    std::optional<double> level_m = {};  // of its liquid, in its bank's size; only in note maps
  };
  std::uint64_t generation = 0;  // unique number of the map
  bool is_note_map = false;
  std::array<Key, kKeys> keys;
  std::vector<Object> objects;
  std::vector<Body> bodies;
  // The exact points of a single bank, each while its is_at() holds; none in note maps.
  std::array<std::optional<StrikePoint>, kPoints> points;
  std::optional<double> release_s;               // only from a note map
  std::optional<microtuning::KeyTuning> tuning;  // only from a note map
  double damp_s = 0.15;
  double evening = 1;  // factor on all impulses that a note map states, so that it is about as loud as other sources

  [[nodiscard]] const Body& body_of(const Object& object) const REALTIME { return bodies[object.body]; }
};

// The sizes in which the objects of a map stand in the mixer, where they follow the parameters a little later. Points
// are given in these, because libringdown refuses a point beside its object, and allocates a sentence. The worker
// writes them; while it changes an object, this is the smaller of both sizes, whose points lie within the object.
using PlacedSizes = std::array<std::atomic<double>, kKeys>;

// A map and the banks of its objects, which are not in the mixer yet.
struct KeyPlan {
  KeyMap map;
  std::vector<std::shared_ptr<ringdown_bank>> banks;  // one for each of map.bodies
  std::string notice;  // a sentence for players of a single bank at concert pitch; may be empty
};

// Reads the bank or note map that the source names. `embedded` holds the bytes of its bank, which replace the file.
// [worker]
Result<KeyPlan> plan_keys(const Source& source, std::string_view embedded);

// Returns whether the point is near enough to the bank's object to be struck there. [worker]
bool is_near(const ringdown_bank* bank, const Vec3& point_m);

// Returns the pressure that each mode gives at 1 m after an impulse of 1 N s at the bank's sample point nearest to a
// point [Pa]; 0 for inaudible modes. The blow is a half sine of `contact_time_s`. [worker]
std::vector<double> struck_pa(const ringdown_bank* bank, const Vec3& point_m, const Vec3& direction,
                              double contact_time_s);

// Returns the factor on the object's lengths for a bend in semitones, which contains the key's tuning.
double size_of(const KeyMap& map, const KeyMap::Object& object, const ParameterValues& parameters,
               double bend_semitones) REALTIME;

// Returns the impulse of full velocity [N s] on an object of this size, unless a note map states it.
double full_impulse_ns(const Body& body, const ParameterValues& parameters, double size) REALTIME;

}  // namespace ringdown::plugin
