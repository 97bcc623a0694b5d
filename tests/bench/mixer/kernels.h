// The ways to sum damped sinusoids that ours is compared with, and our own direct kernel.
//
// `closed form` and `two-pole` are what one would first write: mode by mode. The others run modes in SIMD lanes and are
// compiled for this very machine, so that what they cost is the method's own.
#pragma once

#include "tests/bench/mixer/stage.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ringdown::bench {

class Kernel {
 public:
  virtual ~Kernel() = default;
  // Writes the next samples of the sum; at most kMaxFrames.
  virtual void render(std::span<double> out) = 0;
  static constexpr std::size_t kMaxFrames = 256;
};

struct KernelMaker {
  std::string name;
  bool lasts;  // in double, and fast enough to be asked for ten minutes
  std::unique_ptr<Kernel> (*make)(const std::vector<Sinusoid>& modes);
};

const std::vector<KernelMaker>& kernels();
const KernelMaker& kernel(const std::string& name);

}  // namespace ringdown::bench
