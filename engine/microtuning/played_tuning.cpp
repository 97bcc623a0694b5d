#include "engine/microtuning/played_tuning.h"

#include <algorithm>
#include <cmath>

namespace ringdown::microtuning {
namespace {

constexpr std::uint8_t kSystemExclusive = 0xf0, kEndOfExclusive = 0xf7, kNonRealTime = 0x7e, kRealTime = 0x7f;
constexpr std::uint8_t kMidiTuning = 0x08;
constexpr std::uint8_t kDump = 0x01, kKeyChange = 0x02, kBankDump = 0x04, kBankKeyChange = 0x07;
constexpr std::uint8_t kScaleDump = 0x05, kFineScaleDump = 0x06, kScale = 0x08, kFineScale = 0x09;
constexpr std::size_t kNameBytes = 16, kPitchBytes = 3, kKeyBytes = 4, kChecksumBytes = 1, kChannelBytes = 3;
constexpr std::size_t kBytes = 1, kFineBytes = 2;  // of a degree of a scale
constexpr float kParts = 16384;                    // of a semitone

using Bytes = std::span<const std::uint8_t>;

// Returns the pitch above that of the key in equal temperament; NaN for "no change".
float semitones_of(std::size_t key, Bytes pitch) REALTIME {
  if (pitch[0] == 0x7f && pitch[1] == 0x7f && pitch[2] == 0x7f) return std::numeric_limits<float>::quiet_NaN();
  const auto parts = static_cast<float>(128 * pitch[1] + pitch[2]);
  return static_cast<float>(pitch[0]) - static_cast<float>(key) + parts / kParts;
}

}  // namespace

void PlayedTuning::take(Bytes message, const KeySet& held) REALTIME {
  if (!message.empty() && message.front() == kSystemExclusive) message = message.subspan(1);
  if (!message.empty() && message.back() == kEndOfExclusive) message = message.first(message.size() - 1);
  const bool is_data =
      std::all_of(message.begin(), message.end(), [](std::uint8_t byte) REALTIME { return byte < 0x80; });
  if (message.size() < 7 || !is_data || message[2] != kMidiTuning) return;
  const bool is_real_time = message[0] == kRealTime;
  if (!is_real_time && message[0] != kNonRealTime) return;
  const KeySet kept = is_real_time ? KeySet() : held;
  switch (message[3]) {
    case kDump:
      return take_dump({0, message[4]}, message.subspan(5), kept);
    case kBankDump:
      return take_dump({message[4], message[5]}, message.subspan(6), kept);
    case kKeyChange:
      return take_keys({0, message[4]}, message.subspan(5), kept);
    case kBankKeyChange:
      return take_keys({message[4], message[5]}, message.subspan(6), kept);
    case kScaleDump:
      return take_scale_dump({message[4], message[5]}, message.subspan(6), kBytes, kept);
    case kFineScaleDump:
      return take_scale_dump({message[4], message[5]}, message.subspan(6), kFineBytes, kept);
    case kScale:
      return take_scale(message.subspan(4), kBytes, kept);
    case kFineScale:
      return take_scale(message.subspan(4), kFineBytes, kept);
    default:
      return;
  }
}

// `dump` is a name, a pitch for each key, and a checksum.
void PlayedTuning::take_dump(const Address& address, Bytes dump, const KeySet& kept) REALTIME {
  if (dump.size() != kNameBytes + kKeys * kPitchBytes + kChecksumBytes) return;
  Program* const program = find_or_add(address);
  if (!program) return;
  for (std::size_t key = 0; key < kKeys; ++key) {
    const float semitones = semitones_of(key, dump.subspan(kNameBytes + key * kPitchBytes, kPitchBytes));
    if (!std::isnan(semitones)) program->semitones[key] = semitones;
  }
  update(kept);
}

// `keys` is their number, and for each a key and its pitch.
void PlayedTuning::take_keys(const Address& address, Bytes keys, const KeySet& kept) REALTIME {
  if (keys.size() != 1 + keys[0] * kKeyBytes) return;
  Program* const program = find_or_add(address);
  if (!program) return;
  for (Bytes rest = keys.subspan(1); !rest.empty(); rest = rest.subspan(kKeyBytes)) {
    const float semitones = semitones_of(rest[0], rest.subspan(1, kPitchBytes));
    if (!std::isnan(semitones)) program->semitones[rest[0]] = semitones;
  }
  update(kept);
}

// `dump` is a name, a scale whose degrees have `bytes` each, and a checksum.
void PlayedTuning::take_scale_dump(const Address& address, Bytes dump, std::size_t bytes, const KeySet& kept) REALTIME {
  if (dump.size() != kNameBytes + kDegrees * bytes + kChecksumBytes) return;
  Program* const program = find_or_add(address);
  if (!program) return;
  const Scale scale = scale_of(dump.subspan(kNameBytes), bytes);
  for (std::size_t key = 0; key < kKeys; ++key) program->semitones[key] = scale.semitones[key % kDegrees];
  update(kept);
}

// `message` is a set of channels and a scale whose degrees have `bytes` each.
void PlayedTuning::take_scale(Bytes message, std::size_t bytes, const KeySet& kept) REALTIME {
  if (message.size() != kChannelBytes + kDegrees * bytes) return;
  const std::uint32_t channels = message[0] << 14 | message[1] << 7 | message[2];
  const Scale scale = scale_of(message.subspan(kChannelBytes), bytes);
  for (std::size_t channel = 0; channel < kChannels; ++channel) {
    if (channels >> channel & 1) scales_[channel] = scale;
  }
  update(kept);
}

PlayedTuning::Scale PlayedTuning::scale_of(Bytes degrees, std::size_t bytes) REALTIME {
  Scale scale{.is_set = true};
  for (std::size_t i = 0; i < kDegrees; ++i) {
    scale.semitones[i] = bytes == kBytes ? static_cast<float>(degrees[i] - 64) / 100
                                         : static_cast<float>(128 * degrees[2 * i] + degrees[2 * i + 1] - 8192) / 8192;
  }
  return scale;
}

void PlayedTuning::select(std::size_t channel, std::uint8_t parameter, std::uint8_t value,
                          const KeySet& held) REALTIME {
  if (parameter == kTuningProgram) selected_[channel].program = value;
  if (parameter == kTuningBank) selected_[channel].bank = value;
  if (parameter == kTuningProgram || parameter == kTuningBank) scales_[channel].is_set = false;
  update(held);
}

void PlayedTuning::press(std::size_t key, std::size_t channel) REALTIME {
  channel_of_[key] = static_cast<std::uint8_t>(channel);
  update_key(key);
}

void PlayedTuning::update(const KeySet& kept) REALTIME {
  for (std::size_t key = 0; key < kKeys; ++key) {
    if (!kept[key]) update_key(key);
  }
}

void PlayedTuning::update_key(std::size_t key) REALTIME {
  const std::size_t channel = channel_of_[key];
  if (scales_[channel].is_set) {
    stated_[key].store(scales_[channel].semitones[key % kDegrees], std::memory_order_relaxed);
    return;
  }
  const Program* const program = find(selected_[channel]);
  stated_[key].store(program ? program->semitones[key] : kUnset, std::memory_order_relaxed);
}

PlayedTuning::Program* PlayedTuning::find(const Address& address) REALTIME {
  for (std::size_t i = 0; i < used_; ++i) {
    if (programs_[i].address == address) return &programs_[i];
  }
  return nullptr;
}

PlayedTuning::Program* PlayedTuning::find_or_add(const Address& address) REALTIME {
  if (Program* const known = find(address)) return known;
  if (used_ == kMaxPrograms) return nullptr;
  Program& added = programs_[used_++];
  added.address = address;
  added.semitones.fill(kUnset);
  return &added;
}

void PlayedTuning::set_base(const KeyTuning& tuning) {
  for (std::size_t key = 0; key < kKeys; ++key) {
    base_[key].store(tuning.semitones[key], std::memory_order_relaxed);
    unmapped_[key].store(tuning.unmapped[key], std::memory_order_relaxed);
  }
}

double PlayedTuning::semitones(std::size_t key) const REALTIME {
  const float stated = stated_[key].load(std::memory_order_relaxed);
  return std::isnan(stated) ? base_[key].load(std::memory_order_relaxed) : static_cast<double>(stated);
}

bool PlayedTuning::is_unmapped(std::size_t key) const REALTIME {
  return unmapped_[key].load(std::memory_order_relaxed) && std::isnan(stated_[key].load(std::memory_order_relaxed));
}

}  // namespace ringdown::microtuning
