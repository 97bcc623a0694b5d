// A line that loses and remembers: stands between a client and a daemon, drops every n-th datagram of either direction,
// and keeps what the client asked.
#pragma once

#include "protocol/request.h"
#include "protocol/wire/socket.h"

#include <atomic>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace ringdown::test {

class LossyRelay {
 public:
  // Every `drops`-th is lost; 0: none.
  LossyRelay(std::uint16_t daemon_port, unsigned drops);
  ~LossyRelay();

  [[nodiscard]] std::uint16_t port() const { return client_side_.port(); }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  // What the client has asked so far, in order.
  template <class Kind>
  [[nodiscard]] std::vector<Kind> asked() const {
    const std::scoped_lock lock(mutex_);
    std::vector<Kind> found;
    for (const protocol::Request& request : asked_) {
      if (const auto* kind = request.get_if<Kind>()) found.push_back(*kind);
    }
    return found;
  }

 private:
  void run(const std::stop_token& stop);
  bool lost();
  void remember(const wire::Datagram& datagram);

  wire::OscSocket client_side_, daemon_side_;
  wire::Endpoint daemon_, client_;
  unsigned drops_;
  std::uint64_t seen_ = 0;
  std::atomic<std::uint64_t> dropped_ = 0;
  mutable std::mutex mutex_;  // guards the next
  std::vector<protocol::Request> asked_;
  std::jthread thread_;
};

}  // namespace ringdown::test
