#include "server/latency.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace ringdown::server {

Result<Latency> parse_latency(const std::string& text) {
  constexpr double kMaxFrames = 192000;
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  const std::string_view unit(stop, static_cast<std::size_t>(end - stop));
  const bool good = error == std::errc() && value >= 0;  // false for NaN
  if (good && unit == "ms" && value <= 1000 * kMaxLatency_s) return Latency{.seconds = value / 1000};
  if (good && unit.empty() && value <= kMaxFrames && value == std::floor(value)) {
    return Latency{.frames = static_cast<synth::Frame>(value)};
  }
  return fail(ErrorKind::bad_input,
              "'" + text + "' is not a latency; write frames, like 256, or milliseconds up to 1000, like 5ms");
}

synth::Frame latency_frames(const Driver& driver, const Latency& wanted) {
  const auto block = static_cast<synth::Frame>(driver.block_frames());
  const synth::Frame min = block + block / 16;
  if (wanted.frames) return std::max(min, *wanted.frames);
  if (wanted.seconds) return std::max<synth::Frame>(min, std::llround(*wanted.seconds * driver.sample_rate_hz()));
  return min;
}

}  // namespace ringdown::server
