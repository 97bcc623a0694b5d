#include "engine/modal/levels/level_bank.h"

#include "engine/modal/levels/level_spline.h"
#include "engine/modal/levels/mode_followers.h"
#include "engine/modal/levels/symmetric_spectrum.h"
#include "engine/modal/material_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <utility>

namespace ringdown::modal {
namespace {

using Matrix = std::vector<double>;

constexpr double kStill = 1e-10;       // a liquid's motion whose mass is below this share of the largest is left out
constexpr double kIndependent = 0.01;  // of the liquid's motions, made alike in mass
constexpr double kMinOwn = 0.8;        // eigenvalue of a motion of the liquid over that of the lowest at a higher level
constexpr double kMaxOfOmega = 0.9;    // the most that a mode may lose, so that it keeps a pitch
constexpr double kMinShare = 1e-4;     // of a mode of the bank in a field
constexpr double kRounding = 1e-6;     // of a level that came as a float
constexpr double kMinTerm = 1e-4;      // of a field, as in the radiation of bodies

// Adds up the arrays of all levels, each `size` long, by their shares.
Matrix blended(const std::vector<float>& arrays, const std::vector<double>& shares, std::size_t size) {
  Matrix sum(size);
  for (std::size_t l = 0; l < shares.size(); ++l) {
    for (std::size_t i = 0; i < size; ++i) sum[i] += shares[l] * static_cast<double>(arrays[l * size + i]);
  }
  return sum;
}

// The stiffness and mass matrices of one level, with N columns of the body, then J of the liquid.
class Equations {
 public:
  Equations(const Bank& bank, double level_m)
      : levels_(*bank.levels),
        body_(levels_.columns(bank.mode_count())),
        size_(body_ + levels_.liquid),
        mass_(size_ * size_),
        stiffness_(size_ * size_) {
    const std::vector<double> shares = spline_shares(levels_.level_m, level_m);
    const std::size_t liquid = levels_.liquid;
    const Matrix added = blended(levels_.added, shares, packed_size(body_));
    const Matrix bond = blended(levels_.bond, shares, body_ * liquid);
    const Matrix own = blended(levels_.liquid_mass, shares, packed_size(liquid));
    std::size_t at = 0;
    for (std::size_t i = 0; i < body_; ++i) {
      for (std::size_t j = 0; j <= i; ++j, ++at) {
        put(mass_, i, j, static_cast<double>(levels_.mass[at]) + added[at]);
        put(stiffness_, i, j, static_cast<double>(levels_.stiffness[at]));
      }
    }
    for (std::size_t i = 0; i < body_; ++i) {
      for (std::size_t j = 0; j < liquid; ++j) put(mass_, body_ + j, i, bond[i * liquid + j]);
    }
    at = 0;
    for (std::size_t i = 0; i < liquid; ++i) {
      for (std::size_t j = 0; j <= i; ++j, ++at) {
        put(mass_, body_ + i, body_ + j, own[at]);
        double sum = 0;
        for (std::size_t k = 0; k < body_; ++k)
          sum += static_cast<double>(levels_.following[k * liquid + i]) * bond[k * liquid + j] +
                 static_cast<double>(levels_.following[k * liquid + j]) * bond[k * liquid + i];
        put(stiffness_, body_ + i, body_ + j, sum / 2);
      }
    }
    if (liquid > 0) own_lambda_above_ = leading_lambda(level_m);
  }

