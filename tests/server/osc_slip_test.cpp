// SLIP against RFC 1055's own bytes.
#include "protocol/wire/slip.h"

#include "tests/server/osc_bytes.h"

#include <gtest/gtest.h>

#include <random>

namespace ringdown::wire {
namespace {

using Outcome = SlipDecoder::Outcome;

std::vector<Bytes> packets_in(const std::string& stream, std::size_t limit = 64) {
  SlipDecoder decoder(limit);
  std::vector<Bytes> packets;
  for (const std::byte byte : to_bytes(stream)) {
    const Outcome outcome = decoder.push(byte);
    if (outcome == Outcome::fault) return {to_bytes("fault")};
    if (outcome == Outcome::packet) packets.push_back(decoder.take());
  }
  return packets;
}

TEST(Slip, SlipEscapesAsRfc1055Says) {
  EXPECT_EQ(slip_encode(to_bytes("a\xC0"
                                 "b\xDB"
                                 "c")),
            to_bytes("\xC0"
                     "a\xDB\xDC"
                     "b\xDB\xDD"
                     "c\xC0"));
}

TEST(Slip, EveryPacketComesBackWholeFromSlip) {
  std::mt19937 random(1);
  std::string stream;
  std::vector<Bytes> sent;
  for (std::size_t i = 0; i < 100; ++i) {
    Bytes packet(1 + random() % 60);
    for (std::byte& byte : packet) byte = static_cast<std::byte>(random() % 3 == 0 ? 0xC0 + random() % 32 : random());
    const Bytes framed = slip_encode(packet);
    stream.append(reinterpret_cast<const char*>(framed.data()), framed.size());
    sent.push_back(packet);
  }
  EXPECT_EQ(packets_in(stream), sent);
}

TEST(Slip, EmptySlipPacketsAreNothing) { EXPECT_TRUE(packets_in("\xC0\xC0\xC0").empty()); }

TEST(Slip, ASlipPacketTooLongOrWronglyEscapedIsAFault) {
  const std::vector<Bytes> fault = {to_bytes("fault")};
  EXPECT_EQ(packets_in(std::string(64, 'x') + "\xC0").size(), 1u);
  EXPECT_EQ(packets_in(std::string(65, 'x')), fault);
  EXPECT_EQ(packets_in("a\xDB"
                       "b"),
            fault);
  EXPECT_EQ(packets_in("a\xDB\xC0"), fault);
  EXPECT_EQ(packets_in("a\xDB\xDB"), fault);
}

}  // namespace
}  // namespace ringdown::wire
