// The mixer's half of hearing.h: who is surveyed, and when.
#include "engine/synth/mixer.h"

#include <algorithm>
#include <cmath>

namespace ringdown::synth {
namespace {

constexpr std::size_t kSurveyFrames = 2048;  // 43 ms at 48 kHz; what follows a louder sound is hidden for longer

}  // namespace

// Decides, now and then, what is not computed.
void Mixer::survey(std::size_t frames) RINGDOWN_REALTIME {
  const bool masking = masking_.load(std::memory_order_relaxed);
  since_survey_ += frames;
  surveyed_ = since_survey_ >= kSurveyFrames && (masking || cut_.hides);
  if (!surveyed_) return;
  since_survey_ = 0;
  hearing_.forget();
  const double floor = floor_.load(std::memory_order_relaxed);
  for (std::size_t i = 0; i < active_family_count_; ++i) {
    for_outputs(*active_families_.data()[i], [&](Ringing& sum, std::size_t channel) RINGDOWN_REALTIME {
      if (!contains(wanted_, channel)) return sum.reveal();  // only its states move on
      sum.survey(hearing_, 0, floor);
    });
  }
  for (std::size_t i = 0; i < active_count_; ++i) {
    Object& object = objects_.data()[active_.data()[i]];
    const auto look_at = [&](Voice& voice) RINGDOWN_REALTIME {
      if (!heard(object)) return voice.reveal();
      voice.survey(hearing_, loudness_of(object), floor_of(object));
    };
    if (object.current) look_at(*object.current);
    for (Voice* voice = object.tails; voice; voice = voice->next) look_at(*voice);
  }
  cut_ = hearing_.decide(masking);
}

// What is struck in this chunk waits for the next survey: it would come or go before the strike, at once.
void Mixer::listen(Object& object) RINGDOWN_REALTIME {
  if (!surveyed_ || !heard(object) || (object.first_due >= 0 && cut_.hides)) return;
  const Level loudness = loudness_of(object);
  if (object.current) object.current->listen(cut_, loudness);
  for (Voice* voice = object.tails; voice; voice = voice->next) voice->listen(cut_, loudness);
}

void Mixer::listen(Family& family) RINGDOWN_REALTIME {
  if (!surveyed_ || (family.first_due >= 0 && cut_.hides)) return;
  for_outputs(family, [&](Ringing& sum, std::size_t channel) RINGDOWN_REALTIME {
    if (contains(wanted_, channel)) sum.listen(cut_, 0);
  });
}

Level Mixer::loudness_of(const Object& object) RINGDOWN_REALTIME {
  const double gain = std::max(std::abs(object.gain.from), std::abs(object.gain.to));
  return level_of(gain * gain);
}

}  // namespace ringdown::synth
