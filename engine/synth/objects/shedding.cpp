#include "engine/synth/objects/shedding.h"

#include "engine/synth/modes/work_cost.h"

#include <algorithm>
#include <limits>

// One chunk under a budget. All work is counted in units (work_cost.h); `affordable` is the number of units that fit.
//
// 1. Events are taken off the queue until they would cost kEventsShare of what is affordable (may_accept()); the others
//    wait for the next chunk.
// 2. If the last chunk was tight, or modes are still muted, plan() surveys levels: survey() adds some sources to a
//    histogram, for at most kSurveyShare of what is affordable, and a histogram that has seen all sources replaces the
//    one in use. set_threshold() reads from it the level above which lie as many modes as can be rendered beside events
//    and overhead. The threshold rises to that level at once, and falls towards it by 3 dB, or half of the way if that
//    is more, in every kLowerFrames frames: a threshold that fell at once would let modes in that must leave again.
// 3. Before each source, may_render() compares the time left, at the pace of this chunk so far, with the work planned.
//    Missing time is taken from the quietest modes of the remaining sources, by a higher threshold without a ramp;
//    spare time lets muted modes enter. A source for which there is not even time for this is skipped.
// 4. apply() mutes modes of one source, or brings them back, and charges for that.
// 5. end_chunk() updates the mean costs of events and overhead, and the budget's cost of a unit.
//
// Helpers run steps 3 and 4 for their own sources at the same time. They share what plan() has set and change only the
// source and their own workspaces.

