#include "protocol/wire/codec.h"

#include "tests/server/osc_bytes.h"

#include <gtest/gtest.h>
#include <lo/lo.h>

#include <random>

namespace ringdown::wire {
namespace {

const Message kAllTypes{"/object/bell/strike", {-7, std::int64_t{1} << 40, 0.5f, -0.1, "four", ""}};

std::string all_types_by_hand() {
  return osc_string("/object/bell/strike") + osc_string(",ihfdss") + osc_int(-7) + osc_long(std::int64_t{1} << 40) +
         osc_float(0.5f) + osc_double(-0.1) + osc_string("four") + osc_string("");
}

TEST(OscCodec, BytesFromTheSpecificationDecode) {
  const auto messages = decode_packet(to_bytes(all_types_by_hand()));
  ASSERT_TRUE(messages) << messages.error().message;
  ASSERT_EQ(messages->size(), 1u);
  EXPECT_EQ(messages->front().message, kAllTypes);
  EXPECT_EQ(messages->front().time, kImmediately);
}

TEST(OscCodec, TheSpecificationsOwnExampleDecodes) {
  // OSC 1.0, "OSC Message Examples": /foo with 1000, -1, "hello", 1.234, 5.678.
  const unsigned char packet[] = {0x2f, 0x66, 0x6f, 0x6f, 0x00, 0x00, 0x00, 0x00, 0x2c, 0x69, 0x69, 0x73, 0x66, 0x66,
                                  0x00, 0x00, 0x00, 0x00, 0x03, 0xe8, 0xff, 0xff, 0xff, 0xff, 0x68, 0x65, 0x6c, 0x6c,
                                  0x6f, 0x00, 0x00, 0x00, 0x3f, 0x9d, 0xf3, 0xb6, 0x40, 0xb5, 0xb2, 0x2d};
  const Message expected{"/foo", {1000, -1, "hello", 1.234f, 5.678f}};
  const auto messages = decode_packet(std::as_bytes(std::span(packet)));
  ASSERT_TRUE(messages) << messages.error().message;
  EXPECT_EQ(messages->front().message, expected);
  EXPECT_EQ(encode(expected), to_bytes({reinterpret_cast<const char*>(packet), sizeof packet}));
}

TEST(OscCodec, EncodingWritesTheSpecificationsBytes) {
  EXPECT_EQ(encode(kAllTypes), to_bytes(all_types_by_hand()));
  EXPECT_EQ(encode({"/status", {}}), to_bytes(osc_string("/status") + osc_string(",")));
}

// liblo writes each type that it has a function for.
TEST(OscCodec, WhatLibloWritesIsRead) {
  lo_message message = lo_message_new();
  unsigned char midi[4] = {0, 0x90, 60, 100};
  lo_message_add_int32(message, 1), lo_message_add_float(message, 0.5f), lo_message_add_string(message, "text");
  lo_message_add_int64(message, 2), lo_message_add_double(message, 0.25), lo_message_add_symbol(message, "symbol");
  lo_message_add_timetag(message, {3, 4}), lo_message_add_char(message, 'c'), lo_message_add_midi(message, midi);
  lo_message_add_true(message), lo_message_add_false(message), lo_message_add_nil(message);
  lo_message_add_infinitum(message), lo_message_add_int32(message, 5);
  std::size_t size = 0;
  void* const data = lo_message_serialise(message, "/a", nullptr, &size);
  const auto messages = decode_packet({static_cast<const std::byte*>(data), size});
  std::free(data);
  lo_message_free(message);
  ASSERT_TRUE(messages) << messages.error().message;
  EXPECT_EQ(messages->at(0).message, (Message{"/a",
                                              {1, 0.5f, "text", std::int64_t{2}, 0.25, "symbol", Tag{'t'}, Tag{'c'},
                                               Tag{'m'}, true, false, Tag{'N'}, Tag{'I'}, 5}}));
  EXPECT_EQ(encode({"/a", {true, false, Tag{'N'}, Tag{'I'}}}), to_bytes(osc_string("/a") + osc_string(",TFNI")));
}

TEST(OscCodec, BlobsOfAnySizeAreWrittenAndRead) {
  for (const std::size_t size : {0, 1, 3, 4, 5, 64}) {
    const std::string content(size, '\x7f'), padding((4 - size % 4) % 4, '\0');
    const Bytes expected =
        to_bytes(osc_string("/x") + osc_string(",b") + osc_int(static_cast<std::int32_t>(size)) + content + padding);
    const Message message{"/x", {Blob(size, std::byte{0x7f})}};
    EXPECT_EQ(encode(message), expected) << size;
    const auto messages = decode_packet(expected);
    ASSERT_TRUE(messages) << messages.error().message;
    EXPECT_EQ(messages->front().message, message) << size;
  }
}

TEST(OscCodec, ABundleRoundTripsWithItsTime) {
  const std::vector<Message> sent = {kAllTypes, {"/clear", {}}, {"/sync", {3}}};
  const TimeTag time = 0x123456789abcdef0;
  const Bytes packet = encode_bundle(time, sent);
  EXPECT_EQ(packet, to_bytes(osc_bundle(time, {all_types_by_hand(), osc_string("/clear") + osc_string(","),
                                               osc_string("/sync") + osc_string(",i") + osc_int(3)})));
  const auto messages = decode_packet(packet);
  ASSERT_TRUE(messages) << messages.error().message;
  ASSERT_EQ(messages->size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(messages->at(i).message, sent[i]);
    EXPECT_EQ(messages->at(i).time, time);
  }
}

TEST(OscCodec, NestedBundlesOfLibloItselfKeepTheirOrder) {
  lo_bundle outer = lo_bundle_new({100, 0});
  lo_bundle inner = lo_bundle_new({200, 0});
  const auto add = [](lo_bundle bundle, const char* path) { lo_bundle_add_message(bundle, path, lo_message_new()); };
  add(outer, "/a");
  add(inner, "/b");
  lo_bundle_add_bundle(outer, inner);
  add(outer, "/c");
  std::size_t size = 0;
  void* const data = lo_bundle_serialise(outer, nullptr, &size);
  const auto messages = decode_packet({static_cast<const std::byte*>(data), size});
  std::free(data);
  lo_bundle_free_recursive(outer);
  ASSERT_TRUE(messages) << messages.error().message;
  ASSERT_EQ(messages->size(), 3u);
  EXPECT_EQ(messages->at(0).message.address, "/a");
  EXPECT_EQ(messages->at(1).message.address, "/b");
  EXPECT_EQ(messages->at(1).time, TimeTag{200} << 32);
  EXPECT_EQ(messages->at(2).message.address, "/c");
  EXPECT_EQ(messages->at(2).time, TimeTag{100} << 32);
}

TEST(OscCodec, APacketCutAnywhereIsRefused) {
  const std::string whole = osc_bundle(1, {all_types_by_hand(), all_types_by_hand()});
  const std::size_t after_head = 16;                                            // a bundle of no messages is a packet
  const std::size_t after_first = after_head + 4 + all_types_by_hand().size();  // and so is one with the first only
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto messages = decode_packet(to_bytes(whole.substr(0, length)));
    EXPECT_EQ(messages.has_value(), length == after_head || length == after_first) << length;
  }
  const std::size_t after_address = osc_string("/object/bell/strike").size();  // a message without type tags
  for (std::size_t length = 0; length < all_types_by_hand().size(); ++length) {
    const auto messages = decode_packet(to_bytes(all_types_by_hand().substr(0, length)));
    EXPECT_EQ(messages.has_value(), length == after_address) << length;
  }
}

// Whether the message has arguments that encode() writes as they came: no symbols, arrays, or values that are not kept.
bool comes_back(const std::string& packet) {
  const std::size_t tags = packet.find(',', packet.find('\0'));  // none: left out
  return tags != packet.npos && std::string(packet.c_str() + tags + 1).find_first_not_of("ihfdsbTFNI") == packet.npos;
}

// Whatever arrives, it is refused or it is a message that encodes again to what arrived: nothing is read from
// outside the packet. The `asan` preset makes this test sharp.
TEST(OscCodec, DamagedPacketsAreRefusedOrUnderstood) {
  std::mt19937 random(20261121);
  const std::string whole = osc_bundle(7, {all_types_by_hand(), osc_bundle(9, {all_types_by_hand()})});
  std::size_t understood = 0, refused = 0;
  for (int round = 0; round < 200'000; ++round) {
    std::string packet = round % 2 ? whole : all_types_by_hand();
    const unsigned flips = 1 + random() % 4;
    for (unsigned i = 0; i < flips; ++i) packet[random() % packet.size()] ^= static_cast<char>(1u << random() % 8);
    if (random() % 4 == 0) packet.resize(random() % packet.size());
    const Bytes bytes = to_bytes(packet);  // exactly sized, so that a read past the end is seen
    const auto messages = decode_packet(bytes);
    ++(messages ? understood : refused);
    if (messages && messages->size() == 1 && packet[0] == '/' && comes_back(packet)) {
      ASSERT_EQ(encode(messages->front().message), bytes);
    }
  }
  EXPECT_GT(understood, 1000u);
  EXPECT_GT(refused, 1000u);
}

TEST(OscCodec, TimeTagsCountFrom1900) {
  EXPECT_EQ(time_tag(0), TimeTag{2208988800} << 32);  // RFC 868
  EXPECT_EQ(time_tag(0.5), (TimeTag{2208988800} << 32) + 0x80000000);
  EXPECT_NEAR(unix_seconds(time_tag(1795228800.123456)), 1795228800.123456, 1e-6);
}

TEST(OscCodec, UrlsAreReadStrictly) {
  for (const char* good : {"osc.udp://127.0.0.1:7770", "osc.udp://127.0.0.1:7770/"}) {
    const auto url = parse_url(good);
    ASSERT_TRUE(url) << url.error().message;
    EXPECT_EQ(url->host, "127.0.0.1");
    EXPECT_EQ(url->port, 7770);
  }
  EXPECT_EQ(parse_url("osc.udp://[fe80::1%eth0]:7770/")->host, "fe80::1%eth0");
  for (const char* bad : {"", "127.0.0.1:7770", "osc.tcp://127.0.0.1:7770", "osc.udp://", "osc.udp://:7770",
                          "osc.udp://::1:7770", "osc.udp://[]:7770", "osc.udp://[::1:7770", "osc.udp://[host]:7770",
                          "osc.udp://localhost", "osc.udp://localhost:", "osc.udp://localhost:0",
                          "osc.udp://localhost:65536", "osc.udp://localhost:77x", "osc.udp://localhost:-1"}) {
    const auto url = parse_url(bad);
    ASSERT_FALSE(url) << bad;
    EXPECT_NE(url.error().message.find("osc.udp://127.0.0.1:7770"), std::string::npos);
  }
}

}  // namespace
}  // namespace ringdown::wire
