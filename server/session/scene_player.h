// The embedded scene in the mixer's time: steps the world so that it stays just ahead of the sound, and passes its
// strikes on.
//
// It has no thread and no clock of its own: the daemon's scene thread and `ringdown render` both call advance_to().
// A mutex guards the world against requests that arrive meanwhile; the audio thread never takes it.
#pragma once

#include "engine/base/result.h"
#include "engine/scene/world.h"
#include "engine/synth/event.h"
#include "protocol/request.h"
#include "server/session/bank_reader.h"
#include "server/session/file_roots.h"
#include "server/session/rack.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <vector>

namespace ringdown::session {

class ScenePlayer {
 public:
  // Takes the events of one step, and what rests on objects since; returns how much of it was lost.
  using Sink = std::function<std::size_t(const scene::StepReport&)>;

  // Reads scene files below `roots`, and their banks by `banks`. The events go to the rack, unless send_to() names a
  // sink. All three must outlive the player.
  ScenePlayer(Rack& rack, BankReader& banks, const FileRoots& roots) : rack_(rack), banks_(banks), roots_(roots) {}

  // Sends it elsewhere. Before anything is loaded. [main]
  void send_to(Sink sink) { sink_ = std::move(sink); }

  // What rests on objects damps them: that retunes them, which is the worker's to do. It goes to `post`, which says
  // whether it took it; without one it is done at once. While the scene thread does not run. [main]
  using Post = std::function<bool(std::function<void()>)>;
  void retune_by(Post post) { post_ = std::move(post); }

  // Loads a scene file and the objects it names, and starts it at `frame`. The former scene ends; its objects stay.
  // Returns the number of bodies. [worker]
  Result<std::size_t> load(const std::filesystem::path& path, synth::Frame frame);

  Result<void> pause(bool paused);                                   // [worker]
  Result<scene::BodyId> spawn(const protocol::SpawnBox& box);        // the body's number [worker]
  Result<scene::BodyId> spawn(const protocol::SpawnSphere& sphere);  // [worker]
  Result<void> clear();                                              // [worker]
  Result<void> push(scene::BodyId body, Vec3 impulse_ns);            // at its centre of mass, the scene's axes [worker]

  // An object of the rack has a new bank, or has gone; bodies that play it follow. [worker]
  Result<void> object_changed(const ObjectState& object);
  void object_freed(synth::ObjectNumber number);

  // Steps the world until its time has passed `frame`. When it is more than `slack` frames behind, it skips the
  // difference instead of bunching strikes: the scene then runs slowly. Without a slack it never does. A paused scene
  // is not stepped, nor one in which nothing can sound and that nobody watches: it waits. [scene]
  void advance_to(synth::Frame frame, std::optional<synth::Frame> slack);

  // Goes on at another sample rate, and the rack with it: what is to come stays as many seconds ahead as it was.
  // [any thread, while nothing is rendered]
  void change_sample_rate(double sample_rate_hz);

  // Where the bodies are, and when that is.
  struct Poses {
    std::int32_t version = 0;
    double time_s = 0;  // the scene's, which runs a little ahead of the sound
    bool paused = false;
    std::vector<scene::BodyState> bodies;
  };
  [[nodiscard]] Poses poses() const;  // [any but audio]

  // What the scene looks like. The version grows whenever something of this changes, and never falls.
  struct Description {
    std::int32_t version = 0;
    double duration_s = 0;
    std::optional<scene::CameraDescription> camera;
    std::optional<std::filesystem::path> file;  // absent: there is no scene
    std::vector<scene::BodyOutline> bodies;
    std::vector<scene::StaticOutline> statics;
  };
  [[nodiscard]] Description describe() const;  // [any but audio]

  void set_watched(bool watched) { watched_ = watched; }  // whether somebody follows the bodies [any]

  // What is played: the file, and what was done to it. Nothing when there is no scene. [any but audio]
  struct Playing {
    std::filesystem::path file;
    bool paused = false, cleared = false;
  };
  [[nodiscard]] std::optional<Playing> playing() const;
  [[nodiscard]] std::size_t body_count() const { return body_count_; }
  [[nodiscard]] double duration_s() const {
    return duration_s_;
  }  // what the scene file is worth hearing; 0 without one
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  [[nodiscard]] double slowed_s() const { return slowed_s_; }  // lost because it could not keep up

 private:
  Result<scene::BodyId> spawn(const std::optional<protocol::ObjectRef>& object, scene::BodyDescription body);
  [[nodiscard]] synth::Frame position() const;
  [[nodiscard]] synth::Frame told_until() const;  // no event to come lies before it
  void move_start(synth::Frame later);
  void slow_down(synth::Frame by);
  void take(const scene::StepReport& report, std::vector<scene::RestDamping>& dampings);
  [[nodiscard]] bool matters() const;
  [[nodiscard]] std::vector<scene::RestDamping> end_contacts();
  void lean(const std::vector<scene::RestDamping>& dampings);

  Rack& rack_;
  BankReader& banks_;
  const FileRoots& roots_;
  Sink sink_;
  Post post_;
  mutable std::mutex mutex_;  // guards all that follows but the atomics
  std::optional<scene::World> world_;
  synth::Frame start_ = 0;  // where scene time 0 lies
  Playing playing_;
  std::optional<scene::CameraDescription> camera_;
  std::vector<scene::StaticOutline> statics_;
  std::int32_t version_ = 0;                 // of the description
  std::set<synth::ObjectNumber> leaned_on_;  // what the scene's bodies rest on or against
  std::atomic<bool> watched_ = false;
  std::atomic<std::size_t> body_count_ = 0;
  std::atomic<double> duration_s_ = 0;
  std::atomic<std::uint64_t> dropped_ = 0;
  std::atomic<double> slowed_s_ = 0;
  double complained_s_ = 0;
};

}  // namespace ringdown::session
