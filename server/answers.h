// Sends answers to the senders of requests: by UDP or TCP, as the request arrived, and in few packets.
//
//   answer(ports, peer, outcome, "/object/bell/material");     // /done, or /fail with the error's sentence
//   send_in_bundles(replies, [&](auto packet) { ports.send(peer, packet); });
//
// [any thread but audio]
#pragma once

#include "engine/base/result.h"
#include "protocol/reply.h"
#include "protocol/wire/socket.h"
#include "server/osc_stream.h"
#include "server/refusal_log.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ringdown::server {

inline constexpr std::size_t kMaxMessagesPerBundle = 16;  // short messages then fill one Ethernet frame: 1,400 bytes
inline constexpr std::size_t kMaxBundleBytes = 32768;     // a longer message is sent alone

// The sockets through which answers leave, and where refusals are logged.
struct AnswerPorts {
  wire::OscSocket socket;
  std::shared_ptr<OscStream> stream;  // null: UDP only
  RefusalLog refusals = {};

  void send(Peer to, std::span<const std::byte> packet);
};

// Sends one reply. A refusal (/fail) is also logged. Does not fail if nobody receives the reply.
void answer(AnswerPorts& ports, Peer to, const protocol::Reply& reply);

// Sends the replies to a question, or /fail with the error's sentence.
void answer(AnswerPorts& ports, Peer to, const Result<std::vector<protocol::Reply>>& replies,
            const std::string& address);

// Sends /done, with the number if the request has one as its result, or /fail with the error's sentence.
void answer(AnswerPorts& ports, Peer to, const Result<std::optional<std::int32_t>>& outcome,
            const std::string& address);

// Encodes replies and calls `send` for each packet: a single reply is a packet of its own; more go in bundles, in their
// order.
void send_in_bundles(std::span<const protocol::Reply> replies,
                     const std::function<void(std::span<const std::byte>)>& send);

}  // namespace ringdown::server