  [[nodiscard]] std::size_t body() const { return body_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const Matrix& mass() const { return mass_; }
  [[nodiscard]] double mass(std::size_t i, std::size_t j) const { return mass_[i * size_ + j]; }
  // The mass if the body had half of its own.
  [[nodiscard]] Matrix lighter_mass() const {
    Matrix lighter = mass_;
    for (std::size_t i = 0, at = 0; i < body_; ++i) {
      for (std::size_t j = 0; j <= i; ++j, ++at)
        put(lighter, i, j, mass(i, j) - 0.5 * static_cast<double>(levels_.mass[at]));
    }
    return lighter;
  }
  [[nodiscard]] double stiffness(std::size_t i, std::size_t j) const { return stiffness_[i * size_ + j]; }

  // The liquid's motions that are there at this level, made orthonormal, as columns over J: at most `limit` of them,
  // the most important ones, which come last in the bank. Some are lost where the liquid is shallow, and those that are
  // the same as others but for kIndependent. The liquid's modes only rise when the level falls: what would be lower
  // than the lowest one of the level above is an error of the spline.
  [[nodiscard]] Matrix liquid_basis(std::size_t limit, std::size_t& count) const {
    const std::size_t liquid = size_ - body_;
    double largest = 0;
    for (std::size_t j = 0; j < liquid; ++j) largest = std::max(largest, mass(body_ + j, body_ + j));
    const auto product_of = [&](const std::vector<double>& a, const std::vector<double>& b) {
      double sum = 0;
      for (std::size_t i = 0; i < liquid; ++i) {
        for (std::size_t k = 0; k < liquid; ++k) sum += a[i] * mass(body_ + i, body_ + k) * b[k];
      }
      return sum;
    };
    const auto own_lambda = [&](const std::vector<double>& a) {
      double sum = 0;
      for (std::size_t i = 0; i < liquid; ++i) {
        for (std::size_t k = 0; k < liquid; ++k) sum += a[i] * stiffness(body_ + i, body_ + k) * a[k];
      }
      return sum;
    };
    std::vector<std::vector<double>> columns;
    for (std::size_t j = liquid; j-- > 0 && columns.size() < limit;) {
      const double own = mass(body_ + j, body_ + j);
      if (!(own > kStill * largest)) continue;
      std::vector<double> column(liquid);
      column[j] = 1 / std::sqrt(own);
      for (const std::vector<double>& before : columns) {
        const double part = product_of(before, column);
        for (std::size_t i = 0; i < liquid; ++i) column[i] -= part * before[i];
      }
      const double rest = product_of(column, column);
      if (!(rest > kIndependent)) continue;
      for (double& x : column) x /= std::sqrt(rest);
      if (own_lambda(column) < kMinOwn * own_lambda_above_) continue;
      columns.push_back(std::move(column));
    }
    count = columns.size();
    Matrix basis(liquid * count);
    for (std::size_t i = 0; i < liquid; ++i) {
      for (std::size_t k = 0; k < count; ++k) basis[i * count + k] = columns[k][i];
    }
    return basis;
  }

 private:
  void put(Matrix& matrix, std::size_t i, std::size_t j, double value) const {
    matrix[i * size_ + j] = matrix[j * size_ + i] = value;
  }

  // Returns the eigenvalue of the liquid's leading motion at the bank's next level, `level_m` or the nearest above it.
  [[nodiscard]] double leading_lambda(double level_m) const {
    const std::size_t liquid = levels_.liquid, last = liquid - 1;
    std::size_t l = 1;
    while (l + 1 < levels_.levels() && levels_.level_m[l] < level_m) ++l;
    double stiff = 0;
    for (std::size_t i = 0; i < body_; ++i)
      stiff += static_cast<double>(levels_.following[i * liquid + last]) *
               static_cast<double>(levels_.bond[(l * body_ + i) * liquid + last]);
    return stiff / static_cast<double>(levels_.liquid_mass[l * packed_size(liquid) + packed_size(liquid) - 1]);
  }

  const LiquidLevels& levels_;
  std::size_t body_, size_;
  double own_lambda_above_ = 0;
  Matrix mass_, stiffness_;
};

// All modes of body and liquid at a level.
struct AllModes {
  std::vector<double> lambda;  // ascending
  Matrix mixing;               // size x count
  std::size_t count = 0;
};

// Empty when the liquid's motions have more mass than the liquid adds and half of the body has.
std::optional<AllModes> solve(const Equations& equations, std::size_t limit) {
  const std::size_t body = equations.body(), liquid = equations.size() - body;
  std::size_t there = 0;
  const Matrix basis = equations.liquid_basis(limit, there);
  AllModes modes{.count = body + there};
  const std::size_t n = modes.count;
  Matrix whole(equations.size() * n);  // from the unknowns that are there to all
  for (std::size_t i = 0; i < body; ++i) whole[i * n + i] = 1;
  for (std::size_t i = 0; i < liquid; ++i) {
    for (std::size_t k = 0; k < there; ++k) whole[(body + i) * n + body + k] = basis[i * there + k];
  }
  Matrix stiffness(equations.size() * equations.size());
  for (std::size_t i = 0; i < equations.size(); ++i) {
    for (std::size_t j = 0; j < equations.size(); ++j) stiffness[i * equations.size() + j] = equations.stiffness(i, j);
  }
  if (!is_positive_definite(
          transposed_product(whole, product(equations.lighter_mass(), whole, equations.size()), equations.size()), n))
    return std::nullopt;
  auto spectrum = generalized_spectrum(
      transposed_product(whole, product(stiffness, whole, equations.size()), equations.size()),
      transposed_product(whole, product(equations.mass(), whole, equations.size()), equations.size()), n);
  if (!spectrum) return std::nullopt;
  modes.lambda = std::move(spectrum->values);
  modes.mixing = product(whole, spectrum->vectors, n);
  return modes;
}

// Between two levels the spline's rounding may leave more coupling to a motion of the liquid than its mass allows, or
// nearly so much that a mode appears that does not exist. Then the least important motions are left out there.
std::optional<AllModes> solve(const Equations& equations) {
  std::size_t limit = equations.size() - equations.body();
  std::optional<AllModes> modes = solve(equations, limit);
  while (!modes && limit > 0) modes = solve(equations, --limit);
  return modes;
}

// Scales singular values above 1 to 1.
void limit_to_one(Matrix& map, std::size_t n) {
  const SymmetricSpectrum squares = symmetric_spectrum(transposed_product(map, map, n), n);
  if (n == 0 || squares.values.back() <= 1) return;
  Matrix turned = product(map, squares.vectors, n), back(n * n);
  for (std::size_t k = 0; k < n; ++k) {
    const double factor = squares.values[k] > 1 ? 1 / std::sqrt(squares.values[k]) : 1;
    for (std::size_t i = 0; i < n; ++i) turned[i * n + k] *= factor;
    for (std::size_t i = 0; i < n; ++i) back[k * n + i] = squares.vectors[i * n + k];
  }
  map = product(turned, back, n);
}

}  // namespace

double baked_level_m(const Bank& bank) {
  const std::vector<double>& levels = bank.levels->level_m;
  for (const LiquidNote& note : bank.provenance.liquids) {
    if (!note.around) return std::clamp(note.level_m, levels.front(), levels.back());
  }
  return levels.front();
}

namespace {

// Makes the bank of a level from its modes.
class LevelBankMaker {
 public:
  LevelBankMaker(const Bank& bank, const Equations& equations, const LevelModes& modes)
      : bank_(bank), levels_(*bank.levels), equations_(equations), modes_(modes), count_(bank.mode_count()) {}

