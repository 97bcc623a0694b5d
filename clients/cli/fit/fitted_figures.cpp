#include "clients/cli/fit/fitted_figures.h"

#include "engine/base/formatted.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

// From fitted figures to constants
//
// The fit has ln(E/rho) and the other figures x, with their covariance. A constant of the material is a function g of
// these: a modulus, for example, is the one that was baked, times E/rho over the material's, times the density. Its
// error is sqrt(g'^T C g'), with C the covariance and g' the slopes of g, taken by differences.
namespace ringdown::cli {
namespace {

using Values = std::span<const double>;  // ln(E/rho over the material's), then each figure
using Quantity = std::function<double(Values)>;

class Fitted {
 public:
  explicit Fitted(const Comparison& c) : c_(c), is_nu_(c.figures.size() == 1 && c.nu_told) {
    // Least squares have the last word on figures that they moved. The search for nu has found robust values.
    const bool by_squares = c.determined && !c.figures.empty() && !is_nu_;
    values_.push_back(by_squares ? c.determined->changes[0] : std::log(c.stiffness()));
    for (std::size_t k = 0; k < c.figures.size(); ++k)
      values_.push_back(c.figures[k].value + (by_squares ? c.determined->changes[k + 1] : 0));
  }

  [[nodiscard]] bool is_nu() const { return is_nu_; }
  [[nodiscard]] static double stiffness(Values x) { return std::exp(x[0]); }

  // The density over that of the material: by the weight, and by how the figures change the volume.
  [[nodiscard]] double density(Values x) const {
    if (!(c_.weight_kg > 0) || !c_.bank.mass) return 1;
    double change = 0;
    for (std::size_t k = 0; k < c_.volume_slopes.size(); ++k)
      change += c_.volume_slopes[k] * (x[k + 1] - c_.figures[k].value);
    return c_.weight_kg / c_.bank.mass->mass_kg * std::exp(-change);
  }

  // The value of a figure. A modulus was baked with the material's density and E/rho.
  [[nodiscard]] double figure(Values x, std::size_t k) const {
    return x[k + 1] * (c_.figures[k].is_modulus() ? stiffness(x) * density(x) : 1);
  }

  // The value of the first figure whose name begins so; else what the bank was baked with.
  [[nodiscard]] double figure_or(Values x, const std::string& name, double baked) const {
    const auto found = std::ranges::find_if(c_.figures, [&](const Figure& f) { return f.name.starts_with(name); });
    return found == c_.figures.end() ? baked : x[static_cast<std::size_t>(found - c_.figures.begin()) + 1];
  }

  [[nodiscard]] double value(const Quantity& of) const { return of(values_); }

  // " +- 0.3 %" or, in the quantity's own unit, " +- 0.004"; nothing where no error is known.
  [[nodiscard]] std::string error(const Quantity& of, bool as_share) const {
    if (!c_.determined) return "";
    const double error = std::sqrt(std::max(covariance(of, of), 0.0));
    return as_share ? formatted(" +- {:.2g} %", 100 * error / std::abs(value(of))) : formatted(" +- {:.2g}", error);
  }

  [[nodiscard]] double correlation(const Quantity& a, const Quantity& b) const {
    return covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
  }

 private:
  [[nodiscard]] std::vector<double> slopes(const Quantity& of) const {
    constexpr double kStep = 1e-3;  // of a standard error
    std::vector<double> slopes;
    for (std::size_t k = 0; k < values_.size(); ++k) {
      std::vector<double> above = values_, below = values_;
      const double step = std::max(kStep * c_.determined->errors[k], 1e-9 * std::abs(values_[k]) + 1e-12);
      above[k] += step;
      below[k] -= step;
      slopes.push_back((of(above) - of(below)) / (2 * step));
    }
    return slopes;
  }

  [[nodiscard]] double covariance(const Quantity& a, const Quantity& b) const {
    const std::vector<double> of_a = slopes(a), of_b = slopes(b);
    const std::vector<double>& errors = c_.determined->errors;
    double sum = 0;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      for (std::size_t j = 0; j < values_.size(); ++j)
        sum += of_a[i] * of_b[j] * errors[i] * errors[j] * c_.determined->correlation(i, j);
    }
    return sum;
  }

