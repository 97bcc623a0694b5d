// The instrument behind the plug-in, for any format: MIDI and parameters in, sound out. It knows no plug-in interface;
// plugin.cpp connects it to DPF.
//
//   Instrument instrument(48000, "/usr/lib/lv2/ringdown.lv2/ringdown.so");
//   instrument.set_file("bell.glb");
//   instrument.start();                                          // loads, and starts the worker
//   instrument.render(messages, left, right, 256);               // audio
//   instrument.stop();
//
// THREADS. render() belongs to the audio thread and neither allocates, locks nor makes a system call. parameters() may
// be set by any thread. Everything else belongs to the host's main thread, or the thread on which the host restores
// states.
//
// WORKER. A thread of the instrument checks every few milliseconds what is wanted: another bank, another material or
// size, a bend, a hand on a key. It loads and retunes, and passes the audio thread a new KeyMap through a pointer. It
// runs between start() and stop(). start() and set_...() do this work themselves before they return, so that the first
// block after a session was opened sounds.
#pragma once

#include "clients/plugin/key_map.h"
#include "clients/plugin/keyboard.h"
#include "clients/plugin/parameters.h"
#include "clients/plugin/sources.h"
#include "clients/plugin/tunings.h"

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace ringdown::plugin {

struct MixerDestroy {
  void operator()(ringdown_mixer* mixer) const { ringdown_mixer_destroy(mixer); }
};

struct MidiMessage {
  std::uint32_t frame;  // position in the block
  std::span<const std::uint8_t> bytes;
};

class Instrument {
 public:
  Instrument(double sample_rate_hz, std::filesystem::path binary);
  ~Instrument() { stop(); }
  Instrument(const Instrument&) = delete;
  Instrument& operator=(const Instrument&) = delete;

  // Returns the instrument that this thread made last. The entry of a format sees only DPF's object, so it finds the
  // instrument in that object by this function. [any]
  static Instrument* newest();

  [[nodiscard]] ParameterValues& parameters() { return parameters_; }
  [[nodiscard]] const ParameterValues& parameters() const { return parameters_; }

  // Sets the file of choice 0, a bank or a note map; "": the first preset.
  void set_file(const std::string& path);
  [[nodiscard]] std::string file() const;

  // Sets the bank itself, for sessions that move to other computers: the name of its source, a space and base64; ""
  // unless the parameter asks for it. It is used while a source of this name is selected.
  void set_embedded(const std::string& text);
  [[nodiscard]] std::string embedded() const;

  // The files of tunings. The worker reads them.
  [[nodiscard]] Tunings& tunings() { return tunings_of_keys_; }

  // Sets an exact strike point as strike_point.h writes it; "": none. It is used while its object is played.
  void set_point(const std::string& text, Which which = Which::first);
  [[nodiscard]] std::string point(Which which = Which::first) const;

  // Plays a preset with all other parameters at their defaults, except the level and the scale, and without
  // exact strike points.
  void load_preset(std::size_t preset);

  // Returns the names of keys that strike objects of their own, which only note maps have: "F3" for key 53.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::string>> key_names() const;

  // Returns how many objects the keys strike, at least 1; the number of the keys' map, which changes with the names;
  // and the time after which the slowest mode is inaudible, at the present size and loss [s]. [any]
  [[nodiscard]] std::size_t voices() const REALTIME { return voices_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t generation() const REALTIME { return generation_.load(std::memory_order_relaxed); }
  [[nodiscard]] double tail_s() const REALTIME { return tail_s_.load(std::memory_order_relaxed); }

  // Ends all sound at once, and forgets pedals, bends and pressure. [audio]
  void silence() REALTIME;

  // Returns whether blocks stay silent until another message or parameter arrives. [audio]
  [[nodiscard]] bool is_idle() const REALTIME;

  // Call only while stopped.
  void set_sample_rate(double sample_rate_hz) { sample_rate_hz_ = sample_rate_hz; }

  void start();
  void stop();

  // Renders a block; messages are in order of their frames. Silent until a bank is loaded.
  void render(std::span<const MidiMessage> messages, float* left, float* right, std::size_t frames) REALTIME;

 private:
  // The retuning that the worker last gave an object.
  struct Tuning {
    ringdown_material material{};
    double damping_ns_m = 0;
    bool is_new = true;
  };

  // A gain that reaches its value in a straight line, from the start of a block.
  struct GainRamp {
    double present = 0, step = 0, wanted = 0;
    std::size_t left = 0;
    void apply(double gain, double ramp_frames, std::span<float> on_left, std::span<float> on_right) REALTIME;
  };

  void work();  // runs on the worker's thread
  void catch_up();
  void load(const Source& source);
  bool install(KeyPlan& plan);
  void silence_keys();
  void publish(std::unique_ptr<const KeyMap> map);
  bool tune(const KeyMap& map, const KeyMap::Object& object, Tuning& tuning);
  void spread(const KeyMap& map) REALTIME;
  const KeyMap* take_map() REALTIME;

  const std::filesystem::path binary_;
  double sample_rate_hz_;
  ParameterValues parameters_;
  Keyboard keyboard_;
  Tunings tunings_of_keys_;
  std::unique_ptr<ringdown_mixer, MixerDestroy> mixer_;

  mutable std::mutex mutex_;  // guards the members of this paragraph; the audio thread never locks it
  std::string file_, embedded_;
  std::array<std::string, kPoints> points_;
  bool is_other_ = true;                 // whether the file or the embedded bank has changed
  std::size_t choice_ = 0;               // choice in the last round
  Source source_;                        // the source that was last loaded, or could not be
  std::unique_ptr<KeyPlan> plan_;        // loaded, but not yet in the mixer
  std::int64_t full_at_ = -1;            // frame at which the mixer had no room for the plan; next try after it
  std::vector<Tuning> tunings_;          // tunings of map_'s objects
  PlacedSizes sizes_{};                  // of map_'s objects
  std::shared_ptr<ringdown_bank> bank_;  // bank of map_'s first object
  std::unique_ptr<const KeyMap> map_;
  std::vector<std::unique_ptr<const KeyMap>> retired_;  // maps that the audio thread may still read
  std::uint64_t generations_ = 0;
  std::uint64_t rounds_ = 0;  // rounds of the worker

  std::atomic<const KeyMap*> published_ = nullptr, in_use_ = nullptr;  // the map to play; the map being read
  std::uint64_t spread_generation_ = 0;                                // [audio] that of the map last spread
  double spread_pan_ = 0, spread_width_ = 0;                           // [audio]
  GainRamp gain_;                                                      // [audio]
  std::size_t silent_frames_ = 0;                                      // [audio] since the last sound or message

  static constexpr std::size_t kUnsettled = ~std::size_t{0};
  std::atomic<std::size_t> settled_ = kUnsettled;  // the choice that the worker has installed
  std::atomic<std::size_t> voices_ = 1;
  std::atomic<std::uint64_t> generation_ = 0;
  std::atomic<double> tail_s_ = 0;

  std::thread worker_;
  std::atomic<bool> running_ = false;
};

}  // namespace ringdown::plugin
