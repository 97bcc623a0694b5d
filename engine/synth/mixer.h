// Everything that rings, summed to a stereo mix and to buses: what the JACK callback runs.
//
//   Mixer mixer(48000);
//   mixer.install(0, std::make_unique<Voice>(mixer.table_for(map, material)), Mixer::Install::replace);  // worker
//   mixer.push(Producer::control, {.frame = 480, .verb = verb::Strike{point_m, impulse_ns}});            // any thread
//   mixer.render(left, right);                                                                           // callback
//
// Threads. One audio thread calls render(). Each Producer is one thread that pushes events through its own ring. One
// worker thread installs and collects voices. None of them ever waits for another, and the audio thread neither
// allocates, locks, makes system calls nor frees.
//
// Time. Frame 0 is the first frame ever rendered. An event happens at its own frame whatever the block size; one whose
// frame has passed happens at once and is counted as late.
//
// Parts. A Timeline takes commands and events and cuts blocks into chunks; the Stage holds the objects and gives each
// its events; the Renderer renders what sounds (Source: an Object, or an InstanceGroup of objects that share their
// states); Shedding decides what is left out when time is short; MixOutput writes samples; Meters measure. How a strike
// goes through them, file by file, is told in docs/how/architecture.md.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/block_io.h"
#include "engine/synth/meters.h"
#include "engine/synth/output/mix_output.h"
#include "engine/synth/renderer.h"
#include "engine/synth/objects/shedding.h"
#include "engine/synth/stage.h"
#include "engine/synth/events/timeline.h"
#include "engine/synth/voice_registry.h"

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>

namespace ringdown::synth {

inline constexpr std::size_t kMaxBuses = kFirstPickup - kFirstBus;  // outputs beside mix, pickups and ambisonics

struct MixerSettings {
  // The sound pressure at 1 m from an object that becomes a sample of 1 at gain 1 [Pa]; > 0, fixed once the mixer is
  // made. An object sounds as at 1 m, rms over directions (modal/loudness.h).
  double full_scale_pa = modal::kFullScale_pa;

  // Modes whose amplitude, at the gain of their object, lies so far below full scale rest until the next strike.
  double floor_db = 120;

  // If true, a strike's contact pulse drives the modes sample by sample from the strike's frame on. Otherwise each mode
  // receives at that frame the pulse's spectrum at its frequency. The two differ while the contact lasts, and
  // afterwards only in phase. Driving costs more while the contact lasts, and serves kMaxDrives strikes at a time.
  bool exact_contacts = false;

  // Ceiling of the mix in dB of full scale, without the buses; the mix is then latency_frames() late (limiter.h).
  std::optional<double> limiter_db = {};

  // The order of the ambisonic channels (ambisonics.h), 0 ... kMaxAmbisonicOrder; nullopt: none. Fixed once an object
  // has a voice.
  std::optional<std::size_t> ambisonic_order = {};

  // If true, an object in a place is heard when its sound has travelled to the listener.
  bool travel_time = false;

  // The head that the mix is rendered for: left and right are then its ears (binaural.h). Null: stereo.
  HeadLoader head = {};

  // The number of a voice's lowest modes that may exchange energy, if its bank has as many: 64 by default, 300 offline
  // (coupled_modes.h). Fixed once an object has a voice.
  std::size_t max_coupled = 64;

  // Threads that render big scenes, the audio thread among them. With more than one, rounding depends on which thread
  // renders what.
  std::size_t threads = 1;

  // The share of a block's time that render() may use, 0 ... 1; 0: no limit. What there is no time for is left out, the
  // quietest modes first (shedding.h).
  double budget = 0;
  WorkClock clock = {};
};

class Mixer {
 public:
  explicit Mixer(double sample_rate_hz, const MixerSettings& settings = {});
  ~Mixer();
  Mixer(const Mixer&) = delete;
  Mixer& operator=(const Mixer&) = delete;

  [[nodiscard]] const MixerSettings& settings() const { return settings_; }  // [worker]
  // Goes on with other settings; what rings rings on. [worker, while nothing is rendered]
  void configure(const MixerSettings& settings);

  [[nodiscard]] double sample_rate_hz() const { return sample_rate_hz_.load(std::memory_order_relaxed); }  // [any]
  // Goes on at another sample rate: what rings keeps pitch, decay, phase and loudness; pending events, gains and pans
  // come as many seconds from now as before. The frames go on counting. Takes about as long as installing every voice
  // anew. [worker, while nothing is rendered]
  void change_sample_rate(double sample_rate_hz);

  // Frames by which the mix comes later than events say. [any, but not while configure() runs]
  [[nodiscard]] std::size_t latency_frames() const { return output_.latency_frames(); }

