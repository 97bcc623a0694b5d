// Records what is played as an OSC score (protocol/wire/score.h), which `ringdown render --events` plays again.
//
// Objects, their materials, choices of modes, gains and pans as they are at the start become the score's first
// messages; then every event that was taken, from OSC, from the scene and from notes, at its own frame, and every
// change of objects at the block after which it happened. So the replay of strikes, gains, pans and clears is
// bit-identical at the same sample rate and block size, from silence on; what rang before the start is not in it, and
// an event that came late is replayed at the time it was meant for.
#pragma once

#include "engine/base/result.h"
#include "protocol/wire/message.h"
#include "server/session/observer.h"
#include "server/session/rack.h"

#include <array>
#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace ringdown::session {

inline constexpr std::size_t kMaxRecorded = std::size_t{1} << 20;  // events; what comes after is not in the score

class Recorder final : public Observer {
 public:
  // Writes the messages of a score, which stand by time, to a file.
  using Write = std::function<Result<void>(std::span<const wire::ScoreEvent>, const std::filesystem::path&)>;

  // Observes `rack`, which must be empty and outlive it.
  Recorder(Rack& rack, Write write);

  // Refused when it records already. [worker]
  Result<void> start(const std::filesystem::path& path, synth::Frame frame);

  // Writes the score, which ends at `frame`; returns the number of its messages. Refused when nothing is recorded.
  // [worker]
  Result<std::size_t> stop(synth::Frame frame);

  [[nodiscard]] bool records() const { return records_; }

  // Events beyond kMaxRecorded since it started. [any but audio]
  [[nodiscard]] std::size_t left_out() const;

  // The last gain and pan that an object was given. [any but audio]
  struct GainAndPan {
    double gain = 1, pan = 0;
  };
  [[nodiscard]] GainAndPan level(synth::ObjectNumber object) const;

  void played(const synth::Event& event) override;
  void loaded(const RackObject& object) override;
  void retuned(const RackObject& object) override;
  void selected(const RackObject& object) override;
  void held(const RackObject& object, const modal::Dampers& changed, synth::Frame at) override;
  void regrouped(const RackObject& object) override;
  void freed(const RackObject& object) override;

 private:
  struct Played {
    synth::Event event;
    std::shared_ptr<const std::string> name;
  };
  struct Entry {
    synth::Frame frame;
    std::variant<Played, wire::Message> what;
  };
  // What is not in the rack: the last gain and pan of an object.
  struct Level {
    std::shared_ptr<const std::string> name;
    GainAndPan now;
  };
  void add(synth::Frame frame, std::variant<Played, wire::Message> what);
  void add_change(const protocol::Request& request, synth::Frame at = 0);
  void add_present_state();
  [[nodiscard]] wire::Message message_of(const Entry& entry) const;

  Rack& rack_;
  Write write_;
  std::atomic<bool> records_ = false;
  mutable std::mutex mutex_;  // guards all that follows
  std::filesystem::path path_;
  synth::Frame first_ = 0;
  std::size_t left_out_ = 0;
  std::vector<Entry> entries_;
  std::array<Level, synth::kMaxObjects> levels_{};
};

}  // namespace ringdown::session
