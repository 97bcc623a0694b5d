// The bows that keys draw across their objects: each is drawn while its key is down, by shares of its full speed and
// force that may change meanwhile. [audio]
//
//   Bows bows;
//   bows.draw(60, stroke, 100 / 127.0, {mixer, frame, map.generation, sizes});
//   bows.set_force(60, 1, {mixer, later, map.generation, sizes});
//   bows.lift(60, {mixer, later_still, map.generation, sizes});
#pragma once

#include "clients/library/ringdown.h"
#include "clients/plugin/key_map.h"
#include "engine/base/realtime.h"
#include "engine/base/vec3.h"
#include "server/session/note_map_file.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace ringdown::plugin {

// Writes a vector as libringdown takes it.
inline void write(const Vec3& vector, double (&numbers)[3]) REALTIME {
  numbers[0] = vector.x;
  numbers[1] = vector.y;
  numbers[2] = vector.z;
}

class Bows {
 public:
  // A bow at full velocity and full pressure.
  struct Stroke {
    std::uint32_t object = 0;  // number in the mixer
    std::size_t index = 0;     // in the map
    std::uint64_t map = 0;     // generation of the map that numbers it
    Vec3 point_m, direction;   // in the size of the object's bank
    double speed_m_s = 0, force_n = 0;
  };
  struct Moment {
    ringdown_mixer* mixer;
    std::int64_t frame;
    std::uint64_t map;  // generation of the present map
    const PlacedSizes& sizes;
  };

  // Lays a bow on the key's object, at a share of its speed and at half of its force.
  void draw(std::size_t key, const Stroke& stroke, double speed, const Moment& now) REALTIME;
  [[nodiscard]] bool is_drawn(std::size_t key) const REALTIME { return bows_[key].is_drawn; }

  // Change the bow of a key, if it is drawn, by shares of its full speed and force.
  void set_speed(std::size_t key, double share, const Moment& now) REALTIME;
  void set_force(std::size_t key, double share, const Moment& now) REALTIME;
  void reset(std::size_t key, const Moment& now) REALTIME;  // as it was when the key went down

  void lift(std::size_t key, const Moment& now) REALTIME;

 private:
  struct Bow {
    Stroke stroke;
    double first_speed = 0, speed = 0, force = 0;  // shares
    bool is_drawn = false;
  };
  static void send(const Bow& bow, std::size_t key, const Moment& now) REALTIME;

  std::array<Bow, session::kNotes> bows_;
};

}  // namespace ringdown::plugin
