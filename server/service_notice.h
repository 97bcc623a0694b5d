// Tells systemd how the daemon fares: ready when sound runs, stopping, and by the watchdog that it is alive.
//
// systemd gives a service of Type=notify a datagram socket in NOTIFY_SOCKET and, with WatchdogSec, a time in
// WATCHDOG_USEC (sd_notify(3), sd_watchdog_enabled(3)). Without them nothing happens. [main]
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace ringdown::server {

class ServiceNotice {
 public:
  ServiceNotice();  // looks at the environment
  ~ServiceNotice();
  ServiceNotice(const ServiceNotice&) = delete;
  ServiceNotice& operator=(const ServiceNotice&) = delete;

  // To be called every now and then, at least every 100 ms. The first call with `frames` above 0 says READY=1: frames
  // that were rendered, so sound runs. `beats` counts the rounds of the worker: while it grows, WATCHDOG=1 is said
  // twice in every interval that systemd waits for it.
  void turn(std::uint64_t frames, std::uint64_t beats);

  void stopping();

 private:
  using Clock = std::chrono::steady_clock;
  void say(std::string_view what) const;

  std::string address_;  // of the socket, with a zero in front for an abstract one; empty: nobody listens
  int socket_ = -1;
  bool ready_ = false;
  std::uint64_t last_beats_ = 0;
  Clock::duration interval_{};  // between two WATCHDOG=1; zero: none is wanted
  Clock::time_point next_{};
};

}  // namespace ringdown::server
