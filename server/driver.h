// Where the sound goes: something that calls Mixer::render from its own audio thread, and knows what time it is.
#pragma once

#include "engine/base/result.h"
#include "engine/base/spsc_ring.h"
#include "engine/synth/event.h"
#include "engine/synth/mixer.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ringdown::session {
struct NoteTable;
}

namespace ringdown::server {

class Driver {
 public:
  struct Load {
    double mean = 0;             // share of its time that the callback used, averaged over about a second
    double p99 = 0;              // what 99 of 100 callbacks of the last seconds stayed below
    double peak = 0;             // the largest so far
    std::int32_t misses = 0;     // callbacks that took longer than their period
    std::int32_t xruns = 0;      // cycles that the audio server found late,
    std::int32_t own_xruns = 0;  // and those of them in which our callback was
  };

  // What a driver plays.
  struct Program {
    synth::Mixer& mixer;
    // Retunes the mixer, and all that counts its frames. The driver's own thread calls it while nothing is rendered.
    std::function<void(double sample_rate_hz)> change_sample_rate;
    // Brings the scene up to this frame; may block. Called before each block while freewheels(): nothing else then
    // advances the scene.
    std::function<void(synth::Frame)> prepare_offline;
    // The mixer's buses that are to be heard, and what they are called. [any but audio]
    std::function<std::map<std::size_t, std::string>()> buses;
    // The mixer's inputs that are to be there, bit 0 the first. [any but audio]
    std::function<std::uint32_t()> inputs;
    // What MIDI notes strike. [the driver's own thread]
    std::function<std::shared_ptr<const session::NoteTable>()> notes;
    // Takes the events that notes become, beside the mixer.
    SpscRing<synth::Event>& notes_played;
  };

  virtual ~Driver() = default;  // stops

  [[nodiscard]] virtual double sample_rate_hz() const = 0;     // now; it may change [any but audio]
  [[nodiscard]] virtual std::size_t block_frames() const = 0;  // now; it may change [any but audio]

  // Renders the program, whose mixer is of this driver's sample rate, until destruction. Once. [main]
  virtual Result<void> start(Program program) = 0;

  // Tells the driver that the program's buses(), inputs() or notes() have changed. [any but audio]
  virtual void program_changed() {}

  // The mixer's frame that is being computed at this instant. [any but audio]
  [[nodiscard]] virtual synth::Frame now() const = 0;

  // True while blocks come as fast as they are rendered: now() then runs ahead of the clock. [any]
  [[nodiscard]] virtual bool freewheels() const { return false; }

  // The real-time priority for threads that should be punctual without delaying the audio thread: just below the audio
  // thread's; 0 where that has none. It may change. [any but audio]
  [[nodiscard]] virtual int control_priority() const { return 0; }

  [[nodiscard]] virtual Load load() const = 0;  // [any but audio]
};

struct JackOptions {
  std::string client_name = "ringdown";
  bool connect = false;            // to the first two physical playback ports
  bool wait = false;               // for a server, where there is none yet
  double sample_rate_hz = 48000;   // until then
  std::size_t block_frames = 256;  // until then
};
// Opens a JACK client that outlives its server. While there is no server, the mixer is rendered by a clock of our own
// and its sound is thrown away; when a server answers again, at whatever rate and period, our ports and their
// connections come back (jack_driver.cpp). Fails when no JACK server answers and options.wait is false.
Result<std::unique_ptr<Driver>> open_jack(const JackOptions& options);

// What the null driver heard, when somebody wants to know.
struct Captured {
  static constexpr std::size_t kMost = std::size_t{1} << 28;  // frames: an hour and a half, 2 GiB

  std::vector<float> left, right;
  std::size_t most = kMost;
  std::size_t left_out = 0;  // frames after the first `most`

  void add(std::span<const float> more_left, std::span<const float> more_right);
};

// Renders in real time and throws the sound away, or appends it to `captured`, which must outlive the driver.
Result<std::unique_ptr<Driver>> open_null(double sample_rate_hz, std::size_t block_frames,
                                          Captured* captured = nullptr);

}  // namespace ringdown::server
