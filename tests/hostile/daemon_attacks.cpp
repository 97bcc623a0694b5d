// Bytes for the ports of a daemon that plays, captures its sound and records its score meanwhile. From time to time it
// must answer, and in the end what it has written must be whole.
#include "protocol/schema.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/score.h"
#include "protocol/wire/slip.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/targets.h"
#include "tests/hostile/attack.h"
#include "tests/hostile/playing.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/support/http_client.h"

#include <sndfile.h>

#include <algorithm>
#include <array>
#include <optional>
#include <fstream>
#include <iterator>

namespace ringdown::hostile {
namespace {

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Returns true if a packet asks the daemon to quit or to write files, which it is meant to obey. Such packets would end
// the attack and are not sent.
bool is_command(const std::string& packet) {
  constexpr const char* kCommands[] = {"/quit", "/capture", "/record"};
  return std::ranges::any_of(kCommands, [&](const char* word) { return packet.find(word) != std::string::npos; });
}

class DaemonAttack : public Attack {
 public:
  DaemonAttack() {
    daemon_.emplace(std::vector<std::string>{"--settings", "none", "--driver", "null", "--limiter", "off", "--tcp", "0",
                                             "--query", "0", "--root", stage_.folder().string()});
    fuzz::expect(daemon_->ready(), "the daemon starts");
    fuzz::expect(answers(), "the daemon answers at first");
    for (const wire::Message& message : keep_playing()) daemon_->send(message);
    daemon_->send({"/capture/start", {std::string("heard.wav")}});
    daemon_->send({"/record/start", {std::string("score.osc")}});
    fuzz::expect(answers(), "the daemon answers before the attack");
  }

  void feed(const std::string& input, Random& random) override {
    constexpr std::size_t kInputsPerQuestion = 64, kInputsPerLoad = 2048;
    send(input, random);
    if (++fed_ % kInputsPerQuestion != 0) return;
    for (const wire::Message& message : play_on(random)) daemon_->send(message);
    if (fed_ % kInputsPerLoad == 0) {
      for (const wire::Message& message : keep_playing()) daemon_->send(message);
    }
    fuzz::expect(answers(), "the daemon answers under attack");
  }

  void finish() override {
    daemon_->send({"/scene/clear", {}});
    fuzz::expect(answers(), "the daemon answers after the attack");
    daemon_->send({"/capture/stop", {}});
    daemon_->send({"/record/stop", {}});
    fuzz::expect(answers(), "the daemon has completed its files");
    daemon_->process().send_signal(SIGTERM);
    fuzz::expect(daemon_->process().wait() == 0, "the daemon ends by itself");
    expect_whole_sound();
    std::ifstream file("score.osc", std::ios::binary);
    const std::string score{std::istreambuf_iterator<char>(file), {}};
    const auto events = wire::parse_score(std::as_bytes(std::span(score)), "score.osc");
    fuzz::expect(events.has_value(), events ? "" : events.error().message.c_str());
    fuzz::expect(!events->empty(), "the recorded score is whole");
  }

 protected:
  virtual void send(const std::string& input, Random& random) = 0;
  [[nodiscard]] test::Daemon& daemon() { return *daemon_; }
  // The port that the daemon has announced after these words.
  [[nodiscard]] std::uint16_t port_after(const std::string& words) {
    const std::string output = daemon_->process().output();
    const std::size_t at = output.find(words);
    fuzz::expect(at != std::string::npos, "the daemon says where it listens");
    return static_cast<std::uint16_t>(std::stoi(output.substr(at + words.size())));
  }

 private:
  // Returns true once the daemon has done all that was sent before. Answers to the attack itself are passed over.
  [[nodiscard]] bool answers() {
    daemon_->send({"/sync", {++questions_}});
    daemon_->send({"/status", {}});
    for (bool synced = false, status = false; !synced || !status;) {
      const auto replies = daemon_->packet();
      if (replies.empty()) return false;
      for (const protocol::Reply& reply : replies) {
        const auto* done = reply.get_if<protocol::Synced>();
        synced = synced || (done && done->id == questions_);
        status = status || reply.holds<protocol::StatusReply>();
      }
    }
    return true;
  }

  void expect_whole_sound() {
    SF_INFO info{};
    SNDFILE* const file = sf_open("heard.wav", SFM_READ, &info);
    fuzz::expect(file != nullptr && info.frames > 0, "the captured sound is whole");
    std::array<float, 4096> samples;
    sf_count_t read = 0, all = 0;
    while ((read = sf_read_float(file, samples.data(), static_cast<sf_count_t>(samples.size()))) > 0) {
      all += read;
      fuzz::expect(std::all_of(samples.begin(), samples.begin() + read, [](float x) { return std::isfinite(x); }),
                   "every captured sample is finite");
    }
    fuzz::expect(all == info.frames * info.channels, "the captured sound has the length that it states");
    sf_close(file);
  }

