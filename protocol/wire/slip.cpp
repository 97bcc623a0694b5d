#include "protocol/wire/slip.h"

#include <utility>

namespace ringdown::wire {
namespace {

constexpr std::byte kEnd{0xC0}, kEscape{0xDB}, kEscapedEnd{0xDC}, kEscapedEscape{0xDD};

}  // namespace

std::vector<std::byte> slip_encode(std::span<const std::byte> packet) {
  std::vector<std::byte> stream;
  stream.reserve(packet.size() + 16);
  stream.push_back(kEnd);
  for (const std::byte byte : packet) {
    if (byte == kEnd || byte == kEscape) {
      stream.push_back(kEscape);
      stream.push_back(byte == kEnd ? kEscapedEnd : kEscapedEscape);
    } else {
      stream.push_back(byte);
    }
  }
  stream.push_back(kEnd);
  return stream;
}

SlipDecoder::Outcome SlipDecoder::push(std::byte byte) {
  if (byte == kEnd) {
    if (escaped_) return Outcome::fault;
    return packet_.empty() ? Outcome::more : Outcome::packet;
  }
  if (byte == kEscape && !escaped_) {
    escaped_ = true;
    return Outcome::more;
  }
  if (std::exchange(escaped_, false)) {
    if (byte != kEscapedEnd && byte != kEscapedEscape) return Outcome::fault;
    byte = byte == kEscapedEnd ? kEnd : kEscape;
  }
  if (packet_.size() == limit_) return Outcome::fault;
  packet_.push_back(byte);
  return Outcome::more;
}

std::vector<std::byte> SlipDecoder::take() { return std::exchange(packet_, {}); }

}  // namespace ringdown::wire
