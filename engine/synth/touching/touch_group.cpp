#include "engine/synth/touching/touch_group.h"

#include "engine/synth/modes/counters.h"
#include "engine/synth/modes/sane_samples.h"
#include "engine/synth/objects/shedding.h"
#include "engine/synth/modes/work_cost.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::synth {
namespace {

alignas(64) constexpr std::array<double, kMaxTouchColumns> kZeros{};

constexpr double kMinBowRamp_s = 0.002, kMaxBowRamp_s = 0.05;
constexpr double kMalletLeaves_s = 0.003;  // it has left when it needs so long to come back at its speed
constexpr double kMaxMallet_s = 2;         // and at the latest after that time
constexpr double kRubFade_s = 0.005;       // in which the load goes when no event of a rub has come for long

// Returns the index of a pair of freedoms in the triangle of all pairs.
std::size_t pair_of(std::size_t i, std::size_t j) REALTIME {
  const std::size_t low = std::min(i, j), high = std::max(i, j);
  return high * (high + 1) / 2 + low;
}

// A row of numbers for each freedom.
double* row_of(const AlignedArray<double>& rows, std::size_t freedom) REALTIME {
  return rows.get() + freedom * kTapRow;
}

void end_touch(TouchSlot& touch) REALTIME { touch.used = touch.open = touch.contact.on = false; }

// Adds the samples of static bending to `to`. The sound of a surface follows its acceleration, and a surface that a
// lasting force only bends does not sound. A sample lies between two steps.
void lean(TouchPort& port, const double* force_n, std::size_t frames, std::size_t substeps, double* to) REALTIME {
  double before = port.last_n;
  for (std::size_t n = 0; n < frames; ++n) {
    to[n] += 0.5 * port.leaning * (before + force_n[n * substeps]);
    before = force_n[(n + 1) * substeps - 1];
  }
  port.last_n = before;
}

}  // namespace

TouchGroup::TouchGroup() : taps_(aligned_zeros<double>(kFreedoms * (kFreedoms + 1) / 2 * kTapRow)) {}

void TouchGroup::set(std::span<TouchSlot* const> touches) REALTIME {
  bool fresh = false;
  for (TouchSlot* touch : touches) fresh = std::exchange(touch->fresh, false) || fresh;
  if (!fresh && std::ranges::equal(touches, this->touches())) return;
  std::ranges::copy(touches, touches_.begin());
  touch_count_ = touches.size();
  stale_ = true;
}

ModeStates::Counts TouchGroup::counts() const REALTIME {
  ModeStates::Counts all;
  for (std::size_t b = 0; b < body_count_; ++b) all.add(bodies_[b].object->counts());
  return all;
}

TouchGroup::Body& TouchGroup::body_of(const Object& object) REALTIME {
  return *std::find_if(bodies_.begin(), bodies_.begin() + static_cast<std::ptrdiff_t>(body_count_),
                       [&](const Body& body) REALTIME { return body.object == &object; });
}

ModeArrays TouchGroup::modes_of(const Body& body, const StateArray& states) const REALTIME {
  ModeArrays modes = states.for_kernel(0);
  if (substeps_ > 1) {
    modes.pole_re = body.poles;
    modes.pole_im = body.poles + kMaxTouchColumns;
  }
  return modes;
}

void TouchGroup::play_events(std::size_t offset, const Chunk& chunk) REALTIME {
  for (std::size_t b = 0; b < body_count_; ++b) {
    Object& object = *bodies_[b].object;
    for (; object.due.first && object.due.first->offset <= offset; object.due.first = object.due.first->next) {
      const Event& event = object.due.first->event;
      const auto plays = [&]<class One>(const One& one) REALTIME {
        if constexpr (TwoWay<One>) play_touch(touch_of(one), event.frame, object, chunk);
        if constexpr (!TwoWay<One>) object.play(event, chunk);
        return kEndsContacts<One>;
      };
      if (!visit_now(plays, event.verb)) continue;
      for (TouchSlot* touch : touches()) {
        if (touch->open && touch->involves(object)) end_touch(*touch);  // later ones of the chunk are to come
      }
    }
  }
}

