#include "engine/synth/modes/mode_states.h"

#include "engine/synth/modes/blow_limit.h"
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <tuple>

// The life of a group of modes
//
// A group sounds while it stands in slow_ or fast_, the lists that the kernels go through; a kernel takes it off its
// list once all its modes lie below the floor, and then it rests. As a rule a strike wakes all groups (wake()): it
// excites nearly every mode, and the kernel drops within one chunk what it left below the floor.
//
// Only while there is a threshold, or something is muted, is each group decided by itself (Muting::chooses).
// apply_threshold() moves slow groups below the threshold to muting_.leaving, which are rendered once more, under a
// ramp to zero, before they are muted; what lies above the threshold by kHysteresis comes back through
// muting_.entering. A strike on a muted group first moves the group's states to the present frame, adds its amplitudes,
// and measures the level again: if that reaches the threshold, the group sounds at once, without a ramp, as any struck
// mode does.
//
// A chunk by moments is rendered as a whole, before the strikes within it are played. Such late strikes have states of
// their own (late_), which ring by tables from the strike's frame to the end of the chunk; there merge_late() adds them
// to the states, which have reached that frame, too.
namespace ringdown::synth {
namespace {

constexpr Level kHysteresis = 3;  // 1.1 dB: what wavers about the threshold does not come and go

// Adds a strike's amplitudes to a group as the strike will be after `frames_left` frames.
void add_decayed(BlowAmplitudes blow, double gain, std::uint32_t group, std::size_t frames_left,
                 const ModeFactors* each, StateArray& states) REALTIME {
  alignas(64) double re[kModePadding], im[kModePadding];
  const std::size_t first = std::size_t{group} * kModePadding;
  for (std::size_t i = 0; i < kModePadding; ++i) {
    const std::complex<double> a = gain * std::complex(blow.im ? blow.im[first + i] : 0, -blow.re[first + i]);
    const std::complex<double> by(each ? each->re[first + i] : 1, each ? each->im[first + i] : 0);
    re[i] = a.real() * by.real() - a.imag() * by.imag();
    im[i] = a.real() * by.imag() + a.imag() * by.real();
  }
  ModeArrays struck = states.for_kernel(0);
  struck.z_re = re;
  struck.z_im = im;
  struck.pole_re += first;
  struck.pole_im += first;
  skip_modes(struck, kModePadding, frames_left);
  states.excited();
  for (std::size_t i = 0; i < kModePadding; ++i) {
    states.re()[first + i] += re[i];
    states.im()[first + i] += im[i];
  }
}

// Tables cannot shift pitches: all fast modes, from column `first` on, are moved on sample by sample.
bool drive_fast(const ModeArrays& all, std::size_t first, std::size_t columns, double* out,
                std::size_t frames) REALTIME {
  Hearing hearing = *all.hearing;
  for (const float** row : {&hearing.gain_re, &hearing.gain_im, &hearing.step_re, &hearing.step_im}) {
    if (*row != nullptr) *row += first;
  }
  hearing.log_re += first;
  hearing.log_im += first;
  ModeArrays fast = all;
  fast.z_re += first;
  fast.z_im += first;
  fast.pole_re += first;
  fast.pole_im += first;
  fast.hearing = &hearing;
  return drive_modes(fast, columns - first, {}, out, frames) <= kAbsurdEnergy;
}

// Renders the modes that exchange energy, whose states are zero meanwhile. Modes that are heard by gains of their own
// stay in the kernels, and so do all while modes are muted.
Coupling::Outcome couple(Coupling& coupling, StateArray& states, bool muting, double* out, std::size_t frames,
                         std::span<const Probes::One> probes) REALTIME {
  if (!coupling.possible()) return Coupling::Outcome::nothing;
  const bool allowed = !muting && states.for_kernel(0).hearing == nullptr;
  return coupling.render(states.re(), states.im(), allowed, out, frames, probes);
}

// Adds what the probes feel of all that sounds in the next frames.
void feel(const Probes& probes, const StateArray& states, const std::array<ActiveGroups, 2>& sounding, FadeOut& fade,
          Muting& muting, std::size_t frames) REALTIME {
  for (const ActiveGroups& groups : sounding) probes.ring(states, groups, frames);
  if (fade.running()) fade.feel(probes, frames);
  if (muting.changing()) muting.feel(states, probes, frames);
}

}  // namespace

ModeStates::ModeStates(const ModeTable& table)
    : coupling(table),
      gains(table),
      table_(table),
      states_(table),
      sounding_(table.groups()),
      fade_(table),
      late_(table),
      muting_(table),
      is_(table.groups()) {
  if (table.heard_columns().tube_shares != nullptr) tube_gains_ = aligned_zeros<float>(4 * table.columns());
  states_.let_glide();
  slow_.list = sounding_.data();
  fast_.list = sounding_.data() + table.slow_groups();
}

void ModeStates::hear(const HeardTime* time) REALTIME {
  if (time) {
    gains.put(hearing_, time->offset);
    hearing_.rate = time->rate;
    hearing_.bend = time->bend;
    std::tie(hearing_.log_re, hearing_.log_im) = states_.exponents();
  } else {
    gains.switch_off();
  }
  const Hearing* const hearing = time ? &hearing_ : nullptr;
  states_.hear_by(hearing);
  fade_.hear_by(hearing);
  late_.hear_by(hearing);
}

void ModeStates::hear_tube(double from, double to, std::size_t frames) REALTIME {
  const float* const share = table_.heard_columns().tube_shares;
  if (share == nullptr) return;
  const Hearing before = hearing_;
  const std::size_t columns = table_.columns();
  const auto length = static_cast<float>(frames);
  const auto first = static_cast<float>(1 - from), last = static_cast<float>(1 - to);
  const auto line = [&](const float* gain, const float* step, float otherwise, float* new_gain,
                        float* new_step) REALTIME {
    for (std::size_t c = 0; c < columns; ++c) {
      const float slope = step ? step[c] : 0, at_first = gain ? gain[c] + before.offset * slope : otherwise;
      const float begins = at_first * (1 - share[c] * first);
      new_gain[c] = begins;
      new_step[c] = ((at_first + length * slope) * (1 - share[c] * last) - begins) / length;
    }
  };
  float* const rows = tube_gains_.get();
  line(before.gain_re, before.step_re, 1, rows, rows + 2 * columns);
  line(before.gain_im, before.step_im, 0, rows + columns, rows + 3 * columns);
  hearing_.gain_re = rows, hearing_.gain_im = rows + columns;
  hearing_.step_re = rows + 2 * columns, hearing_.step_im = rows + 3 * columns;
  hearing_.offset = 0;
}

void ModeStates::add(BlowAmplitudes blow, double gain, const ModeFactors* each) REALTIME {
  if (muting_.chooses(threshold_)) {
    return add_to_groups([&](std::uint32_t group) REALTIME { states_.add_strike(blow, gain, group, each); });
  }
  states_.add_strike(blow, gain, each);
  wake();
}

double ModeStates::blow_limit(const double* amplitudes) const REALTIME {
  if (!table_.glide) return 1;
  std::array<float, kMaxGlidingModes> squares{};
  const std::vector<std::uint32_t>& columns = table_.glide->columns;
  for (std::size_t m = 0; m < columns.size(); ++m) {
    const double re = states_.re()[columns[m]], im = states_.im()[columns[m]];
    squares[m] = static_cast<float>(re * re + im * im);
  }
  coupling.add_squares(squares.data());
  return synth::blow_limit(*table_.glide, squares.data(), amplitudes);
}

void ModeStates::add(ModeStates& other, double gain, const ModeFactors* each) REALTIME {
  assert(&table_ == &other.table_);
  other.unmute();
  if (other.coupling.give_back(other.states_.re(), other.states_.im())) other.wake();
  if (muting_.chooses(threshold_)) {
    return add_to_groups([&](std::uint32_t group) REALTIME { states_.add(other.states_, gain, group, each); });
  }
  states_.add(other.states_, gain, each);
  wake();
}

// Adds something to every group while some are muted: what sounded goes on sounding, and any other group sounds if it
// is now loud enough, and is muted if it is not.
template <class Add>
void ModeStates::add_to_groups(const Add& add_to) REALTIME {
  settle();
  mark();
  muting_.muted.clear();
  for (std::uint32_t group = 0; group < table_.groups(); ++group) {
    const Is before = is_[group];
    if (before == Is::muted) muting_.catch_up(states_, group);
    add_to(group);
    if (before == Is::sounding) continue;
    if (group >= table_.slow_groups() || level_of(states_.energy(group)) >= threshold_) {
      list(group);
    } else {
      muting_.mute(states_, group);
    }
  }
}

bool ModeStates::take_over(ModeStates& other, const modal::ModeTransfer* change) REALTIME {
  unmute();
  other.unmute();
  if (coupling.give_back(states_.re(), states_.im())) wake();
  if (other.coupling.give_back(other.states_.re(), other.states_.im())) other.wake();
  bool left = change == nullptr && states_.move_from(other.states_);
  if (change != nullptr) states_.move_from(other.states_, *change);
  left = fade_.move_from(other.fade_, change) || left;
  if (other.slow_.count + other.fast_.count > 0) wake();
  return left;
}

void ModeStates::fade_out(const Fading& fade) REALTIME {
  unmute();
  if (coupling.give_back(states_.re(), states_.im())) wake();
  fade_.begin(states_, fade);
  rest();
}

// Lets the probes feel what rings freely in the next `frames`.
bool ModeStates::render(double* out, std::size_t frames, double floor) REALTIME {
  const Coupling::Outcome coupled = couple(coupling, states_, muting_.chooses(threshold_), out, frames, probes.all());
  if (coupled == Coupling::Outcome::ended) wake();
  states_.follow(false);
  if (!probes.all().empty()) feel(probes, states_, {slow_, fast_}, fade_, muting_, frames);
  const EnergyLimits limits{floor * floor, kAbsurdEnergy};
  bool sane = (!fade_.running() || fade_.render(out, frames)) && coupled != Coupling::Outcome::absurd;
  for (ActiveGroups* groups : {&slow_, &fast_}) {
    if (groups->count > 0) sane = render_modes(states_.for_kernel(frames), *groups, limits, out, frames) && sane;
  }
  if (muting_.changing()) sane = muting_.render_changes(states_, out, frames) && sane;
  muting_.advance(states_, frames, slow_);
  if (!sane) silence();
  return sane;
}

bool ModeStates::render_moments(std::span<const MomentTarget> targets, double* out, std::size_t frames,
                                double floor) REALTIME {
  const Coupling::Outcome coupled = couple(coupling, states_, muting_.chooses(threshold_), out, frames, probes.all());
  if (coupled == Coupling::Outcome::ended) wake();
  states_.follow(true);
  if (!probes.all().empty()) feel(probes, states_, {slow_, fast_}, fade_, muting_, frames);
  const EnergyLimits limits{floor * floor, kAbsurdEnergy};
  const ModeArrays all = states_.for_kernel(frames);
  bool sane = (!fade_.running() || fade_.render(out, frames)) && coupled != Coupling::Outcome::absurd;
  if (fast_.count > 0 && all.hearing != nullptr && (all.hearing->rate != 1 || all.hearing->step_re != nullptr)) {
    sane = drive_fast(all, kModePadding * table_.slow_groups(), table_.columns(), out, frames) && sane;
  } else if (fast_.count > 0) {
    sane = render_modes(all, fast_, limits, out, frames) && sane;
  }
  if (slow_.count > 0) sane = add_moments(all, states_.moments(), slow_, frames, limits, targets) && sane;
  if (muting_.changing()) sane = muting_.render_changes(states_, targets, frames) && sane;
  muting_.advance(states_, frames, slow_);
  if (!sane) silence();
  return sane;
}

void ModeStates::add_late(BlowAmplitudes blow, double gain, std::size_t frames_left, const ModeFactors* each) REALTIME {
  if (!muting_.chooses(threshold_)) return late_.add(blow, gain, each);
  mark();
  for (std::uint32_t group = 0; group < table_.groups(); ++group) {
    double energy = 0;  // before direction
    for (const double* const a : {blow.re, blow.im}) {
      if (a == nullptr) continue;
      const double* const of_group = a + std::size_t{group} * kModePadding;
      for (std::size_t i = 0; i < kModePadding; ++i) energy += gain * gain * of_group[i] * of_group[i];
    }
    const bool sounds = is_[group] == Is::sounding || late_.has(group) || group >= table_.slow_groups() ||
                        level_of(energy) >= threshold_;
    if (sounds) {
      late_.add(blow, gain, group, each);
    } else if (is_[group] == Is::muted) {  // muting_ has reached the end of the chunk
      muting_.catch_up(states_, group);
      add_decayed(blow, gain, group, frames_left, each, states_);
      muting_.measure(states_, group);
    } else {
      add_decayed(blow, gain, group, frames_left, each, states_);
      muting_.mute(states_, group);
    }
  }
}

bool ModeStates::render_late(double* out, std::size_t frames, std::optional<std::span<const Force>> forces) REALTIME {
  if (forces) {
    probes.drive(late_.states(), *forces, frames);
  } else {
    probes.ring(late_.states(), late_.active(), frames);
  }
  const bool sane = forces ? late_.drive(*forces, out, frames) : late_.render(out, frames);
  if (!sane) silence();
  return sane;
}

void ModeStates::merge_late() REALTIME {
  if (late_.has_all() && muting_.groups() == 0) {
    states_.add(late_.states(), 1);
    wake();
    return late_.clear();
  }
  mark();
  for (const std::uint32_t group : late_.groups()) {
    if (is_[group] == Is::muted) muting_.catch_up(states_, group);
    states_.add(late_.states(), 1, group);
    if (is_[group] == Is::sounding) continue;
    list(group);
    is_[group] = Is::sounding;
  }
  muting_.muted.keep_if([this](std::uint32_t group) REALTIME { return is_[group] == Is::muted; });
  late_.clear();
}

void ModeStates::apply_threshold(std::size_t& allowance, bool at_once) REALTIME {
  applied_ = threshold_;
  if (!muting_.chooses(threshold_)) return;
  cut_short_ = cut_short_ || at_once;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < slow_.count; ++i) {
    const std::uint32_t group = slow_.list[i];
    if (level_of(states_.energy(group)) >= threshold_) {
      slow_.list[kept++] = group;
    } else if (at_once) {
      muting_.mute(states_, group);
    } else {
      muting_.leaving.push(group);
    }
  }
  slow_.count = kept;
  if (allowance < kModePadding) return;
  muting_.muted.keep_if([&](std::uint32_t group) REALTIME {
    if (allowance < kModePadding) return true;
    if (threshold_ != kNoThreshold && muting_.level(group) < threshold_ + kHysteresis) return true;
    allowance -= kModePadding;
    muting_.catch_up(states_, group);
    muting_.entering.push(group);
    return false;
  });
  cut_short_ = cut_short_ && allowance < kModePadding;
}

