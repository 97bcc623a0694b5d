// An object's share of a chunk.
//
// By tables the chunk is cut at the object's events: what rings is rendered up to an event, the event happens, and so
// on. By moments what rang at the beginning of the chunk is added for the whole chunk at once; strikes within it ring
// beside, by tables, until the chunk ends. Tables serve a chunk in which anything but strikes happens, or in which gain
// or pan move, because moments add up before single samples are known.
//
// An object that is heard from a place takes moments whenever it can, because its gains move all the time and only
// moments shift its pitch: gain, pan and contacts then count from the next chunk on.
#include "engine/synth/objects/object.h"

#include "engine/synth/modes/counters.h"
#include "engine/synth/modes/sane_samples.h"
#include "engine/synth/objects/shedding.h"
#include "engine/synth/modes/work_cost.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::synth {
namespace {

constexpr double kMinGainRamp_s = 0.005;  // a step in gain or pan would click
constexpr double kMaxGainRamp_s = 3600;
constexpr double kMaxSharedGain = 100;
constexpr double kMinChoke_s = 0.00025;                  // as fast as a body breaks; 10 frames
constexpr double kChokeNepers = 3 * std::numbers::ln10;  // 60 dB

// Returns whether the samples of a segment may be added to the outputs. Absurd ones (sane_samples.h) silence the
// object's voices, and are counted.
bool keep_sane(std::span<const double> samples, const VoiceStack& voices, const Chunk& chunk) REALTIME {
  if (are_sane(samples)) return true;
  voices.for_each([](Voice& voice) REALTIME { voice.silence(); });
  count(chunk.counters->not_finite);
  return false;
}

}  // namespace

void Object::render(const Chunk& chunk, Workspace& workspace) REALTIME {
  workspace.counts.look_terms += placement.begin_chunk(chunk, voices, strip);
  if (fan.on()) hear(0, chunk.frames, chunk);
  pickups.begin(chunk);
  apply_threshold(chunk, workspace);
  voices.for_each([&](Voice& voice) REALTIME {
    if (voice.coupling.possible())
      voice.coupling.affordable = chunk.shedding->may_couple(voice.coupling, chunk, workspace);
  });
  const bool by_moments =
      placement.begun(chunk) ? !is_cleared() : (chunk.moments || !strip.heard(chunk.wanted)) && only_struck(chunk);
  if (by_moments) {
    render_by_moments(chunk, workspace);
  } else {
    render_by_tables(chunk, workspace);
  }
  pickups.end(chunk, voices, workspace);
  placement.end_chunk(chunk, voices);
  end_fan(chunk);
  voices.for_each([&](const Voice& voice) REALTIME {
    if (!voice.ringing()) return;
    const ModeStates::Counts counts = voice.counts();
    ++workspace.counts.voices;
    workspace.counts.add(counts);
    chunk.shedding->worked(render_units(counts.sounding, chunk.frames, by_moments || chunk.moments), workspace);
    if (!voice.coupling.running()) return;
    ++workspace.counts.coupled_voices;
    workspace.counts.note_psi(static_cast<float>(voice.coupling.psi_over_truth() - 1));
    chunk.shedding->worked(voice.coupling.units(chunk.frames), workspace);
  });
}

void Object::fetch(FetchStage stage, std::size_t frames) const REALTIME {
  if (stage == FetchStage::object) {
    const auto* const begin = reinterpret_cast<const char*>(&placement.track + 1);
    const auto* const end = reinterpret_cast<const char*>(&strip) + ChannelStrip::kOftenRead;
    fetch_range(begin, static_cast<std::size_t>(end - begin));
  } else if (const Voice* const voice = voices.current()) {
    VoiceFetch::fetch(*voice, stage, frames);
  }
}

