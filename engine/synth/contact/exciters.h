// Forces that last for a while: contact pulses played sample by sample, audio inputs that excite an object, and
// surfaces that slide or roll.
//
// An exciter is a force in time at one point of one object. There is a fixed number of them; the audio thread takes one
// for a strike and gives it back at the end of the chunk in which the pulse is over.
//
// The ends of chunks depend on the block size, but the sound must not. So the place of a force is free again exactly
// kChunkFrames after the force is over: by then it has been given back, however time was cut into chunks. [audio, after
// construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/contact/rubbing.h"
#include "engine/synth/events/event.h"
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/kernels/block_io.h"
#include "engine/synth/kernels/drive_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace ringdown::synth {

class Voice;
struct MixerCounters;

inline constexpr std::size_t kMaxDrives = 32;           // at a time; more strikes are shaped by their spectrum
inline constexpr std::size_t kMaxDrivenColumns = 4096;  // of an object's modes; with more, too
inline constexpr double kMinPulse_frames = 4;           // a shorter pulse is none in samples

// A contact: a half-sine of unit impulse that begins at frame 0.
class HalfSine {
 public:
  HalfSine() = default;
  explicit HalfSine(double frames) REALTIME;  // >= kMinPulse_frames

  // This contact in frames of another length. [worker]
  [[nodiscard]] HalfSine stretched(double ratio) const {
    return HalfSine(frames_ * ratio > kMinPulse_frames ? frames_ * ratio : kMinPulse_frames);
  }

  // The impulse in frames first ... first + count - 1; the sum over all frames is 1.
  void fill(Frame first, std::size_t count, double* impulses) const REALTIME;
  [[nodiscard]] Frame over_from() const REALTIME { return static_cast<Frame>(std::ceil(frames_)); }

 private:
  double frames_ = 0, scale_ = 0;
};

struct Exciter {
  AlignedArray<double> amplitudes = aligned_zeros<double>(kMaxDrivenColumns);  // what an impulse of 1 gives each mode
  // The impulse is 1 N s, or 1 Pa s in the mouth for a breath, and has no contact time.
  OneOf<Types<verb::Strike, verb::StrikeVertex, verb::Slap>> impulse = verb::Strike{};
  Frame begin = 0;                       // of the force
  std::optional<std::size_t> input;      // the force is this input's samples; else
  std::optional<std::uint32_t> contact;  // it is the friction of this contact of the object; else the pulse
  Rubbing rubbing;
  HalfSine pulse;
  Frame end = 0;               // the force is cut off there
  bool awaits_update = false;  // an event of this chunk, not yet played, goes on with the contact

  // Changes the length of a frame from `now` on. [worker]
  void rescale(Frame now, double ratio);

  // The impulse in frames first ... first + count - 1 of the mixer; `samples` are the input's, or null.
  void fill(Frame first, std::size_t count, const float* samples, double* impulses) REALTIME;
  // The first frame without force; kNever where that is not known yet.
  [[nodiscard]] Frame over_from() const REALTIME {
    if (input) return kNever;
    if (awaits_update) return end;
    return std::min(end, contact ? rubbing.over_from() : begin + pulse.over_from());
  }
};

// The exciters that act on one object.
class ExciterSlots {
 public:
  [[nodiscard]] std::span<Exciter* const> all() const REALTIME { return {slots_.data(), count_}; }
  [[nodiscard]] bool full() const REALTIME { return count_ == kMaxForces; }
  // Returns true if there is no place for a force that begins at this frame.
  [[nodiscard]] bool full_at(Frame frame) const REALTIME {
    const auto kept = std::ranges::count_if(kept_until_, [=](Frame until) REALTIME { return until > frame; });
    return count_ + static_cast<std::size_t>(kept) >= kMaxForces;
  }
  void add(Exciter& exciter) REALTIME { slots_[count_++] = &exciter; }
  // The last one moves to its place, which is kept free until a frame.
  Exciter& take_out(std::size_t which, Frame keep_until) REALTIME {
    Exciter* const exciter = slots_[which];
    slots_[which] = slots_[--count_];
    *std::ranges::min_element(kept_until_) = keep_until;
    return *exciter;
  }
  void clear() REALTIME { count_ = 0; }