void ModeStates::mute_all(std::size_t frames) REALTIME {
  settle();
  if (coupling.give_back(states_.re(), states_.im())) wake();
  cut_short_ = true;
  for (std::size_t i = 0; i < slow_.count; ++i) muting_.mute(states_, slow_.list[i]);
  slow_.count = 0;
  for (std::size_t i = 0; i < fast_.count; ++i) states_.skip(frames, fast_.list[i]);
  if (fade_.running()) fade_.skip(frames);
  muting_.advance(states_, frames, slow_);
}

void ModeStates::count_levels(LevelHistogram& histogram, Level gain, double floor) REALTIME {
  settle();
  for (const ActiveGroups* groups : {&slow_, &fast_}) {
    for (std::size_t i = 0; i < groups->count; ++i) histogram.add(level_of(states_.energy(groups->list[i])) + gain);
  }
  const Level lowest = level_of(floor * floor);
  muting_.muted.keep_if([&](std::uint32_t group) REALTIME {
    const Level level = muting_.level(group);
    if (level >= lowest) return histogram.add(level + gain), true;
    muting_.forget(states_, group);
    return false;
  });
}

void ModeStates::skip(Frame frames) REALTIME {
  unmute();
  if (coupling.give_back(states_.re(), states_.im())) wake();
  if (frames > 0) states_.skip(static_cast<std::uint64_t>(frames));
}

