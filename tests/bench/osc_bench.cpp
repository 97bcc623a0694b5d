// A flood of strikes over UDP at a running daemon, and how it is afterwards:
//
//   ringdown_osc_bench PORT OBJECT [MESSAGES_PER_S] [SECONDS] [SENDERS]
//
// prints one line of CSV: what was sent, what of it the kernel lost because the daemon's queue was full, the xruns,
// drops, merges and late events it caused, how busy the callback was, and how long the daemon then took to answer
// /status. The senders are processes of their own.
#include "protocol/schema.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/socket.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

using namespace ringdown;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

// Asks again every 10 ms, for up to 10 s: the flood may still fill the kernel's queue, which then drops what comes.
std::optional<protocol::StatusReply> ask_status(wire::OscSocket& socket, wire::Endpoint daemon) {
  wire::Datagram datagram;
  for (int tries = 0; tries < 1000; ++tries) {
    static_cast<void>(socket.send_to(daemon, wire::encode({"/status", {}})));
    if (!socket.receive(datagram, std::chrono::milliseconds(10))) continue;
    const auto messages = wire::decode_packet(datagram.bytes);
    const auto reply = messages ? protocol::parse_reply(messages->front().message) : fail(messages.error());
    if (const auto* status = reply ? reply->get_if<protocol::StatusReply>() : nullptr) return *status;
  }
  return std::nullopt;
}

// Sends in batches of 64, each when its time has come. Returns how many.
std::size_t flood(wire::Endpoint daemon, const std::vector<std::byte>& packet, double rate_hz, double seconds) {
  constexpr std::size_t kBatch = 64;
  wire::SocketAddress address(daemon);
  const int socket = ::socket(address.storage.ss_family, SOCK_DGRAM, 0);
  iovec bytes{const_cast<std::byte*>(packet.data()), packet.size()};
  std::vector<mmsghdr> batch(kBatch);
  for (mmsghdr& message : batch) {
    message.msg_hdr = {};
    message.msg_hdr.msg_name = &address.storage;
    message.msg_hdr.msg_namelen = address.size;
    message.msg_hdr.msg_iov = &bytes;
    message.msg_hdr.msg_iovlen = 1;
  }
  std::size_t sent = 0;
  for (const auto begin = Clock::now(); seconds_since(begin) < seconds;) {
    if (static_cast<double>(sent) > rate_hz * seconds_since(begin)) {
      ::usleep(50);
      continue;
    }
    sent += static_cast<std::size_t>(std::max(0, ::sendmmsg(socket, batch.data(), kBatch, 0)));
  }
  return sent;
}

// Sends at that rate from several processes, which share it.
std::size_t flood_from(std::size_t senders, wire::Endpoint daemon, const std::vector<std::byte>& packet, double rate_hz,
                       double seconds) {
  auto* const counts = static_cast<std::size_t*>(
      ::mmap(nullptr, senders * sizeof(std::size_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  for (std::size_t i = 0; i < senders; ++i) {
    if (::fork() != 0) continue;
    counts[i] = flood(daemon, packet, rate_hz / static_cast<double>(senders), seconds);
    ::_exit(0);
  }
  std::size_t sent = 0;
  for (std::size_t i = 0; i < senders; ++i) ::wait(nullptr);
  for (std::size_t i = 0; i < senders; ++i) sent += counts[i];
  ::munmap(counts, senders * sizeof(std::size_t));
  return sent;
}

// Datagrams that came when the socket's queue was full, since it was opened.
long lost_at(std::uint16_t port) {
  char local[8];
  std::snprintf(local, sizeof local, ":%04X", port);
  std::ifstream table("/proc/net/udp");
  for (std::string line; std::getline(table, line);) {
    std::istringstream fields(line);
    std::string slot, address, last;
    fields >> slot >> address;
    if (!address.ends_with(local)) continue;
    while (fields >> last) {
    }
    return std::atol(last.c_str());
  }
  return 0;
}

}  // namespace

int main(int count, char** words) {
  if (count < 3) {
    std::fprintf(stderr, "ringdown_osc_bench PORT OBJECT [MESSAGES_PER_S] [SECONDS] [SENDERS]\n");
    return 2;
  }
  const wire::Endpoint daemon{.port = static_cast<std::uint16_t>(std::atoi(words[1]))};
  const double rate_hz = count > 3 ? std::atof(words[3]) : 200000, seconds = count > 4 ? std::atof(words[4]) : 10;
  const std::size_t senders = count > 5 ? static_cast<std::size_t>(std::max(1, std::atoi(words[5]))) : 1;
  auto socket = wire::OscSocket::bind();
  const auto before = socket ? ask_status(*socket, daemon) : std::nullopt;
  if (!before) {
    std::fprintf(stderr, "no daemon answers on port %s\n", words[1]);
    return 6;
  }
  const auto strike = protocol::format(protocol::Strike{{.name = words[2]}, {{0.05, 0, 0.02}, {-1e-6, 0, 0}, 0.0005}});
  const long lost_before = lost_at(daemon.port);
  const std::size_t sent = flood_from(senders, daemon, wire::encode(strike), rate_hz, seconds);
  const auto begin = Clock::now();
  const auto after = ask_status(*socket, daemon);
  const double answer_ms = 1000 * seconds_since(begin);
  const long lost = lost_at(daemon.port) - lost_before;
  if (!after) {
    std::fprintf(stderr, "the daemon does not answer any more\n");
    return 1;
  }
  std::printf(
      "sent_per_s,lost_per_s,xruns,own_xruns,misses,dropped,merged,late,load_mean,load_peak,status_ms\n"
      "%.0f,%.0f,%d,%d,%d,%d,%d,%d,%.3f,%.3f,%.1f\n",
      static_cast<double>(sent) / seconds, static_cast<double>(lost) / seconds, after->xruns - before->xruns,
      after->own_xruns - before->own_xruns, after->misses - before->misses,
      after->dropped_events - before->dropped_events, after->merged_events - before->merged_events,
      after->late_events - before->late_events, after->load_mean, after->load_peak, answer_ms);
}
