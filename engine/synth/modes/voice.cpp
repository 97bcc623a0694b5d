#include "engine/synth/modes/voice.h"

#include "engine/synth/modes/counters.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace ringdown::synth {

Voice::Voice(std::shared_ptr<ModeTable> table)
    : ModeStates(*table),
      table_(std::move(table)),
      amplitudes_(aligned_zeros<double>(table_->columns() + std::max(table_->columns(), table_->bank().mode_count()))) {
}

Voice::Voice(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material, double sample_rate_hz)
    : Voice(std::make_shared<ModeTable>(std::move(map), material, sample_rate_hz)) {}

std::unique_ptr<Voice> Voice::with_table(std::shared_ptr<ModeTable> table) {
  auto voice = std::make_unique<Voice>(std::move(table));
  voice->take_over(*this);
  return voice;
}

// An absurd strike becomes not-a-number, because modes that die within the chunk would hide a merely huge one.
double Voice::gain_for(double energy, MixerCounters* counters) const REALTIME {
  if (!(energy <= kAbsurdEnergy)) return std::numeric_limits<double>::quiet_NaN();
  const double limit = blow_limit(amplitudes_.get());
  if (limit < 1 && counters) count(counters->limited);
  return limit;
}

void VoiceStack::replace(Voice* voice, bool retune) REALTIME {
  Voice* const old = std::exchange(current_, voice);
  if (!old) return;
  if (retune) {
    if (voice->take_over(*old, voice->mode_change.get())) {
      old->fade_out();
    } else {
      old->silence();
    }
  }
  old->next = tails_;
  tails_ = old;
}

void VoiceStack::fade_out(const Fading& fade) REALTIME {
  for_each([&fade](Voice& voice) REALTIME { voice.fade_out(fade); });
}

void VoiceStack::free_all() {
  delete std::exchange(current_, nullptr);
  while (tails_) delete std::exchange(tails_, tails_->next);
}

}  // namespace ringdown::synth