void TouchGroup::play_touch(const Touch& how, Frame frame, const Object& object, const Chunk& chunk) REALTIME {
  const auto slot = std::ranges::find_if(touches(), [&](const TouchSlot* touch) REALTIME {
    return touch->used && touch->sides[0].object == &object && touch->touch.kind == how.kind &&
           touch->touch.number == how.number &&
           (how.kind != Touch::Kind::mallet || (!touch->open && touch->since == frame));
  });
  if (slot == touches().end()) return;
  TouchSlot& touch = **slot;
  const bool begins = !touch.open;
  const bool ends = how.kind == Touch::Kind::couple && !(how.stiffness > 0);
  if (ends) {
    end_touch(touch);
    return;
  }
  const auto ramp_s = begins ? kMinBowRamp_s
                             : std::clamp(static_cast<double>(frame - touch.since) / chunk.sample_rate_hz,
                                          kMinBowRamp_s, kMaxBowRamp_s);
  const auto ramp = static_cast<Frame>(ramp_s * chunk.sample_rate_hz);
  const bool rubs = how.kind == Touch::Kind::rub;
  const bool lifted = (how.kind == Touch::Kind::bow || rubs) && how.force_n == 0;
  if (!lifted) {  // what is lifted stays where it is and keeps its speed
    const Touch last = touch.touch;
    touch.stale = touch.stale || !(last.point_m == how.point_m && last.direction == how.direction &&
                                   last.other_point_m == how.other_point_m && last.to_other == how.to_other &&
                                   last.width_m == how.width_m);
    touch.touch = how;
    if (begins) touch.speed_m_s = {how.speed_m_s, how.speed_m_s, frame, frame};
    touch.speed_m_s.aim(how.speed_m_s, frame, ramp);
    if (rubs) {
      if (begins) {
        touch.relief = Rubbing(how.number, chunk.sample_rate_hz);
        touch.slide_m_s = {};
        touch.raised_m = 0;
      } else {
        Touch& kept = touch.touch;
        kept.force_n = last.force_n;
        kept.mass_kg = last.mass_kg;
        kept.stiffness = last.stiffness;
        kept.friction = last.friction;
        kept.sliding = last.sliding;
      }
      touch.relief.update(frame, how.contact);
      const std::array<Vec3, 2> along = across(how.direction);
      for (std::size_t k = 0; k < along.size(); ++k) {
        touch.slide_m_s[k].aim(dot(how.slide_m_s, along[k]), frame, ramp);
      }
    }
  }
  touch.force_n.aim(how.force_n, frame, ramp);
  touch.since = frame;
  if (!begins) return;
  touch.open = touch.contact.on = true;
  touch.contact.sliding.release();
  touch.contact.pressed.place(-how.gap_m);
  for (TouchSlot::Side& side : touch.sides) {
    for (TouchPort& port : side.ports) port.last_n = 0;
  }
  touch.rigid.at_m = 0;
  touch.rigid.speed_m_s = how.kind == Touch::Kind::mallet ? -how.speed_m_s : 0;
}

