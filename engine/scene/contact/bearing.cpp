#include "engine/scene/contact/bearing.h"

#include "engine/modal/surface_relief.h"
#include "engine/scene/contact/contact_rules.h"
#include "engine/scene/contact/hertz.h"
#include "engine/scene/fixed_contacts.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace ringdown::scene {
namespace {

// Returns the rms slope of a surface's finish along a cut: measured, or that of the random octaves of its texture
// (rubbing.h), whose wavelengths fall from the longest to the shortest and whose power follows the spectral slope.
double finish_slope(const FrictionSurface& surface) {
  if (surface.relief && surface.relief->profile) return surface.relief->profile->rms_slope();
  const synth::Texture& t = surface.texture;
  double power = 0, slopes = 0;
  for (std::size_t octave = 0; octave < t.octaves(); ++octave) {
    const double ratio = std::exp2(static_cast<double>(octave)), share = std::pow(ratio, t.spectral_slope + 1);
    const double q = 2 * std::numbers::pi * ratio / t.correlation_m;
    power += share;
    slopes += share * q * q;
  }
  return power > 0 ? t.roughness_m * std::sqrt(slopes / power) : 0;
}

double squared(double x) { return x * x; }

}  // namespace

double bearing_area(double area_m2, double load_n, double modulus_pa, double gradient) {
  const double pressure_pa = 0.5 * modulus_pa * gradient;
  if (!(pressure_pa > 0)) return area_m2;
  return area_m2 * std::erf(std::sqrt(std::numbers::pi) * load_n / (2 * area_m2 * pressure_pa));
}

// The load goes as the fourth root of the area, so each round divides the error by four at least.
double face_impact_time(double inverse_mass, double modulus_pa, double area_m2, double waviness, double approach_m_s) {
  constexpr int kRounds = 12;
  const auto stiffness = [&](double area) { return 2 * modulus_pa * std::sqrt(area / std::numbers::pi); };
  double area = area_m2;
  for (int round = 0; round < kRounds && waviness > 0; ++round) {
    const double load_n = approach_m_s * std::sqrt(stiffness(area) / inverse_mass);
    area = std::max(bearing_area(area_m2, load_n, modulus_pa, waviness), 1e-12 * area_m2);
  }
  return std::numbers::pi / std::sqrt(inverse_mass * stiffness(area));
}

// The hull by Andrew's monotone chain (1979), its area by the shoelace formula.
double patch_area(std::span<const Vec3> points_m, Vec3 normal) {
  if (points_m.size() < 3) return 0;
  const Vec3 x = any_across(normal), y = cross(normal, x);
  std::vector<std::pair<double, double>> points;
  for (const Vec3& p : points_m) points.emplace_back(dot(p, x), dot(p, y));
  std::ranges::sort(points);
  const auto turn = [](const auto& a, const auto& b, const auto& c) {
    return (b.first - a.first) * (c.second - a.second) - (b.second - a.second) * (c.first - a.first);
  };
  std::vector<std::pair<double, double>> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t begin = hull.size();
    for (const auto& point : points) {
      while (hull.size() >= begin + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    std::ranges::reverse(points);
  }
  double area = 0;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    const auto &a = hull[k], &b = hull[(k + 1) % hull.size()];
    area += 0.5 * (a.first * b.second - b.first * a.second);
  }
  return std::max(area, 0.0);
}

double waviness_of(const FrictionSurface& a, const FrictionSurface& b) {
  return std::hypot(a.waviness.value_or(0), b.waviness.value_or(0));
}

FilterWidths filter_widths(const ContactSide& a, const ContactSide& b, double load_n) {
  if (!a.surface.relief && !b.surface.relief) return {};
  const double modulus_pa = contact_modulus(a.elastic, b.elastic);
  const double radius_m = relative_radius(a.curvature, b.curvature);
  const double patch_m = std::cbrt(0.75 * load_n * radius_m / modulus_pa);
  const double patch_m2 = std::numbers::pi * squared(patch_m);
  // An isotropic surface has sqrt 2 times the gradient of a cut through it.
  const double gradient = std::sqrt(2 * (squared(finish_slope(a.surface)) + squared(finish_slope(b.surface))));
  const double area_m2 = patch_m2 > 0 ? bearing_area(patch_m2, load_n, modulus_pa, gradient) : 0;
  return {2 * std::sqrt(area_m2 / std::numbers::pi), 2 * patch_m};
}

double pressed_depth(const ContactSide& a, const ContactSide& b, double inverse_mass, double load_n) {
  const SurfacePair both = combine(a.surface, b.surface);
  const double rough_m = 1.5 * 0.4 * both.texture.roughness_m;
  if (both.contact_time_s) {
    const double swing_s = *both.contact_time_s / std::numbers::pi;
    return rough_m + 1.5 * load_n * inverse_mass * swing_s * swing_s;
  }
  const double hertz =
      4.0 / 3 * contact_modulus(a.elastic, b.elastic) * std::sqrt(relative_radius(a.curvature, b.curvature));
  return rough_m + std::pow(load_n / hertz, 2.0 / 3);
}

}  // namespace ringdown::scene
