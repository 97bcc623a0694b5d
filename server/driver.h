// Where the sound goes: something that calls Mixer::render from its own audio thread, and knows what time it is.
#pragma once

#include "engine/base/result.h"
#include "engine/synth/mixer.h"
#include "protocol/event.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::server {

class Driver {
 public:
  struct Load {
    double mean = 0;  // share of its time that the callback used, averaged over about a second
    double peak = 0;  // the largest so far
  };

  virtual ~Driver() = default;  // stops

  [[nodiscard]] virtual double sample_rate_hz() const = 0;
  [[nodiscard]] virtual std::size_t block_frames() const = 0;

  // Renders `mixer`, made for this driver's sample rate, until destruction. Once. `on_lost` is called, on any thread,
  // if the driver can go on no longer; it must only note that. [main]
  virtual Result<void> start(synth::Mixer& mixer, std::function<void()> on_lost) = 0;

  // The mixer's frame that is being computed at this instant. [any but audio]
  [[nodiscard]] virtual protocol::Frame now() const = 0;

  [[nodiscard]] virtual Load load() const = 0;           // [any but audio]
  [[nodiscard]] virtual std::int32_t xruns() const = 0;  // [any]
};

struct JackOptions {
  std::string client_name = "ringdown";
  bool connect = false;  // to the first two physical playback ports
};
// Fails with one sentence when no JACK server answers.
Result<std::unique_ptr<Driver>> open_jack(const JackOptions& options);

// What the null driver heard, when somebody wants to know. It stops listening after kMost frames.
struct Captured {
  static constexpr std::size_t kMost = std::size_t{1} << 28;  // an hour and a half, 2 GiB
  std::vector<float> left, right;
};

// Renders in real time and throws the sound away, or appends it to `captured`, which must outlive the driver.
Result<std::unique_ptr<Driver>> open_null(double sample_rate_hz, std::size_t block_frames,
                                          Captured* captured = nullptr);

}  // namespace ringdown::server
