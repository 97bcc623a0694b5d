// Plays a scene in the mixer's time: steps the world so that it stays just ahead of the sound, and passes its events to
// the rack.
//
//   player.load("drop.toml", frame);               // worker: the scene and its objects; scene time 0 is at `frame`
//   player.advance_to(frame_ahead, slack);         // scene thread, every few milliseconds
//   player.spawn(box); player.push(body, ...);     // worker: requests change the world meanwhile
//
// ScenePlayer has no thread and no clock of its own: the daemon's scene thread and `ringdown render` both call
// advance_to(). A mutex guards the world; the audio thread never takes it.
#pragma once

#include "engine/base/result.h"
#include "engine/scene/gltf/surface.h"
#include "engine/scene/world.h"
#include "engine/synth/events/event.h"
#include "protocol/request.h"
#include "server/session/bank_reader.h"
#include "server/session/file_roots.h"
#include "server/session/rack.h"
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

// A mutex that is given to those who wait in their order: a thread that lets go of it and wants it again at once does
// not pass the others.
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
  // Takes the report of one step: its events, and what has begun or ceased to rest on objects. Returns how many of
  // these could not be passed on.
  using Sink = std::function<std::size_t(const scene::StepReport&)>;

  // Reads scene files below `roots`, and their banks by `banks`. The events go to the rack, unless send_to() names a
  // sink. All three must outlive the player.
  ScenePlayer(Rack& rack, BankReader& banks, const FileRoots& roots) : rack_(rack), banks_(banks), roots_(roots) {}

  // Passes the reports to `sink` instead of the rack. Before anything is loaded. [main]
  void send_to(Sink sink) { sink_ = std::move(sink); }

  // A body that rests on an object damps it, so the worker retunes the object. retune_by() names the function
  // that hands such tasks to the worker and returns whether the worker took them; without it they are carried out at
  // once. While the scene thread does not run. [main]
  using Post = std::function<bool(std::function<void()>)>;
  void retune_by(Post post) { post_ = std::move(post); }

  // Loads a scene file, TOML or glTF (.glb, .gltf), and the objects it names, and starts it at `frame`. The former
  // scene ends; its objects stay. Returns the number of bodies. [worker]
  Result<std::size_t> load(const std::filesystem::path& path, synth::Frame frame);

  // Requests to the scene; without a scene they are refused. spawn() returns the new body's number; clear() removes all
  // bodies, and gives up the step that is being done; push() applies an impulse at the body's centre of mass, in the
  // scene's axes. [worker]
  Result<void> pause(bool paused);
  Result<scene::BodyId> spawn(const protocol::SpawnBox& box);
  Result<scene::BodyId> spawn(const protocol::SpawnSphere& sphere);
  Result<void> clear();
  Result<void> push(scene::BodyId body, Vec3 impulse_ns);

  // An object of the rack has a new bank, or has been freed: bodies that sound by it get the new bank, or become
  // silent. [worker]
  Result<void> object_changed(const ObjectState& object);
  void object_freed(synth::ObjectNumber number);

  // Steps the world until all events before `frame` have been passed on. A world that is more than `slack` frames
  // behind is moved later instead of catching up with a burst of strikes: the scene then runs slowly. Without `slack`
  // the world always catches up. A paused scene is not stepped, and neither is a scene in which nothing can sound and
  // that nobody watches; its time stands still. [scene]
  void advance_to(synth::Frame frame, std::optional<synth::Frame> slack);

  // Takes one step of advance_to(). False when no more are needed. Between two steps requests have their turn, so that
  // what is slow to step can be cleared. [scene]
  bool step_towards(synth::Frame frame, std::optional<synth::Frame> slack);

  // The step that is being done and all later ones end soon, wrong as they are: before the player goes. [any]
  void give_up() { ++given_up_; }

  // Changes the sample rate of the scene and of the rack. Events to come stay as many seconds ahead as they were.
  // [any thread, while nothing is rendered]
  void change_sample_rate(double sample_rate_hz);

  // Where the bodies are at one time of the scene.
  struct Poses {
    std::int32_t version = 0;
    double time_s = 0;  // the scene's, which runs a little ahead of the sound
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

  // Says whether somebody follows the bodies: a watched scene is stepped even when nothing in it can sound. [any]
  void set_watched(bool watched) { watched_ = watched; }

  // Which file is played, and what was done to the scene since; nullopt when there is no scene. [any but audio]
  struct Playing {
    std::filesystem::path file;
    bool paused = false, cleared = false;
  };
  [[nodiscard]] std::optional<Playing> playing() const;

  // Returns the scene's file, without bodies that were cleared and with those that were dropped, which enter at the
  // time at which they were; nullopt when there is no scene. [any but audio]
  [[nodiscard]] std::optional<scene::SceneDescription> description() const;

  [[nodiscard]] std::size_t body_count() const { return body_count_; }  // [any]

  // How long the scene lasts, as its file says; 0 without a scene. [any]
  [[nodiscard]] double duration_s() const { return duration_s_; }

  // Events and dampings that were lost because a queue was full. [any]
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  // By how much the scene was moved later because the computer could not keep up. [any]
  [[nodiscard]] double slowed_s() const { return slowed_s_; }

 private:
  Result<scene::BodyId> spawn(const std::optional<protocol::ObjectRef>& object, scene::BodyDescription body);
  [[nodiscard]] synth::Frame position() const;
  [[nodiscard]] synth::Frame reported_until() const;
  void slow_down(synth::Frame by);
  void pass_on(const scene::StepReport& report, std::vector<scene::RestDamping>& dampings);
  [[nodiscard]] std::vector<scene::RestDamping> end_contacts();
  void set_dampers(const std::vector<scene::RestDamping>& dampings);

  Rack& rack_;
  BankReader& banks_;
  const FileRoots& roots_;
  Sink sink_;
  Post post_;
  mutable FairMutex mutex_;  // guards all members below except the atomics
  std::optional<scene::World> world_;
  ScenePoses poses_;
  scene::Reliefs reliefs_;      // of all scenes so far: the mixer may still feel them
  bool sets_listener_ = false;  // the scene, or one before it
  synth::Frame start_ = 0;      // the frame of scene time 0
  Playing playing_;
  scene::SceneDescription description_;   // of world_
  std::int32_t version_ = 0;              // of the description
  std::set<synth::ObjectNumber> damped_;  // objects that the scene's bodies rest on or against
  std::atomic<int> given_up_ = 0;         // how many wait for a step whose result does not matter
  std::atomic<bool> watched_ = false;
  std::atomic<std::size_t> body_count_ = 0;
  std::atomic<double> duration_s_ = 0;
  std::atomic<std::uint64_t> dropped_ = 0;
  std::atomic<double> slowed_s_ = 0;
  double reported_slowed_s_ = 0;  // slowed_s_ at the last warning
};

}  // namespace ringdown::session
