// The objects that can be struck: their names and numbers, their banks, and the mixer they ring in.
//
// Threads. One worker thread loads, retunes, frees and collects. Any other thread but audio may look objects up and
// push events; neither waits for the worker, except that gains and pans are written down (object_table.h).
#pragma once

#include "engine/base/content_hash.h"
#include "engine/base/result.h"
#include "engine/modal/strike_map.h"
#include "engine/synth/event.h"
#include "engine/synth/mixer.h"
#include "protocol/request.h"
#include "server/session/buses.h"
#include "server/session/file_roots.h"
#include "server/session/object_table.h"
#include "server/session/observer.h"

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
#include <vector>

namespace ringdown::session {

class Rack {
 public:
  // Banks are read below `roots` only.
  explicit Rack(double sample_rate_hz, FileRoots roots = {}) : mixer_(sample_rate_hz), roots_(std::move(roots)) {}

  [[nodiscard]] const FileRoots& roots() const { return roots_; }

  [[nodiscard]] synth::Mixer& mixer() { return mixer_; }
  [[nodiscard]] const synth::Mixer& mixer() const { return mixer_; }

  // Called whenever an object has come, gone or changed, and when a bus has. [main, before anything is loaded]
  void set_on_change(std::function<void()> on_change) { on_change_ = std::move(on_change); }

  // Receives one sentence for each thing that went less well than asked, by the worker or the scene's thread. Without
  // it the sentences are lost. [main, before anything is loaded]
  void set_on_warning(std::function<void(const std::string& sentence)> on_warning) {
    on_warning_ = std::move(on_warning);
  }
  void warn(const std::string& sentence) const {
    if (on_warning_) on_warning_(sentence);
  }

  // Grows with every change. [any]
  [[nodiscard]] std::uint64_t version() const { return version_; }

  // Reports to `observer` from now on, until stop_observing(), which must be called while nothing happens. [main,
  // before other threads use the rack]
  void observe(Observer& observer) { observers_.push_back(&observer); }
  void stop_observing(Observer& observer) { std::erase(observers_, &observer); }

  // Hands an event to the mixer. If the mixer's queue has room, a gain or pan becomes the object's, and the event waits
  // for report_events(). For other events than those two nothing is locked, unless kQueueCapacity wait. [the producer's
  // thread]
  [[nodiscard]] bool push(synth::Producer producer, const synth::Event& event);

  // Where the audio thread puts the events that it has pushed to the mixer itself, for the observers. Events that find
  // this ring full are heard but not reported.
  [[nodiscard]] SpscRing<synth::Event>& notes_played() { return played_by(synth::Producer::midi); }

  // Reports to the observers what was pushed since the last call; several times a second. [any but audio]
  void report_events();

  // The object as it is now. Neither locks nor allocates, unless there is none. [any but audio]
  [[nodiscard]] Result<ObjectSnapshot> find(const protocol::ObjectRef& object) const;

  // All objects, and all names, in the order of the names. [any but audio]
  [[nodiscard]] std::vector<ObjectSnapshot> objects() const { return objects_.all(); }
  [[nodiscard]] std::shared_ptr<const ObjectTable::Names> names() const { return objects_.names(); }

  // A bank, ready to be struck; shared with every object that plays the same unchanged file. [worker]
  struct BankFile {
    std::shared_ptr<const modal::StrikeMap> map;
    std::size_t bytes = 0;
    ContentHash content;
  };
  Result<BankFile> read(const std::filesystem::path& bank);

  // Reads a bank and gives it to `name`: a new object, or a new bank for that object, whose old one rings out.
  // Returns its number. On failure nothing changed. [worker]
  Result<synth::ObjectNumber> load(const std::string& name, const std::filesystem::path& bank);

  // Retunes what rings, and what will. Of `dampers` one without damping is taken away, and one that the object does not
  // have laid on; the others stay. Not before frame `at`. [worker]
  Result<void> set_material(const protocol::ObjectRef& object, const modal::MaterialScale& scale);
  Result<void> set_dampers(const protocol::ObjectRef& object, const modal::Dampers& dampers, synth::Frame at = 0);

