// Describes the daemon's OSC namespace by OSCQuery: JSON over HTTP, read-only. The daemon opens it with --query.
//
// GET / or GET /object/bell answers the namespace or a part of it (osc_namespace.h); ?HOST_INFO answers with the
// address at which OSC is received. One thread accepts connections and answers, without waiting for any of them. Memory
// stays bounded for any input: a request has at most kMaxRequestBytes and no body, ranges are ignored, and answers are
// generated while they are sent. If kMaxQueryConnections are open, the one that has waited longest makes room for the
// next.
#pragma once

#include "engine/base/result.h"
#include "server/osc_namespace.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace ringdown::server {

inline constexpr std::size_t kMaxRequestBytes = 16384;  // of a request's line and headers, and of an answer's headers
inline constexpr std::size_t kMaxQueryConnections = 32;
inline constexpr unsigned kMaxQuerySilence_s = 2;  // silence of a client in the middle of a request, or between two
inline constexpr unsigned kMaxQueryTime_s = 10;    // from a request's first byte to its last, and equally for an answer

class QueryServer {
 public:
  struct About {
    std::string name;     // the name of this daemon
    std::string address;  // where OSC is received
    std::uint16_t osc_port = 0;
    std::function<ObjectNames()> objects;  // returns the names of all objects [called on the server's thread]
  };

  // Opens the port at about.address and serves from now on, until destruction; 0 takes any free port. Fails with
  // ErrorKind::port_busy. [main]
  static Result<std::unique_ptr<QueryServer>> listen(std::uint16_t port, About about);
  ~QueryServer();

  [[nodiscard]] std::uint16_t port() const;

 private:
  struct Impl;
  explicit QueryServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ringdown::server
