// The click of an object that a blow sets in motion as a whole: its acceleration noise, heard also where no mode rings.
//
// The sound of a rigid sphere of radius R that a force accelerates in air (speed of sound c), far away, is that force
// through a filter of two poles, (c/R)(-1 +- i): a dipole that falls by 6 dB an octave below the corner c / (2 pi R).
// Other shapes count as the sphere of the same mass and radius of gyration. Its level is the pressure at 1 m, rms over
// directions: rho R^2 / (2 sqrt(3) m) pascals per newton far above the corner. Chadwick, Zheng & James,
// "Precomputed acceleration noise for improved rigid-body sound", 2012, compute the field of any shape; Koss &
// Alfredson, "Transient sound radiated by spheres undergoing an elastic collision", 1973, that of the sphere.
#pragma once

#include "engine/base/realtime.h"
#include "engine/modal/bank.h"
#include "engine/synth/events/event.h"
#include "engine/synth/kernels/mode_kernel.h"

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace ringdown::synth {

inline constexpr std::size_t kMaxClicks = 256;  // at a time; more are not heard
inline constexpr double kMaxClickRadius_m = 3;  // a larger body's click lies below what is heard

// The shape of an object's click.
struct ClickShape {
  double corner_per_s = 0;  // c / R
  double gain = 0;          // output per newton far above the corner's roll-off
};

// The radius of the solid sphere of the same mass and radius of gyration [m].
double radius_of(const modal::MassProperties& mass);

class Click {
 public:
  Click() = default;

  // The click of a half-sine of `impulse_ns` that begins at frame 0 and lasts `contact_time_s`, but 4 frames at least.
  // [audio]
  Click(const ClickShape& shape, double impulse_ns, double contact_time_s, double sample_rate_hz) REALTIME;

  // Writes the click's next `count` samples to `out`. [audio]
  void fill(std::size_t count, double* out) REALTIME;

  [[nodiscard]] Frame length() const REALTIME { return end_; }  // frames from its begin to its end

 private:
  std::complex<double> push_, push_pole_;  // the part of the response that follows the force
  std::complex<double> ring_, ring_pole_;  // the free decay of the air
  std::complex<double> released_;          // what the end of the force adds to the free decay
  Frame at_ = 0, release_ = 0, end_ = 0;
};

// The clicks that sound, each with its object. The place of a click is free kChunkFrames after the click is over, so
// that it does not matter where chunks end. [audio, after construction]
class Clicks {
 public:
  struct One {
    Click click;
    ObjectNumber object = 0;
    Frame begin = 0;
    [[nodiscard]] Frame free_from() const REALTIME { return begin + click.length() + static_cast<Frame>(kChunkFrames); }
  };

  [[nodiscard]] bool empty() const REALTIME { return count_ == 0; }
  [[nodiscard]] std::size_t size() const REALTIME { return count_; }
  [[nodiscard]] One& operator[](std::size_t i) REALTIME { return all_[i]; }
  // False when there is no place for it at the frame at which it begins.
  [[nodiscard]] bool add(const One& one) REALTIME {
    drop_before(one.begin);
    if (count_ == kMaxClicks) return false;
    all_[count_++] = one;
    return true;
  }
  // Takes out those whose places are free from `frame` on.
  void drop_before(Frame frame) REALTIME {
    for (std::size_t i = 0; i < count_;) {
      if (all_[i].free_from() <= frame) {
        all_[i] = all_[--count_];
      } else {
        ++i;
      }
    }
  }
  void clear() { count_ = 0; }

 private:
  std::array<One, kMaxClicks> all_;
  std::size_t count_ = 0;
};

}  // namespace ringdown::synth