void ModeStates::rest() REALTIME {
  unmute();
  if (coupling.give_back(states_.re(), states_.im())) wake();
  threshold_ = applied_ = kNoThreshold;
  slow_.count = fast_.count = 0;
}

void ModeStates::wake() REALTIME {
  unmute();
  states_.excited();
  slow_.count = table_.slow_groups();
  fast_.count = table_.groups() - slow_.count;
  std::iota(slow_.list, slow_.list + table_.groups(), 0);
}

void ModeStates::list(std::uint32_t group) REALTIME {
  ActiveGroups& groups = group < table_.slow_groups() ? slow_ : fast_;
  groups.list[groups.count++] = group;
}

// Lets groups that were about to leave or enter by a ramp sound from now on.
void ModeStates::settle() REALTIME {
  for (GroupList* groups : {&muting_.leaving, &muting_.entering}) {
    for (const std::uint32_t group : *groups) list(group);
    groups->clear();
  }
}

// Lets all groups that are muted sound from now on.
void ModeStates::unmute() REALTIME {
  settle();
  for (const std::uint32_t group : muting_.muted) {
    muting_.catch_up(states_, group);
    list(group);
  }
  muting_.muted.clear();
}

// Notes in is_ what each group does.
void ModeStates::mark() REALTIME {
  std::fill_n(is_.data(), is_.size(), Is::resting);
  for (const ActiveGroups* groups : {&slow_, &fast_}) {
    for (std::size_t i = 0; i < groups->count; ++i) is_[groups->list[i]] = Is::sounding;
  }
  for (const std::uint32_t group : muting_.muted) is_[group] = Is::muted;
}

