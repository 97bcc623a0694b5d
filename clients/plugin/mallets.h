// The mallets of the parameter "Mallet", and what a key does with them to its object. [audio]
//
// AS STRUCK, a blow is a force that is known in advance: a half sine that lasts as long as "Contact time" says.
//
// A MALLET flies at the object and feels how the surface moves under it, as ringdown_mallet() has it. It has the mass
// and the head of a real one, whichever key it strikes. Its speed v is such that it gives a free object of mass M the
// impulse of the blow, (1 + bounce) v / (1 / mass + 1 / M). Where that would take a mallet faster than kFastest_m_s at
// full velocity, it is a heavier one with the same head.
//
// THE BOW is drawn while its key is down, where the key would strike otherwise (bows.h): at full velocity at 0.2 m/s,
// and at full pressure with a force for which the mode of the object's pitch is playable.
#pragma once

#include "clients/plugin/bows.h"
#include "clients/plugin/key_map.h"
#include "engine/base/realtime.h"
#include "engine/base/vec3.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace ringdown::plugin {

enum class Mallet : std::size_t { as_struck, yarn, cord, rubber, wood, brass, bow };
inline constexpr std::size_t kMallets = 7;
inline constexpr double kFastest_m_s = 5;

// Heads are Hertz's k of contacts.md's table: yarn and cord are between gong mallets and rubber. The masses are those
// of balls of 15 mm radius, or 10 mm of brass, and of wound mallets.
struct MalletInfo {
  const char* name;
  double mass_kg, head, bounce;  // as in ringdown_mallet_args; 0 for what is no mallet
};
inline constexpr std::array<MalletInfo, kMallets> kMalletInfo = {{{"as struck", 0, 0, 0},
                                                                  {"yarn", 0.03, 3e5, 0.5},
                                                                  {"cord", 0.03, 2e6, 0.6},
                                                                  {"rubber", 0.016, 1e7, 0.75},
                                                                  {"wood", 0.01, 1e9, 0.7},
                                                                  {"brass", 0.036, 1e10, 0.85},
                                                                  {"bow", 0, 0, 0}}};

// A target is the place where a key acts on its object at a velocity, and the full blow there.
struct Target {
  std::uint32_t object = 0;             // number in the mixer
  std::optional<std::uint32_t> vertex;  // the sample point, if the place is one
  std::size_t index = 0;                // of the object in the map
  Vec3 point_m;                         // in the size of the object's bank
  double placed_size = 1;
  Vec3 full_ns;
  double contact_time_s = 0;  // of a full blow as struck
  double mass_kg = 0;         // the object's
  double size = 1;            // by the parameters
};
Target target_of(const KeyMap::Key& key, std::uint8_t velocity, const KeyMap& map, const ParameterValues& parameters,
                 const PlacedSizes& sizes, double bend_semitones) REALTIME;

// How a key is struck.
struct Blow {
  double share = 1;      // of the full impulse
  double softness = 1;   // factor on the time of contact
  bool is_dead = false;  // the mallet does not bounce
};

void strike(ringdown_mixer* mixer, std::int64_t frame, const Target& target, const Blow& blow) REALTIME;
void throw_mallet(ringdown_mixer* mixer, std::int64_t frame, const Target& target, const Blow& blow,
                  const MalletInfo& mallet) REALTIME;

// Returns the bow of a key: the note map's, or the one described above.
Bows::Stroke stroke_of(const KeyMap::Key& key, const Target& target, const KeyMap& map,
                       const ParameterValues& parameters) REALTIME;

}  // namespace ringdown::plugin
