#include "engine/synth/modes/probes.h"

#include <algorithm>

namespace ringdown::synth {
namespace {

// How a probe hears modes. Where a listener hears them Doppler-shifted, the states run in that shifted time, and so
// does the probe.
Hearing hearing_of(const Probes::One& probe, const ModeArrays& modes) REALTIME {
  Hearing hearing{.gain_re = probe.gain_re, .gain_im = probe.gain_im};
  if (modes.hearing == nullptr) return hearing;
  hearing.rate = modes.hearing->rate;
  hearing.log_re = modes.hearing->log_re;
  hearing.log_im = modes.hearing->log_im;
  return hearing;
}

// Lets a kernel work on the copy of all states.
void copy_all(const StateArray& states, double* spare, ModeArrays& modes) REALTIME {
  const std::size_t columns = states.table().columns();
  std::copy_n(states.re(), 2 * columns, spare);
  modes.z_re = spare;
  modes.z_im = spare + columns;
}

}  // namespace

void Probes::ring(const One& probe, const StateArray& states, ActiveGroups groups, double* out,
                  std::size_t frames) const REALTIME {
  const std::size_t columns = states.table().columns();
  ModeArrays modes = states.for_kernel(frames);
  modes.z_re = spare_;
  modes.z_im = spare_ + columns;
  const Hearing hearing = hearing_of(probe, modes);
  modes.hearing = &hearing;
  if (hearing.rate != 1) std::fill_n(spare_, 2 * columns, 0.0);  // drive_modes() visits groups that do not sound, too
  for (std::size_t i = 0; i < groups.count; ++i) {
    const std::size_t first = std::size_t{groups.list[i]} * kModePadding;
    std::copy_n(states.re() + first, kModePadding, modes.z_re + first);
    std::copy_n(states.im() + first, kModePadding, modes.z_im + first);
  }
  if (hearing.rate != 1) {
    drive_modes(modes, columns, {}, out, frames);
  } else if (groups.count > 0) {
    static_cast<void>(render_modes(modes, groups, kKeepAllGroups, out, frames));
  }
}

void Probes::ring(const StateArray& states, ActiveGroups groups, std::size_t frames) const REALTIME {
  for (const One& probe : all()) ring(probe, states, groups, probe.to, frames);
}

void Probes::drive(const StateArray& states, std::span<const Force> forces, std::size_t frames) const REALTIME {
  for (const One& probe : all()) {
    ModeArrays modes = states.for_kernel(0);
    copy_all(states, spare_, modes);
    const Hearing hearing = hearing_of(probe, modes);
    modes.hearing = &hearing;
    drive_modes(modes, states.table().columns(), forces, probe.to, frames);
  }
}

void Probes::touch(const StateArray& states, const ModeArrays& modes, std::span<const Force> forces,
                   const PortForces& ports, std::size_t frames, std::size_t substeps) const REALTIME {
  for (const One& probe : all()) {
    ModeArrays stepped = modes;
    copy_all(states, spare_, stepped);
    const Hearing hearing{.gain_re = probe.gain_re, .gain_im = probe.gain_im};
    stepped.hearing = &hearing;
    drive_touched(stepped, states.table().columns(), forces, ports, probe.to, frames, substeps);
  }
}

}  // namespace ringdown::synth
