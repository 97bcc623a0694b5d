// A driver plays a program: it calls Mixer::render from its own audio thread and knows which frame is due. There are
// two: JACK (open_jack) and our own clock, which discards the sound (open_null).
//
//   auto driver = open_jack({.client_name = "ringdown"}, player);
//   (*driver)->start(program);     // renders until the driver is destroyed
#pragma once

#include "engine/base/result.h"
#include "engine/base/spsc_ring.h"
#include "engine/synth/events/event.h"
#include "engine/synth/mixer.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::session {
class MidiPlayer;
struct NoteTable;
}  // namespace ringdown::session

namespace ringdown::server {

class Driver {
 public:
  struct Load {
    double mean = 0;             // share of its period that the callback used, averaged over about a second
    double p99 = 0;              // share that 99 of 100 callbacks of the last seconds did not exceed
    double peak = 0;             // largest share so far
    std::int32_t misses = 0;     // callbacks that took longer than their period
    std::int32_t xruns = 0;      // cycles that the audio server found late
    std::int32_t own_xruns = 0;  // late cycles in which our callback was late
    double skipped_s = 0;        // duration of sound never made, because the audio server went on without us
  };

  // Everything that a driver needs to play.
  struct Program {
    synth::Mixer& mixer;
    // Changes the sample rate of the mixer and of everything that counts its frames. The driver's own thread calls it
    // while nothing is rendered.
    std::function<void(double sample_rate_hz)> change_sample_rate;
    // Advances the scene to this frame; may block. The driver calls it before each block while it freewheels: nothing
    // else advances the scene then.
    std::function<void(synth::Frame)> prepare_offline;
    // Returns numbers and names of the mixer's buses and pickups that should have a port; pickups have the numbers from
    // synth::kMaxBuses on. [any but audio]
    std::function<std::map<std::size_t, std::string>()> buses;
    // Returns the mixer's inputs that should have a port; bit 0 is the first input. [any but audio]
    std::function<std::uint32_t()> inputs;
    // Returns the table of objects that MIDI notes strike. [the driver's own thread]
    std::function<std::shared_ptr<const session::NoteTable>()> notes;
    // Receives a copy of each event that a note became, for the observers.
    SpscRing<synth::Event>& notes_played;
  };

  virtual ~Driver() = default;  // stops rendering

  [[nodiscard]] virtual double sample_rate_hz() const = 0;     // may change [any but audio]
  [[nodiscard]] virtual std::size_t block_frames() const = 0;  // may change [any but audio]

  // Renders the program, whose mixer has this driver's sample rate, until the driver is destroyed. Call once. [main]
  virtual Result<void> start(Program program) = 0;

  // Tells the driver that the program's buses(), inputs() or notes() have changed. [any but audio]
  virtual void program_changed() {}

  // Returns the mixer's frame that is being computed at this instant; while the audio server does not call, at most a
  // block beyond the frames rendered. [any but audio]
  [[nodiscard]] virtual synth::Frame now() const = 0;

  // Returns whether blocks follow each other as fast as they are rendered: now() then runs ahead of the clock. [any]
  [[nodiscard]] virtual bool freewheels() const { return false; }

  // Returns the real-time priority for threads that should be punctual but must not delay the audio thread: just below
  // the audio thread's priority; 0 if the audio thread has none. May change. [any but audio]
  [[nodiscard]] virtual int control_priority() const { return 0; }

  [[nodiscard]] virtual Load load() const = 0;  // [any but audio]
};

struct JackOptions {
  std::string client_name = "ringdown";
  bool connect = false;  // connect to the first two physical playback ports
  // Connect to the first MIDI source with this in its name, in any case of letters, as soon as there is one; "": to the
  // first device; nothing: to none.
  std::optional<std::string> keyboard;
  bool wait = false;               // wait for a server, if there is none yet
  double sample_rate_hz = 48000;   // until then
  std::size_t block_frames = 256;  // until then
};
// Opens a JACK client that outlives its server, and plays what its MIDI input receives by `midi`. While there is no
// server, the mixer is rendered by our own clock and its sound is discarded. When a server answers again, at any rate
// and period, our ports and their connections are restored (jack_driver.cpp). Fails with ErrorKind::no_sound_server if
// no JACK server answers and options.wait is false, and with ErrorKind::usage if the name is too long for JACK.
Result<std::unique_ptr<Driver>> open_jack(const JackOptions& options, std::shared_ptr<session::MidiPlayer> midi);

// Renders in real time and discards the sound. While the mixer's sound is captured, it waits for the capture to keep
// up, so that no frame is lost.
Result<std::unique_ptr<Driver>> open_null(double sample_rate_hz, std::size_t block_frames);

}  // namespace ringdown::server
