// The spectrum of the mix, in dB of full scale. [UI]
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace ringdown::viewer {

class Spectrum {
 public:
  static constexpr std::size_t kFrames = 8192;  // frames of one analysis: 5.9 Hz a bin at 48 kHz
  static constexpr double kFloor_db = -140;

  Spectrum();
  ~Spectrum();
  Spectrum(Spectrum&&) noexcept;
  Spectrum& operator=(Spectrum&&) noexcept;

  // Returns the levels of the last kFrames samples (fewer are padded with silence) under a Hann window: kFrames/2 + 1
  // bins, bin k at k sample_rate / kFrames. A sine of amplitude 1 shows 0 dB. Valid until the next call.
  std::span<const float> analyse(std::span<const float> samples);

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

}  // namespace ringdown::viewer
