// OSC as clients of all kinds send it to a daemon: switches as true and false, messages without type tags, both
// framings of TCP, and IPv6.
#include "engine/modal/bank_file.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <sys/socket.h>
#include <unistd.h>

namespace ringdown::test {
namespace {

bool has_ipv6() { return wire::OscSocket::bind({.address = wire::kLoopback6}).has_value(); }

class OscDoors : public testing::Test {
 protected:
  void SetUp() override {
    const std::string bank = folder_ / "low.glb";
    ASSERT_TRUE(modal::write_bank(single_mode_bank(300, 0.1), bank));
    daemon_.emplace(std::vector<std::string>{"--settings", "none", "--driver", "null", "--object", "low=" + bank,
                                             "--tcp", "0", "--query", "0"});
    ASSERT_TRUE(daemon_->ready()) << daemon_->process().output();
  }

  // The port behind these words of the log.
  [[nodiscard]] std::uint16_t logged_port(const std::string& announcement) {
    const std::string output = daemon_->process().output();
    return static_cast<std::uint16_t>(std::stoi(output.substr(output.find(announcement) + announcement.size())));
  }
  [[nodiscard]] protocol::ObjectReply object() {
    return ask_for<protocol::ObjectReply>(*daemon_, {"/object/low/describe", {}}).value_or(protocol::ObjectReply{});
  }
  void oscsend(const std::string& url, const std::vector<std::string>& words) {
    std::vector<std::string> command = {"oscsend", url};
    command.insert(command.end(), words.begin(), words.end());
    const Outcome sent = run(command);
    EXPECT_EQ(sent.exit_code, 0) << sent.output;
  }

  TemporaryFolder folder_;
  std::optional<Daemon> daemon_;
};

TEST_F(OscDoors, SwitchesGoOnAndOffByTrueAndFalse) {
  if (!installed("oscsend")) GTEST_SKIP() << "oscsend (liblo-tools) is not installed";
  const std::string url = "osc.udp://127.0.0.1:" + std::to_string(daemon_->port());
  for (const bool on : {true, false, true}) {
    oscsend(url, {"/object/low/mute", on ? "T" : "F"});
    EXPECT_TRUE(becomes_true([&] { return object().mute == on; })) << on;
  }
}

TEST_F(OscDoors, AMessageWithoutTypeTagsIsServed) {
  auto client = wire::OscSocket::bind();
  ASSERT_TRUE(client);
  const auto ask = [&](const std::string& packet) -> protocol::Reply {
    EXPECT_TRUE(client->send_to({.port = daemon_->port()}, std::as_bytes(std::span(packet))));
    wire::Datagram datagram;
    if (!client->receive(datagram, kPatience)) return protocol::Done{};
    return *protocol::parse_reply(wire::decode_packet(datagram.bytes)->front().message);
  };
  EXPECT_TRUE(ask(std::string("/status\0", 8)).holds<protocol::StatusReply>());
  const auto refused = ask(std::string("/object/low/gain\0\0\0\0\x3f\0\0\0", 24));
  ASSERT_TRUE(refused.holds<protocol::Fail>());
  EXPECT_NE(refused.get<protocol::Fail>().sentence.find("type tags are missing"), std::string::npos);
}

// oscsend frames by lengths, connects, sends and leaves.
TEST_F(OscDoors, OscsendPlaysOverTcp) {
  if (!installed("oscsend")) GTEST_SKIP() << "oscsend (liblo-tools) is not installed";
  const std::uint16_t port = logged_port("OSC by TCP on 127.0.0.1:");
  oscsend("osc.tcp://127.0.0.1:" + std::to_string(port), {"/object/low/gain", "f", "0.25"});
  EXPECT_TRUE(becomes_true([&] { return object().gain == 0.25; }));
}

TEST_F(OscDoors, WhatIsNoOscByTcpIsSaidInTheLog) {
  const wire::SocketAddress address(*wire::resolve("127.0.0.1", logged_port("OSC by TCP on 127.0.0.1:")));
  const wire::Descriptor client(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  ASSERT_EQ(::connect(client.get(), address.generic(), address.size), 0);
  const std::string request = "GET / HTTP/1.1\r\n\r\n\xC0";
  ASSERT_EQ(::send(client.get(), request.data(), request.size(), MSG_NOSIGNAL), static_cast<ssize_t>(request.size()));
  EXPECT_TRUE(daemon_->process().wait_for_output("the TCP connection is closed"));
}

TEST_F(OscDoors, TheDaemonIsReachedByIpv6) {
  if (!has_ipv6()) GTEST_SKIP() << "this computer has no IPv6";
  const std::string url = "osc.udp://[::1]:" + std::to_string(daemon_->port());
  const Outcome asked = run({program("ringdown"), "send", "--to", url, "/version"});
  EXPECT_EQ(asked.exit_code, 0) << asked.output;
  EXPECT_NE(asked.output.find("ringdownd"), std::string::npos) << asked.output;

  const wire::SocketAddress address(*wire::resolve("::1", logged_port("OSCQuery on http://127.0.0.1:")));
  for (int i = 0; i < 3; ++i) {
    const wire::Descriptor client(::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0));
    ASSERT_EQ(::connect(client.get(), address.generic(), address.size), 0);
    const std::string request = "GET /?HOST_INFO HTTP/1.0\r\n\r\n";
    ASSERT_EQ(::send(client.get(), request.data(), request.size(), 0), static_cast<ssize_t>(request.size()));
    std::string answer(65536, '\0');
    answer.resize(static_cast<std::size_t>(std::max<ssize_t>(0, ::recv(client.get(), answer.data(), 15, MSG_WAITALL))));
    EXPECT_EQ(answer, "HTTP/1.1 200 OK");
  }
}

TEST(OscAddress, AMulticastAddressIsRefusedInASentence) {
  for (const char* group : {"224.0.0.1", "239.1.2.3", "ff02::1"}) {
    const Outcome refused =
        run({program("ringdownd"), "--settings", "none", "--driver", "null", "--port", "0", "--address", group});
    EXPECT_EQ(refused.exit_code, 2) << refused.output;
    EXPECT_NE(refused.output.find(std::string(group) + " is a multicast address"), std::string::npos) << refused.output;
  }
}

}  // namespace
}  // namespace ringdown::test
