// OSC over TCP, spoken to by liblo's own client and by plain sockets.
#include "protocol/wire/framing.h"
#include "tests/server/osc_server_fixture.h"
#include "tests/support/scarcity.h"

#include <arpa/inet.h>
#include <lo/lo.h>

#include <future>
#include <sys/socket.h>
#include <thread>
#include <utility>

namespace ringdown::server {
namespace {

class TcpClient {
 public:
  explicit TcpClient(std::uint16_t port, wire::Framing framing = wire::Framing::slip, const char* host = "127.0.0.1")
      : framing_(framing) {
    const wire::SocketAddress address(*wire::resolve(host, port));
    socket_ = ::socket(address.storage.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const timeval limit{.tv_sec = 60, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    EXPECT_EQ(::connect(socket_, address.generic(), address.size), 0);
  }
  ~TcpClient() { ::close(socket_); }
  TcpClient(const TcpClient&) = delete;
  TcpClient& operator=(const TcpClient&) = delete;

  void send_raw(const std::vector<std::byte>& bytes) const {
    ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  void send(const Message& message) const { send_raw(wire::frame(wire::encode(message), framing_)); }

  // How many bytes come, up to `max` or until the server cuts us off.
  [[nodiscard]] std::size_t bytes_until_silence(std::size_t max) const {
    std::vector<std::byte> bytes(65536);
    std::size_t count = 0;
    for (ssize_t got = 0; count < max && (got = ::recv(socket_, bytes.data(), bytes.size(), 0)) > 0;) {
      count += static_cast<std::size_t>(got);
    }
    return count;
  }

  // The next answer; nothing when the server has cut us off.
  std::optional<protocol::Reply> reply() {
    const auto packet = framing_ == wire::Framing::slip ? slip_packet() : counted_packet();
    if (!packet) return std::nullopt;
    const auto messages = wire::decode_packet(*packet);
    EXPECT_TRUE(messages);
    return *protocol::parse_reply(messages->front().message);
  }

 private:
  std::optional<std::vector<std::byte>> slip_packet() {
    for (std::byte byte{}; ::recv(socket_, &byte, 1, 0) == 1;) {
      if (decoder_.push(byte) == wire::SlipDecoder::Outcome::packet) return decoder_.take();
    }
    return std::nullopt;
  }
  [[nodiscard]] std::optional<std::vector<std::byte>> counted_packet() const {
    std::uint32_t length = 0;
    if (::recv(socket_, &length, sizeof length, MSG_WAITALL) != sizeof length) return std::nullopt;
    std::vector<std::byte> packet(ntohl(length));
    EXPECT_EQ(::recv(socket_, packet.data(), packet.size(), MSG_WAITALL), static_cast<ssize_t>(packet.size()));
    return packet;
  }

  wire::Framing framing_;
  int socket_ = -1;
  wire::SlipDecoder decoder_{wire::kMaxPacketBytes};
};

class OscStreamTest : public OscServerTest {
 protected:
  void SetUp() override {
    auto stream = OscStream::listen({});
    ASSERT_TRUE(stream) << stream.error().message;
    tcp_port_ = (*stream)->port();
    serve({}, std::move(*stream));
  }
  std::uint16_t tcp_port_ = 0;
};

// A client that nobody accepts would wait for ever, and poll() would not wait at all.
TEST(OscStreamAlone, AClientForWhomThereIsNoDescriptorIsTurnedAway) {
  const auto try_it = [] {
    auto stream = OscStream::listen({});
    if (!stream) std::_Exit(1);
    (*stream)->start([](std::span<const std::byte>, Peer) {});
    for (int i = 0; i < 2; ++i) {
      const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      if (i == 0) test::run_out_of_descriptors();
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      address.sin_port = htons((*stream)->port());
      const timeval limit{.tv_sec = 60, .tv_usec = 0};
      ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
      if (::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) std::_Exit(2);
      std::byte byte{};
      if (::recv(socket, &byte, 1, 0) != 0) std::_Exit(3);
      ::close(socket);
    }
    std::_Exit(0);
  };
  EXPECT_EXIT(try_it(), testing::ExitedWithCode(0), "");
}

TEST_F(OscStreamTest, AnswersComeBackOverTheTcpConnection) {
  load("bell");
  TcpClient client(tcp_port_);
  client.send(strike("bell"));
  client.send({"/sync", {7}});
  const auto synced = client.reply();
  ASSERT_TRUE(synced && synced->holds<protocol::Synced>());
  EXPECT_EQ(synced->get<protocol::Synced>().id, 7);
  onsets_until_now();
  EXPECT_EQ(session_.rack().mixer().counters().strikes, 1u);
  client.send({"/no/such/address", {}});
  const auto refused = client.reply();
  EXPECT_TRUE(refused && refused->holds<protocol::Fail>());
}

// Two strikes that come 30 ms apart while the server's thread cannot run keep their distance and their latency.
TEST_F(OscServerTest, AServerThatWakesLateKeepsTheTimesAtWhichMessagesCame) {
  load("tick");
  auto stream = OscStream::listen({});
  ASSERT_TRUE(stream) << stream.error().message;
  const TcpClient client((*stream)->port());
  serve(*parse_latency("300ms"), std::move(*stream));
  driver_.hold_server(true);
  time_.pass(2);  // it asks for its priority every second
  driver_.wait_until_held();
  std::vector<double> came;
  for (int i = 0; i < 2; ++i) {
    const int before = time_.reads();
    client.send(strike("tick"));
    while (time_.reads() == before) std::this_thread::yield();  // until the stream's thread has noted the time
    came.push_back(time_.unix_s());
    time_.pass(0.03);
  }
  time_.pass(0.1);
  driver_.hold_server(false);
  pass_until(came.back() + 0.3);
  const auto found = onsets_until_now();
  ASSERT_EQ(found.size(), came.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(found[i]), time_.frame_of(came[i] + 0.3), 2) << i;
  }
}

TEST_F(OscStreamTest, ClientsOfBothFramingsAreAnsweredInTheirOwn) {
  load("bell");
  TcpClient slip(tcp_port_), counted(tcp_port_, wire::Framing::length);
  for (std::int32_t id = 0; id < 3; ++id) {
    for (TcpClient* client : {&slip, &counted}) {
      client->send({"/sync", {id}});
      const auto synced = client->reply();
      ASSERT_TRUE(synced && synced->holds<protocol::Synced>());
      EXPECT_EQ(synced->get<protocol::Synced>().id, id);
    }
  }
  counted.send({"/notify", {true, 100.f}});
  bool noticed = false;  // notices and answers come in the client's framing, too
  for (int i = 0; i < 100 && !noticed; ++i) {
    const auto reply = counted.reply();
    ASSERT_TRUE(reply);
    noticed = protocol::format(*reply).address.starts_with("/notify.");
  }
  EXPECT_TRUE(noticed);
}

TEST_F(OscStreamTest, AClientOfIpv6IsServed) {
  if (!wire::OscSocket::bind({.address = wire::kLoopback6})) GTEST_SKIP() << "this computer has no IPv6";
  TcpClient client(tcp_port_, wire::Framing::length, "::1");
  client.send({"/version", {}});
  EXPECT_TRUE(client.reply());
}

// `set` is lo_address_set_stream_slip, which takes an int until liblo 0.31 and an enumeration since 0.32.
template <class Encoding>
void send_slip(lo_address target, int (*set)(lo_address, Encoding)) {
  set(target, static_cast<Encoding>(1));
}

// By liblo's default, lengths, and by SLIP.
TEST_F(OscStreamTest, LibloIsUnderstoodOverTcp) {
  load("bell");
  for (const bool slip : {false, true}) {
    const auto before = session_.rack().mixer().counters().strikes.load();
    lo_address target = lo_address_new_with_proto(LO_TCP, "127.0.0.1", std::to_string(tcp_port_).c_str());
    if (slip) send_slip(target, lo_address_set_stream_slip);
    ASSERT_GT(lo_send(target, "/object/bell/strike", "ffffff", 1., 0., 0., 0., 0., 1.), 0);
    ASSERT_GT(lo_send(target, "/object/bell/gain", "f", 0.5), 0);
    for (int i = 0; i < 10000 && session_.rack().mixer().counters().strikes == before; ++i) {
      onsets_until(session_.rack().mixer().counters().frames + 256);
      std::this_thread::sleep_for(5ms);
    }
    EXPECT_EQ(session_.rack().mixer().counters().strikes, before + 1);
    lo_address_free(target);
  }
}

TEST_F(OscStreamTest, ManyMessagesAtOnceArriveAllAndInOrder) {
  TcpClient client(tcp_port_);
  std::vector<std::byte> stream;
  for (int i = 0; i < 5000; ++i) {
    const auto framed = wire::slip_encode(wire::encode({"/version", {}}));
    stream.insert(stream.end(), framed.begin(), framed.end());
  }
  std::thread sender([&] { client.send_raw(stream); });
  for (int i = 0; i < 5000; ++i) {
    const auto answer = client.reply();
    ASSERT_TRUE(answer && answer->holds<protocol::VersionReply>()) << i;
  }
  sender.join();
}

TEST_F(OscStreamTest, AClientInNeitherFramingIsCutOffAndOthersAreNot) {
  TcpClient good(tcp_port_), bad(tcp_port_), endless(tcp_port_);
  bad.send_raw({std::byte{0xDB}, std::byte{'a'}});
  EXPECT_FALSE(bad.reply());
  endless.send_raw(std::vector<std::byte>(wire::kMaxPacketBytes + 1, std::byte{'x'}));
  EXPECT_FALSE(endless.reply());
  TcpClient too_long(tcp_port_), no_osc(tcp_port_);
  too_long.send_raw({std::byte{0}, std::byte{1}, std::byte{0}, std::byte{1}});  // kMaxPacketBytes + 1
  EXPECT_FALSE(too_long.reply());
  no_osc.send_raw({std::byte{0}, std::byte{0}, std::byte{0}, std::byte{4}, std::byte{'P'}, std::byte{'O'},
                   std::byte{'S'}, std::byte{'T'}});
  EXPECT_FALSE(no_osc.reply());
  good.send({"/version", {}});
  EXPECT_TRUE(good.reply());
}

TEST_F(OscStreamTest, AWebPageCannotPlayThroughABrowser) {
  const std::string request = "POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 20\r\n\r\n";
  std::vector<std::byte> stream;
  for (const char c : request) stream.push_back(static_cast<std::byte>(c));
  const std::vector<std::byte> body = wire::slip_encode(wire::encode({"/version", {}}));
  stream.insert(stream.end(), body.begin(), body.end());
  TcpClient browser(tcp_port_), good(tcp_port_);
  browser.send_raw(stream);
  EXPECT_FALSE(browser.reply());
  good.send_raw(body);
  EXPECT_TRUE(good.reply()) << "the same body alone is understood";
}

TEST_F(OscStreamTest, ConnectionsAreTakenUpToTheLimitAndNotOneMore) {
  std::vector<std::unique_ptr<TcpClient>> clients;
  for (std::size_t i = 0; i < kMaxConnections; ++i) {
    clients.push_back(std::make_unique<TcpClient>(tcp_port_));
    clients.back()->send({"/version", {}});
    ASSERT_TRUE(clients.back()->reply());
  }
  TcpClient one_more(tcp_port_);
  EXPECT_FALSE(one_more.reply());
  clients.pop_back();
  for (int i = 0; i < 1000; ++i) {
    TcpClient again(tcp_port_);
    again.send({"/version", {}});
    if (again.reply()) return;
    std::this_thread::sleep_for(10ms);
  }
  FAIL() << "a place that became free was not given again";
}

// It never reads, while its answers pile up: it is cut off instead of growing our memory.
TEST_F(OscStreamTest, AClientThatDoesNotReadItsAnswersIsCutOff) {
  TcpClient deaf(tcp_port_);
  const auto request = wire::slip_encode(wire::encode({"/version", {}}));
  std::vector<std::byte> many;
  for (int i = 0; i < 1000; ++i) many.insert(many.end(), request.begin(), request.end());
  std::thread sender([&] {
    for (int i = 0; i < 300; ++i) deaf.send_raw(many);  // ends when we are cut off, or is 300,000 answers: 15 MB
  });
  sender.join();
  TcpClient good(tcp_port_);
  good.send({"/version", {}});
  EXPECT_TRUE(good.reply());
  int answers = 0;
  while (deaf.reply()) ++answers;
  EXPECT_LT(answers, 300000);
}

// The whole answer waits for the client, in one piece.
TEST(OscStream, AnswersWaitForAClientUpToTheLimitAndNotAByteMore) {
  for (const std::size_t more : {0u, 1u}) {
    auto stream = OscStream::listen({});
    ASSERT_TRUE(stream) << stream.error().message;
    std::promise<Peer> met;
    (*stream)->start([&](std::span<const std::byte>, Peer from) { met.set_value(from); });
    const TcpClient client((*stream)->port());
    client.send({"/version", {}});
    const std::size_t frame = wire::slip_encode(std::vector<std::byte>(1)).size() - 1;  // what SLIP adds to zeros
    const std::vector<std::byte> packet(kMaxUnreadBytes - frame + more);
    ASSERT_EQ(wire::slip_encode(packet).size(), kMaxUnreadBytes + more);
    (*stream)->send(met.get_future().get(), packet);
    EXPECT_EQ(client.bytes_until_silence(kMaxUnreadBytes), more == 0 ? kMaxUnreadBytes : 0);
    (*stream)->stop();
  }
}

}  // namespace
}  // namespace ringdown::server
