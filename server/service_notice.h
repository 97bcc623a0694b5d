// Tells systemd that the daemon is ready, once the first sound has been rendered; that it is alive, for the watchdog;
// and that it is stopping.
//
// systemd gives a service of Type=notify a datagram socket in NOTIFY_SOCKET and, with WatchdogSec, a time in
// WATCHDOG_USEC (sd_notify(3), sd_watchdog_enabled(3)). Without these variables ServiceNotice does nothing. [main]
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace ringdown::server {

class ServiceNotice {
 public:
  ServiceNotice();  // reads the environment
  ~ServiceNotice();
  ServiceNotice(const ServiceNotice&) = delete;
  ServiceNotice& operator=(const ServiceNotice&) = delete;

  // Call at least every 100 ms. `frames` counts rendered frames; the first call with a count above 0 sends READY=1.
  // `beats` counts the rounds of the worker; while it grows, WATCHDOG=1 is sent twice in every interval that systemd
  // allows.
  void turn(std::uint64_t frames, std::uint64_t beats);

  void stopping();

 private:
  using Clock = std::chrono::steady_clock;
  void say(std::string_view what) const;

  std::string address_;  // the socket's address, with a leading zero byte if it is abstract; empty: no socket
  int socket_ = -1;
  bool ready_ = false;
  std::uint64_t last_beats_ = 0;
  Clock::duration interval_{};  // time between two WATCHDOG=1; zero: systemd wants none
  Clock::time_point next_{};
};

}  // namespace ringdown::server
