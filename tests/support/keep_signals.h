// Keeps the signals of a failed test where the reader can look and listen.
//
//   KeepSignals keep(48000);
//   keep.add("mixer", samples);
//
// When the scope ends and the running test has failed, or RINGDOWN_KEEP_SIGNALS is set, every signal is written under
// <build>/failed-signals/ as a 32-bit float wave (SUITE.TEST.NAME.wav) and as its spectrum (.csv: Hz, dB), and the
// paths are printed.
#pragma once

#include "tests/support/signal.h"

#include <string>
#include <utility>
#include <vector>

namespace ringdown::test {

class KeepSignals {
 public:
  explicit KeepSignals(double sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}
  ~KeepSignals();
  KeepSignals(const KeepSignals&) = delete;
  KeepSignals& operator=(const KeepSignals&) = delete;

  void add(std::string name, std::span<const double> samples) {
    signals_.emplace_back(std::move(name), Samples(samples.begin(), samples.end()));
  }

 private:
  double sample_rate_hz_;
  std::vector<std::pair<std::string, Samples>> signals_;
};

void write_wave(const std::string& path, std::span<const double> samples, double sample_rate_hz);
void write_spectrum(const std::string& path, std::span<const double> samples, double sample_rate_hz);

}  // namespace ringdown::test
