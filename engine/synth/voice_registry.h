// The worker's book of voices: which tables they share, how many are alive, and freeing those that are done with.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/spsc_ring.h"
#include "engine/synth/event.h"
#include "engine/synth/instance_group.h"
#include "engine/synth/modes/mode_table.h"
#include "engine/synth/voice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace ringdown::synth {

inline constexpr std::size_t kMaxVoices = 4096;  // playing, ringing out or waiting for collect()

class VoiceRegistry {
 public:
  // The table that voices of this bank, material, dampers and choice of modes share; a new one if there is none.
  // [worker]
  [[nodiscard]] std::shared_ptr<ModeTable> table_for(const std::shared_ptr<const modal::StrikeMap>& map,
                                                     const modal::MaterialScale& material,
                                                     const modal::Dampers& dampers, modal::ModeRange modes,
                                                     double sample_rate_hz, const TableSettings& settings) const;

  // Groups that are made from now on render so many ambisonic channels. [worker]
  void set_ambisonic_channels(std::size_t count) { ambisonic_channels_ = count; }

  // Whether another voice may be installed. [worker]
  [[nodiscard]] bool has_room() const { return voices_ < kMaxVoices; }
  // A voice is about to be installed. Returns the group that its table needs from now on, because it is the second
  // voice of the table; null: none. keep_group() makes the group stay. [worker]
  [[nodiscard]] std::unique_ptr<InstanceGroup> group_for(const std::shared_ptr<ModeTable>& table);
  void keep_group(const std::shared_ptr<ModeTable>& table, std::unique_ptr<InstanceGroup> group);
  // A voice of the object has been handed to the mixer. [worker]
  void count_installed(ObjectNumber object);

  // True while the object has a voice that is playing, ringing out or not yet collected. [worker]
  [[nodiscard]] bool in_use(ObjectNumber object) const { return voices_of_[object] > 0; }

  // Hands back a voice that has fallen silent. There is always room, because has_room() allows no more. [audio]
  void retire(ObjectNumber object, Voice* voice) RINGDOWN_REALTIME;
  // Frees what has been handed back. [worker]
  void collect();

  // Exchanges every table for the one that `renewed(table)` returns, null where it is not in use, and every group for
  // an empty one. [worker, while nothing is rendered]
  template <class Renewed>
  void renew(const Renewed& renewed) {
    for (SharedTable& shared : tables_) {
      const std::shared_ptr<ModeTable> table = renewed(shared.table.lock().get());
      if (!table) continue;
      shared.table = table;
      if (!shared.group) continue;
      shared.group = std::make_unique<InstanceGroup>(*table, ambisonic_channels_);
      table->instances = shared.group.get();
    }
  }

 private:
  struct SharedTable {
    std::weak_ptr<ModeTable> table;
    std::unique_ptr<InstanceGroup> group;  // null while the table has one voice
  };
  [[nodiscard]] SharedTable* find(const std::shared_ptr<ModeTable>& table);
  struct Retired {
    ObjectNumber object;
    Voice* voice;
  };

  std::vector<SharedTable> tables_;
  std::size_t ambisonic_channels_ = 0;
  std::array<std::uint32_t, kMaxObjects> voices_of_{};  // of each object
  std::size_t voices_ = 0;
  SpscRing<Retired> retired_{kMaxVoices};
};

}  // namespace ringdown::synth
