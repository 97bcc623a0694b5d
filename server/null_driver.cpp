#include "engine/base/within_memory.h"
#include "server/driver.h"
#include "server/load_meter.h"

#include <chrono>
#include <thread>
#include <vector>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;

class NullDriver final : public Driver {
 public:
  NullDriver(double sample_rate_hz, std::size_t block_frames) : sample_rate_hz_(sample_rate_hz), block_(block_frames) {}

  [[nodiscard]] double sample_rate_hz() const override { return sample_rate_hz_; }
  [[nodiscard]] std::size_t block_frames() const override { return block_; }

  Result<void> start(Program program) override {
    first_frame_ = program.mixer.counters().frames;
    origin_ = LoadMeter::Clock::now();
    return within_memory("start an audio thread", [&]() -> Result<void> {
      left_.resize(block_);
      right_.resize(block_);
      thread_ = std::jthread([this, &mixer = program.mixer](const std::stop_token& stop) { run(mixer, stop); });
      return {};
    });
  }

  [[nodiscard]] synth::Frame now() const override {
    const std::chrono::duration<double> elapsed = LoadMeter::Clock::now() - origin_;
    return first_frame_ + static_cast<synth::Frame>(elapsed.count() * sample_rate_hz_);
  }

  [[nodiscard]] Load load() const override { return meter_.read(); }

 private:
  void run(synth::Mixer& mixer, const std::stop_token& stop) {
    for (std::int64_t block = 0; !stop.stop_requested(); ++block) {
      const double due_s = static_cast<double>(block * static_cast<std::int64_t>(block_)) / sample_rate_hz_;
      std::this_thread::sleep_until(
          origin_ + std::chrono::duration_cast<LoadMeter::Clock::duration>(std::chrono::duration<double>(due_s)));
      while (!mixer.capture_tap().takes(block_) && !stop.stop_requested()) std::this_thread::sleep_for(1ms);
      meter_.begin(block_, sample_rate_hz_);
      mixer.render(left_, right_);
      meter_.end();
    }
  }

  double sample_rate_hz_;
  std::size_t block_;
  std::vector<float> left_, right_;  // a discarded block
  LoadMeter meter_;
  synth::Frame first_frame_ = 0;
  LoadMeter::Clock::time_point origin_;
  std::jthread thread_;  // last member: ends before the others are destroyed
};

}  // namespace

Result<std::unique_ptr<Driver>> open_null(double sample_rate_hz, std::size_t block_frames) {
  return std::make_unique<NullDriver>(sample_rate_hz, block_frames);
}

}  // namespace ringdown::server