// Moves the contact's coordinates through a segment without contact forces. `which` selects normal or tangential ones,
// or both; tangential ones may follow later, only if something touches.
void TouchGroup::move_freely(std::size_t begin, std::size_t frames, const Chunk& chunk, Directions which) REALTIME {
  const bool along = which == Directions::along;
  const std::size_t steps = frames * substeps_;
  for (std::size_t i = 0; i < network_.freedoms() && !along; ++i) std::fill_n(row_of(approach_, i), steps + 1, 0.0);
  for (std::size_t b = 0; b < body_count_; ++b) {
    Body& body = bodies_[b];
    Voice& voice = *body.object->voices.current();
    std::array<const double*, kMaxPlaces> weights{};
    std::array<std::size_t, kMaxPlaces> freedoms{};
    std::array<double*, kMaxPlaces> out{};
    alignas(64) std::array<std::array<double, kMaxTouchSteps + 8>, kMaxPlaces> room;
    std::size_t count = 0;
    for (const TouchSlot* touch : touches()) {
      for (const TouchSlot::Side& side : touch->sides) {
        if (side.object != body.object || !touch->open) continue;
        const std::size_t normals = touch->contact.impact ? 1 : 0,
                          end = which == Directions::normal ? normals : touch->contact.freedoms();
        for (std::size_t k = along ? normals : 0; k < end && count < kFreedoms; ++k, ++count) {
          weights[count] = side.ports[k].weight.get();
          freedoms[count] = touch->first + k;
          out[count] = room[count].data();
        }
      }
    }
    const auto to_move = [&](ModeArrays modes, std::size_t points) REALTIME {
      free_motion(modes, body.table->columns(), {weights.data(), count}, {out.data(), count}, points);
    };
    const ModeArrays modes = modes_of(body, TouchedStates(voice).open());
    const std::size_t places = count;
    if (!along) {
      body.heard_whole = modes.hearing == nullptr && !body.table->glide && body.object->exciters.all().empty();
      weights[count] = kTouchSound.data();
      out[count] = body.sound.data();
      count += body.heard_whole ? 1 : 0;
    }
    if (count > 0) to_move(modes, steps + 1);
    count = places;
    for (std::size_t k = 0; k < count; ++k) {
      double* const to = row_of(approach_, freedoms[k]);
      for (std::size_t n = 0; n <= steps; ++n) to[n] -= room[k][n];
    }
    // An exciter's impulse J takes J A off Im z at once, where A is what an impulse of 1 gives.
    body.exciting_count = 0;
    for (Exciter* exciter : body.object->exciters.all()) {
      double* const impulses = body.impulses[body.exciting_count].data();
      if (!along) {
        const float* const samples = exciter->input ? chunk.inputs[*exciter->input] : nullptr;
        exciter->fill(chunk.begin + static_cast<Frame>(begin), frames, samples ? samples + begin : nullptr, impulses);
      }
      body.exciting[body.exciting_count++] = {exciter->amplitudes.get(), impulses};
      if (count == 0 || std::all_of(impulses, impulses + frames, [](double j) REALTIME { return j == 0; })) {
        continue;
      }
      // The states of an impulse of 1 i: Re (i A p^n) = -(answer to an impulse of 1).
      ModeArrays struck = modes_of(body, TouchedStates(voice).open());
      struck.z_re = const_cast<double*>(kZeros.data());
      struck.z_im = exciter->amplitudes.get();
      to_move(struck, steps + 1);
      for (std::size_t k = 0; k < count; ++k) {
        double* const to = row_of(approach_, freedoms[k]);
        for (std::size_t n = 0; n < frames; ++n) {
          const std::size_t at = n * substeps_;
          for (std::size_t m = 0; at + m <= steps; ++m) to[at + m] += impulses[n] * room[k][m];
        }
      }
    }
  }
  for (const TouchSlot* touch : touches()) {
    if (touch->rigid.kg == 0 || !touch->open || along) continue;
    double* const to = row_of(approach_, touch->first);
    const double curve = 0.5 * touch->rigid.load_n / touch->rigid.kg;
    for (std::size_t n = 0; n <= steps; ++n) {
      const double t = static_cast<double>(n) * step_s_;
      to[n] -= (touch->rigid.speed_m_s + curve * t) * t;
    }
  }
}

// Returns true if nothing touches in a segment, which is then complete.
bool TouchGroup::stays_apart(std::size_t steps) REALTIME {
  for (const TouchSlot* touch : touches()) {
    if (!touch->open) continue;
    if (!touch->contact.impact || touch->touch.kind == Touch::Kind::rub) return false;
    const double* const row = row_of(approach_, touch->first);
    if (touch->contact.pressed.depth_m() + *std::max_element(row, row + steps + 1) - row[0] > 0) return false;
  }
  for (TouchSlot* touch : touches()) {
    if (!touch->open) continue;
    const double* const row = row_of(approach_, touch->first);
    touch->contact.pressed.place(touch->contact.pressed.depth_m() + row[steps] - row[0]);
    touch->contact.sliding.release();
  }
  pushes_.fill(false);
  for (std::size_t i = 0; i < network_.freedoms(); ++i) std::fill_n(row_of(forces_, i), steps, 0.0);
  move_masses(steps);
  return true;
}

// Lets the profiles under a rub press its surfaces together. Of profiles the slope is known; a surface that keeps still
// shall push what rubs by the load times the slope, as a one-way contact does. A spring that the load presses down by d
// does so when the surface is raised by 2/3 d times the slope.
void TouchGroup::raise(TouchSlot& touch, Frame begin, std::size_t frames) REALTIME {
  std::array<double, kMaxTouchSteps> slopes;
  touch.relief.fill_slopes(begin, frames, slopes.data());
  double* const row = row_of(approach_, touch.first);
  const double start = touch.raised_m;
  for (std::size_t n = 0; n < frames; ++n) {
    const double load = touch.force_n.at(begin + static_cast<Frame>(n)) / touch.touch.stiffness;
    const double before = touch.raised_m - start;
    touch.raised_m = 2.0 / 3 * std::cbrt(load * load) * slopes[n];
    for (std::size_t s = 1; s <= substeps_; ++s) {
      const double part = static_cast<double>(s) / static_cast<double>(substeps_);
      row[n * substeps_ + s] += before + part * (touch.raised_m - start - before);
    }
  }
}

