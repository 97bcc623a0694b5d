// Leaves out the quietest modes when time is short, of all objects taken together.
//
// One threshold holds for all modes. A survey counts, some sources in each chunk, how many modes ring at which level;
// from that and from what the time budget can afford follows the level below which modes are muted. It rises at once
// and falls slowly, so nothing pumps. When a chunk turns out to be more expensive than the last ones, the threshold of
// what is still to be rendered in it is raised, by the pace so far. Strikes for which there is no time wait for the
// next chunk, and when time is over, what is left is muted for a chunk. Nothing is lost: states move on, and whatever
// was muted comes back when there is time.
//
// The mixer asks "may I?" before it does something that costs time. Without a limit everything may, and nothing here
// costs anything. One audio thread; const functions are called by its helpers too.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/chunk.h"
#include "engine/synth/modes/coupled_modes.h"
#include "engine/synth/modes/level_histogram.h"
#include "engine/synth/source.h"
#include "engine/synth/time_budget.h"

#include <cstddef>
#include <limits>
#include <span>

namespace ringdown::synth {

class Shedding {
 public:
  // The share of a block's time that may be used, 0: no limit; and the threads that render. [worker, while nothing is
  // rendered]
  void configure(double share, WorkClock clock, std::size_t threads);

  // The rest: [audio]
  void begin_block(std::size_t frames, double sample_rate_hz, bool deadline) RINGDOWN_REALTIME {
    budget_.begin_block(frames, sample_rate_hz, deadline);
  }
  void begin_chunk(std::size_t frames) RINGDOWN_REALTIME;
  // After events have found their sources: surveys some sources, sets the threshold, and opens the workspaces.
  void plan(std::span<Source* const> sources, const Chunk& chunk, std::span<Workspace> workspaces) RINGDOWN_REALTIME;
  void end_chunk(const ChunkCounts& counts, const Chunk& chunk, bool events_waited) RINGDOWN_REALTIME;

  // Whether modes may have to be muted, or brought back, in this chunk.
  [[nodiscard]] bool active() const RINGDOWN_REALTIME { return active_; }
  // Whether time is short: what is only an embellishment should be left out.
  [[nodiscard]] bool tight() const RINGDOWN_REALTIME { return tight_; }
  // Whether something was shed in the last chunk.
  [[nodiscard]] bool shed() const RINGDOWN_REALTIME { return shed_; }

  // May an event that costs `units` happen in this chunk? The first one of a chunk always may, whatever it costs.
  [[nodiscard]] bool may_accept(double units) RINGDOWN_REALTIME;
  // May an object begin to share its states?
  [[nodiscard]] bool may_join(double units) const RINGDOWN_REALTIME;
  // May an event happen, now that its turn has come? One that costs more than a chunk happens late rather than never.
  [[nodiscard]] bool may_play(double units, Workspace& workspace) const RINGDOWN_REALTIME;
  // May a source be rendered? Sets the threshold for it.
  [[nodiscard]] bool may_render(const Source& source, const Chunk& chunk, Workspace& workspace) const RINGDOWN_REALTIME;
  // May modes that exchange energy do so, or go on to? Once they have been stopped they begin again when there is
  // plenty of time.
  [[nodiscard]] bool may_couple(const Coupling& coupling, const Chunk& chunk,
                                Workspace& workspace) const RINGDOWN_REALTIME;
  // Mutes modes of a source and brings others back; their sound is `gain` above their states.
  void apply(ModeStates& states, Level gain, bool look_again, Workspace& workspace) const RINGDOWN_REALTIME;
  void worked(double units, Workspace& workspace) const RINGDOWN_REALTIME {
    workspace.counts.units += units;
    budget_.worked(units);
  }

 private:
  void survey(std::span<Source* const> sources, const Chunk& chunk, Workspace& workspace) RINGDOWN_REALTIME;
  void set_threshold(const Chunk& chunk) RINGDOWN_REALTIME;
  [[nodiscard]] std::size_t modes_that_may_enter(double units, const Chunk& chunk) const RINGDOWN_REALTIME;

  TimeBudget budget_;
  std::size_t threads_ = 1;
  LevelHistogram counting_, counted_;  // the survey that goes on, and the last one that is complete
  std::size_t next_surveyed_ = 0;      // in the list of sources
  Level threshold_ = ModeStates::kNoThreshold;
  std::size_t since_lowered_ = 0;  // frames
  bool active_ = false, tight_ = false, shed_ = false;
  bool little_ = true;    // in the last chunk there was little to do
  bool at_once_ = false;  // there is no time for ramps
  ChunkCounts last_;      // of the last chunk
  // The affordable work when modes last exchanged energy [units/frame].
  double coupled_affordable_ = std::numeric_limits<double>::max();
  double event_units_ = 0;      // accepted in this chunk
  double event_average_ = 0;    // the same, on average
  double overhead_ = 0;         // units that were neither events nor rendering, on average
  double planned_units_ = 0;    // of this chunk
  double rendering_share_ = 1;  // of these, rendering
};

}  // namespace ringdown::synth
