// The mixer's half of hearing.h: who is surveyed, and when.
//
// Without a budget all is surveyed at once, now and then; with one, some items in each chunk, so that no chunk takes
// much longer than the others, and more of them when time is short. What has been surveyed decides once all was.
#include "engine/synth/mixer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ringdown::synth {
namespace {

constexpr std::size_t kSurveyFrames = 2048;  // 43 ms at 48 kHz; what follows a louder sound is hidden for longer
constexpr double kRound_s = 0.085;           // of a survey in parts
constexpr double kQuickRound = 4;            // chunks, when time is short; or more, so that each takes no more than
constexpr double kSurveyShare = 0.08;        // of its time,
constexpr double kLeftAfterSurvey = 0.6;     // and never so much that less is left
constexpr std::size_t kLowerFrames = 4096;   // in this time the level falls by kLowerBy
constexpr Level kLowerBy = 2;                // 3 dB: 35 dB in a second

}  // namespace

// Decides, now and then, what is not computed.
void Mixer::survey(std::size_t frames) RINGDOWN_REALTIME {
  const bool limited = budget_.limited();
  const bool masking = sounding_modes_ + hidden_modes_ >= masking_from_.load(std::memory_order_relaxed);
  survey_begin_ = survey_end_ = 0;
  since_survey_ += frames;
  since_lowered_ += frames;
  if (!masking && !cut_.hides && !(limited && tight_) && hidden_modes_ == 0) {
    survey_at_ = 0;
    return;
  }
  const auto all = static_cast<double>(sounding_modes_ + hidden_modes_);
  double modes = std::numeric_limits<double>::max();
  if (limited) {
    const auto part = static_cast<double>(frames) / (kRound_s * sample_rate_hz());
    const double most = budget_.looks(kSurveyShare);
    modes = tight_ ? std::clamp(most, all * part, all / kQuickRound) : all * part;
  } else if (since_survey_ < kSurveyFrames && masking) {
    return;
  }
  if (survey_at_ == 0) hearing_.forget();
  const std::size_t items = active_family_count_ + active_count_;
  survey_begin_ = std::min(survey_at_, items);
  const std::int64_t begin_ns = budget_.begin();
  double looked = 0;
  for (survey_end_ = survey_begin_; survey_end_ < items && looked < modes; ++survey_end_) {
    if (budget_.over(kLeftAfterSurvey * budget_.usual())) break;
    looked += survey_item(survey_end_);
  }
  budget_.looked(begin_ns, looked);
  survey_at_ = survey_end_;
  if (survey_at_ < items) return;
  survey_at_ = since_survey_ = 0;
  decide(masking);
}

// Returns how many modes it has.
double Mixer::survey_item(std::size_t item) RINGDOWN_REALTIME {
  const auto look_at = [&](Ringing& states, bool heard, Level loudness, double floor) RINGDOWN_REALTIME {
    const std::size_t modes = states.sounding_modes() + states.hidden_modes();
    if (heard) {
      states.survey(hearing_, loudness, floor);
    } else if (!tight_ && least_ == Cut::kNothing) {
      states.reveal();  // only its states move on
    }
    return static_cast<double>(modes);
  };
  double modes = 0;
  if (item < active_family_count_) {
    const double floor = floor_.load(std::memory_order_relaxed);
    for_outputs(*active_families_.data()[item], [&](Ringing& sum, std::size_t channel) RINGDOWN_REALTIME {
      modes += look_at(sum, contains(wanted_, channel), 0, floor);
    });
  } else {
    const Object& object = objects_.data()[active_.data()[item - active_family_count_]];
    const auto look = [&](Voice& voice) RINGDOWN_REALTIME {
      modes += look_at(voice, heard(object), loudness_of(object), floor_of(object));
    };
    if (object.current) look(*object.current);
    for (Voice* voice = object.tails; voice; voice = voice->next) look(*voice);
  }
  budget_.worked(kSurveyPerMode * modes);
  return modes;
}

// The level below which modes are shed rises at once and falls slowly.
void Mixer::decide(bool masking) RINGDOWN_REALTIME {
  const bool limited = budget_.limited();
  const Level needed = limited ? hearing_.least_for(most_modes()) : Cut::kNothing;
  const Level before = least_;
  if (!limited || needed > least_) {
    least_ = needed;
  } else if (least_ > needed && since_lowered_ >= kLowerFrames) {
    const double floor_amplitude = floor_.load(std::memory_order_relaxed);
    const Level floor = level_of(floor_amplitude * floor_amplitude);
    least_ = least_ > floor ? std::max(least_ - kLowerBy, needed) : needed;
    since_lowered_ = 0;
  }
  const std::uint32_t number = cut_.number + (least_ > before ? 1 : 0);
  cut_ = hearing_.decide(masking || least_ > Cut::kNothing, least_);
  cut_.number = number;
}

// Has strikes that come before listen() judged by the cut, when time is short.
void Mixer::attend(Object& object) RINGDOWN_REALTIME {
  if (least_ > Cut::kNothing && object.current && heard(object)) object.current->attend(cut_, loudness_of(object));
}

void Mixer::attend(Family& family) RINGDOWN_REALTIME {
  if (least_ == Cut::kNothing) return;
  for_outputs(family, [&](Ringing& sum, std::size_t channel) RINGDOWN_REALTIME {
    if (contains(wanted_, channel)) sum.attend(cut_, 0);
  });
}

// What is struck in this chunk waits, if there is time, for the next survey: it would come or go before the strike, at
// once.
void Mixer::listen(Object& object, bool in_turn, Place& place) RINGDOWN_REALTIME {
  if (!heard(object) || (object.first_due >= 0 && cut_.hides && least_ == Cut::kNothing)) return;
  const Level loudness = loudness_of(object);
  if (object.current) listen(*object.current, loudness, in_turn, place);
  for (Voice* voice = object.tails; voice; voice = voice->next) listen(*voice, loudness, in_turn, place);
}

void Mixer::listen(Family& family, bool in_turn, Place& place) RINGDOWN_REALTIME {
  if (family.first_due >= 0 && cut_.hides && least_ == Cut::kNothing) return;
  for_outputs(family, [&](Ringing& sum, std::size_t channel) RINGDOWN_REALTIME {
    if (contains(wanted_, channel)) listen(sum, 0, in_turn, place);
  });
}

// In its turn; at once when the cut has risen, but then nothing comes back, or when it was missed.
void Mixer::listen(Ringing& states, Level loudness, bool in_turn, Place& place) RINGDOWN_REALTIME {
  if (!in_turn && !(budget_.limited() && states.ignores(cut_))) return;
  const double units_to_come = (kComingPerMode + 1) * static_cast<double>(place.most_coming);
  if (budget_.over(units_to_come)) place.most_coming = 0;
  std::size_t none = 0;
  std::size_t& most_coming = in_turn || states.missed() ? place.most_coming : none;
  const bool comes = most_coming >= kModePadding;
  if (!comes && states.sounding_slow_modes() == 0) return;
  const std::size_t before = most_coming, sounding = states.sounding_slow_modes();
  states.listen(cut_, loudness, most_coming);
  const std::size_t going = sounding - states.sounding_slow_modes();
  count_work((kComingPerMode + 1) * static_cast<double>(before - most_coming + going) +
                 kSurveyPerMode * static_cast<double>(sounding + (comes ? states.hidden_modes() : 0)),
             place);
}

Level Mixer::loudness_of(const Object& object) RINGDOWN_REALTIME {
  const double gain = std::max(std::abs(object.gain.from), std::abs(object.gain.to));
  return level_of(gain * gain);
}

}  // namespace ringdown::synth
