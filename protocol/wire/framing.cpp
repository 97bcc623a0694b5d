#include "protocol/wire/framing.h"

#include <utility>

namespace ringdown::wire {
namespace {

constexpr std::size_t kLengthBytes = 4;

}  // namespace

FrameDecoder::Outcome FrameDecoder::push(std::byte byte) {
  if (!framing_) framing_ = byte == std::byte{} ? Framing::length : Framing::slip;
  return *framing_ == Framing::slip ? slip_.push(byte) : push_counted(byte);
}

FrameDecoder::Outcome FrameDecoder::push_counted(std::byte byte) {
  if (length_bytes_ < kLengthBytes) {
    length_ = length_ << 8 | std::to_integer<std::size_t>(byte);
    if (++length_bytes_ < kLengthBytes) return Outcome::more;
    if (length_ > limit_) return Outcome::fault;
    if (length_ == 0) length_bytes_ = 0;
    return Outcome::more;
  }
  packet_.push_back(byte);
  if (packet_.size() < length_) return Outcome::more;
  length_ = length_bytes_ = 0;
  return Outcome::packet;
}

std::vector<std::byte> FrameDecoder::take() {
  return framing() == Framing::slip ? slip_.take() : std::exchange(packet_, {});
}

std::vector<std::byte> frame(std::span<const std::byte> packet, Framing framing) {
  if (framing == Framing::slip) return slip_encode(packet);
  std::vector<std::byte> stream;
  stream.reserve(kLengthBytes + packet.size());
  for (const int shift : {24, 16, 8, 0}) stream.push_back(static_cast<std::byte>(packet.size() >> shift));
  stream.insert(stream.end(), packet.begin(), packet.end());
  return stream;
}

}  // namespace ringdown::wire
