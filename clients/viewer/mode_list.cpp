#include "clients/viewer/mode_list.h"

#include "engine/modal/hearing/loudness.h"
#include "engine/modal/material_scale.h"

#include <algorithm>
#include <cmath>

namespace ringdown::viewer {

std::vector<ListedMode> list_modes(const KnownBank& known, const Adjustment& adjustment, std::uint32_t node) {
  const modal::Bank& bank = known.bank;
  std::vector<ListedMode> list;
  if (bank.point_count() == 0) return list;
  const std::size_t point = std::min<std::size_t>(node, bank.point_count() - 1);
  const Vec3 blow = outward_normal(bank, static_cast<std::uint32_t>(point));
  const double shape_factor = modal::shape_factor(adjustment.scale);
  const modal::Loudness loudness(bank);
  list.reserve(known.by_frequency.size());
  for (std::size_t rank = 0; rank < known.by_frequency.size(); ++rank) {
    const std::uint32_t mode = known.by_frequency[rank];
    const modal::DampedMode damped = modal::rescale(bank, mode, adjustment.scale);
    const modal::Vec3f& shape = bank.shape(mode, point);
    const double excited = shape_factor * std::abs(dot(blow, Vec3{shape[0], shape[1], shape[2]}));
    const double output = loudness.pressure_pa(bank, mode, adjustment.scale, damped.frequency_hz) /
                          modal::kFullScale_pa * bank.gain * excited;
    list.push_back({damped.frequency_hz, damped.decay_per_s > 0 ? modal::t60_s(damped.decay_per_s) : 0,
                    20 * std::log10(std::max(output * adjustment.gain, 1e-9)), adjustment.range.has(rank)});
  }
  return list;
}

Vec3 outward_normal(const modal::Bank& bank, std::uint32_t point) {
  const auto at = [&](std::uint32_t i) {
    return Vec3{bank.positions[i][0], bank.positions[i][1], bank.positions[i][2]};
  };
  Vec3 sum;
  for (const auto& [a, b, c] : bank.triangles) {
    if (a == point || b == point || c == point) sum = sum + cross(at(b) - at(a), at(c) - at(a));
  }
  const double size = length(sum);
  return size > 0 ? (1 / size) * sum : Vec3{0, 0, 1};
}

}  // namespace ringdown::viewer
