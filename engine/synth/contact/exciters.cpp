#include "engine/synth/contact/exciters.h"

#include "engine/synth/modes/counters.h"
#include "engine/synth/modes/voice.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace ringdown::synth {
namespace {

// An impulse of 1 along the force of a contact.
verb::Strike unit_impulse(const verb::Contact& event) REALTIME {
  const Vec3& force_n = event.contact.force_n;
  return {.point_m = event.point_m, .impulse_ns = (1 / length(force_n)) * force_n, .contact_time_s = 0};
}

// Breath is the contact of this number, which no message can name.
constexpr std::uint32_t kBreath = ~std::uint32_t{0};

// White noise in the mouth from 20 Hz to 10 kHz, as the friction on a profile that passes at 1 m/s. Its ten octaves of
// waves have slopes whose power doubles from one to the next, as the width of the octaves does; together the slopes
// have a root mean square of 1 (rubbing.cpp: heights of variance 151/945, slopes of variance 2/9 for each octave).
Contact breath_of(const verb::Blow& blow) REALTIME {
  constexpr double kLongest_m = 1.0 / 20, kWaves = 1023, kShares = 1023.0 / 512;
  const double roughness_m = kLongest_m * std::sqrt(kShares * (151.0 / 945) / (4 * kWaves * (2.0 / 9)));
  return {.number = kBreath,
          .force_n = {blow.pressure_pa, 0, 0},
          .slip_m_s = 1,
          .texture = {.roughness_m = roughness_m,
                      .correlation_m = kLongest_m,
                      .spectral_slope = -2,
                      .shortest_m = kLongest_m / 512},
          .stays = true};
}

}  // namespace

// The scale is one over the sum of sin(pi n / frames) for 0 <= n <= frames, in closed form as a geometric sum of
// exponentials: the samples of a pulse then add up to 1, whatever its length.
HalfSine::HalfSine(double frames) REALTIME : frames_(frames) {
  const double half_step = 0.5 * std::numbers::pi / frames, last = std::floor(frames);
  scale_ = std::sin(half_step) / (std::sin(half_step * last) * std::sin(half_step * (last + 1)));
}

void HalfSine::fill(Frame first, std::size_t count, double* impulses) const REALTIME {
  for (std::size_t i = 0; i < count; ++i) {
    const double n = static_cast<double>(first) + static_cast<double>(i);
    impulses[i] = n >= 0 && n < frames_ ? scale_ * std::sin(std::numbers::pi * n / frames_) : 0.0;
  }
}

void Exciter::fill(Frame first, std::size_t count, const float* samples, double* impulses) REALTIME {
  if (!input) {
    const auto left = std::clamp<Frame>(end - first, 0, static_cast<Frame>(count));
    if (contact) {
      rubbing.fill(first, static_cast<std::size_t>(left), impulses);
    } else {
      pulse.fill(first - begin, static_cast<std::size_t>(left), impulses);
    }
    std::fill(impulses + left, impulses + count, 0.0);
  } else if (samples) {
    std::copy_n(samples, count, impulses);
  } else {
    std::fill_n(impulses, count, 0.0);
  }
}

void Exciter::rescale(Frame now, double ratio) {
  if (input) {
    verb::Strike& force = impulse.get<verb::Strike>();
    force.impulse_ns = (1 / ratio) * force.impulse_ns;
    return;
  }
  begin = rescaled(begin, now, ratio);
  if (end != kNever) end = rescaled(end, now, ratio);
  if (contact) {
    rubbing.rescale(now, ratio);
  } else {
    pulse = pulse.stretched(ratio);
  }
}

Exciter* ExciterSlots::find_contact(std::uint32_t number, Frame frame) const REALTIME {
  for (Exciter* exciter : all()) {
    if (exciter->contact == number && !exciter->input && exciter->over_from() > frame) return exciter;
  }
  return nullptr;
}

void ExciterSlots::stop_at(Frame end) REALTIME {
  for (Exciter* exciter : all()) exciter->end = std::min(exciter->end, end);
}

Exciter* Exciters::take(Frame from) REALTIME {
  for (std::uint32_t rest = free_; rest != 0; rest &= rest - 1) {
    const auto place = static_cast<std::size_t>(std::countr_zero(rest));
    if (kept_until_[place] > from) continue;
    free_ &= ~(1u << place);
    Exciter& exciter = exciters_[place];
    exciter.input.reset();
    exciter.contact.reset();
    exciter.end = kNever;
    exciter.awaits_update = false;
    return &exciter;
  }
  return nullptr;
}

void Exciters::give_back(Exciter& exciter) REALTIME { free_ |= 1u << (&exciter - exciters_.data()); }

// Finds what an impulse of 1 gives the voice's modes, and adds the exciter to the slots. False when it cannot act.
bool Exciters::fit(Exciter& exciter, Voice* voice, ExciterSlots& slots) REALTIME {
  if (!voice || voice->table().columns() > kMaxDrivenColumns) return false;
  const auto finds = [voice](const auto& impulse) REALTIME { return voice->find_sane_amplitudes(impulse); };
  if (!visit_now(finds, exciter.impulse)) return false;
  std::copy_n(voice->amplitudes().re, voice->table().columns(), exciter.amplitudes.get());
  slots.add(exciter);
  return true;
}

