#include "server/bundles.h"

#include "protocol/schema.h"
#include "protocol/wire/codec.h"

#include <string>
#include <variant>

namespace ringdown::server {
namespace {

// At most.
std::size_t bytes_of(const wire::Message& message) {
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

void send_in_bundles(std::span<const protocol::Reply> replies,
                     const std::function<void(std::span<const std::byte>)>& send) {
  if (replies.size() == 1) return send(wire::encode(protocol::format(replies.front())));
  std::vector<wire::Message> messages;
  std::size_t bytes = 0;
  const auto send_these = [&] {
    if (!messages.empty()) send(wire::encode_bundle(wire::kImmediately, messages));
    messages.clear();
    bytes = 0;
  };
  for (const protocol::Reply& reply : replies) {
    wire::Message message = protocol::format(reply);
    const std::size_t more = bytes_of(message);
    if (messages.size() == kMaxMessagesPerBundle || bytes + more > kMaxBundleBytes) send_these();
    messages.push_back(std::move(message));
    bytes += more;
  }
  send_these();
}

}  // namespace ringdown::server
