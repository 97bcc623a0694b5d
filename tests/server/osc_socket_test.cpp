#include "protocol/wire/socket.h"

#include "tests/server/osc_bytes.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <thread>

namespace ringdown::wire {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// The local address the kernel itself states for a UDP port, from /proc/net/udp: eight hex digits of the address.
std::string kernels_address_of(std::uint16_t port) {
  std::ifstream table("/proc/net/udp");
  char wanted[8];
  std::snprintf(wanted, sizeof wanted, ":%04X", port);
  for (std::string line; std::getline(table, line);) {
    std::istringstream fields(line);
    std::string slot, local;
    fields >> slot >> local;
    if (local.ends_with(wanted)) return local.substr(0, 8);
  }
  return "none";
}

TEST(OscSocket, ASocketListensOnLoopbackOnly) {
  const auto socket = OscSocket::bind();
  ASSERT_TRUE(socket) << socket.error().message;
  ASSERT_NE(socket->port(), 0);
  EXPECT_EQ(kernels_address_of(socket->port()), "0100007F");
}

TEST(OscSocket, ASocketListensElsewhereWhenAsked) {
  const auto socket = OscSocket::bind(*resolve("0.0.0.0", 0));
  ASSERT_TRUE(socket) << socket.error().message;
  EXPECT_EQ(kernels_address_of(socket->port()), "00000000");
}

TEST(OscSocket, ATakenPortIsOneSentence) {
  const auto first = OscSocket::bind();
  ASSERT_TRUE(first);
  const auto second = OscSocket::bind(first->endpoint());
  ASSERT_FALSE(second);
  const std::string& sentence = second.error().message;
  EXPECT_NE(sentence.find(to_text(first->endpoint())), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("taken"), std::string::npos) << sentence;
}

TEST(OscSocket, AForeignAddressIsRefused) {
  EXPECT_FALSE(OscSocket::bind(*resolve("192.0.2.1", 0)));  // TEST-NET-1, RFC 5737: nobody's
  EXPECT_FALSE(resolve("no.such.host.invalid", 1));         // RFC 2606
}

TEST(OscSocket, ADatagramArrivesWithItsSender) {
  auto receiver = OscSocket::bind();
  auto sender = OscSocket::bind();
  ASSERT_TRUE(receiver && sender);
  for (const std::size_t size : {std::size_t{4}, std::size_t{65504}}) {
    const Bytes sent(size, std::byte{42});
    ASSERT_TRUE(sender->send_to(receiver->endpoint(), sent));
    Datagram datagram;
    ASSERT_TRUE(receiver->receive(datagram, seconds(10)));
    EXPECT_EQ(datagram.bytes, sent);
    EXPECT_EQ(datagram.from, sender->endpoint());
  }
}

TEST(OscSocket, AnAnswerFindsItsWayBack) {
  auto a = OscSocket::bind();
  auto b = OscSocket::bind();
  Datagram datagram;
  ASSERT_TRUE(a->send_to(b->endpoint(), Bytes(4)));
  ASSERT_TRUE(b->receive(datagram, seconds(10)));
  ASSERT_TRUE(b->send_to(datagram.from, Bytes(8)));
  ASSERT_TRUE(a->receive(datagram, seconds(10)));
  EXPECT_EQ(datagram.bytes.size(), 8u);
}

TEST(OscSocket, AReceiveEndsWithItsTimeout) {
  auto socket = OscSocket::bind();
  Datagram datagram;
  EXPECT_FALSE(socket->receive(datagram, milliseconds(1)));
}

TEST(OscSocket, AnotherThreadCanWakeTheReceiver) {
  auto socket = OscSocket::bind();
  std::thread waker([&] { socket->wake(); });
  Datagram datagram;
  EXPECT_FALSE(socket->receive(datagram, seconds(100)));  // the test's own time limit is the clock
  waker.join();
  ASSERT_TRUE(socket->send_to(socket->endpoint(), Bytes(4)));
  EXPECT_TRUE(socket->receive(datagram, seconds(10))) << "one wake() ends one receive()";
}

TEST(OscSocket, AFloodWithinTheBufferIsNotLost) {
  auto receiver = OscSocket::bind();
  auto sender = OscSocket::bind();
  // The kernel counts bookkeeping, about 768 bytes for a small datagram, against the buffer.
  const std::size_t count = receiver->receive_buffer_bytes() / 1024;
  ASSERT_GE(count, 100u);
  for (std::size_t i = 0; i < count; ++i) ASSERT_TRUE(sender->send_to(receiver->endpoint(), Bytes(64)));
  Datagram datagram;
  std::size_t arrived = 0;
  while (arrived < count && receiver->receive(datagram, seconds(10))) ++arrived;
  EXPECT_EQ(arrived, count);
}

TEST(OscSocket, AMovedSocketKeepsItsPort) {
  auto socket = OscSocket::bind();
  const Endpoint endpoint = socket->endpoint();
  OscSocket moved = std::move(*socket);
  EXPECT_EQ(moved.endpoint(), endpoint);
  ASSERT_TRUE(moved.send_to(endpoint, Bytes(4)));
  Datagram datagram;
  EXPECT_TRUE(moved.receive(datagram, seconds(10)));
}

}  // namespace
}  // namespace ringdown::wire
