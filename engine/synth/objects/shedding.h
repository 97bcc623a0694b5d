// Leaves out the quietest modes of all objects when time is short.
//
// One threshold applies to all modes. A survey, which visits some sources in each chunk, counts how many modes ring at
// which level. From this count and from the work that the time budget can afford follows the level below which modes
// are muted. The threshold rises at once and falls slowly, so nothing pumps. If a chunk turns out to be more expensive
// than the last ones, the threshold for its remaining sources is raised according to the pace so far. Strikes for which
// there is no time wait for the next chunk, and when time is over, the remaining sources are muted for a chunk. Nothing
// is lost: states move on, and muted modes come back when there is time.
//
// The mixer asks for permission before it does something that costs time. Without a limit everything is permitted, and
// asking costs nothing. One audio thread; const functions are called by its helpers too.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/chunk.h"
#include "engine/synth/modes/coupled_modes.h"
#include "engine/synth/modes/level_histogram.h"
#include "engine/synth/objects/source.h"
#include "engine/synth/objects/time_budget.h"

#include <cstddef>
#include <limits>
#include <span>

namespace ringdown::synth {

class Shedding {
 public:
  // Sets the share of a block's time that may be used (0: no limit), the clock, and the number of threads that render.
  // [worker, while nothing is rendered]
  void configure(double share, WorkClock clock, std::size_t threads);

  // All functions below: [audio]
  void begin_block(std::size_t frames, double sample_rate_hz, bool deadline) REALTIME {
    budget_.begin_block(frames, sample_rate_hz, deadline);
  }
  void begin_chunk(std::size_t frames) REALTIME;
  // Call after events have been assigned to their sources: surveys some sources, sets the threshold, and opens the
  // workspaces.
  void plan(std::span<Source* const> sources, const Chunk& chunk, std::span<Workspace> workspaces) REALTIME;
  void end_chunk(const ChunkCounts& counts, const Chunk& chunk, bool events_waited) REALTIME;

  // Returns whether modes may have to be muted, or brought back, in this chunk.
  [[nodiscard]] bool active() const REALTIME { return active_; }
  // Returns whether time is short, so that embellishments should be left out.
  [[nodiscard]] bool tight() const REALTIME { return tight_; }
  // Returns whether something was shed in the last chunk.
  [[nodiscard]] bool shed() const REALTIME { return shed_; }

  // Returns whether an event that costs `units` may happen in this chunk. The first event of a chunk always may,
  // whatever it costs.
  [[nodiscard]] bool may_accept(double units) REALTIME;
  // Returns whether an object may begin to share its states.
  [[nodiscard]] bool may_join(double units) const REALTIME;
  // Returns whether an event may happen, now that its turn has come. One that costs more than a chunk happens late
  // rather than never.
  [[nodiscard]] bool may_play(double units, Workspace& workspace) const REALTIME;
  // Returns whether a source may be rendered, and sets the threshold for it.
  [[nodiscard]] bool may_render(const Source& source, const Chunk& chunk, Workspace& workspace) const REALTIME;
  // Returns whether modes that exchange energy may do so, or continue. Once they have been stopped they begin again
  // only when there is plenty of time.
  [[nodiscard]] bool may_couple(const Coupling& coupling, const Chunk& chunk, Workspace& workspace) const REALTIME;
  // Mutes modes of a source and brings others back; the source's sound is `gain` above its states.
  void apply(ModeStates& states, Level gain, bool look_again, Workspace& workspace) const REALTIME;
  void worked(double units, Workspace& workspace) const REALTIME {
    workspace.counts.units += units;
    budget_.worked(units);
  }

 private:
  void survey(std::span<Source* const> sources, const Chunk& chunk, Workspace& workspace) REALTIME;
  void set_threshold(const Chunk& chunk) REALTIME;
  [[nodiscard]] std::size_t modes_that_may_enter(double units, const Chunk& chunk) const REALTIME;

  TimeBudget budget_;
  std::size_t threads_ = 1;
  LevelHistogram counting_, counted_;  // the running survey, and the last complete one
  std::size_t next_surveyed_ = 0;      // index in the list of sources
  Level threshold_ = kNoThreshold;
  std::size_t since_lowered_ = 0;  // frames since the threshold was last lowered
  bool active_ = false, tight_ = false, shed_ = false;
  bool little_ = true;    // whether there was little to do in the last chunk
  bool at_once_ = false;  // whether there is no time for ramps
  ChunkCounts last_;      // counts of the last chunk
  // The affordable work when modes last exchanged energy [units/frame].
  double coupled_affordable_ = std::numeric_limits<double>::max();
  double event_units_ = 0;      // units of events accepted in this chunk
  double event_average_ = 0;    // mean of event_units_
  double overhead_ = 0;         // mean number of units that were neither events nor rendering
  double planned_units_ = 0;    // units planned for this chunk
  double rendering_share_ = 1;  // share of rendering in planned_units_
};

}  // namespace ringdown::synth
