#include "server/nsm_messages.h"

#include "protocol/wire/codec.h"

#include <utility>

namespace ringdown::server {
namespace {

std::string text_at(const wire::Message& message, std::size_t at) {
  const auto* text = at < message.arguments.size() ? std::get_if<std::string>(&message.arguments[at]) : nullptr;
  return text ? *text : "";
}

}  // namespace

std::optional<NsmRequest> parse_nsm(std::span<const std::byte> datagram) {
  using Kind = NsmRequest::Kind;
  const auto messages = wire::decode_packet(datagram);
  if (!messages || messages->empty()) return std::nullopt;
  const wire::Message& message = messages->front().message;
  if (message.address == "/nsm/client/save") return NsmRequest{Kind::save};
  if (message.address == "/error" && text_at(message, 0) == "/nsm/server/announce") {
    return NsmRequest{Kind::refuse,
                      fail(ErrorKind::refused, "the session manager refused the daemon: " + text_at(message, 2))};
  }
  if (message.address != "/nsm/client/open") return std::nullopt;
  NsmSession session{text_at(message, 0), text_at(message, 2)};
  if (!session.path.is_absolute() || session.client_id.empty()) {
    return NsmRequest{Kind::open,
                      fail(ErrorKind::bad_input, "the session manager's /nsm/client/open has no path or no client id")};
  }
  return NsmRequest{Kind::open, std::move(session)};
}

}  // namespace ringdown::server