// Before its frames `begin` to `end` - 1 of the chunk are rendered.
void Object::hear(std::size_t begin, std::size_t end, const Chunk& chunk) REALTIME {
  if (begin >= end) return;
  const bool placed = placement.begun(chunk);
  if (placed) placement.hear(begin, end, chunk, voices);
  if (!fan.on()) return;
  const auto gain = [&](std::size_t offset)
                        REALTIME { return fan.gain(chunk.begin + static_cast<Frame>(offset), chunk.sample_rate_hz); };
  constexpr ModeStates::HeardTime kHere{};
  const double from = gain(begin), to = gain(end);
  voices.for_each([&](Voice& voice) REALTIME {
    if (!placed) voice.hear(voice.table().heard_columns().tube_shares ? &kHere : nullptr);
    voice.hear_tube(from, to, end - begin);
  });
}

void Object::end_fan(const Chunk& chunk) REALTIME {
  if (!fan.end(chunk.end(), chunk.sample_rate_hz) || placement.begun(chunk)) return;
  voices.for_each([](Voice& voice) REALTIME { voice.hear(nullptr); });
}

// Returns true if an event ends some of its sound in this chunk; moments cannot be cut at an event.
bool Object::is_cleared() const REALTIME {
  for (const DueEvent* event = due.first; event; event = event->next) {
    if (effect_of(event->event) == Effect::damps) return true;
  }
  return false;
}

// Returns true if only strikes happen to it in the chunk, and no gain or pan is moving.
bool Object::only_struck(const Chunk& chunk) const REALTIME {
  for (const DueEvent* event = due.first; event; event = event->next) {
    if (!excites(event->event)) return false;
  }
  return strip.still_at(chunk.begin);
}

// The amplitude of states below which modes rest. A force that acts may yet make a weak mode loud, little by little.
double Object::floor(const Chunk& chunk) const REALTIME {
  return driven(chunk) ? 0 : chunk.floor / std::max(1.0, strip.max_gain()) * pickups.floor_factor();
}

// Takes the next event off the list. False when there is none, or no time for it: then it waits for the next chunk.
bool Object::play_next(const Chunk& chunk, Workspace& workspace) REALTIME {
  if (!due.first || !chunk.shedding->may_play(units_of(due.first->event.verb.index()), workspace)) return false;
  due.first = due.first->next;
  return true;
}

// Plays an event of the object at its frame.
struct Object::Play {
  // The stage, the listener or a TouchGroup plays these.
  using Elsewhere = Types<verb::Click, verb::Bow, verb::Mallet, verb::Couple, verb::Collision, verb::Rub, verb::Pickup,
                          verb::Pose, verb::Listener, verb::ListenerOff, verb::ListenerAir>;

  Object& object;
  Frame frame;
  const Chunk& chunk;

  template <class Blow>
  requires(Blow::kEffect == Effect::excites) void operator()(const Blow& blow) const REALTIME {
    Voice* const voice = object.voices.current();
    const bool struck = is_sane(blow) && voice && voice->strike(blow, chunk.counters);
    count(struck ? chunk.counters->strikes : chunk.counters->refused);
  }
  void operator()(const verb::Contact& contact) const REALTIME {
    Exciters::update(contact, frame, object.voices.current(), object.exciters);
  }
  void operator()(const verb::Blow& blow) const REALTIME { Exciters::update(blow, frame, object.exciters); }
  void operator()(const verb::Gain& gain) const REALTIME {
    if (!(std::abs(gain.gain) <= kMaxEventValue)) return count(chunk.counters->refused);
    object.strip.set_gain(gain.gain, frame, frames_of(gain.ramp_s));
  }
  void operator()(const verb::Pan& pan) const REALTIME {
    if (!(std::abs(pan.pan) <= kMaxEventValue)) return count(chunk.counters->refused);
    object.strip.set_pan(pan.pan, frame, frames_of(0));
  }
  void operator()(const verb::Fan& turn) const REALTIME {
    const auto fits = [](double x, const Range& range) REALTIME { return x >= range.low && x <= range.high; };
    if (!fits(turn.rate_hz, verb::Fan::kRate_hz) || !fits(turn.depth, verb::Fan::kDepth))
      return count(chunk.counters->refused);
    object.fan.set(turn, frame, chunk.sample_rate_hz);
  }
  void operator()(const verb::Clear& clear) const REALTIME {
    object.voices.fade_out({static_cast<std::size_t>(frames_of(clear.ramp_s))});
  }
  void operator()(const verb::Choke& choke) const REALTIME {
    object.voices.fade_out({static_cast<std::size_t>(frames_of(choke.within_s, kMinChoke_s)), kChokeNepers});
  }
  template <class One>
  requires(Elsewhere::kHas<One>) void operator()(const One&) const REALTIME {}

