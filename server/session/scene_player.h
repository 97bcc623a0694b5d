// Plays a scene in the mixer's time: steps the world so that it stays just ahead of the sound, and passes its events to
// the rack.
//
//   player.load("drop.toml", frame);               // worker: the scene and its objects; scene time 0 is at `frame`
//   player.advance_to(frame_ahead, slack);         // scene thread, every few milliseconds
//   player.spawn(box); player.change(push);        // worker: requests change the world meanwhile
//
// ScenePlayer has no thread and no clock of its own: the daemon's scene thread and `ringdown render` both call
// advance_to(). A mutex guards the world; the audio thread never takes it.
#pragma once

#include "engine/base/one_of.h"
#include "engine/base/result.h"
#include "engine/scene/gltf/surface.h"
#include "engine/scene/world.h"
#include "engine/synth/events/event.h"
#include "protocol/request.h"
#include "server/session/bank_reader.h"
#include "server/session/file_roots.h"
#include "server/session/kept_scene.h"
#include "server/session/rack.h"
#include "server/session/scene_pieces.h"
#include "server/session/scene_poses.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace ringdown::session {

// A mutex that waiting threads get in the order of their arrival: a thread that unlocks the mutex and locks it again at
// once does not overtake the waiting threads.
class FairMutex {
 public:
  void lock() {
    const std::scoped_lock door(door_);
    mutex_.lock();
  }
  void unlock() { mutex_.unlock(); }

 private:
  std::mutex door_, mutex_;
};

class ScenePlayer {
 public:
  // Takes the report of one step: events, and bodies that have begun or ceased to rest on objects. Returns the number
  // of items that could not be passed on.
  using Sink = std::function<std::size_t(const scene::StepReport&)>;

  // Reads scene files below `roots`, and their banks by `banks`. The events go to the rack, unless send_to() names a
  // sink. All three must outlive the player.
  ScenePlayer(Rack& rack, BankReader& banks, const FileRoots& roots) : rack_(rack), banks_(banks), roots_(roots) {}

  // Passes the reports to `sink` instead of the rack. Call before anything is loaded. [main]
  void send_to(Sink sink) { sink_ = std::move(sink); }

  // Says how the scenes to come are read: with `limits`, contacts of animated bodies are recovered from their motion;
  // with `camera`, the listener is the scene's camera of this name. `watch`, if there is one, gets the contacts of
  // every step. [main]
  using Watch = std::function<void(std::span<const scene::HeardContact>)>;
  void read_with(std::optional<scene::FoleyLimits> limits, std::optional<std::string> camera, Watch watch) {
    foley_ = limits;
    camera_ = std::move(camera);
    watch_ = std::move(watch);
  }

  // Sets the function that hands tasks to the worker and returns whether the worker took them. The tasks retune
  // objects, which bodies resting on them damp; without the function they are carried out at once. Call while the scene
  // thread does not run. [main]
  using Post = std::function<bool(std::function<void()>)>;
  void retune_by(Post post) { post_ = std::move(post); }

  // Loads a scene file, TOML or glTF (.glb, .gltf), and the objects it names, and starts the scene at `frame`. The
  // previous scene ends; its objects stay. A paused scene waits for pause(false). Returns the number of bodies.
  // [worker]
  Result<std::size_t> load(const std::filesystem::path& path, synth::Frame frame, bool paused = false);

  // Requests to the scene; without a scene they are refused. spawn() returns the new body's number; clear() removes all
  // bodies and aborts the present step; change() takes one body out, puts it back where it was or elsewhere, at rest,
  // or applies an impulse at its centre of mass, in the scene's axes. [worker]
  Result<void> pause(bool paused);
  Result<scene::BodyId> spawn(const protocol::SpawnBox& box);
  Result<scene::BodyId> spawn(const protocol::SpawnSphere& sphere);
  Result<void> clear();
  using Change = OneOf<Types<protocol::SceneRemove, protocol::SceneRestore, protocol::ScenePlace, protocol::ScenePush>>;
  Result<void> change(const Change& change);

  // Call after an object of the rack got a new bank or was freed: bodies that sound by this object get the new bank, or
  // become silent. [worker]
  Result<void> object_changed(const ObjectState& object);
  void object_freed(synth::ObjectNumber number);

  // Steps the world until all events before `frame` have been passed on. A world that is more than `slack` frames
  // behind is moved later instead of catching up with a burst of strikes: the scene then runs slowly. Without `slack`
  // the world always catches up. A paused scene is not stepped, and neither is a scene in which nothing can sound and
  // that nobody watches; its time stands still. [scene]
  void advance_to(synth::Frame frame, std::optional<synth::Frame> slack);

