// All objects of the mixer: what happens to them, which of them are active, and which share their states. [audio,
// unless a function says otherwise]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/chunk.h"
#include "engine/synth/contact/exciters.h"
#include "engine/synth/touching/touches.h"
#include "engine/synth/listening/listening.h"
#include "engine/synth/listening/pickups.h"
#include "engine/synth/meters.h"
#include "engine/synth/modes/click.h"
#include "engine/synth/modes/fetch.h"
#include "engine/synth/objects/object.h"
#include "engine/synth/objects/shedding.h"
#include "engine/synth/events/timeline.h"
#include "engine/synth/voice_registry.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace ringdown::synth {

inline constexpr std::size_t kMaxEventsPerChunk = 1024;  // more in one chunk happen up to kChunkFrames later

// The objects by number, each made when the worker first speaks of its number.
class Objects {
 public:
  // [worker]
  void make(ObjectNumber number) {
    if (find(number)) return;
    owned_.push_back(std::make_unique<Object>(number));
    by_number_[number].store(owned_.back().get(), std::memory_order_release);
  }
  // Null: there has never been an object of this number. [audio, worker]
  [[nodiscard]] Object* find(std::size_t number) const REALTIME {
    return number < kMaxObjects ? by_number_[number].load(std::memory_order_acquire) : nullptr;
  }
  // [worker, while nothing is rendered]
  [[nodiscard]] std::span<const std::unique_ptr<Object>> all() const { return owned_; }

 private:
  std::array<std::atomic<Object*>, kMaxObjects> by_number_{};
  std::vector<std::unique_ptr<Object>> owned_;
};

class Stage {
 public:
  Stage(EventQueue& events, VoiceRegistry& voices, MixerCounters& counters);
  ~Stage();  // frees the voices [worker]
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  // Makes room for an object and for what may act on it. Comes before the first command about the object. [worker]
  void make_object(ObjectNumber number);

  // Carries out a command at frame `now`; `impulse` is that of Command::Kind::connect.
  void execute(const Command& command, const verb::Strike& impulse, Frame now) REALTIME;

  // Takes up where something is (is_placing()).
  void place(const Event& event, Frame now, double sample_rate_hz) REALTIME;
  void set_travel_time(bool on) { listening_.set_travel_time(on); }  // [worker, while nothing is rendered]
  // The listener for a chunk; null when there has never been one.
  [[nodiscard]] const Listening* begin_listening(const Chunk& chunk) REALTIME {
    if (!listening_.used()) return nullptr;
    listening_.begin_cell(chunk.cell_begin(), chunk.cell_end(), chunk.sample_rate_hz);
    return &listening_;
  }
  // Returns true if there has ever been a listener.
  [[nodiscard]] bool has_listened() const REALTIME { return listening_.used(); }

  // Finds which inputs are not silent in the chunk's first frames, and activates what they excite. Returns how many of
  // `rest` frames were looked at: kChunkFrames at most when an input is connected.
  [[nodiscard]] std::size_t listen_to_inputs(Chunk& chunk, std::size_t rest) REALTIME;

  // Returns true if nothing sounds or is about to.
  [[nodiscard]] bool idle() const REALTIME {
    return active_objects_.size() + active_groups_.size() + clicks_.size() == 0;
  }

  // Gives the events of the chunk to their objects and groups. With `exact_contacts` strikes play their contact sample
  // by sample where they can.
  void route_events(const Chunk& chunk, bool exact_contacts, Shedding& shedding, Workspace& workspace) REALTIME;
  // The sources to render in this chunk, after its events have been routed: groups, then objects.
  [[nodiscard]] std::span<Source* const> sources() REALTIME;
  void render_clicks(const Chunk& chunk, Workspace& workspace) REALTIME;
  // After the chunk: takes what has fallen silent off the lists, hands silent voices back, lets objects share states,
  // and returns events that had to wait to the queue.
  void finish_chunk(const Chunk& chunk, const Shedding& shedding, Workspace& workspace) REALTIME;
  // Returns true if events of the chunk were postponed because time was short.
  [[nodiscard]] bool events_waited() const REALTIME { return events_waited_; }

