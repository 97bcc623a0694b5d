// Holds the worker's commands and all producers' events until their frames, and cuts blocks into chunks at commands.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/spsc_ring.h"
#include "engine/synth/events/event_queue.h"
#include "engine/synth/kernels/mode_kernel.h"

#include <algorithm>
#include <cstddef>

namespace ringdown::synth {

class InstanceGroup;
class Voice;

// A change that the worker has made to an object. A command waits for its frame, and so does every command behind it.
struct Command {
  enum class Kind {
    replace,      // `voice` becomes the object's voice; the old one rings out
    retune,       // `voice`, of the same bank, takes over what rings
    remove,       // the object has no voice any more; what rings fades out
    assign,       // the object is heard at the bus `channel` too
    silence,      // the object is silent at all outputs, reached over `ramp` frames
    unsilence,    // the object is heard again
    found_group,  // voices of the group's table may share their states from now on
    connect,      // `input` excites the object, by an impulse of its own (Timeline::connect())
    disconnect,   // `input` excites nothing
  } kind;
  ObjectNumber object = 0;
  Frame at = 0;
  Voice* voice = nullptr;
  InstanceGroup* group = nullptr;
  std::uint32_t channel = 0, input = 0;
  Frame ramp = 0;
};

class Timeline {
 public:
  explicit Timeline(std::size_t command_capacity) : commands_(command_capacity) {}

  // False when the ring is full: nothing was taken. [the producer's thread; the worker]
  [[nodiscard]] bool push(Producer producer, const Event& event) REALTIME { return events_.push(producer, event); }
  [[nodiscard]] bool push(const Command& command) { return commands_.push(command); }
  [[nodiscard]] bool connect(const Command& command, const verb::Strike& impulse) {
    if (commands_.size() == commands_.capacity() || !impulses_.push(impulse)) return false;
    return commands_.push(command);
  }

  [[nodiscard]] EventQueue& events() REALTIME { return events_; }  // [audio]

  // The next command, if its frame is not after `now`, until pop_command(). [audio]
  [[nodiscard]] const Command* due_command(Frame now) const REALTIME {
    const Command* const next = commands_.front();
    return next && next->at <= now ? next : nullptr;
  }
  void pop_command() REALTIME { commands_.pop(); }  // [audio]
  // The impulse of the due command, which is Command::Kind::connect. [audio]
  [[nodiscard]] verb::Strike take_impulse() REALTIME {
    const verb::Strike impulse = *impulses_.front();
    impulses_.pop();
    return impulse;
  }

  // Returns how many of the next `rest` frames can be rendered at once, after all due commands have been applied: up to
  // the next command, and to kChunkFrames unless nothing sounds (`idle`) and nothing happens; with `in_cells` up to the
  // next multiple of kChunkFrames. [audio]
  [[nodiscard]] std::size_t chunk_frames(Frame now, std::size_t rest, bool idle, bool in_cells) const REALTIME {
    if (const Command* const next = commands_.front()) rest = std::min(rest, static_cast<std::size_t>(next->at - now));
    if (idle && !events_.next_before(now + static_cast<Frame>(rest))) return rest;
    return std::min(rest, in_cells ? kChunkFrames - static_cast<std::size_t>(now) % kChunkFrames : kChunkFrames);
  }

 private:
  EventQueue events_;
  SpscRing<Command> commands_;
  SpscRing<verb::Strike> impulses_{64};  // of the commands that connect
};

}  // namespace ringdown::synth
