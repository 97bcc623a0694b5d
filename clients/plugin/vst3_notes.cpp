#include "clients/plugin/vst3_notes.h"

#include <algorithm>
#include <cmath>

namespace ringdown::plugin {

// The model keeps the thread's variable at a fixed place, so that its use is safe: any other model might allocate it at
// its first use.
TRUST_REALTIME_BEGIN
NoteSayings*& sayings_of_block() REALTIME {
  static thread_local NoteSayings* present __attribute__((tls_model("initial-exec"))) = nullptr;
  return present;
}
TRUST_REALTIME_END

std::size_t NoteExpressions::write(const NoteSaying& saying, std::array<Message, 2>& messages) REALTIME {
  if (saying.kind == NoteSaying::Kind::begins) {
    if (saying.key < kKeys) notes_[saying.key] = {saying.note, saying.channel};
    return 0;
  }
  std::size_t key = 0;
  while (key < kKeys && notes_[key].number != saying.note) ++key;
  if (saying.note < 0 || key == kKeys || !std::isfinite(saying.value)) return 0;
  const double share = std::clamp(saying.value, 0.0, 1.0);
  if (saying.kind == NoteSaying::Kind::brightness) {
    const auto value = static_cast<std::uint8_t>(std::lround(127 * share));
    messages[0] = {static_cast<std::uint8_t>(session::midi::kControl | notes_[key].channel), session::midi::kBrightness,
                   value};
    return 1;
  }
  const int code = tuning_code(kTuning_semitones * (2 * share - 1));
  messages[0] = {kTuneKeyHigh, static_cast<std::uint8_t>(key), static_cast<std::uint8_t>(code >> 7)};
  messages[1] = {kTuneKeyLow, static_cast<std::uint8_t>(key), static_cast<std::uint8_t>(code & 0x7f)};
  return 2;
}

}  // namespace ringdown::plugin
