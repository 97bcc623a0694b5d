#include "protocol/wire/socket.h"

#include "tests/server/osc_bytes.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <fstream>
#include <net/if.h>
#include <sched.h>
#include <sstream>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <thread>
#include <utility>

namespace ringdown::wire {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// The local address the kernel itself states for a UDP port, from /proc/net/udp: eight hex digits of the address.
// Addresses of IPv6 have 32 digits, in /proc/net/udp6.
std::string kernels_address_of(std::uint16_t port, const char* file = "/proc/net/udp") {
  std::ifstream table(file);
  char wanted[8];
  std::snprintf(wanted, sizeof wanted, ":%04X", port);
  for (std::string line; std::getline(table, line);) {
    std::istringstream fields(line);
    std::string slot, local;
    fields >> slot >> local;
    if (local.ends_with(wanted)) return local.substr(0, local.find(':'));
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

bool has_ipv6() { return OscSocket::bind({.address = kLoopback6}).has_value(); }

TEST(OscSocket, AServerListensOnBothLoopbacksOrOnAllAddresses) {
  if (!has_ipv6()) GTEST_SKIP() << "this computer has no IPv6";
  const auto own = OscSocket::serve({}), all = OscSocket::serve(*resolve("0.0.0.0", 0));
  ASSERT_TRUE(own && all);
  EXPECT_EQ(kernels_address_of(own->port()), "0100007F");
  EXPECT_EQ(kernels_address_of(own->port(), "/proc/net/udp6"), "00000000000000000000000001000000");
  EXPECT_EQ(kernels_address_of(all->port()), "00000000");
  EXPECT_EQ(kernels_address_of(all->port(), "/proc/net/udp6"), "00000000000000000000000000000000");
  const auto other = OscSocket::serve(*resolve("127.0.0.2", 0)), six = OscSocket::serve(*resolve("::1", 0));
  ASSERT_TRUE(other && six);
  EXPECT_EQ(kernels_address_of(other->port(), "/proc/net/udp6"), "none") << "only what was asked for";
  EXPECT_EQ(kernels_address_of(six->port()), "none");
}

TEST(OscSocket, AServerAnswersClientsOfBothVersionsOfIp) {
  if (!has_ipv6()) GTEST_SKIP() << "this computer has no IPv6";
  auto server = OscSocket::serve({});
  ASSERT_TRUE(server) << server.error().message;
  std::vector<OscSocket> clients;
  for (const char* host : {"127.0.0.1", "::1"}) {
    auto client = OscSocket::reach(*resolve(host, server->port()));
    ASSERT_TRUE(client) << client.error().message;
    clients.push_back(std::move(*client));
  }
  // Both clients ask before anything is read, several times: none waits behind the other.
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(clients[0].send_to(*resolve("127.0.0.1", server->port()), Bytes(4)));
    ASSERT_TRUE(clients[1].send_to(*resolve("::1", server->port()), Bytes(8)));
  }
  Datagram datagram;
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(server->receive(datagram, seconds(10)));
    EXPECT_EQ(datagram.from, clients[datagram.bytes.size() == 4 ? 0 : 1].endpoint());
    ASSERT_TRUE(server->send_to(datagram.from, datagram.bytes));
  }
  for (std::size_t i = 0; i < clients.size(); ++i) {
    for (int round = 0; round < 3; ++round) {
      ASSERT_TRUE(clients[i].receive(datagram, seconds(10)));
      EXPECT_EQ(datagram.bytes.size(), 4 + 4 * i);
      EXPECT_EQ(datagram.from.port, server->port());
    }
  }
  EXPECT_FALSE(clients[0].send_to(*resolve("::1", server->port()), Bytes(4))) << "an IPv4 socket reaches no IPv6";
}

TEST(OscSocket, APortThatIsTakenForIpv6IsTaken) {
  if (!has_ipv6()) GTEST_SKIP() << "this computer has no IPv6";
  const auto six = OscSocket::bind({.address = kLoopback6});
  ASSERT_TRUE(six);
  const auto server = OscSocket::serve({.port = six->port()});
  ASSERT_FALSE(server);
  EXPECT_NE(server.error().message.find("[::1]:" + std::to_string(six->port()) + " is taken"), std::string::npos)
      << server.error().message;
}

// In a network of its own, where the loopback is up but IPv6 is off. Returns 0 when a server worked there, 1 when not,
// and 2 where such a network cannot be made.
int serve_without_ipv6() {
  if (::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return 2;
  const int control = ::socket(AF_INET, SOCK_DGRAM, 0);
  ifreq loopback{};
  std::snprintf(loopback.ifr_name, sizeof loopback.ifr_name, "lo");
  loopback.ifr_flags = IFF_UP;
  if (::ioctl(control, SIOCSIFFLAGS, &loopback) != 0) return 2;
  std::ofstream("/proc/sys/net/ipv6/conf/all/disable_ipv6") << "1" << std::endl;
  if (has_ipv6()) return 2;
  for (const char* host : {"127.0.0.1", "0.0.0.0"}) {
    auto server = OscSocket::serve(*resolve(host, 0));
    auto client = OscSocket::bind();
    Datagram datagram;
    if (!server || !client || !client->send_to({.port = server->port()}, Bytes(4))) return 1;
    if (!server->receive(datagram, seconds(10)) || datagram.from != client->endpoint()) return 1;
  }
  return 0;
}

TEST(OscSocket, AServerWorksWhereIpv6IsOff) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(serve_without_ipv6());
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 2) GTEST_SKIP() << "no network without IPv6 can be made here";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(OscSocket, AddressesAreReadAndWritten) {
  EXPECT_EQ(to_text(*resolve("127.0.0.1", 7770)), "127.0.0.1:7770");
  EXPECT_EQ(to_text(*resolve("::1", 7770)), "[::1]:7770");
  EXPECT_EQ(resolve("localhost", 1)->address, kLoopback4) << "older daemons serve IPv4 only";
  for (const char* loopback : {"127.0.0.1", "127.0.1.1", "::1"}) EXPECT_TRUE(resolve(loopback, 1)->is_loopback());
  for (const char* open : {"0.0.0.0", "::", "192.0.2.1", "2001:db8::1"}) {
    EXPECT_FALSE(resolve(open, 1)->is_loopback()) << open;
    EXPECT_FALSE(resolve(open, 1)->is_multicast()) << open;
  }
  for (const char* group : {"224.0.0.1", "239.255.255.255", "ff02::1"}) EXPECT_TRUE(resolve(group, 1)->is_multicast());
  EXPECT_FALSE(resolve("223.255.255.255", 1)->is_multicast());
  EXPECT_FALSE(resolve("240.0.0.1", 1)->is_multicast());
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