  Bank make() {
    Bank out = bank_;
    out.levels.reset();
    out.fracture.reset();
    out.pitch_hz.reset();
    out.losses.resize(count_);
    out.shapes = shapes();
    for (LiquidNote& note : out.provenance.liquids) {
      if (note.around) continue;
      note.level_m = modes_.level_m;
      note.volume_m3 = volume_m3();
    }
    const std::vector<double> drag = drag_of(modes_.level_m), drag_before = drag_of(baked_level_m(bank_));
    const MaterialDamping law = bank_.material ? bank_.material->damping_law() : MaterialDamping();
    for (std::size_t m = 0; m < count_; ++m) {
      const double omega = modes_.omega_rad_s[m], lambda = omega * omega;
      const DampedMode own{bank_.frequency_hz[m], bank_.decay_per_s[m]};
      const double own_lambda = undamped_lambda(own), own_omega = std::sqrt(own_lambda);
      const double strained = strain(m, lambda) / (equations_.stiffness(column(m), column(m)) / own_lambda);
      const double moved = motion(m) / dry_mass(column(m), column(m));
      const ModeLoss before = loss_of(bank_, m);
      ModeLoss loss;
      loss.material_per_s = bank_.material ? material_share(bank_, m) * strained * mode_loss(law, lambda).material_per_s
                                           : strained * omega / own_omega * before.material_per_s;
      if (!bank_.heat.empty()) {
        out.heat[m] = multiplied(bank_.heat[m], strained, 1);
        loss.heat_per_s = heat_loss(out.heat[m], omega);
      }
      loss.support_per_s = moved * std::max(before.support_per_s - drag_before[m] * std::sqrt(own_omega), 0.0);
      loss.support_per_s += drag[m] * std::sqrt(omega);
      loss.air_per_s = moved * before.air_per_s;
      if (bank_.radiation) {
        out.radiation->maps.modes[m] = field(m, omega);
        if (!bank_.losses.empty())
          loss.air_per_s = radiation_decay_per_s(rms(out.radiation->maps.modes[m]), omega, bank_.radiation->air);
      }
      if (loss.total_per_s() > kMaxOfOmega * omega)
        loss.support_per_s = std::max(kMaxOfOmega * omega - (loss.total_per_s() - loss.support_per_s), 0.0);
      const DampedMode mode = with_decay(lambda, loss.total_per_s());
      out.frequency_hz[m] = mode.frequency_hz;
      out.decay_per_s[m] = mode.decay_per_s;
      out.losses[m] = loss;
    }
    return out;
  }

