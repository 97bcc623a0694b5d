// Watches the clock of a JACK server as a client of its own: how far it strays from an even run.
//
//   JackClock clock(server.name());
//   ... record ...
//   if (clock.strayed_s() > 5e-4) ...  // the server was kept from running: that recording says nothing of others
//   if (clock.xruns() > 0) ...         // frames are missing in it, whoever was late
//
// How far it strays rests on the server and this client alone, never on what is tested. An xrun may be the fault of any
// client.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

struct _jack_client;

namespace ringdown::bench {

class JackClock {
 public:
  explicit JackClock(const std::string& server);
  ~JackClock();
  JackClock(const JackClock&) = delete;
  JackClock& operator=(const JackClock&) = delete;

  [[nodiscard]] bool works() const { return client_ != nullptr; }

  // Forgets what was seen so far.
  void restart() { begin_ = seen_.load(), xruns_ = 0; }

  // That the server told of since restart().
  [[nodiscard]] int xruns() const { return xruns_; }

  // The times at which cycles began, by the server's own clock (jack_get_cycle_times), less the time that the frames
  // passed by then take at the sample rate: by how much that varied since restart(). A lost cycle counts as its length.
  // Infinite when hardly a cycle was seen. [not the JACK thread]
  [[nodiscard]] double strayed_s() const;

 private:
  struct Cycle {
    double began_s, frames_s;
  };
  int process(std::uint32_t frames);

  _jack_client* client_;
  double rate_hz_ = 0;
  std::uint64_t frames_ = 0;
  std::vector<Cycle> cycles_;  // room for minutes
  std::atomic<std::size_t> seen_ = 0, begin_ = 0;
  std::atomic<int> xruns_ = 0;
};

}  // namespace ringdown::bench
