#include "engine/synth/voice_registry.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace ringdown::synth {

std::shared_ptr<ModeTable> VoiceRegistry::table_for(const std::shared_ptr<const modal::StrikeMap>& map,
                                                    const modal::MaterialScale& material, const modal::Dampers& dampers,
                                                    modal::ModeRange modes, double sample_rate_hz,
                                                    const TableSettings& settings) const {
  for (const SharedTable& shared : tables_) {
    if (auto table = shared.table.lock(); table && table->is_of(map, material, dampers, modes)) return table;
  }
  return std::make_shared<ModeTable>(map, material, sample_rate_hz, dampers, modes, settings);
}

VoiceRegistry::SharedTable* VoiceRegistry::find(const std::shared_ptr<ModeTable>& table) {
  const auto found =
      std::ranges::find_if(tables_, [&](const SharedTable& shared) { return shared.table.lock() == table; });
  return found == tables_.end() ? nullptr : &*found;
}

std::unique_ptr<InstanceGroup> VoiceRegistry::group_for(const std::shared_ptr<ModeTable>& table) {
  const SharedTable* const known = find(table);
  if (!known) tables_.push_back({table, nullptr});
  return known && !known->group ? std::make_unique<InstanceGroup>(*table, ambisonic_channels_) : nullptr;
}

void VoiceRegistry::keep_group(const std::shared_ptr<ModeTable>& table, std::unique_ptr<InstanceGroup> group) {
  find(table)->group = std::move(group);
}

void VoiceRegistry::count_installed(ObjectNumber object) {
  ++voices_;
  ++voices_of_[object];
}

void VoiceRegistry::retire(ObjectNumber object, Voice* voice) REALTIME {
  [[maybe_unused]] const bool handed_over = retired_.push({object, voice});
  assert(handed_over);
}

void VoiceRegistry::collect() {
  for (; const Retired* retired = retired_.front(); retired_.pop()) {
    delete retired->voice;
    --voices_;
    --voices_of_[retired->object];
  }
  std::erase_if(tables_, [](const SharedTable& shared) { return shared.table.expired(); });
}

}  // namespace ringdown::synth