  Stage stage_;
  std::optional<test::Daemon> daemon_;
  std::size_t fed_ = 0;
  std::int32_t questions_ = 0;
};

// OSC packets: changed ones of the corpus, and requests from the table, alone and in bundles.
class PacketAttack : public DaemonAttack {
 public:
  std::string make(Random& random) override {
    std::string packet;
    if (random.one_in(3)) {
      packet = mutator_.next(random.engine(), 16384);
    } else if (random.one_in(3)) {
      std::vector<wire::Message> messages;
      for (std::size_t n = random.below(8); n > 0; --n) messages.push_back(hostile_message(random, names()));
      packet = text_of(wire::encode_bundle(random.engine()(), messages));
    } else {
      packet = text_of(wire::encode(hostile_message(random, names())));
    }
    if (random.one_in(6) && !packet.empty())
      packet[random.below(packet.size())] ^= static_cast<char>(1 + random.below(255));
    return is_command(packet) ? "/status" : packet;
  }

 private:
  fuzz::Mutator mutator_{fuzz::inputs_of({RINGDOWN_SOURCE_DIR "/tests/fuzz/corpus/osc"})};
};

class DatagramAttack : public PacketAttack {
  void send(const std::string& input, Random& /*random*/) override {
    static_cast<void>(socket_.send_to({.port = daemon().port()}, std::as_bytes(std::span(input))));
  }
  wire::OscSocket socket_ = *wire::OscSocket::bind();
};

// One connection for each input, which holds a packet or a few bytes of one, framed one way or the other.
class StreamAttack : public PacketAttack {
  void send(const std::string& input, Random& random) override {
    const std::string framed = frame(input, random);
    test::HttpConnection connection(port_);
    fuzz::expect(connection.open(), "the daemon takes a TCP connection");
    connection.send(
        std::string_view(framed).substr(0, random.one_in(4) ? random.below(framed.size() + 1) : framed.size()));
  }
  virtual std::string frame(const std::string& packet, Random& random) = 0;
  std::uint16_t port_ = port_after("OSC by TCP on 127.0.0.1:");
};

class SlipAttack : public StreamAttack {
  std::string frame(const std::string& packet, Random& random) override {
    std::string framed = text_of(wire::slip_encode(std::as_bytes(std::span(packet))));
    if (random.one_in(3)) framed += framed;
    return framed;
  }
};

// A length of four bytes before each packet: OSC 1.0 over TCP. Some lengths lie.
class LengthAttack : public StreamAttack {
  std::string frame(const std::string& packet, Random& random) override {
    const auto length = random.one_in(5) ? static_cast<std::uint32_t>(random.engine()() >> random.below(33))
                                         : static_cast<std::uint32_t>(packet.size());
    std::string framed;
    for (int shift = 24; shift >= 0; shift -= 8) framed += static_cast<char>(length >> shift & 0xff);
    framed += packet;
    return random.one_in(3) ? framed + framed : framed;
  }
};

// HTTP and what is none, for the OSCQuery port.
class QueryAttack : public DaemonAttack {
 public:
  std::string make(Random& random) override { return mutator_.next(random.engine(), 16384); }

 private:
  void send(const std::string& input, Random& random) override {
    const std::string request = input.starts_with('/') ? "GET " + input + " HTTP/1.1\r\nHost: x\r\n\r\n" : input;
    const auto from = static_cast<std::uint32_t>(INADDR_LOOPBACK + 1 + random.below(60000));
    test::HttpConnection connection(port_, from);
    fuzz::expect(connection.open(), "the daemon takes an HTTP connection");
    connection.send(request);
    connection.end();
    const std::string text = connection.receive();
    fuzz::expect(text.empty() || test::parse_http(text).status >= 100, "an answer is one of HTTP");
  }
  fuzz::Mutator mutator_{fuzz::inputs_of({RINGDOWN_SOURCE_DIR "/tests/fuzz/corpus/http"})};
  std::uint16_t port_ = port_after("OSCQuery on http://127.0.0.1:");
};

template <class Kind>
std::unique_ptr<Attack> begin(const std::string& /*name*/) {
  return std::make_unique<Kind>();
}

}  // namespace

std::vector<Kind> daemon_kinds() {
  std::vector<Kind> kinds;
  kinds.push_back({"udp-port", 20, 0, begin<DatagramAttack>});
  kinds.push_back({"tcp-slip-port", 3, 0, begin<SlipAttack>});
  kinds.push_back({"tcp-length-port", 3, 0, begin<LengthAttack>});
  kinds.push_back({"http-port", 2, 0, begin<QueryAttack>});
  return kinds;
}

}  // namespace ringdown::hostile
