// OSC bytes written by hand from the OSC 1.0 specification, sharing nothing with the codec under test.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::wire {

using Bytes = std::vector<std::byte>;

// "An OSC string: non-null ASCII characters followed by a null, followed by 0-3 additional null characters".
inline std::string osc_string(std::string text) {
  text.push_back('\0');
  while (text.size() % 4 != 0) text.push_back('\0');
  return text;
}
inline std::string big_endian(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text.push_back(static_cast<char>(value >> (8 * i)));
  return text;
}
inline std::string osc_int(std::int32_t value) { return big_endian(static_cast<std::uint32_t>(value), 4); }
inline std::string osc_float(float value) { return big_endian(std::bit_cast<std::uint32_t>(value), 4); }
inline std::string osc_long(std::int64_t value) { return big_endian(static_cast<std::uint64_t>(value), 8); }
inline std::string osc_double(double value) { return big_endian(std::bit_cast<std::uint64_t>(value), 8); }

inline std::string osc_bundle(std::uint64_t time, const std::vector<std::string>& elements) {
  std::string text = osc_string("#bundle") + big_endian(time, 8);
  for (const std::string& element : elements) text += big_endian(element.size(), 4) + element;
  return text;
}

inline Bytes to_bytes(std::string_view text) {
  const auto* const first = reinterpret_cast<const std::byte*>(text.data());
  return Bytes(first, first + text.size());
}

}  // namespace ringdown::wire
