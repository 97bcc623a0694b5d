#include "server/session/strike_merger.h"

#include <algorithm>

namespace ringdown::session {
namespace {

using synth::Event;

bool same_place(const synth::verb::Strike& a, const synth::verb::Strike& b) { return a.point_m == b.point_m; }
bool same_place(const synth::verb::StrikeVertex& a, const synth::verb::StrikeVertex& b) { return a.vertex == b.vertex; }

// Adds a strike to a held event if object, point and contact time are equal.
template <class Strike>
bool merge(const Strike& strike, const Event& event, Event& held) {
  Strike* const before = held.verb.get_if<Strike>();
  if (!before || held.object != event.object || !same_place(*before, strike) ||
      before->contact_time_s != strike.contact_time_s) {
    return false;
  }
  before->impulse_ns = before->impulse_ns + strike.impulse_ns;
  held.frame = std::max(held.frame, event.frame);
  return true;
}

}  // namespace

StrikeMerger::Verdict StrikeMerger::add(const Event& event) {
  if (window_ == 0) return Verdict::pass;
  const auto* strike = event.verb.get_if<synth::verb::Strike>();
  const auto* vertex = event.verb.get_if<synth::verb::StrikeVertex>();
  if (!strike && !vertex) return held_.empty() ? Verdict::pass : Verdict::full;
  if (event.frame >= begin_ + window_ || event.frame < begin_ - window_) {
    begin_ = event.frame;
    strikes_ = 0;
  }
  if (++strikes_ <= kMaxUnmerged) return held_.empty() ? Verdict::pass : Verdict::full;
  const auto takes = [&](Event& held) { return strike ? merge(*strike, event, held) : merge(*vertex, event, held); };
  if (std::ranges::any_of(held_, takes)) return Verdict::merged;
  if (held_.size() == kMaxHeld) return Verdict::pass;
  held_.push_back(event);
  return Verdict::held;
}

}  // namespace ringdown::session
