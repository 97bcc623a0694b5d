// Announces the address at which OSC is received on the network, by DNS-SD (Zeroconf, Bonjour): service _osc._udp, and
// _osc._tcp.
//
// Avahi's daemon announces the services. If it does not run, one line in the log says so, and the services are
// announced when it starts. A number is appended to a name that is in use. The announcement ends when the Zeroconf
// object is destroyed. [main; Avahi's client has a thread of its own]
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace ringdown::server {

class Zeroconf {
 public:
  // `name` is the name that users see.
  Zeroconf(std::string name, std::uint16_t udp_port, std::optional<std::uint16_t> tcp_port);
  ~Zeroconf();
  Zeroconf(const Zeroconf&) = delete;
  Zeroconf& operator=(const Zeroconf&) = delete;

 private:
  struct Avahi;
  std::unique_ptr<Avahi> avahi_;
};

}  // namespace ringdown::server
