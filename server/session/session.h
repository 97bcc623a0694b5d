// What requests do, without sockets, threads or clocks: the part that the daemon and `ringdown render` share.
//
// play() takes the mixer's lane (protocol/lanes.h), perform() the worker's lanes. In the daemon the two run on
// different threads; offline, one thread calls both between blocks.
#pragma once

#include "engine/base/result.h"
#include "protocol/lanes.h"
#include "server/session/bank_reader.h"
#include "server/session/file_roots.h"
#include "server/session/rack.h"
#include "server/session/scene_player.h"
#include "server/session/strike_merger.h"

#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::session {

// Events may lie at most this far ahead.
inline constexpr double kMaxAhead_s = 3600;

class Session {
 public:
  // Files are read below `roots` only.
  explicit Session(double sample_rate_hz, FileRoots roots = {})
      : roots_(std::move(roots)), banks_(roots_), rack_(sample_rate_hz, banks_), scene_(rack_, banks_, roots_) {}

  [[nodiscard]] const FileRoots& roots() const { return roots_; }
  [[nodiscard]] BankReader& banks() { return banks_; }
  [[nodiscard]] Rack& rack() { return rack_; }
  [[nodiscard]] const Rack& rack() const { return rack_; }
  [[nodiscard]] ScenePlayer& scene() { return scene_; }
  [[nodiscard]] const ScenePlayer& scene() const { return scene_; }
  [[nodiscard]] double sample_rate_hz() const { return rack_.mixer().sample_rate_hz(); }

  // Sends a request to the mixer as events, to happen at `frame`. An error names the argument. [control]
  Result<void> play(const protocol::MixerRequest& request, synth::Frame frame);

  // Whether play() or perform() would take it now, queues aside. [control]
  [[nodiscard]] Result<void> check(const protocol::MixerRequest& request, synth::Frame frame);
  [[nodiscard]] Result<void> check(const protocol::TimedWorkerRequest& request, synth::Frame frame);

  // Counts `events` that could not be taken, and says so: "dropped, because ...". [any]
  [[nodiscard]] tl::unexpected<Error> drop(std::size_t events, const std::string& because);

  // Carries out what changes objects or the scene. A scene loaded now starts at `frame`, and what happens at a time of
  // its own happens then. Returns the number for the answer, if there is one. [worker]
  Result<std::optional<std::int32_t>> perform(const protocol::WorkerRequest& request, synth::Frame frame);
  Result<std::optional<std::int32_t>> perform(const protocol::TimedWorkerRequest& request, synth::Frame frame);

  // In a flood, strikes within `seconds` of each other on the same point of an object become one (strike_merger.h).
  // 0, as in the beginning, merges none. [before anything is played]
  void merge_within(double seconds) { merger_ = StrikeMerger(std::llround(seconds * sample_rate_hz())); }

  // Whether the merger holds strikes back, and handing those to the mixer, soon after the last play(). [control]
  [[nodiscard]] bool holds_strikes() const { return !merger_.held().empty(); }
  void flush();

  // Retunes what rings and what is to come. [any thread, while nothing is rendered]
  void change_sample_rate(double sample_rate_hz) { scene_.change_sample_rate(sample_rate_hz); }

  // Events that were refused because a queue was full. [any]
  [[nodiscard]] std::uint64_t dropped() const { return dropped_ + scene_.dropped(); }

  // Strikes that were added to another. [any]
  [[nodiscard]] std::uint64_t merged() const { return merged_; }

 private:
  [[nodiscard]] Result<void> check_frame(synth::Frame frame) const;
  [[nodiscard]] std::size_t push(const synth::Event& event);
  Result<synth::ObjectNumber> load_object(const protocol::LoadObject& load);
  Result<void> free_object(const protocol::FreeObject& request);

  FileRoots roots_;
  BankReader banks_;
  Rack rack_;
  ScenePlayer scene_;
  StrikeMerger merger_{0};
  std::vector<synth::Event> events_;  // control: of the request at hand
  std::atomic<std::uint64_t> dropped_ = 0, merged_ = 0;
};

}  // namespace ringdown::session
