// Many messages to one receiver, in as few packets as is wise. [any thread but audio]
#pragma once

#include "protocol/reply.h"
#include "protocol/wire/message.h"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace ringdown::server {

inline constexpr std::size_t kMaxMessagesPerBundle = 16;  // of short ones some 1,400 bytes: one Ethernet frame
inline constexpr std::size_t kMaxBundleBytes = 32768;     // a longer message goes alone

// One message goes as it is; more go in bundles, in their order.
void send_in_bundles(std::span<const protocol::Reply> replies,
                     const std::function<void(std::span<const std::byte>)>& send);

}  // namespace ringdown::server