// The load of a rub acts on both surfaces as its force does, the other way: what lies still neither falls nor bends the
// surface, and where it is carried to no step of the load is heard. Network and laws see the whole force.
void TouchGroup::find_forces(Frame begin, std::size_t steps) REALTIME {
  const std::size_t freedoms = network_.freedoms();
  std::array<double, kFreedoms> load{};
  std::array<double, kFreedoms> free{}, force{};
  std::array<TapRow, kFreedoms * kFreedoms> rows;
  pushes_.fill(false);
  for (std::size_t s = 0; s < steps; ++s) {
    for (std::size_t i = 0; i < freedoms; ++i) free[i] = row_of(approach_, i)[s + 1] - row_of(approach_, i)[s];
    bool loaded = false;
    for (TouchSlot* touch : touches()) {
      if (!touch->open) continue;
      const Frame frame = begin + static_cast<Frame>(s / substeps_);
      if (touch->touch.kind == Touch::Kind::bow) {
        if (s % substeps_ == 0) touch->contact.load_n = touch->force_n.at(frame);
        free[touch->first] += touch->speed_m_s.at(frame) * step_s_;
      }
      if (touch->touch.kind == Touch::Kind::rub) {
        const std::size_t j = touch->first;
        load[j] = touch->force_n.at(frame);
        loaded = true;
        for (std::size_t i = 0; i < freedoms; ++i) free[i] += load[j] * taps_[pair_of(i, j) * kTapRow];
        for (std::size_t k = 0; k < touch->contact.directions; ++k) {
          free[j + 1 + k] += touch->slide_m_s[k].at(frame) * step_s_;
        }
      }
    }
    const bool works = network_.step({free.data(), freedoms}, step_s_, {force.data(), freedoms});
    for (std::size_t i = 0; i < freedoms; ++i) row_of(forces_, i)[s] = force[i] -= load[i];
    if (!works && !loaded) continue;
    std::size_t count = 0;
    for (std::size_t j = 0; j < freedoms; ++j) {
      if (force[j] == 0) continue;
      pushes_[j] = true;
      for (std::size_t i = 0; i < freedoms; ++i) {
        const std::size_t pair = pair_of(i, j);
        if (coupled_[pair]) rows[count++] = {taps_.get() + pair * kTapRow, row_of(approach_, i) + s + 1, force[j]};
      }
    }
    add_taps({rows.data(), count}, steps - s);
  }
  move_masses(steps);
}

void TouchGroup::move_masses(std::size_t steps) REALTIME {
  for (TouchSlot* touch : touches()) {
    RigidMass& rigid = touch->rigid;
    if (rigid.kg == 0 || !touch->open) continue;
    const double* const push = row_of(forces_, touch->first);
    for (std::size_t s = 0; s < steps; ++s) {
      const double faster = (push[s] + rigid.load_n) / rigid.kg * step_s_;
      rigid.at_m += (rigid.speed_m_s + 0.5 * faster) * step_s_;
      rigid.speed_m_s += faster;
    }
  }
}

