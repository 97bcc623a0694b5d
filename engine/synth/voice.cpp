#include "engine/synth/voice.h"

#include <limits>
#include <utility>

namespace ringdown::synth {

Voice::Voice(std::shared_ptr<ModeTable> table)
    : Ringing(*table),
      table_(std::move(table)),
      scratch_(table_->bank().mode_count()),
      amplitudes_(aligned_zeros<double>(table_->columns())) {}

Voice::Voice(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material, double sample_rate_hz)
    : Voice(std::make_shared<ModeTable>(std::move(map), material, sample_rate_hz)) {}

bool Voice::strike(const protocol::Event& event) RINGDOWN_REALTIME {
  const std::optional<double> gain = find_amplitudes(event);
  if (gain) add(amplitudes_.get(), *gain);
  return gain.has_value();
}

bool Voice::strike_aside(const protocol::Event& event) RINGDOWN_REALTIME {
  const std::optional<double> gain = find_amplitudes(event);
  if (gain) add_aside(amplitudes_.get(), *gain);
  return gain.has_value();
}

std::optional<double> Voice::find_amplitudes(const protocol::Event& event) RINGDOWN_REALTIME {
  const std::optional<double> energy = table_->strike(event, {scratch_.data(), scratch_.size()}, amplitudes_.get());
  if (!energy) return std::nullopt;
  // Modes that die within the chunk would take the trace of an absurd strike with them: this one stays.
  return *energy <= kAbsurdEnergy ? 1.0 : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace ringdown::synth
