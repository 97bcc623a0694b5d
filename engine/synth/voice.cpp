#include "engine/synth/voice.h"

#include "engine/synth/meters.h"

#include <limits>
#include <utility>

namespace ringdown::synth {
namespace {

// The factor of a strike's amplitudes. An absurd strike becomes not-a-number, because modes that die within
// the chunk would hide a merely huge one.
double gain_for(double energy, const Voice& voice, MixerCounters* counters) RINGDOWN_REALTIME {
  if (!(energy <= kAbsurdEnergy)) return std::numeric_limits<double>::quiet_NaN();
  const double limit = voice.blow_limit(voice.amplitudes());
  if (limit < 1 && counters) count(counters->limited);
  return limit;
}

}  // namespace

Voice::Voice(std::shared_ptr<ModeTable> table)
    : ModeStates(*table),
      table_(std::move(table)),
      scratch_(table_->bank().mode_count()),
      amplitudes_(aligned_zeros<double>(table_->columns())) {}

Voice::Voice(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material, double sample_rate_hz)
    : Voice(std::make_shared<ModeTable>(std::move(map), material, sample_rate_hz)) {}

std::unique_ptr<Voice> Voice::with_table(std::shared_ptr<ModeTable> table) {
  auto voice = std::make_unique<Voice>(std::move(table));
  voice->take_over(*this);
  return voice;
}

bool Voice::strike(const Event& event, MixerCounters* counters) RINGDOWN_REALTIME {
  const std::optional<double> energy = find_amplitudes(event);
  if (energy) add(amplitudes(), gain_for(*energy, *this, counters));
  return energy.has_value();
}

bool Voice::strike_late(const Event& event, std::size_t frames_left, MixerCounters* counters) RINGDOWN_REALTIME {
  const std::optional<double> energy = find_amplitudes(event);
  if (energy) add_late(amplitudes(), gain_for(*energy, *this, counters), frames_left);
  return energy.has_value();
}

}  // namespace ringdown::synth