 private:
  static bool is_sane(const verb::Ring& ring) REALTIME { return std::abs(ring.amplitude) <= kMaxEventValue; }
  static bool is_sane(const verb::Impart& impart) REALTIME {
    return std::abs(impart.velocity) <= kMaxEventValue && std::abs(impart.phase_rad) <= kMaxEventValue;
  }
  static bool is_sane(const auto&) REALTIME { return true; }
  // Written so that a ramp that is not a number becomes the shortest.
  [[nodiscard]] Frame frames_of(double ramp_s, double min_s = kMinGainRamp_s) const REALTIME {
    const double within_s = std::min(ramp_s > min_s ? ramp_s : min_s, kMaxGainRamp_s);
    return static_cast<Frame>(within_s * chunk.sample_rate_hz);
  }
};

void Object::play(const Event& event, const Chunk& chunk) REALTIME {
  visit_now(Play{*this, event.frame, chunk}, event.verb);
}

void Object::render_by_tables(const Chunk& chunk, Workspace& workspace) REALTIME {
  std::size_t at = 0;
  for (const DueEvent* event = due.first; play_next(chunk, workspace); event = due.first) {
    render_segment(at, event->offset, chunk, workspace);
    at = event->offset;
    play(event->event, chunk);
  }
  render_segment(at, chunk.frames, chunk, workspace);
}

void Object::render_segment(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace) REALTIME {
  if (begin == end) return;
  bool sounds = false;
  double* const mono = workspace.mono.data();
  std::fill_n(mono + begin, end - begin, 0.0);
  hear(begin, end, chunk);
  pickups.listen(begin, chunk, voices, workspace);
  voices.for_each([&](Voice& voice) REALTIME {
    if (!voice.ringing()) return;
    if (!voice.render(mono + begin, end - begin, floor(chunk))) count(chunk.counters->not_finite);
    sounds = true;
  });
  if (driven(chunk)) {
    drive(begin, end, chunk, workspace);
    voices.current()->merge_late();
    sounds = true;
  }
  if (sounds && keep_sane({mono + begin, end - begin}, voices, chunk)) {
    strip.add_samples(mono, begin, end, chunk, workspace.sums);
  }
}

void Object::render_by_moments(const Chunk& chunk, Workspace& workspace) REALTIME {
  for (const DueEvent* event = due.first; event && event->offset == 0 && play_next(chunk, workspace);
       event = due.first) {
    play(event->event, chunk);
  }
  FieldSums* const field = (chunk.wanted & kAllAmbisonic) != 0 ? workspace.sums.field() : nullptr;
  std::array<MomentTarget, ChannelStrip::kMaxTargets> room;
  std::span<const MomentTarget> targets(room.data(), 1);
  if (field) {
    room[0] = field->begin_object();
  } else {
    targets = strip.moment_targets(chunk, workspace.sums, room);
  }
  const bool late = due.first || driven(chunk);
  bool samples = driven(chunk);
  voices.for_each([&](const Voice& voice) REALTIME { samples = samples || voice.needs_samples(); });
  // Only samples from here on may be other than zero.
  const std::size_t begin = samples ? 0 : late ? due.first->offset : chunk.frames;
  double* const mono = workspace.mono.data();
  std::fill(mono + begin, mono + chunk.frames, 0.0);
  pickups.listen(0, chunk, voices, workspace);
  voices.for_each([&](Voice& voice) REALTIME {
    if (!voice.ringing()) return;
    if (!voice.render_moments(targets, mono, chunk.frames, floor(chunk))) count(chunk.counters->not_finite);
  });
  if (field) strip.add_to_field(chunk, *field);
  if (late) render_late(chunk, workspace);
  if (begin < chunk.frames && keep_sane({mono + begin, chunk.frames - begin}, voices, chunk)) {
    strip.add_samples(mono, begin, chunk.frames, chunk, workspace.sums);
  }
}