 private:
  [[nodiscard]] std::size_t column(std::size_t mode) const { return levels_.rigid + mode; }
  [[nodiscard]] double share(std::size_t row, std::size_t mode) const { return modes_.mixing[row * count_ + mode]; }
  [[nodiscard]] double dry_mass(std::size_t i, std::size_t j) const {
    return levels_.mass[i >= j ? packed_size(i) + j : packed_size(j) + i];
  }
  // Linear between levels: a spline might overshoot below 0.
  [[nodiscard]] std::pair<std::size_t, double> place_of(double level_m) const {
    std::size_t i = 0;
    while (i + 2 < levels_.levels() && level_m > levels_.level_m[i + 1]) ++i;
    return {i, (level_m - levels_.level_m[i]) / (levels_.level_m[i + 1] - levels_.level_m[i])};
  }
  [[nodiscard]] std::vector<double> drag_of(double level_m) const {
    const auto [i, part] = place_of(level_m);
    std::vector<double> drag(count_);
    for (std::size_t m = 0; m < count_; ++m)
      drag[m] = (1 - part) * static_cast<double>(levels_.drag[i * count_ + m]) +
                part * static_cast<double>(levels_.drag[(i + 1) * count_ + m]);
    return drag;
  }
  [[nodiscard]] double volume_m3() const {
    const auto [i, part] = place_of(modes_.level_m);
    return (1 - part) * levels_.volume_m3[i] + part * levels_.volume_m3[i + 1];
  }

  // The share of a mode's strain energy, and of its kinetic energy, that is in the body.
  [[nodiscard]] double strain(std::size_t mode, double lambda) const {
    double sum = 0;
    for (std::size_t i = 0; i < equations_.body(); ++i) {
      for (std::size_t j = 0; j < equations_.body(); ++j)
        sum += share(i, mode) * equations_.stiffness(i, j) * share(j, mode);
    }
    return sum / lambda;
  }
  [[nodiscard]] double motion(std::size_t mode) const {
    double sum = 0;
    for (std::size_t i = 0; i < equations_.body(); ++i) {
      for (std::size_t j = 0; j < equations_.body(); ++j) sum += share(i, mode) * dry_mass(i, j) * share(j, mode);
    }
    return sum;
  }

