#include "engine/modal/nonlinear_limits.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace ringdown::modal {
namespace {

// Returns for each mode with terms the amplitude at which its largest motion equals the body's thickness.
std::vector<double> amplitudes_of_a_thickness(const NonlinearTerms& terms, const Bank& bank) {
  std::vector<double> amplitudes;
  for (const std::uint32_t mode : terms.modes) {
    double largest = 0;
    for (std::size_t p = 0; p < bank.point_count(); ++p) {
      const auto [x, y, z] = bank.shape(mode, p);
      largest = std::max(largest, std::hypot(double{x}, double{y}, double{z}));
    }
    amplitudes.push_back(terms.thickness_m / largest);
  }
  return amplitudes;
}

}  // namespace

// Comparisons are written so that NaN fails every limit.
Result<void> check(const NonlinearTerms& terms, const Bank& bank, const std::string& name) {
  const auto refuse = [&](const std::string& sentence) {
    return fail(ErrorKind::bad_input, "{}.{}; bake the object again", name, sentence);
  };
  if (!(terms.thickness_m >= kMinThickness_m && terms.thickness_m <= kMaxThickness_m)) {
    return refuse("thickness is not that of a body, 1e-9 to 1000 m");
  }
  const std::vector<double> a = amplitudes_of_a_thickness(terms, bank);
  const auto mode = [&](std::size_t i) { return std::to_string(terms.modes[i]); };
  const auto omega = [&](std::size_t i) {
    return std::sqrt(undamped_lambda({bank.frequency_hz[terms.modes[i]], bank.decay_per_s[terms.modes[i]]}));
  };
  const auto norm = [&](const auto& term_of_function) {
    double sum = 0;
    for (std::size_t k = 0; k < terms.function_count(); ++k) sum += std::pow(double{term_of_function(k)}, 2);
    return std::sqrt(sum);
  };
  for (std::size_t i = 0; i < terms.mode_count(); ++i) {
    const double curving = norm([&](std::size_t k) { return terms.g(k, i); });
    if (!(curving <= kMaxCurving * omega(i))) {
      return refuse("curving: mode " + mode(i) + " has more energy in the nonlinear terms than in total");
    }
    for (std::size_t j = 0; j <= i; ++j) {
      const double bending = norm([&](std::size_t k) { return terms.h(k, i, j); });
      if (bending == 0 || bending * std::sqrt(a[i] * a[j]) <= kMaxStretching * std::sqrt(omega(i) * omega(j))) continue;
      return refuse(
          formatted("bending: bent by its thickness in modes {} and {}, the body would stretch over 1000 times as hard "
                    "as it bends",
                    mode(j), mode(i)));
    }
  }
  return {};
}

}  // namespace ringdown::modal
