// The response of the modes that a bank leaves out, those above its band foremost, to forces slower than these modes.
//
// An omitted mode with eigenvalue lambda answers a force of angular frequency omega by
//
//   phi phi^T / (lambda - omega^2) = phi phi^T (1 / lambda + omega^2 / lambda^2 + ...).
//
// The sums of the first two terms over all omitted modes are matrices over the bank's sample points. They follow from
// solutions of the finite elements' static equations (engine/bake/laboratory/residual_of.h), and stand in a file of
// their own beside the bank, because playing does not need them.
//
// The file is a numpy array (.npy, format 1.0) of 2 x 3P x 3P little-endian floats. [worker]
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace ringdown::modal {

struct Residual {
  std::size_t points = 0;  // P, those of the bank
  // 3P x 3P, symmetric; row 3 p + axis.
  std::vector<float> flexibility;  // sum of phi phi^T / lambda [m/N]
  std::vector<float> inertia;      // sum of phi phi^T / lambda^2 [m s^2/N]
  [[nodiscard]] std::size_t index(std::size_t row, std::size_t column) const { return 3 * points * row + column; }
};

inline constexpr std::size_t kMaxResidualPoints = 2000;  // 144 MB for each matrix

Result<void> write_residual(const Residual& residual, const std::filesystem::path& path);

// Fails if the file is not an array of this form for a bank of `points` points.
Result<Residual> read_residual(const std::filesystem::path& path, std::size_t points);

}  // namespace ringdown::modal
