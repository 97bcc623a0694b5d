#include "server/answers.h"

#include "protocol/schema.h"
#include "protocol/wire/codec.h"

#include <utility>
#include <variant>

namespace ringdown::server {
namespace {

// The maximum size of the encoded message.
std::size_t max_bytes_of(const wire::Message& message) {
  constexpr std::size_t kNumber = 16, kPadding = 8;
  std::size_t bytes = kNumber + message.address.size() + kPadding;
  for (const wire::Argument& argument : message.arguments) {
    bytes += kNumber;
    if (const auto* text = std::get_if<std::string>(&argument)) bytes += text->size();
    if (const auto* blob = std::get_if<wire::Blob>(&argument)) bytes += blob->size();
  }
  return bytes;
}

}  // namespace

void AnswerPorts::send(Peer to, std::span<const std::byte> packet) {
  if (to.connection == 0) {
    static_cast<void>(socket.send_to(to.endpoint, packet));
  } else if (stream) {
    stream->send(to, packet);
  }
}

void answer(AnswerPorts& ports, Peer to, const protocol::Reply& reply) {
  if (const auto* refusal = reply.get_if<protocol::Fail>()) {
    ports.refusals.add(to_text(to.endpoint), refusal->sentence);
  }
  ports.send(to, wire::encode(protocol::format(reply)));
}

void answer(AnswerPorts& ports, Peer to, const Result<std::vector<protocol::Reply>>& replies,
            const std::string& address) {
  if (!replies) return answer(ports, to, protocol::Fail{address, address + ": " + replies.error().message});
  send_in_bundles(*replies, [&](std::span<const std::byte> packet) { ports.send(to, packet); });
}

void answer(AnswerPorts& ports, Peer to, const Result<std::optional<std::int32_t>>& outcome,
            const std::string& address) {
  if (outcome) return answer(ports, to, protocol::Done{address, *outcome});
  answer(ports, to, protocol::Fail{address, address + ": " + outcome.error().message});
}

void send_in_bundles(std::span<const protocol::Reply> replies,
                     const std::function<void(std::span<const std::byte>)>& send) {
  if (replies.size() == 1) return send(wire::encode(protocol::format(replies.front())));
  std::vector<wire::Message> messages;
  std::size_t bytes = 0;
  const auto send_bundle = [&] {
    if (!messages.empty()) send(wire::encode_bundle(wire::kImmediately, messages));
    messages.clear();
    bytes = 0;
  };
  for (const protocol::Reply& reply : replies) {
    wire::Message message = protocol::format(reply);
    const std::size_t more = max_bytes_of(message);
    if (messages.size() == kMaxMessagesPerBundle || bytes + more > kMaxBundleBytes) send_bundle();
    messages.push_back(std::move(message));
    bytes += more;
  }
  send_bundle();
}

}  // namespace ringdown::server
