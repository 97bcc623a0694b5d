#include "protocol/wire/packet.h"

#include "tests/server/osc_bytes.h"

#include <gtest/gtest.h>

#include <limits>
#include <tuple>

namespace ringdown::wire {
namespace {

std::string message(const std::string& address) { return osc_string(address) + osc_string(","); }

// The sentence that refuses the packet, or "" when it was accepted.
std::string refusal(const std::string& packet) {
  const Bytes bytes = to_bytes(packet);
  const auto messages = decode_packet(bytes);
  return messages ? "" : messages.error().message;
}

TEST(OscPacket, ABundleIsOpenedInItsOrder) {
  const std::string inner = osc_bundle(9, {message("/b"), message("/c")});
  const Bytes packet = to_bytes(osc_bundle(5, {message("/a"), inner, message("/d")}));
  const auto messages = decode_packet(packet);
  ASSERT_TRUE(messages) << messages.error().message;
  std::string order;
  std::vector<TimeTag> times;
  for (const TimedMessage& timed : *messages) {
    order += timed.message.address[1];
    times.push_back(timed.time);
  }
  EXPECT_EQ(order, "abcd");
  EXPECT_EQ(times, (std::vector<TimeTag>{5, 9, 9, 5}));
}

TEST(OscPacket, AnInnerBundleIsNeverEarlierThanTheOuterOne) {
  const Bytes packet = to_bytes(osc_bundle(500, {osc_bundle(kImmediately, {message("/a")})}));
  EXPECT_EQ(decode_packet(packet)->at(0).time, 500u);
}

TEST(OscPacket, AMessageAloneIsImmediate) {
  const Bytes packet = to_bytes(message("/a"));
  EXPECT_EQ(decode_packet(packet)->at(0).time, kImmediately);
}

TEST(OscPacket, AnEmptyBundleIsNoMessages) {
  const Bytes packet = to_bytes(osc_bundle(1, {}));
  EXPECT_TRUE(decode_packet(packet)->empty());
}

TEST(OscPacket, EveryLimitOfAPacketHoldsAtTheLimitAndRefusesPastIt) {
  const auto nested = [](int depth) {
    std::string packet = message("/a");
    for (int i = 0; i < depth; ++i) packet = osc_bundle(1, {packet});
    return packet;
  };
  EXPECT_EQ(refusal(nested(4)), "");
  EXPECT_NE(refusal(nested(5)).find("deeper than 4"), std::string::npos);

  const auto with_arguments = [](std::size_t count) {
    std::string packet = osc_string("/a") + osc_string("," + std::string(count, 'i'));
    for (std::size_t i = 0; i < count; ++i) packet += osc_int(1);
    return packet;
  };
  EXPECT_EQ(refusal(with_arguments(64)), "");
  EXPECT_NE(refusal(with_arguments(65)).find("more than 64"), std::string::npos);

  EXPECT_EQ(refusal(message("/" + std::string(255, 'a'))), "");
  EXPECT_NE(refusal(message("/" + std::string(256, 'a'))).find("256"), std::string::npos);

  const auto sized = [](std::size_t bytes) {  // one message with one long text
    return osc_string("/a") + osc_string(",s") + osc_string(std::string(bytes - 9, 'x'));
  };
  EXPECT_EQ(refusal(sized(65536)), "");
  EXPECT_NE(refusal(sized(65540)).find("65536"), std::string::npos);
}

TEST(OscPacket, TypesThatOscDoesNotKnowAreRefusedByName) {
  for (const char type : std::string("axQ?7 ")) {
    const std::string sentence =
        refusal(osc_string("/a") + osc_string(std::string(",i") + type) + osc_int(1) + osc_int(0));
    EXPECT_NE(sentence.find("/a argument 2"), std::string::npos) << type << ": " << sentence;
    const bool named = sentence.find(std::string("'") + type + "'") != std::string::npos;
    EXPECT_TRUE(named || type == ' ') << sentence;
  }
}

// Every type of OSC 1.0 and 1.1, with an int32 behind each so that a wrong length would be seen.
TEST(OscPacket, EveryTypeOfOscIsRead) {
  const std::vector<std::tuple<std::string, std::string, Argument>> types = {
      {"i", osc_int(-7), -7},
      {"f", osc_float(0.5f), 0.5f},
      {"s", osc_string("four"), "four"},
      {"b", osc_int(2) + std::string("ab\0\0", 4), Blob{std::byte{'a'}, std::byte{'b'}}},
      {"h", osc_long(std::int64_t{1} << 40), std::int64_t{1} << 40},
      {"t", osc_long(1), Tag{'t'}},
      {"d", osc_double(-0.1), -0.1},
      {"S", osc_string("symbol"), "symbol"},
      {"c", osc_int('x'), Tag{'c'}},
      {"r", osc_int(0x11223344), Tag{'r'}},
      {"m", osc_int(0x00903c64), Tag{'m'}},
      {"T", "", true},
      {"F", "", false},
      {"N", "", Tag{'N'}},
      {"I", "", Tag{'I'}},
  };
  std::string all_types, all_bytes;
  std::vector<Argument> all;
  for (const auto& [type, bytes, expected] : types) {
    const Bytes packet = to_bytes(osc_string("/a") + osc_string("," + type + "i") + bytes + osc_int(1));
    const auto messages = decode_packet(packet);
    ASSERT_TRUE(messages) << messages.error().message;
    EXPECT_EQ(messages->at(0).message.arguments, (std::vector<Argument>{expected, 1})) << type;
    all_types += type, all_bytes += bytes;
    all.push_back(expected);
  }
  const Bytes nested = to_bytes(osc_string("/a") + osc_string(",[" + all_types + "[]]") + all_bytes);
  const auto messages = decode_packet(nested);
  ASSERT_TRUE(messages) << messages.error().message;
  EXPECT_EQ(messages->at(0).message.arguments, all) << "elements of an array are arguments like any others";
}

TEST(OscPacket, BracketsOfArraysMustMatch) {
  for (const char* types : {",[", ",]", ",][", ",[[]", ",[]]"}) {
    EXPECT_NE(refusal(osc_string("/a") + osc_string(types)).find("bracket"), std::string::npos) << types;
  }
}

TEST(OscPacket, AMessageWithoutTypeTagsHasNoArguments) {
  const Bytes packet = to_bytes(std::string("/status\0", 8));
  const auto messages = decode_packet(packet);
  ASSERT_TRUE(messages) << messages.error().message;
  EXPECT_EQ(messages->at(0).message, (Message{"/status", {}}));
  EXPECT_EQ(refusal(osc_bundle(1, {osc_string("/a"), message("/b")})), "");
  const std::string sentence = refusal(osc_string("/object/bell/gain") + osc_float(0.5f));
  EXPECT_NE(sentence.find("/object/bell/gain"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("type tags are missing"), std::string::npos) << sentence;
}

TEST(OscPacket, ABlobMustFitAndBePaddedWithZeros) {
  const std::string head = osc_string("/a") + osc_string(",bi");
  const auto packet = [&](std::int32_t size, const std::string& bytes) {
    return to_bytes(head + osc_int(size) + bytes + osc_int(7));
  };
  EXPECT_TRUE(decode_packet(packet(0, "")));
  EXPECT_TRUE(decode_packet(packet(4, "abcd")));
  EXPECT_TRUE(decode_packet(packet(5, std::string("abcde\0\0\0", 8))));
  EXPECT_FALSE(decode_packet(packet(5, "abcdefgh"))) << "padding";
  EXPECT_FALSE(decode_packet(packet(12, "abcd"))) << "cut off";
  EXPECT_FALSE(decode_packet(packet(-1, "abcd")));
  EXPECT_FALSE(decode_packet(packet(std::numeric_limits<std::int32_t>::max(), "abcd")));
}

TEST(OscPacket, LengthsOfPacketsAreMultiplesOfFour) {
  for (const std::size_t length : {1, 2, 3, 6, 9, 11}) {
    EXPECT_NE(refusal(message("/abc").substr(0, length)).find("multiple of 4"), std::string::npos) << length;
  }
}

TEST(OscPacket, BrokenPacketsAreRefused) {
  const std::pair<const char*, std::string> broken[] = {
      {"empty", ""},
      {"no multiple of 4", "/a\0"},
      {"address without end", "/abc"},
      {"no slash", message("a")},
      {"empty address", osc_string("") + osc_string(",")},
      {"control character in the address", message("/a\x01")},
      {"space in the address", message("/a b")},
      {"type tags without comma", osc_string("/a") + osc_string("i") + osc_int(1)},
      {"argument missing", osc_string("/a") + osc_string(",i")},
      {"half a double", osc_string("/a") + osc_string(",d") + osc_int(1)},
      {"bytes left over", message("/a") + osc_int(0)},
      {"padding not zero", osc_string("/a") + std::string(",\0x\0", 4)},
      {"text without end", osc_string("/a") + osc_string(",s") + "abcd"},
      {"bundle without timetag", osc_string("#bundle")},
      {"element size past the end", osc_bundle(1, {}) + big_endian(12, 4) + message("/a")},
      {"element size huge", osc_bundle(1, {}) + big_endian(0xffffffff, 4) + message("/a")},
      {"element size cut", osc_bundle(1, {message("/a")}) + "ab"},
      {"element empty", osc_bundle(1, {""})},
      {"element not OSC", osc_bundle(1, {"abcd"})},
      {"one bad among good", osc_bundle(1, {message("/a"), osc_string("/b") + osc_int(1)})},
  };
  for (const auto& [what, packet] : broken) EXPECT_NE(refusal(packet), "") << what;
}

}  // namespace
}  // namespace ringdown::wire