// A contact pulse as samples. The strike's half-sine becomes an exciter that pushes the modes for as long as the
// contact lasts, instead of a single impulse whose amplitudes are shaped by the pulse's spectrum. Both sound alike once
// the contact is over; sample by sample, the onset is right, too. When too many forces act, or the pulse is shorter
// than kMinPulse_frames, false tells the caller to use the spectrum.
bool Exciters::play_pulse(const decltype(Exciter::impulse)& impulse, double frames, Frame frame, Voice* voice,
                          ExciterSlots& slots) REALTIME {
  if (!voice || !(frames >= kMinPulse_frames) || slots.full_at(frame)) return false;
  Exciter* const exciter = take(frame);
  if (!exciter) return false;
  exciter->impulse = impulse;
  exciter->begin = frame;
  exciter->pulse = HalfSine(frames);
  if (fit(*exciter, voice, slots)) {
    const double limit = voice->blow_limit(exciter->amplitudes.get());
    if (limit == 1) return true;
    for (std::size_t c = 0; c < voice->table().columns(); ++c) exciter->amplitudes.get()[c] *= limit;
    count(counters_.limited);
    return true;
  }
  give_back(*exciter);
  return false;
}

bool Exciters::open(const verb::Contact& event, Frame frame, double sample_rate_hz, Voice* voice,
                    ExciterSlots& slots) REALTIME {
  const Contact& contact = event.contact;
  const bool acts = length(contact.force_n) > 0;
  return open_number(acts ? unit_impulse(event) : verb::Strike{}, contact.number, acts, frame, sample_rate_hz, voice,
                     slots);
}

bool Exciters::open(const verb::Blow& blow, Frame frame, double sample_rate_hz, Voice* voice,
                    ExciterSlots& slots) REALTIME {
  const verb::Slap of_one_pa{.impulse_ns = voice ? voice->table().whole().mouth_area_m2 : 0, .contact_time_s = 0};
  return open_number(of_one_pa, kBreath, blow.pressure_pa > 0, frame, sample_rate_hz, voice, slots);
}

bool Exciters::open_number(const decltype(Exciter::impulse)& impulse, std::uint32_t number, bool acts, Frame frame,
                           double sample_rate_hz, Voice* voice, ExciterSlots& slots) REALTIME {
  Exciter* const open = slots.find_contact(number, frame);
  if (!acts) return open != nullptr;
  if (open) {
    open->awaits_update = true;
    return true;
  }
  Exciter* const exciter = voice && !slots.full_at(frame) ? take(frame) : nullptr;
  if (exciter) {
    exciter->impulse = impulse;
    exciter->begin = frame;
    exciter->contact = number;
    exciter->rubbing = Rubbing(number, sample_rate_hz);
    exciter->awaits_update = true;
    if (fit(*exciter, voice, slots)) return true;
    give_back(*exciter);
  }
  count(counters_.refused);
  return false;
}

void Exciters::update(const verb::Contact& event, Frame frame, Voice* voice, const ExciterSlots& slots) REALTIME {
  Exciter* const exciter = slots.find_contact(event.contact.number, frame);
  if (!exciter) return;
  exciter->awaits_update = false;
  exciter->rubbing.update(frame, event.contact);
  if (length(event.contact.force_n) == 0 || !voice) return;
  const verb::Strike impulse = unit_impulse(event);
  exciter->impulse = impulse;
  exciter->begin = frame;
  if (!voice->find_sane_amplitudes(impulse)) return;
  std::copy_n(voice->amplitudes().re, voice->table().columns(), exciter->amplitudes.get());
}

void Exciters::update(const verb::Blow& blow, Frame frame, const ExciterSlots& slots) REALTIME {
  Exciter* const exciter = slots.find_contact(kBreath, frame);
  if (!exciter) return;
  exciter->awaits_update = false;
  exciter->rubbing.update(frame, breath_of(blow));
}

void Exciters::connect(std::size_t input, ObjectNumber object, const verb::Strike& impulse, Voice* voice,
                       ExciterSlots& slots) REALTIME {
  if (!voice) return;
  if (slots.full()) {  // an input stays; a pulse or contact would soon have ended
    const auto all = slots.all();
    const auto pulse =
        std::find_if(all.begin(), all.end(), [](const Exciter* exciter) REALTIME { return !exciter->input; });
    if (pulse != all.end()) drop(static_cast<std::size_t>(pulse - all.begin()), slots);
  }
  Exciter* const exciter = take(kNever);
  if (!exciter) return count(counters_.refused);
  exciter->impulse = impulse;
  exciter->input = input;
  if (fit(*exciter, voice, slots)) {
    targets_[input] = object;
  } else {
    give_back(*exciter);
  }
}

void Exciters::disconnect(std::size_t input, ExciterSlots& slots) REALTIME {
  for (std::size_t i = 0; i < slots.all().size(); ++i) {
    if (slots.all()[i]->input == input) return drop(i, slots);
  }
}

void Exciters::refit(Voice* voice, ExciterSlots& slots) REALTIME {
  const ExciterSlots before = slots;
  slots.clear();
  for (Exciter* exciter : before.all()) {
    if (fit(*exciter, voice, slots)) continue;
    slots.add(*exciter);
    drop(slots.all().size() - 1, slots);
  }
}

void Exciters::drop_finished(Frame frame, ExciterSlots& slots) REALTIME {
  for (std::size_t i = 0; i < slots.all().size();) {
    if (const Frame over = slots.all()[i]->over_from(); over <= frame) {
      drop(i, slots, over + static_cast<Frame>(kChunkFrames));
    } else {
      ++i;
    }
  }
}

void Exciters::drop(std::size_t which, ExciterSlots& slots, Frame keep_until) REALTIME {
  Exciter& exciter = slots.take_out(which, keep_until);
  kept_until_[static_cast<std::size_t>(&exciter - exciters_.data())] = keep_until;
  if (exciter.input) targets_[*exciter.input].reset();
  give_back(exciter);
}

}  // namespace ringdown::synth