  const Comparison& c_;
  bool is_nu_;
  std::vector<double> values_;
};

bool all_alike(const std::array<double, 3>& values) {
  constexpr double kRounding = 1e-6;
  return std::ranges::all_of(values,
                             [&](double v) { return std::abs(v - values[0]) <= kRounding * std::abs(values[0]); });
}

bool is_cubic(const modal::Orthotropy& solid) {
  return all_alike(solid.youngs_modulus_pa) && all_alike(solid.poisson_ratio) && all_alike(solid.shear_modulus_pa);
}

// Returns the lines that the weight makes possible: the density, and stiffnesses where they are few.
std::string constants_by_weight(const Comparison& c, const Fitted& fitted) {
  const modal::Material& material = *c.bank.material;
  const std::optional<modal::Orthotropy>& solid = material.orthotropy;
  const auto density = [&](Values x) { return fitted.density(x) * material.density_kg_m3; };
  const auto young = [&](Values x) {
    const double baked =
        solid ? fitted.figure_or(x, "youngs_modulus_1", solid->youngs_modulus_pa[0]) : material.youngs_modulus_pa;
    return baked * Fitted::stiffness(x) * fitted.density(x);
  };
  const auto nu = [&](Values x) {
    return fitted.figure_or(x, "poisson_ratio", solid ? solid->poisson_ratio[0] : material.poisson_ratio);
  };
  const auto c11 = [&](Values x) { return young(x) * (1 - nu(x)) / ((1 + nu(x)) * (1 - 2 * nu(x))); };
  const auto c12 = [&](Values x) { return young(x) * nu(x) / ((1 + nu(x)) * (1 - 2 * nu(x))); };
  const auto c44 = [&](Values x) {
    if (!solid) return young(x) / (2 * (1 + nu(x)));
    return fitted.figure_or(x, "shear_modulus", solid->shear_modulus_pa[0]) * Fitted::stiffness(x) * fitted.density(x);
  };
  const auto line = [&](const char* name, const Quantity& of) {
    return formatted("{:<12} {:.6g} GPa{}\n", name, 1e-9 * fitted.value(of), fitted.error(of, true));
  };
  std::string text = formatted("density      {:.1f} kg/m3 by the weight\n", fitted.value(density));
  text += line(solid && !is_cubic(*solid) ? "E1" : "E", young);
  if (solid && !is_cubic(*solid)) return text;
  return text + line("c11", c11) + (solid ? line("c12", c12) : "") + line("c44", c44);
}

}  // namespace

std::string fitted_figures(const Comparison& c) {
  const Fitted fitted(c);
  std::vector<std::pair<std::string, Quantity>> shown = {{"E/rho", Fitted::stiffness}};
  std::string text = formatted("E/rho        {:.4f} times that of {}{}\n", fitted.value(Fitted::stiffness), c.material,
                               fitted.error(Fitted::stiffness, true));
  for (std::size_t k = 0; k < c.figures.size(); ++k) {
    const Figure& figure = c.figures[k];
    const Quantity of = [&fitted, k](Values x) { return fitted.figure(x, k); };
    shown.emplace_back(fitted.is_nu() ? "nu" : figure.name, of);
    if (fitted.is_nu()) {
      text += formatted("nu           {:.4f}{}; the material says {:.3f}\n", c.poisson_ratio, fitted.error(of, false),
                        c.given_poisson_ratio);
    } else {
      text += formatted("{:<12} {:.6g}{}{}\n", figure.name, fitted.value(of), fitted.error(of, true),
                        figure.is_modulus() && !(c.weight_kg > 0) ? ", if as dense as " + c.material : "");
    }
  }
  if (c.figures.empty()) {
    text +=
        formatted("nu           {:.3f} as the material says: the recordings do not determine it\n", c.poisson_ratio);
  }
  if (c.determined && !c.figures.empty()) {
    text += "correlation  ";
    for (std::size_t a = 0; a < shown.size(); ++a) {
      for (std::size_t b = a + 1; b < shown.size(); ++b)
        text += formatted("{}{} and {} {:+.2f}", a == 0 && b == 1 ? "" : ", ", shown[a].first, shown[b].first,
                          fitted.correlation(shown[a].second, shown[b].second));
    }
    text += "\n";
  }
  if (c.weight_kg > 0 && c.bank.mass && c.bank.material) text += constants_by_weight(c, fitted);
  return text;
}

}  // namespace ringdown::cli
