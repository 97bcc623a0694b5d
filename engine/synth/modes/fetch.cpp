#include "engine/synth/modes/fetch.h"

#include "engine/synth/modes/voice.h"

#include <cstdint>

namespace ringdown::synth {
namespace {

// Asks for what lies from one member up to another.
void fetch_between(const void* from, const void* to) REALTIME {
  fetch_range(from, reinterpret_cast<std::uintptr_t>(to) - reinterpret_cast<std::uintptr_t>(from));
}

}  // namespace

void VoiceFetch::fetch(const Voice& voice, FetchStage stage, std::size_t frames) REALTIME {
  const ModeStates& states = voice;
  if (stage == FetchStage::voice) {  // all but probes and late strikes
    fetch_range(&states.coupling, 1);
    fetch_between(&states.gains, &states.late_);
    fetch_between(&states.muting_, &voice + 1);
    return;
  }
  const ModeTable& table = voice.table();
  if (stage == FetchStage::table) return fetch_range(&table, sizeof table);
  const ModeArrays modes = table.modes(states.states_.re(), states.states_.im(), frames);
  fetch_range(modes.z_re, 2 * table.columns() * sizeof(double));  // real and imaginary parts
  if (modes.advance_re != nullptr) fetch_range(modes.advance_re, 2 * table.columns() * sizeof(double));
  fetch_range(states.slow_.list, states.slow_.count * sizeof(std::uint32_t));
  const MomentArrays moments = table.moments();
  fetch_range(moments.band, table.slow_modes() * sizeof *moments.band);
  fetch_range(moments.weights, table.slow_modes() * 2 * kMoments * sizeof *moments.weights);
}

}  // namespace ringdown::synth
