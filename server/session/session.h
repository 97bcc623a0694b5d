// Carries out requests: objects, their mixer and their scene, without sockets, threads or clocks. The daemon and
// `ringdown render` share it.
//
//   Session session(48000);
//   session.perform(protocol::LoadObject{"bell", "bell.glb"}, 0);                       // worker
//   session.play(protocol::Strike{{.name = "bell"}, point_m, impulse_ns, 0}, frame);    // control
//   session.rack().mixer().render(left, right);                                         // audio
//   session.rack().collect();                                                           // worker, now and then
//
// play() takes requests of the mixer's lane (protocol/lanes.h), perform() those of the worker's lanes. In the daemon
// the two run on different threads; offline, one thread calls both between blocks.
#pragma once

#include "engine/base/result.h"
#include "protocol/lanes.h"
#include "server/session/bank_reader.h"
#include "server/session/breakage.h"
#include "server/session/file_roots.h"
#include "server/session/rack.h"
#include "server/session/scene_player.h"
#include "server/session/strike_merger.h"

#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::session {

class Session {
 public:
  // Files are read below `roots` only. `vary` may change every event (Rack).
  explicit Session(double sample_rate_hz, FileRoots roots = {}, Rack::Vary vary = {})
      : roots_(std::move(roots)),
        banks_(roots_),
        rack_(sample_rate_hz, banks_, std::move(vary)),
        scene_(rack_, banks_, roots_) {}

  [[nodiscard]] const FileRoots& roots() const { return roots_; }
  [[nodiscard]] BankReader& banks() { return banks_; }
  [[nodiscard]] Rack& rack() { return rack_; }
  [[nodiscard]] const Rack& rack() const { return rack_; }
  [[nodiscard]] const Breakage& breakage() const { return breakage_; }
  [[nodiscard]] ScenePlayer& scene() { return scene_; }
  [[nodiscard]] const ScenePlayer& scene() const { return scene_; }
  [[nodiscard]] double sample_rate_hz() const { return rack_.mixer().sample_rate_hz(); }

  // Sends a request to the mixer as events that happen at `frame`. An error says what is wrong, or that events
  // were dropped. [control]
  Result<void> play(const protocol::MixerRequest& request, synth::Frame frame);

  // Succeeds if play() or perform() would accept the request now, provided that no queue is full. [control]
  [[nodiscard]] Result<void> check(const protocol::MixerRequest& request, synth::Frame frame);
  [[nodiscard]] Result<void> check(const protocol::TimedWorkerRequest& request, synth::Frame frame);

  // Counts `events` as dropped and returns the error "dropped, because ...". [any]
  [[nodiscard]] tl::unexpected<Error> drop(std::size_t events, const std::string& because);

  // Carries out a request that changes objects or the scene. A scene that is loaded starts at `frame`, and a request
  // with a time of its own happens at `frame`. Returns the number for the answer, if the request has one. [worker]
  Result<std::optional<std::int32_t>> perform(const protocol::WorkerRequest& request, synth::Frame frame);
  Result<std::optional<std::int32_t>> perform(const protocol::TimedWorkerRequest& request, synth::Frame frame);

  // In a flood, strikes within `seconds` of each other on the same point of an object become one (strike_merger.h). The
  // default, 0, merges none. [before anything is played]
  void merge_within(double seconds) { merger_ = StrikeMerger(std::llround(seconds * sample_rate_hz())); }

  // Returns true if the merger holds strikes back. flush() hands them to the mixer; call flush() soon after the last
  // play(). [control]
  [[nodiscard]] bool holds_strikes() const { return !merger_.held().empty(); }
  void flush();

  // Changes the sample rate of the mixer and of the scene. [any thread, while nothing is rendered]
  void change_sample_rate(double sample_rate_hz) { scene_.change_sample_rate(sample_rate_hz); }

  // Events that were refused because a queue was full. [any]
  [[nodiscard]] std::uint64_t dropped() const { return dropped_ + scene_.lost().dropped; }

  // Strikes that were added to another strike. [any]
  [[nodiscard]] std::uint64_t merged() const { return merged_; }

 private:
  [[nodiscard]] Result<void> check_frame(synth::Frame frame) const;
  [[nodiscard]] std::size_t push(const synth::Event& event);
  Result<synth::ObjectNumber> load_object(const protocol::LoadObject& load);

  FileRoots roots_;
  BankReader banks_;
  Rack rack_;
  Breakage breakage_{rack_};
  ScenePlayer scene_;
  StrikeMerger merger_{0};
  std::vector<synth::Event> events_;  // control: events of the request that was last checked
  std::atomic<std::uint64_t> dropped_ = 0, merged_ = 0;
};

}  // namespace ringdown::session
