// Parses a session manager's messages (New Session Manager's protocol). Separate from the client's socket and thread,
// so that tests can pass in broken messages. [any thread]
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace ringdown::server {

struct NsmSession {
  std::filesystem::path path;  // absolute; our files have this name and an ending
  std::string client_id;       // the name of our JACK client, not empty
};

struct NsmRequest {
  enum class Kind { refuse, open, save };
  Kind kind;
  Result<NsmSession> session = NsmSession{};  // open: the session, or what its message lacks; refuse: the reason
};

// Reads the first message of a datagram. nullopt: the datagram is broken, or asks for nothing that we support.
std::optional<NsmRequest> parse_nsm(std::span<const std::byte> datagram);

}  // namespace ringdown::server
