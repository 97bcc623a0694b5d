// Where packets come from and answers go to. [any thread but audio]
#pragma once

#include "protocol/wire/socket.h"

#include <cstdint>

namespace ringdown::server {

// Who sent a packet, and gets its answers.
struct Peer {
  wire::Endpoint endpoint;
  std::uint32_t connection = 0;  // of OscStream; 0: UDP
  friend bool operator==(const Peer&, const Peer&) = default;
};

}  // namespace ringdown::server
