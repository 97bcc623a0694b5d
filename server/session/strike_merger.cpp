#include "server/session/strike_merger.h"

#include <algorithm>

namespace ringdown::session {
namespace {

using synth::Event;

bool same_blow(const Event& a, const Event& b) {
  return a.object == b.object && a.type == b.type && a.vertex == b.vertex && a.point_m == b.point_m &&
         a.contact_time_s == b.contact_time_s;
}

}  // namespace

StrikeMerger::Verdict StrikeMerger::add(const Event& event) {
  if (window_ == 0) return Verdict::pass;
  if (!is_strike(event)) return held_.empty() ? Verdict::pass : Verdict::full;
  if (event.frame >= begin_ + window_ || event.frame < begin_ - window_) {
    begin_ = event.frame;
    strikes_ = 0;
  }
  if (++strikes_ <= kMaxUnmerged) return held_.empty() ? Verdict::pass : Verdict::full;
  const auto known = std::ranges::find_if(held_, [&](const Event& held) { return same_blow(held, event); });
  if (known == held_.end()) {
    if (held_.size() == kMaxHeld) return Verdict::pass;
    held_.push_back(event);
    return Verdict::held;
  }
  known->impulse_ns = known->impulse_ns + event.impulse_ns;
  known->frame = std::max(known->frame, event.frame);
  return Verdict::merged;
}

}  // namespace ringdown::session
