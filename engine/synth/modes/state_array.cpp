#include "engine/synth/modes/state_array.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::synth {

// Adds -i times the amplitudes, each times its factor.
void StateArray::add_strike(BlowAmplitudes blow, double gain, std::size_t first, std::size_t end,
                            const ModeFactors* each) REALTIME {
  excited();
  double *const re = this->re(), *const im = this->im();
  if (each == nullptr) {
    for (std::size_t i = first; i < end; ++i) im[i] -= gain * blow.re[i];
    if (blow.im == nullptr) return;
    for (std::size_t i = first; i < end; ++i) re[i] += gain * blow.im[i];
    return;
  }
  for (std::size_t i = first; i < end; ++i) {
    re[i] += gain * blow.re[i] * static_cast<double>(each->im[i]);
    im[i] -= gain * blow.re[i] * static_cast<double>(each->re[i]);
  }
  if (blow.im == nullptr) return;
  for (std::size_t i = first; i < end; ++i) {
    re[i] += gain * blow.im[i] * static_cast<double>(each->re[i]);
    im[i] += gain * blow.im[i] * static_cast<double>(each->im[i]);
  }
}

void StateArray::add_strike(BlowAmplitudes blow, double gain, const ModeFactors* each) REALTIME {
  add_strike(blow, gain, 0, table_.columns(), each);
}

void StateArray::add_strike(BlowAmplitudes blow, double gain, std::uint32_t group, const ModeFactors* each) REALTIME {
  const std::size_t first = std::size_t{group} * kModePadding;
  add_strike(blow, gain, first, first + kModePadding, each);
}

void StateArray::add(const StateArray& other, double gain, std::size_t first, std::size_t end,
                     const ModeFactors* each) REALTIME {
  excited();
  double *const re = this->re(), *const im = this->im();
  const double *const from_re = other.re(), *const from_im = other.im();
  if (each == nullptr) {
    for (std::size_t i = first; i < end; ++i) re[i] += gain * from_re[i];
    for (std::size_t i = first; i < end; ++i) im[i] += gain * from_im[i];
    return;
  }
  for (std::size_t i = first; i < end; ++i) {
    const auto by_re = static_cast<double>(each->re[i]), by_im = static_cast<double>(each->im[i]);
    re[i] += gain * (from_re[i] * by_re - from_im[i] * by_im);
    im[i] += gain * (from_re[i] * by_im + from_im[i] * by_re);
  }
}

void StateArray::add(const StateArray& other, double gain, const ModeFactors* each) REALTIME {
  add(other, gain, 0, table_.columns(), each);
}

void StateArray::add(const StateArray& other, double gain, std::uint32_t group, const ModeFactors* each) REALTIME {
  const std::size_t first = std::size_t{group} * kModePadding;
  add(other, gain, first, first + kModePadding, each);
}

bool StateArray::move_from(StateArray& other) REALTIME {
  excited();
  bool left = false;
  for (const auto& [mine, theirs] : {std::pair{re(), other.re()}, std::pair{im(), other.im()}}) {
    for (std::size_t i = 0; i < table_.playable_modes(); ++i) {
      const std::optional<std::size_t> from = other.table_.column_of(table_.mode_of(i));
      mine[table_.column(i)] = from ? std::exchange(theirs[*from], 0.0) : 0.0;
    }
    for (std::size_t i = 0; i < other.table_.columns(); ++i) left = left || theirs[i] != 0;
  }
  return left;
}

void StateArray::move_from(StateArray& other, const modal::ModeTransfer& change) REALTIME {
  excited();
  clear();
  const ModeTable& theirs = other.table_;
  const std::size_t modes = theirs.bank().mode_count();
  // The real part of a state is its displacement times omega, the imaginary part minus its velocity.
  const bool turns = !change.turn.empty();
  for (std::size_t j = 0; j < theirs.playable_modes(); ++j) {
    const double output = theirs.output_per_velocity(j);
    if (!(output > 0)) continue;
    const std::size_t from = theirs.mode_of(j), column = theirs.column(j);
    const double displacement = other.re()[column] / output, velocity = other.im()[column] / output;
    if (displacement == 0 && velocity == 0) continue;
    for (std::size_t i = 0; i < table_.playable_modes(); ++i) {
      const std::size_t at = table_.mode_of(i) * modes + from, to = table_.column(i);
      const double turn = turns ? change.turn[at] : 0, mine = table_.output_per_velocity(i);
      re()[to] += mine * (change.displacement[at] * displacement - turn * velocity);
      im()[to] += mine * (change.velocity[at] * velocity + turn * displacement);
    }
  }
  other.clear();
}

void StateArray::skip(std::uint64_t frames) REALTIME { skip_modes(for_kernel(0), table_.columns(), frames); }

void StateArray::skip(std::uint64_t frames, std::uint32_t group) REALTIME {
  const std::size_t first = std::size_t{group} * kModePadding;
  ModeArrays here = for_kernel(0);
  here.z_re += first;
  here.z_im += first;
  here.pole_re += first;
  here.pole_im += first;
  skip_modes(here, kModePadding, frames);
}

void StateArray::clear() REALTIME { std::fill_n(numbers_.get(), 2 * table_.columns(), 0.0); }

void StateArray::clear(std::uint32_t group) REALTIME {
  const std::size_t first = std::size_t{group} * kModePadding;
  std::fill_n(re() + first, kModePadding, 0.0);
  std::fill_n(im() + first, kModePadding, 0.0);
}

double StateArray::energy(std::uint32_t group) const REALTIME {
  const std::size_t first = std::size_t{group} * kModePadding;
  const double *re = this->re() + first, *im = this->im() + first;
  double sum = 0;
  for (std::size_t i = 0; i < kModePadding; ++i) sum += re[i] * re[i] + im[i] * im[i];
  return sum;
}

double StateArray::amplitude(std::uint32_t group) const REALTIME {
  const std::size_t first = std::size_t{group} * kModePadding;
  double sum = 0;
  for (std::size_t i = first; i < first + kModePadding; ++i) sum += std::sqrt(re()[i] * re()[i] + im()[i] * im()[i]);
  return sum;
}

double StateArray::amplitude() const REALTIME {
  double sum = 0;
  for (std::uint32_t group = 0; group < table_.groups(); ++group) sum += amplitude(group);
  return sum;
}

}  // namespace ringdown::synth