// The chunk's remaining strikes, and what drives the object.
void Object::render_late(const Chunk& chunk, Workspace& workspace) REALTIME {
  Voice* const voice = voices.current();
  const bool driven = this->driven(chunk);
  bool struck = driven;
  std::size_t at = 0;
  const auto render_to = [&](std::size_t end) REALTIME {
    hear(at, end, chunk);
    pickups.listen(at, chunk, voices, workspace);
    if (driven) {
      drive(at, end, chunk, workspace);
    } else if (struck && end > at && !voice->render_late(workspace.mono.data() + at, end - at)) {
      count(chunk.counters->not_finite);
    }
    at = end;
  };
  for (const DueEvent* event = due.first; play_next(chunk, workspace); event = due.first) {
    render_to(event->offset);
    if (!excites(event->event)) {
      play(event->event, chunk);
      continue;
    }
    bool played = false;
    const auto strike = [&]<class One>(const One& one) REALTIME {
      if constexpr (One::kEffect == Effect::excites) {
        played = voice && voice->strike_late(one, chunk.frames - at, chunk.counters);
      }
    };
    visit_now(strike, event->event.verb);
    count(played ? chunk.counters->strikes : chunk.counters->refused);
    struck = struck || played;
  }
  render_to(chunk.frames);
  if (struck) voice->merge_late();
}

void Object::begin_touched(const Chunk& chunk, Workspace& workspace) REALTIME {
  workspace.counts.look_terms += placement.begin_chunk(chunk, voices, strip);
  pickups.begin(chunk);
}

void Object::render_touched(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace,
                            const TouchForces& touch) REALTIME {
  double* const mono = workspace.mono.data();
  std::fill_n(mono + begin, end - begin, 0.0);
  hear(begin, end, chunk);
  pickups.listen(begin, chunk, voices, workspace);
  voices.for_each([&](Voice& voice) REALTIME {
    const bool current = &voice == voices.current();
    if (!current && !voice.ringing()) return;
    const bool sane = current ? TouchedStates(voice).render(touch, mono + begin, end - begin)
                              : voice.render(mono + begin, end - begin, floor(chunk));
    if (!sane) count(chunk.counters->not_finite);
  });
  for (std::size_t n = begin; n < end; ++n) mono[n] -= touch.leaning[n - begin];
  if (keep_sane({mono + begin, end - begin}, voices, chunk)) {
    strip.add_samples(mono, begin, end, chunk, workspace.sums);
  }
}

void Object::end_touched(const Chunk& chunk, Workspace& workspace) REALTIME {
  pickups.end(chunk, voices, workspace);
  placement.end_chunk(chunk, voices);
  end_fan(chunk);
  voices.for_each([&](const Voice& voice) REALTIME {
    if (!voice.ringing()) return;
    ++workspace.counts.voices;
    workspace.counts.add(voice.counts());
  });
}

void Object::drive(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace) REALTIME {
  if (begin == end) return;
  std::array<Force, kMaxForces> forces;
  std::size_t acting = 0;
  for (Exciter* exciter : exciters.all()) {
    const float* const samples = exciter->input ? chunk.inputs[*exciter->input] : nullptr;
    double* const impulses = workspace.impulses[acting].data();
    exciter->fill(chunk.begin + static_cast<Frame>(begin), end - begin, samples ? samples + begin : nullptr, impulses);
    forces[acting++] = {exciter->amplitudes.get(), impulses};
  }
  const double chunks = static_cast<double>(end - begin) / static_cast<double>(kChunkFrames);
  chunk.shedding->worked(kDrivePerMode * chunks * static_cast<double>(voices.current()->table().columns()), workspace);
  const bool sane = voices.current()->render_late(workspace.mono.data() + begin, end - begin,
                                                  std::span<const Force>(forces.data(), acting));
  if (!sane) count(chunk.counters->not_finite);
}

