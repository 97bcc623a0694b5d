#include "engine/modal/strike_map.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace ringdown::modal {

StrikeMap::StrikeMap(std::shared_ptr<const Bank> bank)
    : bank_(std::move(bank)),
      surface_(*bank_),
      loudness_(*bank_),
      by_frequency_(bank_->mode_count()),
      rank_(bank_->mode_count()),
      shapes_(3 * bank_->mode_count() * bank_->point_count()) {
  const std::size_t modes = bank_->mode_count();
  std::iota(by_frequency_.begin(), by_frequency_.end(), 0u);
  std::ranges::stable_sort(by_frequency_, {}, [&](std::uint32_t mode) { return bank_->frequency_hz[mode]; });
  for (std::size_t i = 0; i < modes; ++i) rank_[by_frequency_[i]] = static_cast<std::uint32_t>(i);
  if (bank_->radiation) directions_ = DirectionMap(bank_->radiation->maps, by_frequency_);
  for (std::size_t m = 0; m < modes; ++m) {
    for (std::size_t p = 0; p < bank_->point_count(); ++p) {
      for (std::size_t axis = 0; axis < 3; ++axis) shapes_[(3 * p + axis) * modes + m] = bank_->shape(m, p)[axis];
    }
  }
}

void StrikeMap::excite(Vec3 point_m, Vec3 impulse_ns, std::span<double> amplitudes) const REALTIME {
  const SurfacePoint hit = surface_.nearest(point_m);
  std::fill(amplitudes.begin(), amplitudes.end(), 0.0);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    if (hit.weights[corner] > 0) add(hit.points[corner], hit.weights[corner] * impulse_ns, amplitudes);
  }
}

void StrikeMap::excite_vertex(std::size_t vertex, Vec3 impulse_ns, std::span<double> amplitudes) const REALTIME {
  std::fill(amplitudes.begin(), amplitudes.end(), 0.0);
  add(vertex, impulse_ns, amplitudes);
}

void StrikeMap::add(std::size_t point, Vec3 impulse_ns, std::span<double> amplitudes) const REALTIME {
  const std::size_t modes = amplitudes.size();
  assert(modes == bank_->mode_count() && point < bank_->point_count());
  const float* x = shapes_.data() + 3 * point * modes;
  const float* y = x + modes;
  const float* z = y + modes;
  for (std::size_t m = 0; m < modes; ++m) {
    amplitudes[m] += impulse_ns.x * x[m] + impulse_ns.y * y[m] + impulse_ns.z * z[m];
  }
}

}  // namespace ringdown::modal