  // Rigid motions of unit mass at a point: along the axes, then about the principal ones.
  [[nodiscard]] std::array<Vec3, 6> rigid_at(const Vec3f& point) const {
    const MassProperties& mass = *bank_.mass;
    const Vec3 arm = Vec3{point[0], point[1], point[2]} - mass.center_of_mass_m;
    const auto& [x, y, z, w] = mass.orientation;
    const std::array axes = {Vec3{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                             Vec3{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                             Vec3{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
    const std::array inertia = {mass.inertia_kg_m2.x, mass.inertia_kg_m2.y, mass.inertia_kg_m2.z};
    const double along = 1 / std::sqrt(mass.mass_kg);
    std::array<Vec3, 6> motions = {Vec3{along, 0, 0}, Vec3{0, along, 0}, Vec3{0, 0, along}};
    for (std::size_t axis = 0; axis < 3; ++axis)
      motions[3 + axis] = (1 / std::sqrt(inertia[axis])) * cross(axes[axis], arm);
    return motions;
  }

  [[nodiscard]] std::vector<Vec3f> shapes() const {
    const std::size_t points = bank_.point_count();
    std::vector<Vec3f> out(count_ * points);
    Matrix here(count_ * 3);
    for (std::size_t p = 0; p < points; ++p) {
      std::ranges::fill(here, 0.0);
      const auto add = [&](std::size_t row, const Vec3& moved) {
        for (std::size_t m = 0; m < count_; ++m) {
          const double part = share(row, m);
          here[3 * m] += part * moved.x;
          here[3 * m + 1] += part * moved.y;
          here[3 * m + 2] += part * moved.z;
        }
      };
      if (levels_.rigid > 0) {
        const std::array<Vec3, 6> motions = rigid_at(bank_.positions[p]);
        for (std::size_t k = 0; k < motions.size(); ++k) add(k, motions[k]);
      }
      for (std::size_t m = 0; m < count_; ++m) {
        const Vec3f& moved = bank_.shape(m, p);
        add(column(m), {moved[0], moved[1], moved[2]});
      }
      for (std::size_t k = 0; k < levels_.shapes.size() / (3 * points); ++k) {
        const float* const moved = &levels_.shapes[3 * (k * points + p)];
        add(levels_.rigid + count_ + k, {moved[0], moved[1], moved[2]});
      }
      for (std::size_t m = 0; m < count_; ++m)
        out[m * points + p] = {static_cast<float>(here[3 * m]), static_cast<float>(here[3 * m + 1]),
                               static_cast<float>(here[3 * m + 2])};
    }
    return out;
  }

  [[nodiscard]] FarField field(std::size_t mode, double omega) const {
    const double k = omega / bank_.radiation->air.sound_speed_m_s;
    std::vector<std::complex<double>> values;
    for (std::size_t m = 0; m < count_; ++m) {
      const FarField& own = bank_.radiation->maps.modes[m];
      const double part = share(column(m), mode);
      if (std::abs(part) < kMinShare || own.terms.empty()) continue;
      values.resize(std::max<std::size_t>(values.size(), own.terms.back().harmonic + std::size_t{1}));
      const double level = part * level_ratio(own, k);
      for (const FarField::Term& term : own.terms) values[term.harmonic] += level * std::complex<double>(term.value);
    }
    return {.wavenumber_rad_m = k, .terms = terms_of(values, kMinTerm), .levels = {}};
  }

  const Bank& bank_;
  const LiquidLevels& levels_;
  const Equations& equations_;
  const LevelModes& modes_;
  const std::size_t count_;
};

}  // namespace

Result<void> check_level(const Bank& bank, double level_m) {
  if (!bank.levels)
    return fail(ErrorKind::bad_input,
                "its bank does not know other levels of a liquid; bake it with [fill] and levels = 16");
  const Range range = bank.levels->range_m();
  const double rounding_m = kRounding * (range.high - range.low + std::abs(range.high));
  if (!(level_m >= range.low - rounding_m))
    return fail(ErrorKind::bad_input, "the level {:.4g} m lies below the bottom, at {:.4g} m, where it is empty",
                level_m, range.low);
  if (!(level_m <= range.high + rounding_m))
    return fail(ErrorKind::bad_input, "the level {:.4g} m lies above the rim, at {:.4g} m, where it runs over", level_m,
                range.high);
  return {};
}

Result<LevelBank> at_level(const Bank& bank, double wanted_m) {
  if (auto good = check_level(bank, wanted_m); !good) return fail(good);
  const double level_m = std::clamp(wanted_m, bank.levels->level_m.front(), bank.levels->level_m.back());
  const Equations equations(bank, level_m);
  const std::optional<AllModes> all = solve(equations);
  if (!all) return fail(ErrorKind::bad_input, "the matrices of its bank's levels are damaged; bake it again");
  const std::size_t modes = bank.mode_count(), rigid = bank.levels->rigid, count = all->count - rigid;
  // Likeness is the part of a mode's motion that is along the bank's mode, in the mass of the body alone.
  Matrix likeness(modes * count);
  std::vector<double> signs(modes * count);
  const Matrix dry = Equations(bank, bank.levels->level_m.front()).mass();
  const std::size_t size = equations.size(), body = equations.body();
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> moved(body);
    double norm = 0;
    for (std::size_t i = 0; i < body; ++i) {
      for (std::size_t j = 0; j < body; ++j) moved[i] += dry[i * size + j] * all->mixing[j * all->count + rigid + k];
      norm += moved[i] * all->mixing[i * all->count + rigid + k];
    }
    for (std::size_t m = 0; m < modes; ++m) {
      const std::size_t at = rigid + m;
      const double along = moved[at] / std::sqrt(std::max(norm * dry[at * size + at], 1e-300));
      likeness[m * count + k] = std::abs(along);
      signs[m * count + k] = along < 0 ? -1 : 1;
    }
  }
  std::vector<double> shares;
  for (std::size_t m = 0; m < modes; ++m)
    shares.push_back(equations.stiffness(rigid + m, rigid + m) /
                     undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]}));
  const std::vector<std::size_t> found = followers(std::move(likeness), shares, count);
  LevelModes own{.level_m = level_m, .mixing = Matrix(size * modes), .mass = equations.mass(), .omega_rad_s = {}};
  for (std::size_t m = 0; m < modes; ++m) {
    const std::size_t from = rigid + found[m];
    own.omega_rad_s.push_back(std::sqrt(std::max(all->lambda[from], 0.0)));
    for (std::size_t i = 0; i < size; ++i)
      own.mixing[i * modes + m] = signs[m * count + found[m]] * all->mixing[i * all->count + from];
  }
  return LevelBank{LevelBankMaker(bank, equations, own).make(), std::move(own)};
}

LevelModes as_baked(const Bank& bank) {
  const LiquidLevels& levels = *bank.levels;
  const double level_m = baked_level_m(bank);
  const Equations equations(bank, level_m);
  const std::size_t modes = bank.mode_count(), size = equations.size();
  LevelModes own{.level_m = level_m, .mixing = Matrix(size * modes), .mass = equations.mass(), .omega_rad_s = {}};
  for (std::size_t m = 0; m < modes; ++m) {
    const double lambda = undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
    own.omega_rad_s.push_back(std::sqrt(lambda));
    own.mixing[(levels.rigid + m) * modes + m] = 1;
    for (std::size_t j = 0; j < levels.liquid; ++j)
      own.mixing[(equations.body() + j) * modes + m] =
          lambda * static_cast<double>(levels.following[(levels.rigid + m) * levels.liquid + j]);
  }
  return own;
}

ModeTransfer transfer(const LevelModes& from, const LevelModes& to) {
  const std::size_t modes = from.omega_rad_s.size(), size = to.mixing.size() / std::max<std::size_t>(modes, 1);
  const auto between = [&](const Matrix& mass) {
    return transposed_product(to.mixing, product(mass, from.mixing, size), size);
  };
  ModeTransfer change{between(to.level_m >= from.level_m ? from.mass : to.mass), between(to.mass)};
  for (std::size_t i = 0; i < modes; ++i) {
    for (std::size_t j = 0; j < modes; ++j)
      change.displacement[i * modes + j] *= to.omega_rad_s[i] / std::max(from.omega_rad_s[j], 1e-300);
  }
  limit_to_one(change.velocity, modes);
  limit_to_one(change.displacement, modes);
  return change;
}

}  // namespace ringdown::modal
