#include "engine/synth/listening/pickups.h"

#include "engine/synth/modes/counters.h"
#include "engine/synth/modes/sane_samples.h"
#include "engine/synth/modes/work_cost.h"

#include <algorithm>
#include <cmath>

namespace ringdown::synth {
namespace {

constexpr double kFelt = 1e-6;  // amplitudes 120 dB below what is heard may still be felt

bool is_sane(const verb::Pickup& how) REALTIME {
  return how.number >= 1 && how.number <= kMaxPickups && how.motion <= 2 && is_finite(how.point_m) &&
         is_finite(how.direction) && std::isfinite(how.gain);
}

}  // namespace

void PickupSlots::begin(const Chunk& chunk) REALTIME {
  for (Pickup* pickup : all()) std::fill_n(pickup->samples.data(), chunk.frames, 0.0);
}

void PickupSlots::listen(std::size_t offset, const Chunk& chunk, const VoiceStack& voices,
                         Workspace& workspace) REALTIME {
  if (!any()) return;
  voices.for_each([&](Voice& voice) REALTIME {
    voice.probes.begin(workspace.spare.get());
    for (Pickup* pickup : all()) {
      if (!contains(chunk.wanted, pickup->channel())) continue;
      for (const Pickup::Gains& gains : pickup->gains) {
        if (gains.voice != &voice) continue;
        voice.probes.add({gains.re.get(), gains.im.get(), pickup->samples.data() + offset});
        break;
      }
    }
  });
}

void PickupSlots::end(const Chunk& chunk, const VoiceStack& voices, Workspace& workspace) REALTIME {
  if (!any()) return;
  const double chunks = static_cast<double>(chunk.frames) / static_cast<double>(kChunkFrames);
  voices.for_each([&](Voice& voice) REALTIME {
    const auto probed = static_cast<double>(voice.probes.all().size() * voice.table().columns());
    workspace.counts.units += kProbePerMode * chunks * probed;
    voice.probes.clear();
  });
  for (const Pickup* pickup : all()) {
    const auto in_chunk = [&](Frame frame) REALTIME {
      return static_cast<std::size_t>(std::clamp<Frame>(frame - chunk.begin, 0, static_cast<Frame>(chunk.frames)));
    };
    const std::size_t first = in_chunk(pickup->begin), end = in_chunk(pickup->end);
    if (first >= end || !contains(chunk.wanted, pickup->channel())) continue;
    if (!are_sane({pickup->samples.data() + first, end - first})) {
      count(chunk.counters->not_finite);
      continue;
    }
    double* const out = workspace.sums.samples(pickup->channel());
    for (std::size_t n = first; n < end; ++n) out[n] += pickup->samples[n];
  }
}

double PickupSlots::floor_factor() const REALTIME {
  if (!any()) return 1;
  double largest = 1;
  for (const Pickup* pickup : all()) largest = std::max(largest, pickup->gains[0].largest);
  return kFelt / largest;
}

bool Pickups::set(const verb::Pickup& how, Frame frame, PickupSlots& slots, const VoiceStack& voices) REALTIME {
  if (!is_sane(how)) return false;
  const bool removes = !(length(how.direction) > 0);
  const auto is_of_number = [&](const Pickup& pickup) REALTIME {
    return pickup.owner && pickup.end == kNever && pickup.how.number == how.number;
  };
  const auto before = std::ranges::find_if(pickups_, is_of_number);
  if (removes && (before == pickups_.end() || before->owner != &slots)) return false;
  const Voice* const voice = voices.current();
  if (!removes && (!voice || voice->table().columns() > kMaxProbedColumns)) return false;
  const auto free =
      std::ranges::find_if(pickups_, [](const Pickup& pickup) REALTIME { return pickup.owner == nullptr; });
  if (!removes && free == pickups_.end()) return false;
  if (before != pickups_.end()) before->end = std::max(frame, before->begin);
  if (removes) return true;
  free->how = how;
  free->begin = frame;
  free->end = kNever;
  free->owner = &slots;
  ++used_;
  slots.slots_[slots.count_++] = &*free;
  refit(slots, voices);
  return true;
}

void Pickups::refit(PickupSlots& slots, const VoiceStack& voices) REALTIME {
  for (Pickup* pickup : slots.all()) {
    std::size_t count = 0;
    voices.for_each([&](Voice& voice) REALTIME {
      if (count == pickup->gains.size() || voice.table().columns() > kMaxProbedColumns) return;
      Pickup::Gains& gains = pickup->gains[count++];
      gains.voice = &voice;
      gains.largest = voice.find_motion(pickup->how, gains.re.get(), gains.im.get());
    });
    for (; count < pickup->gains.size(); ++count) pickup->gains[count].voice = nullptr;
  }
}

void Pickups::drop(Pickup& pickup) REALTIME {
  PickupSlots& slots = *pickup.owner;
  const auto place = std::ranges::find(slots.slots_, &pickup);
  *place = slots.slots_[--slots.count_];
  pickup.owner = nullptr;
  --used_;
}

void Pickups::drop_finished(Frame frame) REALTIME {
  if (used_ == 0) return;
  for (Pickup& pickup : pickups_) {
    if (pickup.owner && pickup.end <= frame) drop(pickup);
  }
}

void Pickups::leave(PickupSlots& slots) REALTIME {
  while (slots.any()) drop(*slots.slots_[0]);
}

}  // namespace ringdown::synth
