// The objects that can be struck: their names and numbers, their banks, and the mixer they ring in.
//
//   rack.load("bell", "bell.glb");                                // worker: a bank, and a voice in the mixer
//   rack.push(synth::Producer::control, {.object = number, ...}); // any thread: the bell is struck
//   rack.set_material({.name = "bell"}, {.stiffness = 1.1});      // worker: what rings is retuned
//   rack.free({.name = "bell"});                                  // worker: fades out
//   rack.collect();                                               // worker, several times a second
//
// Threads. One worker thread loads, retunes, frees and collects. Any other thread but audio may look objects up and
// push events. Lookups and events do not wait for the worker. All changes are reported to observers().
#pragma once

#include "engine/base/result.h"
#include "engine/synth/events/event.h"
#include "engine/synth/mixer.h"
#include "protocol/request.h"
#include "server/session/bank_reader.h"
#include "server/session/buses.h"
#include "server/session/listener_memory.h"
#include "server/session/object_table.h"
#include "server/session/observers.h"
#include "server/session/silences.h"

#include <array>
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::session {

// The farthest an event may lie ahead, so that senders with a wrong clock get an error.
inline constexpr double kMaxAhead_s = 3600;
[[nodiscard]] inline bool is_too_far_ahead(const synth::Mixer& mixer, synth::Frame frame) {  // [any]
  const synth::Frame now = mixer.counters().frames.load(std::memory_order_relaxed);
  return static_cast<double>(frame - now) > kMaxAhead_s * mixer.sample_rate_hz();
}

class Rack {
 public:
  // `vary`, if there is one, may change every event before it is handed to the mixer. `banks` must outlive the rack.
  using Vary = std::function<void(synth::Event&)>;
  Rack(double sample_rate_hz, BankReader& banks, Vary vary = {})
      : mixer_(sample_rate_hz), banks_(banks), vary_(std::move(vary)) {}

  [[nodiscard]] synth::Mixer& mixer() { return mixer_; }
  [[nodiscard]] const synth::Mixer& mixer() const { return mixer_; }

  // The observers of events and changes in the rack.
  [[nodiscard]] Observers& observers() { return observers_; }
  [[nodiscard]] const Observers& observers() const { return observers_; }

  // Receives one sentence for each request that could be carried out in part only, from the worker or from the scene's
  // thread. By default the sentences are lost. [set by main, before anything is loaded]
  using Warn = std::function<void(const std::string& sentence)>;
  Warn warn = [](const std::string&) {};

  // Hands an event to the mixer. Returns false, and does nothing, if the mixer's queue is full. A gain or pan is stored
  // in the object, and a listener is remembered. Neither locks nor allocates, unless Observers::keep() does. [the
  // producer's thread]
  [[nodiscard]] bool push(synth::Producer producer, const synth::Event& event);

  // The listener's last pose and air, if there is a listener. [any but audio]
  [[nodiscard]] const ListenerMemory& listener() const { return listener_; }

  // Returns the object as it is now. Neither locks nor allocates, unless there is none. [any but audio]
  [[nodiscard]] Result<ObjectSnapshot> find(const protocol::ObjectRef& object) const;

  // All objects, and all names, in the order of the names. [any but audio]
  [[nodiscard]] std::vector<ObjectSnapshot> objects() const { return objects_.all(); }
  [[nodiscard]] std::shared_ptr<const ObjectTable::Names> names() const { return objects_.names(); }

  // Reads a bank and gives it to the object of that name, which is created if there is none; the object's previous bank
  // rings out. Returns the object's number. On failure nothing changes. [worker]
  Result<synth::ObjectNumber> load(const std::string& name, const std::filesystem::path& bank);
  // Gives the object of that name a bank that was already read from `path`; otherwise like load().
  Result<synth::ObjectNumber> add(const std::string& name, const std::filesystem::path& path, BankFile bank);

  // Change the material or the dampers, which retunes ringing modes and later strikes. Each damper in `dampers` is
  // added, or replaces the object's damper of that number, or removes that damper if its damping is 0; all other
  // dampers of the object stay. The retuning happens at frame `at`, or at once if that has passed. `untuned_size`: the
  // size that the object would have in equal temperament, if a keyboard's tuning asks for this one. [worker]
  Result<void> set_material(const protocol::ObjectRef& object, const modal::MaterialScale& scale,
                            std::optional<double> untuned_size = {});
  Result<void> set_dampers(const protocol::ObjectRef& object, const modal::Dampers& dampers, synth::Frame at = 0);

  // Lets the liquid in the object stand at another level [m, in the object's frame and size], which retunes what rings
  // at frame `at`. Fails when the bank knows no levels, or not this one. A new bank stands as baked. [worker]
  Result<void> set_level(const protocol::ObjectRef& object, double level_m, synth::Frame at = 0);

  // Tunes the tubes under the object, and retunes what rings at frame `at`. Fails when the bank has no tube whose pull
  // it shows. A new bank's tubes are as baked. [worker]
  Result<void> set_tubes(const protocol::ObjectRef& object, const modal::TubeTuning& tuning, synth::Frame at = 0);

  // Restricts the object to a range of its modes. Modes outside the range fade within a few milliseconds. A new bank
  // removes the restriction. [worker]
  Result<void> select_modes(const protocol::ObjectRef& object, modal::ModeRange modes);

  // Puts the object into a group; an empty name takes the object out of its group. [worker]
  Result<void> set_group(const protocol::ObjectRef& object, const std::string& group);

  // Sets ObjectState::mute or ObjectState::solo (silences.h). A silenced object goes on ringing unheard, and fades in
  // and out without a click. [worker]
  Result<void> set_heard(const protocol::ObjectRef& object, bool ObjectState::*flag, bool on);

  // Lets an input, counted from 0, excite the object: a sample of 1 is `force_n` at `point_m`, in the object's frame. A
  // force of 0 ends the excitation. An input excites one object at a time, until that object is freed. A point far from
  // the object is refused (check_point()). [worker]
  Result<void> excite(std::size_t input, const protocol::ObjectRef& object, const Vec3& point_m, const Vec3& force_n);

  // The inputs that have ever excited an object; their ports stay. Bit 0 is the first input. [any]
  [[nodiscard]] std::uint32_t inputs() const { return inputs_; }

  // The object and point that each input excites. [worker]
  struct Excitation {
    synth::ObjectNumber object;
    Vec3 point_m, force_n;
  };
  using Excitations = std::array<std::optional<Excitation>, synth::kMaxInputs>;
  [[nodiscard]] const Excitations& excitations() const { return excitations_; }

  // The buses, which make objects audible at their own ports beside the mix.
  [[nodiscard]] Buses& buses() { return buses_; }

  // The outputs beside the mix that should have a port, by number: the buses, and the pickups that have ever been set.
  // [any but audio]
  [[nodiscard]] std::map<std::size_t, std::string> ports() const;

  // Fades the object out. Its name may be used again at once, its number when the object is silent. [worker]
  Result<void> free(const protocol::ObjectRef& object);

  // Retunes everything to another sample rate. [any thread, while nothing is rendered]
  void change_sample_rate(double sample_rate_hz);

  // Reports events, and frees unused voices, snapshots and banks, and the numbers and buses of freed objects that have
  // fallen silent. Call several times a second. [worker]
  void collect();

 private:
  using Edit = std::function<void(ObjectState&)>;
  // change() replaces an object's snapshot and reports that to the observers; retune() first gives the object a new
  // voice of its bank. [worker]
  void change(const ObjectState& object, const Edit& edit, synth::Frame at = 0);
  [[nodiscard]] Result<void> retune(const ObjectState& object, const Edit& edit, synth::Frame at = 0);
  [[nodiscard]] Result<void> install(const ObjectState& object, synth::Mixer::Install how, synth::Frame at = 0,
                                     std::shared_ptr<const modal::ModeTransfer> mode_change = {});

  synth::Mixer mixer_;
  BankReader& banks_;  // worker
  Vary vary_;
  Observers observers_;
  ObjectTable objects_;
  Buses buses_;
  Excitations excitations_;                              // worker
  std::atomic<std::uint32_t> inputs_ = 0, pickups_ = 0;  // of pickups, bit 0 is pickup 1
  std::uint32_t shown_pickups_ = 0;                      // worker: those that observers know of
  ListenerMemory listener_;
  Silences silences_{mixer_};             // worker
  std::set<synth::ObjectNumber> fading_;  // worker: freed objects that still sound at their bus
  std::mutex rate_mutex_;  // held while voices are made and installed, or collected: all are of one sample rate
  std::int32_t last_bank_version_ = 0;  // worker
};

}  // namespace ringdown::session