  // The contact of this number that is not over at a frame; null: none.
  [[nodiscard]] Exciter* find_contact(std::uint32_t number, Frame frame) const REALTIME;
  // Returns true if a pulse or a contact acts: anything but an input.
  [[nodiscard]] bool has_pulse() const REALTIME {
    return std::ranges::any_of(all(), [](const Exciter* exciter) REALTIME { return !exciter->input; });
  }
  // Returns true if a force acts in a chunk in which these inputs are not silent.
  [[nodiscard]] bool act(const std::array<bool, kMaxInputs>& input_sounds) const REALTIME {
    return std::ranges::any_of(
        all(), [&](const Exciter* exciter) REALTIME { return !exciter->input || input_sounds[*exciter->input]; });
  }
  void stop_at(Frame end) REALTIME;  // cuts off every pulse and contact

 private:
  std::array<Exciter*, kMaxForces> slots_{};
  std::array<Frame, kMaxForces> kept_until_{};  // of places whose forces are over
  std::size_t count_ = 0;
};

// All exciters, and which object each input excites. An exciter acts on a voice: where none fits, or its bank has more
// than kMaxDrivenColumns modes, nothing acts.
class Exciters {
 public:
  explicit Exciters(MixerCounters& counters) : counters_(counters) {}

  // Plays the strike's contact sample by sample. False when the strike is better shaped by its spectrum: it is too
  // short, or too many forces act already.
  template <class Strike>
  [[nodiscard]] bool start_pulse(const Strike& strike, Frame frame, double sample_rate_hz, Voice* voice,
                                 ExciterSlots& slots) REALTIME {
    Strike impulse = strike;
    impulse.contact_time_s = 0;
    return play_pulse(impulse, strike.contact_time_s * sample_rate_hz, frame, voice, slots);
  }
  // Makes room for a contact or for breath over the mouth, unless the object has it already. False when there is no
  // force, no room, or no air for the breath to act on.
  [[nodiscard]] bool open(const verb::Contact& event, Frame frame, double sample_rate_hz, Voice* voice,
                          ExciterSlots& slots) REALTIME;
  [[nodiscard]] bool open(const verb::Blow& blow, Frame frame, double sample_rate_hz, Voice* voice,
                          ExciterSlots& slots) REALTIME;
  // The contact or the breath is as the event says from the event's frame on.
  static void update(const verb::Contact& event, Frame frame, Voice* voice, const ExciterSlots& slots) REALTIME;
  static void update(const verb::Blow& blow, Frame frame, const ExciterSlots& slots) REALTIME;

  // Lets an input excite an object, whose voice and slots these are.
  void connect(std::size_t input, ObjectNumber object, const verb::Strike& impulse, Voice* voice,
               ExciterSlots& slots) REALTIME;
  void disconnect(std::size_t input, ExciterSlots& slots) REALTIME;
  [[nodiscard]] std::optional<ObjectNumber> target_of(std::size_t input) const REALTIME { return targets_[input]; }

  // Returns true if some input excites an object.
  [[nodiscard]] bool take_inputs() const REALTIME {
    return std::ranges::any_of(targets_, [](const auto& target) REALTIME { return target.has_value(); });
  }

  // Fits what acts on an object to its new voice; drops what does not fit.
  void refit(Voice* voice, ExciterSlots& slots) REALTIME;
  // Gives back the exciters that are over at a frame.
  void drop_finished(Frame frame, ExciterSlots& slots) REALTIME;

 private:
  [[nodiscard]] bool open_number(const decltype(Exciter::impulse)& impulse, std::uint32_t number, bool acts,
                                 Frame frame, double sample_rate_hz, Voice* voice, ExciterSlots& slots) REALTIME;
  [[nodiscard]] bool play_pulse(const decltype(Exciter::impulse)& impulse, double frames, Frame frame, Voice* voice,
                                ExciterSlots& slots) REALTIME;
  [[nodiscard]] Exciter* take(Frame from) REALTIME;  // null: none is free from that frame on
  void give_back(Exciter& exciter) REALTIME;
  void drop(std::size_t which, ExciterSlots& slots, Frame keep_until = 0) REALTIME;
  [[nodiscard]] bool fit(Exciter& exciter, Voice* voice, ExciterSlots& slots) REALTIME;

  static_assert(kMaxDrives == 32);
  std::uint32_t free_ = ~0u;  // bit i: exciter i
  std::array<Exciter, kMaxDrives> exciters_;
  std::array<Frame, kMaxDrives> kept_until_{};  // of exciters that are free
  std::array<std::optional<ObjectNumber>, kMaxInputs> targets_;
  MixerCounters& counters_;
};

}  // namespace ringdown::synth