void ModeStates::silence() REALTIME {
  if (coupling.give_back(states_.re(), states_.im())) wake();
  coupling.cut_off();
  states_.clear();
  fade_.clear();
  late_.clear();
  muting_.clear();
  slow_.count = fast_.count = 0;
}

double ModeStates::peak_level(Frame rested) const REALTIME {
  double sum = 0;
  const auto add = [&](std::uint32_t group, Frame behind) REALTIME {
    const double decay = static_cast<double>(behind) * table_.slowest_decay(group);
    sum += (behind > 0 ? std::exp(-decay) : 1.0) * states_.amplitude(group);
  };
  if (rested > 0) {
    for (std::uint32_t group = 0; group < table_.groups(); ++group) add(group, rested);
    return sum;
  }
  for (const ActiveGroups* groups : {&slow_, &fast_}) {
    for (std::size_t i = 0; i < groups->count; ++i) add(groups->list[i], 0);
  }
  for (const GroupList* groups : {&muting_.muted, &muting_.leaving, &muting_.entering}) {
    for (const std::uint32_t group : *groups) add(group, muting_.frames_behind(group));
  }
  sum += coupling.amplitude();
  if (fade_.running()) sum += fade_.level() * fade_.states().amplitude();
  return sum;
}

void ModeStates::add_amplitudes(double gain, Frame rested, ModeWatch::Slot& to) const REALTIME {
  const ModeArrays all = states_.for_kernel(0), fading = fade_.states().for_kernel(0);
  const auto square = [](double re, double im) REALTIME { return re * re + im * im; };
  const double fade = fade_.running() ? fade_.level() : 0.0;
  for (std::size_t i = 0; i < table_.playable_modes(); ++i) {
    const std::size_t c = table_.column(i);
    const auto group = static_cast<std::uint32_t>(c / kModePadding);
    double amplitude = std::sqrt(square(all.z_re[c], all.z_im[c]));
    const Frame behind = rested + muting_.frames_behind(group);
    if (behind > 0 && amplitude > 0) {
      amplitude *= std::pow(square(all.pole_re[c], all.pole_im[c]), 0.5 * static_cast<double>(behind));
    }
    if (fade > 0) amplitude += fade * std::sqrt(square(fading.z_re[c], fading.z_im[c]));
    if (amplitude > 0) to.add(table_.mode_of(i), gain * amplitude);
  }
}

}  // namespace ringdown::synth
