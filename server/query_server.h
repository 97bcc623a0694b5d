// OSCQuery over HTTP, read-only and by option: GET / or GET /object/bell answers the namespace as JSON
// (osc_namespace.h), ?HOST_INFO says where OSC is received. Two threads of its own; whoever asks for too much waits.
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
    std::string name;     // of this daemon
    std::string address;  // where OSC is received
    std::uint16_t osc_port = 0;
    std::function<std::vector<std::string>()> objects;  // their names now [any thread]
  };

  // Serves at once, at about.address. Port 0 takes any free one. A taken port is an error whose sentence says so.
  static Result<std::unique_ptr<QueryServer>> listen(std::uint16_t port, About about);
  ~QueryServer();

  [[nodiscard]] std::uint16_t port() const;

 private:
  struct Impl;
  explicit QueryServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ringdown::server
