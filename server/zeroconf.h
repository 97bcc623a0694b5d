// Announces on the network where OSC is received, by DNS-SD (Zeroconf, Bonjour): service _osc._udp, and _osc._tcp.
//
// Avahi's daemon announces the services. Where it does not run, one line in the log says so, and the services are
// announced when it starts. A name that is taken gets a number. The announcement ends when the Zeroconf object is
// destroyed. [main; Avahi's client has a thread of its own]
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace ringdown::server {

class Zeroconf {
 public:
  // `name` is the name that people see.
  Zeroconf(std::string name, std::uint16_t udp_port, std::optional<std::uint16_t> tcp_port);
  ~Zeroconf();
  Zeroconf(const Zeroconf&) = delete;
  Zeroconf& operator=(const Zeroconf&) = delete;

 private:
  struct Avahi;
  std::unique_ptr<Avahi> avahi_;
};

}  // namespace ringdown::server