  // Takes one step of advance_to(). Returns false if no more steps are needed. Requests are handled between two steps,
  // so that a scene that is slow to step can be cleared. [scene]
  bool step_towards(synth::Frame frame, std::optional<synth::Frame> slack);

  // Makes the present step and all later ones end soon, with wrong results. Call before the player is destroyed. [any]
  void give_up() { ++given_up_; }

  // Changes the sample rate of the scene and of the rack. Events to come stay as many seconds ahead as they were.
  // [any thread, while nothing is rendered]
  void change_sample_rate(double sample_rate_hz);

  // The poses of the bodies at one time of the scene.
  struct Poses {
    std::int32_t version = 0;
    double time_s = 0;  // scene time, which runs a little ahead of the sound
    bool paused = false;
    std::vector<scene::BodyState> bodies;
  };
  [[nodiscard]] Poses poses() const;  // [any but audio]

  // The scene's appearance. `version` grows whenever something in the description changes.
  struct Description {
    std::int32_t version = 0;
    double duration_s = 0;
    std::optional<scene::CameraDescription> camera;
    std::optional<std::filesystem::path> file;  // absent: there is no scene
    std::vector<scene::BodyOutline> bodies;
    std::vector<scene::StaticOutline> statics;
  };
  [[nodiscard]] Description describe() const;  // [any but audio]

  // Sets whether anybody follows the bodies. A watched scene is stepped even if nothing in it can sound. [any]
  void set_watched(bool watched) { watched_ = watched; }

  // The file that is played, and the changes to the scene since loading; nullopt if there is no scene. [any but audio]
  struct Playing {
    std::filesystem::path file;
    bool paused = false, cleared = false;
  };
  [[nodiscard]] std::optional<Playing> playing() const;

  // Returns the description in the scene's file, without cleared bodies and with dropped bodies, which enter at the
  // time at which they were dropped; nullopt if there is no scene. [any but audio]
  [[nodiscard]] std::optional<scene::SceneDescription> description() const;

  // The pieces of the scene's bodies, and which bodies have broken. [any but audio]
  [[nodiscard]] const ScenePieces& pieces() const { return pieces_; }

  [[nodiscard]] std::size_t body_count() const { return body_count_; }  // [any]

  // The duration of the scene by its file; 0 without a scene. [any]
  [[nodiscard]] double duration_s() const { return duration_s_; }

  struct Lost {
    std::uint64_t dropped = 0;  // events and dampings, because a queue was full
    double slowed_s = 0;        // the total delay of the scene, because the computer could not keep up
  };
  [[nodiscard]] Lost lost() const { return {dropped_, slowed_s_}; }  // [any]

 private:
  Result<scene::BodyId> spawn(const std::optional<protocol::ObjectRef>& object, scene::BodyDescription body);
  [[nodiscard]] synth::Frame position() const;
  void slow_down(synth::Frame by);
  void pass_on(const scene::StepReport& report, std::vector<scene::RestDamping>& dampings);
  [[nodiscard]] std::vector<scene::RestDamping> end_contacts();
  void set_dampers(const std::vector<scene::RestDamping>& dampings);

  Rack& rack_;
  BankReader& banks_;
  const FileRoots& roots_;
  Sink sink_;
  std::optional<scene::FoleyLimits> foley_;
  std::optional<std::string> camera_;
  Watch watch_;
  Post post_;
  ScenePieces pieces_{rack_};  // worker
  mutable FairMutex mutex_;    // guards all members below except the atomics
  std::optional<scene::World> world_;
  ScenePoses poses_;
  scene::Reliefs reliefs_;      // reliefs of all scenes so far, which the mixer may still use
  bool sets_listener_ = false;  // whether this scene, or a previous one, has set a listener
  synth::Frame start_ = 0;      // the frame of scene time 0
  Playing playing_;
  KeptScene kept_;                        // description of world_
  std::int32_t version_ = 0;              // version of the description
  std::set<synth::ObjectNumber> damped_;  // objects that the scene's bodies rest on or against
  std::atomic<int> given_up_ = 0;         // number of callers waiting for a step whose result does not matter
  std::atomic<bool> watched_ = false;
  std::atomic<std::size_t> body_count_ = 0;
  std::atomic<double> duration_s_ = 0;
  std::atomic<std::uint64_t> dropped_ = 0;
  std::atomic<double> slowed_s_ = 0;
  double reported_slowed_s_ = 0;  // slowed_s_ at the last warning
};

}  // namespace ringdown::session
