#include "engine/modal/direction_map.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace ringdown::modal {
namespace {

// Returns exp(i psi) over the rms. psi is the dominant phase of the field: that of the major axis of the ellipse that
// F's values form in the complex plane.
std::complex<double> scale_of(const FarField& field) {
  std::complex<double> squares = 0;
  for (const FarField::Term& term : field.terms)
    squares += std::complex<double>(term.value) * std::complex<double>(term.value);
  const double level = rms(field);
  return level > 0 ? std::polar(1 / level, 0.5 * std::arg(squares)) : 0.0;
}

double sharpness_of(const FarField& field) {
  double sum = 0, all = 0;
  for (const FarField::Term& term : field.terms) {
    int degree = static_cast<int>(std::sqrt(static_cast<double>(term.harmonic)));
    while (degree * degree > term.harmonic) --degree;
    const double power = std::norm(term.value);
    sum += degree * (degree + 1.0) * power;
    all += power;
  }
  return all > 0 ? std::sqrt(sum / all) : 0;
}

}  // namespace

DirectionMap::DirectionMap(const RadiationMaps& maps, std::span<const std::uint32_t> by_frequency) {
  using Row = std::array<float, 2 * kGroup>;
  first_.push_back(0);
  for (std::size_t begin = 0; begin < by_frequency.size(); begin += kGroup) {
    std::map<std::uint16_t, Row> rows;
    for (std::size_t i = 0; i < kGroup && begin + i < by_frequency.size(); ++i) {
      const FarField& field = maps.modes[by_frequency[begin + i]];
      const std::complex<double> scale = scale_of(field);
      for (const FarField::Term& term : field.terms) {
        const std::complex<double> value = std::conj(std::complex<double>(term.value)) * scale;
        Row& row = rows[term.harmonic];
        row[i] = static_cast<float>(value.real());
        row[kGroup + i] = static_cast<float>(value.imag());
      }
      degree_ = std::max(degree_, degree_of(field));
      sharpness_ = std::max(sharpness_, sharpness_of(field));
    }
    for (const auto& [harmonic, row] : rows) {
      harmonics_.push_back(harmonic);
      values_.insert(values_.end(), row.begin(), row.end());
    }
    first_.push_back(static_cast<std::uint32_t>(harmonics_.size()));
  }
}

}  // namespace ringdown::modal
