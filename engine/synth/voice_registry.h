// The worker's record of voices: which tables they share, how many are alive, and which can be freed.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/spsc_ring.h"
#include "engine/synth/events/event.h"
#include "engine/synth/objects/instance_group.h"
#include "engine/synth/modes/mode_table.h"
#include "engine/synth/modes/voice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace ringdown::synth {

inline constexpr std::size_t kMaxVoices = 4096;  // voices playing, ringing out or waiting for collect()

class VoiceRegistry {
 public:
  // Returns the table that voices of this bank, material, dampers and choice of modes share, and makes one if there is
  // none. [worker]
  [[nodiscard]] std::shared_ptr<ModeTable> table_for(const std::shared_ptr<const modal::StrikeMap>& map,
                                                     const modal::MaterialScale& material,
                                                     const modal::Dampers& dampers, modal::ModeRange modes,
                                                     double sample_rate_hz, const TableSettings& settings) const;

  // Makes groups created from now on render this number of ambisonic channels. [worker]
  void set_ambisonic_channels(std::size_t count) { ambisonic_channels_ = count; }

  // Returns whether another voice may be installed. [worker]
  [[nodiscard]] bool has_room() const { return voices_ < kMaxVoices; }
  // Call before a voice is installed. Returns the group that its table needs from now on, because it is the table's
  // second voice, or null. keep_group() makes the group permanent. [worker]
  [[nodiscard]] std::unique_ptr<InstanceGroup> group_for(const std::shared_ptr<ModeTable>& table);
  void keep_group(const std::shared_ptr<ModeTable>& table, std::unique_ptr<InstanceGroup> group);
  // Call when a voice of the object has been handed to the mixer. [worker]
  void count_installed(ObjectNumber object);

  // Returns whether the object has a voice that is playing, ringing out or not yet collected. [worker]
  [[nodiscard]] bool in_use(ObjectNumber object) const { return voices_of_[object] > 0; }

  // Returns a voice that has fallen silent to the worker. There is always room, because has_room() limits the number.
  // [audio]
  void retire(ObjectNumber object, Voice* voice) REALTIME;
  // Frees voices that have been returned. [worker]
  void collect();

  // Replaces every table by the one that `renewed(table)` returns, null for a table that is not in use, and every group
  // by an empty one. [worker, while nothing is rendered]
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
  std::array<std::uint32_t, kMaxObjects> voices_of_{};  // number of voices of each object
  std::size_t voices_ = 0;
  SpscRing<Retired> retired_{kMaxVoices};
};

}  // namespace ringdown::synth
