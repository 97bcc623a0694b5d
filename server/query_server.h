// Describes the daemon's OSC namespace by OSCQuery: JSON over HTTP, read-only. The daemon opens it with --query.
//
// GET / or GET /object/bell answers the namespace or a part of it (osc_namespace.h); ?HOST_INFO answers where OSC is
// received. One thread of the server accepts connections and two answer requests.
#pragma once

#include "engine/base/result.h"
#include "protocol/wire/socket.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::server {

class QueryServer {
 public:
  struct About {
    std::string name;     // the name of this daemon
    std::string address;  // where OSC is received
    std::uint16_t osc_port = 0;
    std::function<std::vector<std::string>()> objects;  // returns the names of all objects [called on any thread]
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