void TouchGroup::render_segment(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace) REALTIME {
  const std::size_t frames = end - begin, steps = frames * substeps_;
  // A contact that touched will mostly touch again, so all directions are computed at once, which visits the modes
  // once.
  const bool at_once = touched_;
  move_freely(begin, frames, chunk, at_once ? Directions::all : Directions::normal);
  touched_ = !stays_apart(steps);
  if (touched_) {
    if (!at_once) move_freely(begin, frames, chunk, Directions::along);
    for (TouchSlot* touch : touches()) {
      if (touch->open && touch->touch.kind == Touch::Kind::rub) {
        raise(*touch, chunk.begin + static_cast<Frame>(begin), frames);
      }
    }
    find_forces(chunk.begin + static_cast<Frame>(begin), steps);
    bool sane = true;
    for (std::size_t i = 0; i < network_.freedoms(); ++i) sane = are_sane({row_of(forces_, i), steps}) && sane;
    if (!sane) {  // all of them act on each other, so all end, and what the network knows is found anew
      count(chunk.counters->not_finite);
      for (TouchSlot* touch : touches()) end_touch(*touch);
      stale_ = true;
    }
  }
  double columns = 0;
  for (std::size_t b = 0; b < body_count_; ++b) {
    Body& body = bodies_[b];
    std::array<PortForce, kMaxPortForces> ports;
    std::array<double, kMaxTouchSteps> leaning{};
    std::size_t count = 0;
    for (TouchSlot* touch : touches()) {
      for (TouchSlot::Side& side : touch->sides) {
        if (side.object != body.object || !touch->open) continue;
        for (std::size_t k = 0; k < touch->contact.freedoms() && count < kMaxPortForces; ++k) {
          if (!pushes_[touch->first + k] && side.ports[k].last_n == 0) continue;
          lean(side.ports[k], row_of(forces_, touch->first + k), frames, substeps_, leaning.data());
          if (!pushes_[touch->first + k]) continue;
          double* const force = row_of(forces_, touch->first + k);
          ports[count++] = {side.ports[k].weight.get(), force};
          if (!body.heard_whole) continue;
          const std::size_t padded = (steps + kAnswerPadding - 1) / kAnswerPadding * kAnswerPadding;
          std::fill(force + steps, force + padded, 0.0);
          add_answer(force, side.ports[k].answer.data() + kAnswerPadding, body.sound.data(), padded);
        }
      }
    }
    const TouchForces touch{modes_of(body, TouchedStates(*body.object->voices.current()).open()),
                            {body.exciting.data(), body.exciting_count},
                            {body.response, body.response + kMaxTouchColumns, {ports.data(), count}},
                            substeps_,
                            leaning.data(),
                            body.heard_whole ? body.sound.data() : nullptr};
    body.object->render_touched(begin, end, chunk, workspace, touch);
    columns += static_cast<double>(body.table->columns());
  }
  const double chunks = static_cast<double>(steps) / static_cast<double>(kChunkFrames);
  chunk.shedding->worked(chunks * (kTouchPerMode * columns + kTouchPerContact * static_cast<double>(touch_count_)),
                         workspace);
}

void TouchGroup::close_finished(Frame now) REALTIME {
  for (TouchSlot* touch : touches()) {
    if (!touch->open) continue;
    const Touch& how = touch->touch;
    const bool rubs = how.kind == Touch::Kind::rub;
    const double rate_hz = 1 / (step_s_ * static_cast<double>(substeps_));
    if (rubs && touch->force_n.to != 0 && static_cast<double>(now - touch->since) >= kContactTimeOut_s * rate_hz) {
      touch->force_n.aim(0, now, static_cast<Frame>(kRubFade_s * rate_hz));
    }
    bool over = (rubs || how.kind == Touch::Kind::bow) && touch->force_n.to == 0 && now >= touch->force_n.end;
    if (rubs && touch->contact.pressed.depth_m() > 0) over = false;  // its spring throws it off first
    if (how.kind == Touch::Kind::mallet) {
      const double away = -touch->contact.pressed.depth_m();
      over = (touch->rigid.speed_m_s > 0 && away > kMalletLeaves_s * touch->rigid.speed_m_s) ||
             now - touch->since > static_cast<Frame>(kMaxMallet_s * rate_hz);
    }
    if (over) end_touch(*touch);
  }
}

void TouchGroup::render(const Chunk& chunk, Workspace& workspace) REALTIME {
  refresh(chunk);
  for (std::size_t b = 0; b < body_count_; ++b) bodies_[b].object->begin_touched(chunk, workspace);
  for (std::size_t at = 0; at < chunk.frames;) {
    play_events(at, chunk);
    refresh(chunk);
    std::size_t end = std::min(chunk.frames, at + kMaxTouchSteps / substeps_);
    for (std::size_t b = 0; b < body_count_; ++b) {
      const DueEvent* const next = bodies_[b].object->due.first;
      if (next) end = std::min(end, std::max(next->offset, at + 1));
    }
    render_segment(at, end, chunk, workspace);
    at = end;
  }
  for (std::size_t b = 0; b < body_count_; ++b) bodies_[b].object->end_touched(chunk, workspace);
  close_finished(chunk.end());
}

}  // namespace ringdown::synth
