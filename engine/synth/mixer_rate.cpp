// The mixer at another sample rate.
#include "engine/synth/mixer.h"

#include <cmath>
#include <limits>
#include <map>
#include <memory>

namespace ringdown::synth {

void Mixer::change_sample_rate(double sample_rate_hz) {
  const double ratio = sample_rate_hz / this->sample_rate_hz();
  accept_orders(std::numeric_limits<Frame>::max());
  counters_.late.fetch_add(agenda_.rescale(now_, ratio), std::memory_order_relaxed);

  struct Tables {
    std::shared_ptr<ModeTable> old, renewed;
  };
  std::map<const ModeTable*, Tables> tables;  // who shared one shares the new one
  const auto retune = [&](Voice*& voice) {
    const std::unique_ptr<Voice> old(voice);
    Tables& table = tables[&old->table()];
    if (!table.old) table = {old->shared_table(), old->table().at_rate(sample_rate_hz)};
    voice = old->with_table(table.renewed).release();
    voice->next = old->next;
  };
  const auto moved = [this, ratio](Frame frame) {
    return now_ + static_cast<Frame>(std::llround(static_cast<double>(frame - now_) * ratio));
  };
  for (Object& object : objects_) part(object);
  clicks_.clear();
  keep_active_families();
  for (Object& object : objects_) {
    for (Ramp* ramp : {&object.gain, &object.left, &object.right}) {
      ramp->begin = moved(ramp->begin);
      ramp->end = moved(ramp->end);
    }
    if (object.current) retune(object.current);
    for (std::size_t i = 0; i < object.drive_count; ++i) drives_[object.drives[i]].rescale(now_, ratio);
    place_drives_again(object);
    for (Voice** link = &object.tails; *link; link = &(*link)->next) retune(*link);
  }
  for (Kin& kin : families_) {
    const auto table = tables.find(kin.table.lock().get());
    if (table == tables.end()) continue;
    kin.table = table->second.renewed;
    if (!kin.family) continue;
    kin.family = std::make_unique<Family>(*table->second.renewed);
    table->second.renewed->family = kin.family.get();
  }
  sample_rate_hz_.store(sample_rate_hz, std::memory_order_relaxed);
  limit(ceiling_db_);
}

}  // namespace ringdown::synth
