// Records a performance as an OSC score (protocol/wire/score.h), which `ringdown render --events` plays again.
//
// The score's first messages load the objects present at the start, with their materials, ranges of modes, gains and
// pans. Then follow every event that the mixer has taken, from OSC, from the scene and from notes, at the event's own
// frame, and every change of an object, at the block after which it happened. So the replay of strikes, gains, pans and
// clears is bit-identical, from silence on, if sample rate and block size are equal. Sound that rang before the start
// is not recorded, and an event that came late is replayed at its intended time.
#pragma once

#include "engine/base/one_of.h"
#include "engine/base/result.h"
#include "protocol/wire/message.h"
#include "server/session/observers.h"
#include "server/session/rack.h"

#include <atomic>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ringdown::session {

inline constexpr std::size_t kMaxRecorded = std::size_t{1} << 20;  // events; later ones are not in the score

class Recorder final : public Observer {
 public:
  // Writes the messages of a score, in order of time, to a file.
  using Write = std::function<Result<void>(std::span<const wire::ScoreEvent>, const std::filesystem::path&)>;

  // Observes `rack`, which must be empty and outlive it.
  Recorder(Rack& rack, Write write);

  // Starts a recording into `path`, which stop() writes. Refused while a recording runs. [worker]
  Result<void> start(const std::filesystem::path& path, synth::Frame frame);

  // Writes the score, to `path` if given, and returns the number of its messages. The score has every event that the
  // mixer has taken; it ends at `frame`, or just after an event that comes later. Refused if no recording runs. If the
  // file cannot be written, the recording goes on. [worker]
  Result<std::size_t> stop(synth::Frame frame, std::optional<std::filesystem::path> path = std::nullopt);

  [[nodiscard]] bool records() const { return records_; }

  // Events beyond kMaxRecorded since the recording started. [any but audio]
  [[nodiscard]] std::size_t left_out() const;

  void played(const synth::Event& event) override;
  void changed(const ObjectState* before, const ObjectState* after, synth::Frame at) override;

 private:
  struct Played {
    synth::Event event;
    std::string name;  // the name of the event's object
  };
  using What = OneOf<Types<Played, wire::Message>>;
  struct Entry {
    synth::Frame frame;
    What what;
  };
  void add(synth::Frame frame, What what);
  [[nodiscard]] std::vector<wire::ScoreEvent> score_until(synth::Frame frame);
  [[nodiscard]] wire::Message message_of(const Entry& entry) const;

  Rack& rack_;
  Write write_;
  std::atomic<bool> records_ = false;
  mutable std::mutex mutex_;  // guards all members below
  std::filesystem::path path_;
  synth::Frame first_ = 0;
  std::size_t left_out_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace ringdown::session
