// Measures loudness and true peak of a stereo sound, by EBU R 128 (ITU-R BS.1770), piece by piece. [one thread]
//
//   Loudness loudness(48000);
//   loudness.add(left, right);              // spans of equal length
//   loudness.lufs();                        // nothing if all is silent, or shorter than 0.4 s
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::session {

class Loudness {
 public:
  explicit Loudness(double sample_rate_hz);
  Loudness(Loudness&&) noexcept;
  Loudness& operator=(Loudness&&) noexcept;
  ~Loudness();

  void add(std::span<const float> left, std::span<const float> right);

  // The loudness of all so far [LUFS]: nothing if no 0.4 s of it are above -70 LUFS.
  [[nodiscard]] std::optional<double> lufs() const;

  // The largest value between and at the samples, by oversampling; 1 is full scale.
  [[nodiscard]] double true_peak() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ringdown::session
