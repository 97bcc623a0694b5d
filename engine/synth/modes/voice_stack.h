// The voices of one object. [audio, unless a function says otherwise]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/voice.h"

namespace ringdown::synth {

// An object's voices: the current one, which takes strikes, and older ones that ring out.
class VoiceStack {
 public:
  [[nodiscard]] Voice* current() const RINGDOWN_REALTIME { return current_; }
  [[nodiscard]] bool has_tails() const RINGDOWN_REALTIME { return tails_ != nullptr; }

  // Makes `voice`, or none, the current one. With `retune` it takes over what rings of its modes in the old one, whose
  // other modes fade out; otherwise the old one rings out.
  void replace(Voice* voice, bool retune) RINGDOWN_REALTIME;
  void fade_out(const Fading& fade) RINGDOWN_REALTIME;
  // Takes silent tails off, oldest last, and hands each to `retire(voice, last)`; `last` tells that the object has no
  // voice any more.
  template <class Retire>
  void drop_silent_tails(const Retire& retire) RINGDOWN_REALTIME {
    for (Voice** link = &tails_; *link;) {
      Voice* const voice = *link;
      if (voice->ringing()) {
        link = &voice->next;
        continue;
      }
      Voice* const next = voice->next;
      const bool last = !current_ && !next && link == &tails_;
      *link = next;
      retire(voice, last);
    }
  }
  template <class Act>
  void for_each(const Act& act) const RINGDOWN_REALTIME {
    if (current_) act(*current_);
    for (Voice* voice = tails_; voice; voice = voice->next) act(*voice);
  }
  void free_all();  // [worker, while nothing is rendered]
  // Exchanges every voice for the one that `renew(voice)` returns. [worker, while nothing is rendered]
  template <class Renew>
  void renew(const Renew& renew) {
    if (current_) current_ = renew(current_);
    for (Voice** link = &tails_; *link; link = &(*link)->next) {
      Voice* const next = (*link)->next;
      *link = renew(*link);
      (*link)->next = next;
    }
  }

 private:
  Voice *current_ = nullptr, *tails_ = nullptr;
};

}  // namespace ringdown::synth
