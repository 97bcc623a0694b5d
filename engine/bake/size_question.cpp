#include "engine/bake/size_question.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace ringdown::bake {
namespace {

struct Unit {
  const char *name, *option;
  double length_m;
};
constexpr std::array<Unit, 4> kUnits = {
    {{"millimetre", "mm", 0.001}, {"centimetre", "cm", 0.01}, {"inch", "in", 0.0254}, {"metre", "m", 1}}};

BodyShape scaled(BodyShape shape, double by) {
  shape.volume_m3 *= by * by * by;
  shape.thickness_m *= by;
  shape.wall_m *= by;
  shape.width_m *= by;
  shape.length_m *= by;
  return shape;
}

std::string length_text(double metres) {
  char text[32];
  metres < 1 ? std::snprintf(text, sizeof text, "%.3g mm", 1000 * metres)
             : std::snprintf(text, sizeof text, "%.3g m", metres);
  return text;
}

double modes_below(const BodyShape& shape, const modal::Material& material, const BakeOptions& options) {
  return debye_count(shape.volume_m3, material, highest_lambda_in_band(options.band_high_hz, material.damping));
}

enum class Sound { kGood, kSilent, kCrowded };

Sound sound_of(const BodyShape& shape, const modal::Material& material, const BakeOptions& options) {
  if (guessed_lowest_hz(shape, material) > options.band_high_hz) return Sound::kSilent;
  return modes_below(shape, material, options) > options.most_modes ? Sound::kCrowded : Sound::kGood;
}

}  // namespace

double guessed_lowest_hz(const BodyShape& shape, const modal::Material& material) {
  const double e = material.youngs_modulus_pa, rho = material.density_kg_m3, nu = material.poisson_ratio;
  const double bending = 1.03 * shape.thickness_m / (shape.length_m * shape.length_m) * std::sqrt(e / rho);
  const double shear = std::sqrt(e / (2 * (1 + nu) * rho)) / (2 * shape.length_m);
  return std::min(bending, shear);
}

double debye_count(double volume_m3, const modal::Material& material, double lambda) {
  const double e = material.youngs_modulus_pa, nu = material.poisson_ratio, rho = material.density_kg_m3;
  const double transverse = std::sqrt(e / (2 * (1 + nu) * rho));
  const double longitudinal = transverse * std::sqrt((2 - 2 * nu) / (1 - 2 * nu));
  const double slowness = std::pow(longitudinal, -3) + 2 * std::pow(transverse, -3);
  return volume_m3 * std::pow(lambda, 1.5) / (6 * std::numbers::pi * std::numbers::pi) * slowness;
}

std::string question_size(const BodyShape& shape, const modal::Material& material, const BakeOptions& options,
                          const std::filesystem::path& path, double unit_m) {
  const Sound sound = sound_of(shape, material, options);
  if (sound == Sound::kGood) return "";
  char trouble[120];
  if (sound == Sound::kSilent) {
    std::snprintf(trouble, sizeof trouble, "its lowest note would be near %.2g Hz", guessed_lowest_hz(shape, material));
  } else {
    std::snprintf(trouble, sizeof trouble, "some %.2g modes would lie below %.0f Hz",
                  modes_below(shape, material, options), options.band_high_hz);
  }
  std::string text = path.filename().string() + " is " + length_text(shape.length_m) + " long, so that " + trouble;
  for (const Unit& unit : kUnits) {
    const BodyShape other = scaled(shape, unit.length_m / unit_m);
    if (unit.length_m == unit_m || sound_of(other, material, options) != Sound::kGood) continue;
    char note[32];
    std::snprintf(note, sizeof note, "%.2g Hz", guessed_lowest_hz(other, material));
    return text + "; if its unit is the " + unit.name + " (--unit " + unit.option + "), it is " +
           length_text(other.length_m) + " long, and its lowest note about " + note;
  }
  return text + "; check its unit (--unit)";
}

}  // namespace ringdown::bake
