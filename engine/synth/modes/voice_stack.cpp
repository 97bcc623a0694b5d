#include "engine/synth/modes/voice_stack.h"

#include <utility>

namespace ringdown::synth {

void VoiceStack::replace(Voice* voice, bool retune) RINGDOWN_REALTIME {
  Voice* const old = std::exchange(current_, voice);
  if (!old) return;
  if (retune) {
    if (voice->take_over(*old)) {
      old->fade_out();
    } else {
      old->silence();
    }
  }
  old->next = tails_;
  tails_ = old;
}

void VoiceStack::fade_out(const Fading& fade) RINGDOWN_REALTIME {
  for_each([&fade](Voice& voice) RINGDOWN_REALTIME { voice.fade_out(fade); });
}

void VoiceStack::free_all() {
  delete std::exchange(current_, nullptr);
  while (tails_) delete std::exchange(tails_, tails_->next);
}

}  // namespace ringdown::synth
