// How packets are told apart in a TCP stream, by bytes written by hand.
#include "protocol/wire/framing.h"

#include "tests/server/osc_bytes.h"

#include <gtest/gtest.h>

namespace ringdown::wire {
namespace {

using Outcome = FrameDecoder::Outcome;

struct Read {
  std::vector<Bytes> packets;
  bool fault = false;
  Framing framing = Framing::slip;
};

Read read(const std::string& stream, std::size_t limit = 64) {
  FrameDecoder decoder(limit);
  Read result;
  for (const std::byte byte : to_bytes(stream)) {
    const Outcome outcome = decoder.push(byte);
    result.fault = outcome == Outcome::fault;
    if (result.fault) break;
    if (outcome == Outcome::packet) result.packets.push_back(decoder.take());
  }
  result.framing = decoder.framing();
  return result;
}

std::string counted(const std::string& packet) { return big_endian(packet.size(), 4) + packet; }

TEST(OscFraming, TheFirstByteTellsLengthsFromSlip) {
  const std::vector<Bytes> two = {to_bytes("/status"), to_bytes("#bundle\xC0")};
  const Read lengths = read(counted("/status") + counted("#bundle\xC0"));
  EXPECT_EQ(lengths.packets, two);
  EXPECT_EQ(lengths.framing, Framing::length);
  for (const std::string begin : {"\xC0", ""}) {
    const Read slip = read(begin + "/status\xC0#bundle\xDB\xDC\xC0");
    EXPECT_EQ(slip.packets, two);
    EXPECT_EQ(slip.framing, Framing::slip);
  }
}

TEST(OscFraming, APacketIsAsLongAsTheLimitAndNotAByteLonger) {
  EXPECT_EQ(read(counted(std::string(64, 'x'))).packets.size(), 1u);
  EXPECT_TRUE(read(big_endian(65, 4)).fault) << "before a byte of it came";
  EXPECT_TRUE(read(std::string("\0\xff\xff\xff", 4)).fault);
  EXPECT_TRUE(read(counted("a") + big_endian(0xffffffff, 4)).fault) << "a later length has all bits";
}

TEST(OscFraming, EmptyPacketsAreNothing) {
  const Read some = read(big_endian(0, 4) + counted("a") + big_endian(0, 4) + counted("b"));
  EXPECT_FALSE(some.fault);
  EXPECT_EQ(some.packets, (std::vector<Bytes>{to_bytes("a"), to_bytes("b")}));
}

TEST(OscFraming, AnswersAreFramedAsTheClientDoes) {
  const Bytes packet = to_bytes("/a\xC0z");
  EXPECT_EQ(frame(packet, Framing::length), to_bytes(std::string("\0\0\0\4/a\xC0z", 8)));
  EXPECT_EQ(frame(packet, Framing::slip), to_bytes("\xC0/a\xDB\xDCz\xC0"));
}

}  // namespace
}  // namespace ringdown::wire