  // Parts all objects that share states, and ends clicks, before the sample rate changes. [worker, while nothing is
  // rendered]
  void part_all(Frame now);
  // Changes the length of a frame; `renew(voice)` frees a voice and returns the one in its place. [worker, while
  // nothing is rendered, after part_all()]
  template <class Renew>
  void rescale(Frame now, double ratio, const Renew& renew) {
    listening_.rescale(now);
    for (const std::unique_ptr<Object>& object : objects_.all()) {
      object->strip.rescale(now, ratio);
      object->placement.track.rescale(now);
      object->voices.renew(renew);
      for (Exciter* exciter : object->exciters.all()) exciter->rescale(now, ratio);
      forces_->exciters.refit(object->voices.current(), object->exciters);
      Pickups::refit(object->pickups, object->voices);
    }
  }

  // Null: there has never been an object of this number.
  [[nodiscard]] const Object* object(std::size_t number) const REALTIME { return objects_.find(number); }
  // One past the highest object number in use so far.
  [[nodiscard]] std::size_t object_limit() const REALTIME { return object_limit_; }

 private:
  // What acts on objects for some time, and what feels them.
  struct Forces {
    explicit Forces(MixerCounters& counters) : exciters(counters) {}
    Exciters exciters;
    Touches touches;
    Pickups pickups;
  };

  // Sources that are rendered, in the order in which they became active.
  template <class Kind>
  class ActiveList {
   public:
    explicit ActiveList(std::size_t capacity) : list_(capacity) {}
    [[nodiscard]] std::size_t size() const REALTIME { return count_; }
    [[nodiscard]] std::span<Kind* const> all() const REALTIME { return {list_.data(), count_}; }
    void add(Kind& source) REALTIME {
      if (source.active) return;
      source.active = true;
      list_[count_++] = &source;
    }
    template <class Stays>
    void keep_if(const Stays& stays) REALTIME {
      std::size_t kept = 0;
      for (std::size_t i = 0; i < count_; ++i) {
        fetch_ahead(all(), i, FetchStage::table);
        Kind& source = *list_[i];
        if (stays(source)) {
          list_[kept++] = &source;
        } else {
          source.active = false;
        }
      }
      count_ = kept;
    }

   private:
    std::vector<Kind*> list_;
    std::size_t count_ = 0;
  };

  [[nodiscard]] Frame travels(const QueuedEvent& event, const Object& object, const Chunk& chunk) const REALTIME;
  [[nodiscard]] bool accept(DueEvent& due, const Chunk& chunk, bool exact_contacts, const Shedding& shedding,
                            Workspace& workspace) REALTIME;
  template <class Lasting>
  [[nodiscard]] bool accept_lasting(const Lasting& force, const DueEvent& due, const Chunk& chunk) REALTIME;
  enum class Felt { taken, as_strike, one_way, not_at_all };
  [[nodiscard]] Felt accept_touch(const Touch& how, const DueEvent& due, const Chunk& chunk,
                                  const Shedding& shedding) REALTIME;
  template <class Strike>
  [[nodiscard]] bool starts_pulse(const Strike& strike, const DueEvent& due, const Chunk& chunk) REALTIME;
  void start_click(const verb::Click& click, const DueEvent& due, const Chunk& chunk,
                   const Shedding& shedding) REALTIME;
  void give_to_source(DueEvent& due, const Chunk& chunk, const Shedding& shedding, Workspace& workspace) REALTIME;
  void join(Object& object, Frame now, const Shedding& shedding, Workspace& workspace) REALTIME;
  void part(Object& object, Frame now) REALTIME;
  [[nodiscard]] bool settles(Object& object, const Chunk& chunk) REALTIME;
  void part_drifted(const Chunk& chunk) REALTIME;
  void put_back(DueList& due) REALTIME;
  [[nodiscard]] bool stays_active(Object& object, const Chunk& chunk) REALTIME;

  EventQueue& events_;
  VoiceRegistry& voices_;
  MixerCounters& counters_;
  Objects objects_;
  std::size_t object_limit_ = 0;
  std::size_t next_looked_at_ = 0;  // which part of the objects part_drifted() looked at last
  Listening listening_;
  Clicks clicks_;
  std::unique_ptr<Forces> forces_;  // made with the first object
  ActiveList<Object> active_objects_;
  ActiveList<InstanceGroup> active_groups_;
  std::vector<Source*> sources_;  // of the chunk
  std::vector<DueEvent> due_ = std::vector<DueEvent>(kMaxEventsPerChunk);
  std::size_t due_count_ = 0;
  bool events_waited_ = false;
};

}  // namespace ringdown::synth