  // Leaves the object these of its modes; what others ring fades within some milliseconds. A new bank has all. [worker]
  Result<void> select_modes(const protocol::ObjectRef& object, modal::ModeRange modes);

  // Puts the object into a group, or, when it is empty, into none. [worker]
  Result<void> set_group(const protocol::ObjectRef& object, const std::string& group);

  // Lets an input, from 0, excite the object: a sample of 1 is `force_n` at `point_m`, in the object's frame. No force
  // ends it. An input excites one object at a time, until that is freed. [worker]
  Result<void> excite(std::size_t input, const protocol::ObjectRef& object, const Vec3& point_m, const Vec3& force_n);

  // The inputs that have excited something, and are now to stay; bit 0 is the first. [any]
  [[nodiscard]] std::uint32_t inputs() const { return inputs_; }

  // What the inputs excite. [worker]
  struct Excitation {
    synth::ObjectNumber object;
    Vec3 point_m, force_n;
  };
  using Excitations = std::array<std::optional<Excitation>, synth::kMaxInputs>;
  [[nodiscard]] const Excitations& excitations() const { return excitations_; }

  // Where the objects are heard beside the mix.
  [[nodiscard]] Buses& buses() { return buses_; }

  // Fades the object out and gives its name and number free. [worker]
  Result<void> free(const protocol::ObjectRef& object);

  // Retunes everything to another sample rate. [any thread, while nothing is rendered]
  void change_sample_rate(double sample_rate_hz);

  // Frees memory the mixer is done with, and numbers that have fallen silent. Several times a second. [worker]
  void collect();

 private:
  [[nodiscard]] SpscRing<synth::Event>& played_by(synth::Producer p) { return played_[static_cast<std::size_t>(p)]; }
  [[nodiscard]] Result<synth::ObjectNumber> free_number() const;
  using Edit = std::function<void(ObjectState&)>;
  // Replaces an object's snapshot and reports that to the observers; retune() gives it a voice of the same bank first.
  // [worker]
  void change(const ObjectState& object, const Edit& edit, synth::Frame at = 0);
  [[nodiscard]] Result<void> retune(const ObjectState& object, const Edit& edit, synth::Frame at = 0);
  void report(const ObjectState* before, const ObjectState* after, synth::Frame at);
  void note_change();
  [[nodiscard]] Result<void> assign(const ObjectState& object);
  [[nodiscard]] Result<void> install(const ObjectState& object, synth::Mixer::Install how, synth::Frame at = 0);

  synth::Mixer mixer_;
  FileRoots roots_;
  std::vector<Observer*> observers_;
  // What each producer has pushed and the observers do not know of yet.
  std::array<SpscRing<synth::Event>, static_cast<std::size_t>(synth::Producer::kCount)> played_{
      SpscRing<synth::Event>(synth::kQueueCapacity), SpscRing<synth::Event>(synth::kQueueCapacity),
      SpscRing<synth::Event>(synth::kQueueCapacity), SpscRing<synth::Event>(synth::kQueueCapacity)};
  std::mutex reporting_;  // held by the one who empties them
  ObjectTable objects_;
  std::function<void()> on_change_;
  std::function<void(const std::string&)> on_warning_;
  std::atomic<std::uint64_t> version_ = 0;
  Buses buses_;
  Excitations excitations_;  // worker
  std::atomic<std::uint32_t> inputs_ = 0;
  std::set<synth::ObjectNumber> fading_;  // worker: freed objects that still sound at their bus
  std::mutex rate_mutex_;  // held while voices are made and installed, or collected: all are of one sample rate
  struct KnownBank {
    std::weak_ptr<const modal::StrikeMap> map;
    std::size_t bytes = 0;
    ContentHash content;
  };
  std::map<std::string, KnownBank> banks_;  // worker: those in use, by file and its time
  std::int32_t last_bank_version_ = 0;      // worker
};

}  // namespace ringdown::session
