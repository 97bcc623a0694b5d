#include "engine/modal/hearing/loudness.h"

#include <cmath>
#include <numbers>

namespace ringdown::modal {
namespace {

Vec3 point_of(const Vec3f& v) { return {v[0], v[1], v[2]}; }

}  // namespace

// Each point represents a third of the triangles around it: their vector areas give its normal, their areas its weight.
Loudness::Loudness(const Bank& bank) {
  if (bank.radiation || bank.triangles.empty()) return;
  std::vector<Vec3> normals(bank.point_count());
  std::vector<double> weights(bank.point_count(), 0.0);
  for (const auto& [a, b, c] : bank.triangles) {
    const Vec3 at = point_of(bank.positions[a]);
    const Vec3 twice_area = cross(point_of(bank.positions[b]) - at, point_of(bank.positions[c]) - at);
    for (const std::uint32_t corner : {a, b, c}) {
      normals[corner] = normals[corner] + twice_area;
      weights[corner] += length(twice_area) / 6;
    }
  }
  for (const double weight : weights) area_m2_ += weight;
  if (!(area_m2_ > 0)) return;
  for (Vec3& normal : normals) {
    if (const double size = length(normal); size > 0) normal = (1 / size) * normal;
  }
  normal_rms_.reserve(bank.mode_count());
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    double sum = 0;
    for (std::size_t p = 0; p < bank.point_count(); ++p) {
      const double along = dot(point_of(bank.shape(m, p)), normals[p]);
      sum += weights[p] * along * along;
    }
    normal_rms_.push_back(std::sqrt(sum / area_m2_));
  }
}

double Loudness::pressure_pa(const Bank& bank, std::size_t m, const MaterialScale& scale, double frequency_hz) const {
  const Air air = air_of(bank);
  const double omega = hz_to_rad_per_s(frequency_hz);
  if (bank.radiation) return air.density_kg_m3 * omega * rms(rescale(bank.radiation->maps.modes[m], scale));
  if (normal_rms_.empty()) return air.density_kg_m3 * omega * kUnknownFlow * std::sqrt(scale.size / scale.density);
  const double area_m2 = scale.size * scale.size * area_m2_;
  const double ka = omega / air.sound_speed_m_s * std::sqrt(area_m2 / std::numbers::pi);
  const double sigma = ka * ka / (1 + ka * ka);
  return air.density_kg_m3 * air.sound_speed_m_s * std::sqrt(sigma * area_m2 / (4 * std::numbers::pi)) *
         shape_factor(scale) * normal_rms_[m];
}

}  // namespace ringdown::modal
