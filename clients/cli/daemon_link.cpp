#include "clients/cli/daemon_link.h"

#include "protocol/schema.h"
#include "protocol/wire/codec.h"

#include <optional>
#include <utility>
#include <variant>

namespace ringdown::cli {
namespace {

using protocol::Reply;
using wire::Message;
using Clock = std::chrono::steady_clock;

// Returns whether `reply` is about the message sent to `address`, for which `expected` is the address of success.
bool answers(const Message& message, const Reply& reply, std::string_view address, std::string_view expected) {
  if (const auto* fail = reply.get_if<protocol::Fail>()) return fail->address == address;
  if (const auto* done = reply.get_if<protocol::Done>()) return done->address == address;
  return message.address == expected;
}

std::optional<Reply> find_answer(const wire::Datagram& datagram, std::string_view address, std::string_view expected) {
  const auto messages = wire::decode_packet(datagram.bytes);
  if (!messages) return std::nullopt;
  for (const auto& [time, message] : *messages) {
    Result<Reply> reply = protocol::parse_reply(message);
    if (reply && answers(message, *reply, address, expected)) return std::move(*reply);
  }
  return std::nullopt;
}

}  // namespace

Result<DaemonLink> DaemonLink::open(const std::string& url) {
  const auto parsed = wire::parse_url(url);
  if (!parsed) return fail(parsed);
  const auto daemon = wire::resolve(parsed->host, parsed->port);
  if (!daemon) return fail(daemon);
  auto socket = wire::OscSocket::reach(*daemon);
  if (!socket) return fail(socket);
  return DaemonLink(std::move(*socket), *daemon, url);
}

Result<Reply> DaemonLink::ask(const Message& message, std::chrono::milliseconds timeout) {
  const auto spec = protocol::find_address(message.address);
  if (!spec) return fail(spec);
  const bool silent = (*spec)->reply.empty();
  if (Result<void> sent = socket_.send_to(daemon_, wire::encode(message)); !sent) return fail(sent);
  if (silent) {
    const Message sync = protocol::format(protocol::Request(protocol::Sync{1}));
    if (Result<void> sent = socket_.send_to(daemon_, wire::encode(sync)); !sent) return fail(sent);
  }
  const std::string_view expected = silent ? "/synced" : (*spec)->reply;
  wire::Datagram datagram;
  for (const auto deadline = Clock::now() + timeout;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) break;
    if (!socket_.receive(datagram, left)) continue;
    if (std::optional<Reply> reply = find_answer(datagram, message.address, expected)) return std::move(*reply);
  }
  return fail(ErrorKind::refused,
              "no answer from a daemon at " + url_ + ": start ringdownd, or name the right one with --to");
}

}  // namespace ringdown::cli