void Object::apply_threshold(const Chunk& chunk, Workspace& workspace) REALTIME {
  if (!chunk.shedding->active()) return;
  const double gain = strip.max_gain();
  const Level level = level_of(gain * gain);
  voices.for_each([&](Voice& voice) REALTIME { chunk.shedding->apply(voice, level, look_again, workspace); });
}

void Object::skip(const Chunk& chunk, Workspace& workspace) REALTIME {
  voices.for_each([&](Voice& voice) REALTIME {
    if (voice.ringing()) voice.mute_all(chunk.frames), workspace.counts.shed = true;
    workspace.counts.add(voice.counts());
  });
}

void Object::prepare(const Chunk& chunk) REALTIME {
  voices.for_each([&](const Voice& voice) REALTIME { voice.table().prepare(chunk.frames); });
}

void Object::count_levels(const Chunk& chunk, LevelHistogram& histogram) REALTIME {
  const double gain = strip.max_gain();
  voices.for_each([&](Voice& voice) REALTIME { voice.count_levels(histogram, level_of(gain * gain), floor(chunk)); });
}

ModeStates::Counts Object::counts() const REALTIME {
  ModeStates::Counts all;
  voices.for_each([&all](const Voice& voice) REALTIME { all.add(voice.counts()); });
  return all;
}

bool Object::ringing() const REALTIME {
  return voices.has_tails() || (voices.current() && voices.current()->ringing());
}

bool Object::can_share(Frame now) const REALTIME {
  const Voice* const voice = voices.current();
  const InstanceGroup* const group = voice ? voice->table().instances : nullptr;
  if (voice && voice->table().glide) return false;  // its pitch depends on its own amplitude
  if (!group || touched || fan.on() || pickups.any() || voices.has_tails() || !exciters.all().empty() ||
      voice->counts().fading)
    return false;
  // Gains are part of the group's sums, and what is absurdly loud should not depend on sharing.
  if (std::abs(strip.final_gain()) > kMaxSharedGain) return false;
  return group->accepts(strip.bus()) && strip.still_at(now);
}

double Object::units_of(std::size_t verb) const REALTIME {
  if (!voices.current() || verb == Verbs::index_of<verb::Click>()) return 0;
  const auto modes = static_cast<double>(voices.current()->table().columns());
  if (effect_of(verb) == Effect::excites) return (member.shares_states ? kSharedStrikePerMode : kStrikePerMode) * modes;
  return member.shares_states ? kJoinPerMode * modes : 0.0;
}

double Object::units_to_share() const REALTIME {
  return kJoinPerMode * static_cast<double>(voices.current()->table().columns());
}

double Object::peak_level(Frame now, std::size_t& looked_at) const REALTIME {
  const double gain = std::abs(strip.gain_at(now));
  if (member.shares_states) {
    const Voice& voice = *voices.current();
    if (!voice.table().instances->keeps_states_of(member)) return 0;
    looked_at += voice.table().columns();
    return gain * voice.peak_level(std::max<Frame>(now - member.anchor, 1));
  }
  double sum = 0;
  voices.for_each([&](const Voice& voice) REALTIME {
    if (!voice.ringing()) return;
    looked_at += voice.table().columns();
    sum += voice.peak_level(0);
  });
  return gain * sum;
}

std::size_t Object::write_amplitudes(Frame now, ModeWatch::Slot& to) const REALTIME {
  const Voice* const voice = voices.current();
  to.bank.store(voice ? &voice->table().bank() : nullptr, std::memory_order_relaxed);
  if (!voice) return 0;
  const std::size_t modes = voice->table().bank().mode_count();
  for (std::size_t m = 0; m < modes; ++m) to.amplitudes.get()[m].store(0, std::memory_order_relaxed);
  const double gain = std::abs(strip.gain_at(now));
  if (!member.shares_states) {
    voice->add_amplitudes(gain, 0, to);
  } else if (voice->table().instances->keeps_states_of(member)) {
    voice->add_amplitudes(gain, now - member.anchor, to);
  }
  return modes;
}

}  // namespace ringdown::synth
