// The objects that can be struck: their names and numbers, their banks, and the mixer they ring in.
//
// Threads. One worker thread loads, retunes, frees and collects. Any other thread but audio may look objects up and
// make events; a mutex guards the table, and the audio thread never takes it.
#pragma once

#include "engine/base/content_hash.h"
#include "engine/base/result.h"
#include "engine/modal/strike_map.h"
#include "engine/synth/event.h"
#include "engine/synth/mixer.h"
#include "protocol/request.h"
#include "server/session/buses.h"
#include "server/session/file_roots.h"
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
#include <unordered_map>
#include <vector>

namespace ringdown::session {

// An object as it is now. The bank stays valid for whoever holds the pointer, whatever is loaded later.
struct RackObject {
  std::string name;
  synth::ObjectNumber number = 0;
  std::shared_ptr<const std::filesystem::path> bank;  // where the map was read from
  std::size_t bank_bytes = 0;                         // the size of that file
  ContentHash bank_content;                           // of that file
  std::int32_t bank_version = 0;                      // grows when the object gets a new bank
  std::shared_ptr<const modal::StrikeMap> map;
  modal::MaterialScale material;
  modal::Dampers dampers;  // what lies on it
  modal::ModeRange modes;  // those that it has
  std::string group;       // empty: in none
};

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

  // Tells `observer` from now on; until observe_no_more(), which must come while nothing happens. [main, before other
  // threads use the rack]
  void observe(Observer& observer) { observers_.push_back(&observer); }
  void observe_no_more(Observer& observer) { std::erase(observers_, &observer); }

  // Hands an event to the mixer and, if it has room, tells the observers. [the producer's thread]
  [[nodiscard]] bool push(synth::Producer producer, const synth::Event& event);

  // Where the audio thread puts the events that it has pushed itself, for the observers. Those that find it full are
  // heard but not told.
  [[nodiscard]] SpscRing<synth::Event>& notes_played() { return notes_played_; }

  // Tells the observers of these; several times a second. [any but audio]
  void tell_of_notes();

  // Takes as long with one object as with kMaxObjects. [any but audio]
  [[nodiscard]] Result<RackObject> find(const protocol::ObjectRef& object) const;

  // By name; the names as they are now, however many there are, without copying them. [any but audio]
  using Names = std::vector<std::string>;
  [[nodiscard]] std::vector<RackObject> objects() const;
  [[nodiscard]] std::shared_ptr<const Names> names() const;

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
  [[nodiscard]] Result<synth::ObjectNumber> free_number() const;
  // Puts an object in the table, or its successor in its place. [worker]
  void keep(RackObject object);
  void list_names();
  void note_change();
  [[nodiscard]] Result<void> assign(const RackObject& object);
  [[nodiscard]] Result<void> install(const RackObject& object, synth::Mixer::Install how, synth::Frame at = 0);

  synth::Mixer mixer_;
  FileRoots roots_;
  std::vector<Observer*> observers_;
  SpscRing<synth::Event> notes_played_{synth::kQueueCapacity};
  std::mutex notes_mutex_;    // held by the one who empties it
  mutable std::mutex mutex_;  // guards the next three, which the worker alone changes
  std::vector<std::optional<RackObject>> objects_ = std::vector<std::optional<RackObject>>(synth::kMaxObjects);
  std::unordered_map<std::string, synth::ObjectNumber> numbers_;  // by name
  std::shared_ptr<const Names> names_ = std::make_shared<const Names>();
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

// The event of an immediate request (strike, gain, pan, clear of one object), for an object that find() returned.
// Refuses a vertex or mode that its bank does not have. [any but audio]
Result<synth::Event> event_for(const protocol::Request& request, const RackObject& object, synth::Frame frame);

}  // namespace ringdown::session