  // Hands an event over. False when the producer's ring is full: the event was not taken. The event's object is
  // < kMaxObjects and its numbers are finite. [the producer's thread]
  [[nodiscard]] bool push(Producer producer, const Event& event) REALTIME { return timeline_.push(producer, event); }

  // The table that voices of this bank, material, dampers and choice of modes share; a new one if there is none.
  // Objects whose voices share a table can share their states too (instance_group.h). [worker]
  [[nodiscard]] std::shared_ptr<ModeTable> table_for(const std::shared_ptr<const modal::StrikeMap>& map,
                                                     const modal::MaterialScale& material,
                                                     const modal::Dampers& dampers = {},
                                                     modal::ModeRange modes = {}) const {
    return voices_.table_for(map, material, dampers, modes, sample_rate_hz(),
                             {settings_.full_scale_pa, settings_.max_coupled,
                              settings_.ambisonic_order.has_value() || settings_.head != nullptr});
  }

  enum class Install {
    replace,  // the old voice rings out, the new one takes the strikes to come
    retune,   // the new voice, of the same bank or of the changed object (Voice::mode_change), takes over what
              // rings of its modes; the others fade out
  };
  // Gives `object` a new voice from frame `at` on, or as soon as that is past; later commands wait for it. False when
  // kMaxVoices are alive, or too many commands wait. [worker]
  [[nodiscard]] bool install(ObjectNumber object, std::unique_ptr<Voice> voice, Install how, Frame at = 0);

  // Takes the object away: what rings fades out within FadeOut::kMinFrames. False when too many commands wait. [worker]
  [[nodiscard]] bool remove(ObjectNumber object);

  // Sends the object, at its gain, to a bus as well as to the mix, from the next block on; nullopt: to the mix only, as
  // by default. Several objects may share a bus. False when too many commands wait. [worker]
  [[nodiscard]] bool assign(ObjectNumber object, std::optional<std::size_t> bus);

  // Silences the object at the mix and at its bus, or lets it be heard again, over kSilenceRamp_s; what rings goes on
  // ringing unheard. False when too many commands wait. [worker]
  [[nodiscard]] bool silence(ObjectNumber object, bool silent);
  static constexpr double kSilenceRamp_s = 0.02;

  // From the next block on, input `input` < kMaxInputs excites an object: a sample of 1 is an impulse at a point, in
  // the object's frame, in one frame. An input excites one object, and an object takes kMaxForces inputs and pulses at
  // a time; nothing happens when the object does not exist. False when too many commands wait. [worker]
  [[nodiscard]] bool connect_input(std::size_t input, ObjectNumber object, Vec3 point_m, Vec3 impulse_ns);
  [[nodiscard]] bool disconnect_input(std::size_t input);

  // Frees the voices that have died away. [worker]
  void collect() { voices_.collect(); }
  // True while `object` has a voice that is playing, ringing out or not yet collected. [worker]
  [[nodiscard]] bool in_use(ObjectNumber object) const { return voices_.in_use(object); }

  // Says whether blocks are due at a certain time, as by default; otherwise the time budget is not kept. [audio]
  void keep_deadlines(bool on) REALTIME { deadlines_ = on; }

  // Writes the next frames; any number of frames. [audio]
  void render(const Outputs& outputs, const Inputs& inputs, std::size_t frames) REALTIME;
  void render(const Outputs& outputs, std::size_t frames) REALTIME { render(outputs, {}, frames); }
  void render(std::span<float> left, std::span<float> right) REALTIME {  // the mix only
    render(Outputs(left.data(), right.data()), left.size());
  }

  [[nodiscard]] Meters& meters() { return meters_; }
  [[nodiscard]] const MixerCounters& counters() const { return meters_.counters; }
  [[nodiscard]] TestTone& test_tone() { return output_.test_tone; }
  [[nodiscard]] SoundTap& sound_tap() { return output_.sound_tap; }
  [[nodiscard]] SoundTap& capture_tap() { return output_.capture_tap; }

 private:
  void make_object(ObjectNumber object);  // before the first command about it [worker]
  void execute_commands(Frame until) REALTIME;
  void render_chunk(Chunk& chunk) REALTIME;

  std::atomic<double> sample_rate_hz_;
  MixerSettings settings_;
  Timeline timeline_{2 * kMaxVoices};
  VoiceRegistry voices_;
  Meters meters_;
  Stage stage_{timeline_.events(), voices_, meters_.counters};
  Renderer renderer_;
  Shedding shedding_;
  LookPressure look_pressure_;
  MixOutput output_;
  Frame now_ = 0;  // the next frame to be rendered
  double floor_ = 1e-6;
  bool deadlines_ = true;
};

}  // namespace ringdown::synth