namespace ringdown::synth {
namespace {

// Shares of what the budget can afford in a chunk:
constexpr double kTight = 0.75;             // above this load levels are surveyed
constexpr double kEventsShare = 0.3;        // share for events; further ones wait
constexpr double kForget = 1.001;           // growth per chunk of coupled_affordable_ while no modes exchange energy
constexpr double kCoupledShare = 0.7;       // maximum total work at which modes begin to exchange energy
constexpr double kSurveyShare = 0.06;       // share for the survey in a chunk
constexpr double kRecoverShare = 0.05;      // share that must be left before modes cut short come back early
constexpr double kUnprovenShare = 0.05;     // share that may enter before anything was rendered
constexpr double kMaxEvent = 0.7;           // a costlier event only waits for this share of the time
constexpr double kLittle = 0.25;            // with less work than this, another program took the time
constexpr double kAverage = 0.05;           // weight of a chunk in running means
constexpr std::size_t kLowerFrames = 1024;  // frames per fall of the threshold
constexpr Level kLowerPart = 2;             // the threshold falls by the distance over kLowerPart
constexpr Level kLowerBy = 8;               // but at least by 3 dB; 140 dB in a second
constexpr double kMinShare = 0.02;          // minimum share of a source's modes, however little time is left

}  // namespace

void Shedding::configure(double share, WorkClock clock, std::size_t threads) {
  budget_.configure(share, clock);
  threads_ = threads;
}

void Shedding::begin_chunk(std::size_t frames) REALTIME {
  budget_.begin_chunk(frames);
  event_units_ = 0;
}

bool Shedding::may_accept(double units) REALTIME {
  if (!budget_.limited()) return true;
  if (event_units_ > 0 && units > 0 && event_units_ + units > kEventsShare * budget_.affordable()) return false;
  event_units_ += units;
  return true;
}

bool Shedding::may_join(double units) const REALTIME { return !budget_.limited() || units <= budget_.units_left(0, 1); }

bool Shedding::may_play(double units, Workspace& workspace) const REALTIME {
  if (!budget_.limited()) return true;
  const double needed = std::min(units, kMaxEvent * budget_.affordable());
  if (units > 0 && needed > budget_.units_left(workspace.counts.units - workspace.units_before, threads_)) return false;
  worked(units, workspace);
  return true;
}

void Shedding::plan(std::span<Source* const> sources, const Chunk& chunk, std::span<Workspace> workspaces) REALTIME {
  const bool limited = budget_.limited();
  if (chunk.moments) worked(static_cast<double>(kMomentsFixed), workspaces[0]);
  active_ = limited ? tight_ || threshold_ != kNoThreshold || last_.muted_modes > 0 : last_.muted_modes > 0;
  if (limited && active_) {
    survey(sources, chunk, workspaces[0]);
    set_threshold(chunk);
  } else {
    threshold_ = kNoThreshold;
    at_once_ = false;
    next_surveyed_ = 0;
    if (counted_.modes() > 0) counted_.clear();
    if (!limited && !active_) return;
    for (Source* source : sources) source->look_again = active_;  // without a limit everything comes back
  }
  const double rendering = render_units(last_.modes, chunk.frames, chunk.moments);
  const double overhead = std::max(overhead_ - workspaces[0].counts.units, 0.0);  // of which some is done
  planned_units_ = rendering + event_units_ + overhead;
  rendering_share_ = rendering / std::max(planned_units_, 1.0);
  for (Workspace& workspace : workspaces) {  // may_render() sets them anew where there is a limit
    workspace.threshold = threshold_;
    workspace.at_once = at_once_;
    workspace.units_before = workspace.counts.units;
    workspace.enter_units = std::max(budget_.affordable() - planned_units_, 0.0) / static_cast<double>(threads_);
    workspace.allowance = std::numeric_limits<std::size_t>::max();
    workspace.recovers = true;
    workspace.coupled_units = 0;
  }
  budget_.begin_rendering();
}

// Counts the levels of some sources after those of the last chunk; what has been counted decides once all have been.
void Shedding::survey(std::span<Source* const> sources, const Chunk& chunk, Workspace& workspace) REALTIME {
  if (next_surveyed_ == 0) counting_.clear();
  const double max = kSurveyShare * budget_.affordable();
  double units = 0;
  std::size_t at = std::min(next_surveyed_, sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    Source& source = *sources[i];
    source.look_again = i >= at && (units < max || i == at);
    if (!source.look_again) continue;
    const ModeStates::Counts counts = source.counts();
    source.count_levels(chunk, counting_);
    const double looked =
        kLookPerMode * static_cast<double>(counts.sounding) + kLookPerMuted * static_cast<double>(counts.muted);
    worked(looked, workspace);
    units += looked;
    next_surveyed_ = i + 1;
  }
  if (next_surveyed_ < sources.size()) return;
  next_surveyed_ = 0;
  counted_ = counting_;
}

// The threshold that leaves as many modes as can be afforded: it rises at once and falls slowly.
void Shedding::set_threshold(const Chunk& chunk) REALTIME {
  const double units = std::max(budget_.affordable() - overhead_ - event_average_, 0.0);
  const double modes = units / render_units(1, chunk.frames, chunk.moments);
  Level needed = counted_.threshold_for(modes, kNoThreshold);
  const auto sounding = static_cast<double>(last_.modes);
  if (sounding > 1.1 * modes && counted_.modes() > 0) {  // struck since the survey
    const double above = static_cast<double>(counted_.modes_from(threshold_));
    needed = std::max(needed, counted_.threshold_for(above * modes / sounding, kNoThreshold));
  }
  since_lowered_ += chunk.frames;
  at_once_ = false;
  if (needed > threshold_) {
    threshold_ = needed;
    at_once_ = sounding > modes * (1 + kTight) / 2;
  } else if (needed < threshold_ && since_lowered_ >= kLowerFrames) {
    since_lowered_ = 0;
    const Level way = needed == kNoThreshold ? 0 : (threshold_ - needed) / kLowerPart;
    threshold_ = std::max(threshold_ - std::max(kLowerBy, way), needed);
    if (needed == kNoThreshold && threshold_ < LevelHistogram::kMinLevel) threshold_ = kNoThreshold;
    if (needed == kNoThreshold && counted_.modes_from(threshold_) == counted_.modes()) threshold_ = kNoThreshold;
  }
}

// Compares the chunk's work at the pace so far with the time left. Work that does not fit is taken from the quietest
// modes of the remaining sources; spare time lets muted modes enter.
bool Shedding::may_render(const Source& source, const Chunk& chunk, Workspace& workspace) const REALTIME {
  if (!budget_.limited() || little_) return true;
  const double done = workspace.counts.units - workspace.units_before;
  const double left = budget_.units_left(done, threads_);
  const double to_do = std::max(planned_units_ / static_cast<double>(threads_) - done, 0.0);
  workspace.threshold = threshold_;
  workspace.at_once = at_once_;
  const double unproven = kUnprovenShare * budget_.affordable();  // until the chunk's price is known
  workspace.allowance = modes_that_may_enter(std::min({left - to_do, done + unproven, workspace.enter_units}), chunk);
  workspace.recovers = left - to_do > kRecoverShare * budget_.affordable();
  double share = 1;
  if (left < to_do && active_ && counted_.modes() > 0) {
    const double rendering = to_do * rendering_share_;
    share =
        std::clamp((left - (to_do - rendering) - kLookPerMode * rendering) / std::max(rendering, 1.0), kMinShare, 1.0);
    const double above = static_cast<double>(counted_.modes_from(threshold_));
    workspace.threshold = std::max(threshold_, counted_.threshold_for(share * above, kNoThreshold));
    workspace.at_once = true;
  }
  if (!source.can_skip(chunk)) return true;
  const ModeStates::Counts counts = source.counts();
  const double looking =
      (workspace.at_once || source.look_again ? kLookPerMode * static_cast<double>(counts.slow) : 0.0) +
      (source.look_again ? kLookPerMuted * static_cast<double>(counts.muted) : 0.0);
  return looking + share * render_units(counts.sounding, chunk.frames, chunk.moments) <= left;
}

bool Shedding::may_couple(const Coupling& coupling, const Chunk& chunk, Workspace& workspace) const REALTIME {
  if (!budget_.limited()) return true;
  if (threshold_ != kNoThreshold) return false;
  if (coupling.running()) return last_.units <= budget_.affordable();
  const double units = coupling.units(chunk.frames);
  const double affordable = std::min(budget_.affordable(), coupled_affordable_ * static_cast<double>(chunk.frames));
  if (last_.units + workspace.coupled_units + units > kCoupledShare * affordable) return false;
  workspace.coupled_units += units;
  return true;
}

std::size_t Shedding::modes_that_may_enter(double units, const Chunk& chunk) const REALTIME {
  return static_cast<std::size_t>(std::max(units, 0.0) /
                                  (kEnterPerMode + render_units(1, chunk.frames, chunk.moments)));
}

void Shedding::apply(ModeStates& states, Level gain, bool look_again, Workspace& workspace) const REALTIME {
  const bool rose =
      states.set_threshold(workspace.threshold == kNoThreshold ? kNoThreshold : workspace.threshold - gain);
  const ModeStates::Counts before = states.counts();
  const bool brings_back = look_again || (workspace.recovers && before.cut_short);
  if (!brings_back && !rose) return;
  std::size_t allowance = brings_back ? workspace.allowance : 0;
  const std::size_t allowed = allowance;
  states.apply_threshold(allowance, workspace.at_once);
  const std::size_t entered = allowed - allowance;
  const double cost = (kEnterPerMode + 1) * static_cast<double>(entered);
  workspace.allowance -= entered;
  workspace.enter_units -= cost;
  workspace.counts.enter_units += cost;
  const double muted = allowed >= kModePadding ? static_cast<double>(before.muted) : 0.0;
  worked(kLookPerMode * static_cast<double>(before.slow) + kLookPerMuted * muted + cost, workspace);
}

void Shedding::end_chunk(const ChunkCounts& counts, const Chunk& chunk, bool events_waited) REALTIME {
  last_ = counts;
  shed_ = tight_ = little_ = false;
  if (!budget_.limited()) return;
  const double units = counts.units;
  const double rest =
      counts.units - render_units(counts.modes, chunk.frames, chunk.moments) - counts.enter_units - event_units_;
  overhead_ += kAverage * (std::max(rest, 0.0) - overhead_);
  event_average_ += kAverage * (event_units_ - event_average_);
  const double affordable = budget_.affordable();
  shed_ = counts.shed || events_waited || threshold_ != kNoThreshold;
  tight_ = counts.shed || threshold_ != kNoThreshold || units > kTight * affordable;
  little_ = units < kLittle * affordable && counts.muted_modes == 0;
  budget_.end_chunk(units);
  const double learnt = budget_.affordable() / static_cast<double>(chunk.frames);
  coupled_affordable_ = counts.coupled_voices > 0 ? learnt : kForget * coupled_affordable_;
}

}  // namespace ringdown::synth
