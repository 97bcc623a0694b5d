#include "protocol/wire/message.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace ringdown::wire {

Blob encode_floats(std::span<const float> numbers) {
  Blob blob;
  blob.reserve(4 * numbers.size());
  for (const float number : numbers) {
    const auto word = std::bit_cast<std::uint32_t>(number);
    for (const int shift : {24, 16, 8, 0}) blob.push_back(static_cast<std::byte>(word >> shift));
  }
  return blob;
}

std::vector<float> decode_floats(const Blob& blob) {
  std::vector<float> numbers;
  numbers.reserve(blob.size() / 4);
  for (std::size_t i = 0; i + 4 <= blob.size(); i += 4) {
    std::uint32_t word = 0;
    for (std::size_t k = i; k < i + 4; ++k) word = word << 8 | std::to_integer<std::uint32_t>(blob[k]);
    const auto number = std::bit_cast<float>(word);
    numbers.push_back(std::isfinite(number) ? number : 0);
  }
  return numbers;
}

}  // namespace ringdown::wire
