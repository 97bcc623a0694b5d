#include "engine/modal/nonlinear.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::modal {
namespace {

// Returns 1 / x, bounded by 1 / (2 least) near zero, where two frequencies are in resonance and averaging fails.
double bounded_inverse(double x, double min) { return x / (x * x + min * min); }

// The fully symmetric tensor of the cubic energy: sum over k of (g_k . q) t_k = sum T_pij q_p q_i q_j.
class CubicEnergy {
 public:
  explicit CubicEnergy(const NonlinearTerms& terms) : m_(terms.mode_count()), t_(m_ * m_ * m_) {
    std::vector<double> once(m_ * m_ * m_);
    for (std::size_t k = 0; k < terms.function_count(); ++k) {
      for (std::size_t p = 0; p < m_; ++p) {
        const double g = static_cast<double>(terms.g(k, p)) / 3;
        if (g == 0) continue;
        for (std::size_t i = 0; i < m_; ++i) {
          for (std::size_t j = 0; j <= i; ++j) once[at(p, i, j)] += g * static_cast<double>(terms.h(k, i, j));
        }
      }
    }
    for (std::size_t p = 0; p < m_; ++p) {
      for (std::size_t i = 0; i < m_; ++i) {
        for (std::size_t j = 0; j < m_; ++j) {
          t_[at(p, i, j)] = sorted(once, p, i, j) + sorted(once, i, p, j) + sorted(once, j, p, i);
        }
      }
    }
  }
  [[nodiscard]] double operator()(std::size_t p, std::size_t i, std::size_t j) const { return t_[at(p, i, j)]; }

 private:
  [[nodiscard]] std::size_t at(std::size_t p, std::size_t i, std::size_t j) const { return (p * m_ + i) * m_ + j; }
  [[nodiscard]] double sorted(const std::vector<double>& once, std::size_t p, std::size_t i, std::size_t j) const {
    return once[at(p, std::max(i, j), std::min(i, j))];
  }
  std::size_t m_;
  std::vector<double> t_;
};

// The contribution of the cubic energy to B_ml.
double cubic_detuning(const CubicEnergy& t, const std::vector<double>& omega, std::size_t m, std::size_t l) {
  constexpr double kResonance = 0.2;  // share of an eigenvalue within which resonance is bounded
  double sum = 0;
  for (std::size_t p = 0; p < omega.size(); ++p) {
    const double lambda = omega[p] * omega[p];
    const auto driven = [&](double by) { return bounded_inverse(lambda - by * by, kResonance * lambda); };
    if (l != m) {
      const double offset = -1.5 * t(p, l, l) / lambda, c = 6 * t(p, m, l);
      sum += 3 * t(p, m, m) * offset / omega[m];
      sum -= c * c * (driven(omega[l] + omega[m]) + driven(omega[l] - omega[m])) / (8 * omega[m]);
    } else if (p == m) {
      const double g = 3 * t(m, m, m);
      sum -= 5.0 / 12 * g * g / (lambda * omega[m]);
    } else {
      const double g = 3 * t(p, m, m);
      sum -= 0.5 * g * g * (1 / lambda + 0.5 * driven(2 * omega[m])) / omega[m];
    }
  }
  return sum;
}

}  // namespace

void multiply(NonlinearTerms& terms, double bending, double curving) {
  for (float& value : terms.bending) value = static_cast<float>(bending * static_cast<double>(value));
  for (float& value : terms.curving) value = static_cast<float>(curving * static_cast<double>(value));
}

void take_modes(NonlinearTerms& terms, const std::vector<std::size_t>& order) {
  NonlinearTerms taken{.thickness_m = terms.thickness_m, .residual = terms.residual, .coupled = terms.coupled};
  std::vector<std::size_t> from;  // the old position of each new mode
  for (std::size_t m = 0; m < terms.mode_count(); ++m) {
    const auto found = std::find(order.begin(), order.end(), terms.modes[m]);
    if (found == order.end()) continue;
    taken.modes.push_back(static_cast<std::uint32_t>(found - order.begin()));
    from.push_back(m);
    if (!terms.errors.empty()) taken.errors.push_back(terms.errors[m]);
  }
  for (std::size_t k = 0; k < terms.function_count(); ++k) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      taken.curving.push_back(terms.g(k, from[i]));
      for (std::size_t j = 0; j <= i; ++j) taken.bending.push_back(terms.h(k, from[i], from[j]));
    }
  }
  terms = std::move(taken);
}

std::vector<double> detuning(const NonlinearTerms& terms, const std::vector<double>& omega_rad_s) {
  const std::size_t m_count = terms.mode_count();
  std::vector<double> b(m_count * m_count);
  for (std::size_t k = 0; k < terms.function_count(); ++k) {
    for (std::size_t m = 0; m < m_count; ++m) {
      const auto own = static_cast<double>(terms.h(k, m, m));
      for (std::size_t l = 0; l < m_count; ++l) {
        const auto other = static_cast<double>(terms.h(k, l, l)), both = static_cast<double>(terms.h(k, l, m));
        b[m * m_count + l] += (l == m ? 0.75 * own * own : 0.5 * (own * other + 2 * both * both)) / omega_rad_s[m];
      }
    }
  }
  if (std::all_of(terms.curving.begin(), terms.curving.end(), [](float g) { return g == 0; })) return b;
  const CubicEnergy cubic(terms);
  for (std::size_t m = 0; m < m_count; ++m) {
    for (std::size_t l = 0; l < m_count; ++l) b[m * m_count + l] += cubic_detuning(cubic, omega_rad_s, m, l);
  }
  return b;
}

}  // namespace ringdown::modal
