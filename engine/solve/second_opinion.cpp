// The comparison, step by step.
//
// The other method is asked once for the few modes nearest to the shift. Families of close modes that reach across the
// farthest of these, or across the top of the band, cannot be compared; when no family is left, twice as many modes are
// asked for.
//
// An iteration with one vector finds one shape of a multiple eigenvalue and may miss the others. Therefore a family may
// have fewer modes in the second opinion than in the result, as long as every mode of the result has a partner of equal
// frequency. The proof remains complete: the shapes of the result must be linearly independent and must solve the
// equation, so they are all modes; and the number of modes below the shift must be the number that the factorization
// counted there, so none is missing.
#include "engine/solve/second_opinion.h"

#include "engine/base/formatted.h"
#include "engine/dense/decompositions.h"
#include "engine/dense/products.h"
#include "engine/solve/methods.h"
#include "engine/solve/spectra.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace ringdown::solve {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kFirstWanted = 6, kMaxWanted = 192;  // modes near a shift
constexpr double kFamilyGap = 2 * kSameFamily;     // relative, of lambda

// Neighbouring modes closer together than kSameFamily. `ours` are modes of the result, `theirs` of the second opinion.
struct Family {
  double first = 0, last = 0;       // lambda
  std::vector<Index> ours, theirs;  // numbers of modes, ascending in lambda

  [[nodiscard]] bool within(double low, double high) const {
    return first * (1 - kFamilyGap) > low && last * (1 + kFamilyGap) < high;
  }
};

// All families above `low`, ascending. `ours` and `theirs` may be in any order.
std::vector<Family> families_of(const VectorXd& ours, const VectorXd& theirs, double low) {
  struct Mode {
    double lambda;
    Index number;
    bool ours;
  };
  std::vector<Mode> all;
  for (Index i = 0; i < ours.size(); ++i) all.push_back({ours[i], i, true});
  for (Index i = 0; i < theirs.size(); ++i) all.push_back({theirs[i], i, false});
  std::erase_if(all, [low](const Mode& mode) { return mode.lambda <= low; });
  std::stable_sort(all.begin(), all.end(), [](const Mode& a, const Mode& b) { return a.lambda < b.lambda; });
  std::vector<Family> families;
  for (const Mode& mode : all) {
    if (families.empty() || mode.lambda - families.back().last > kFamilyGap * mode.lambda) {
      families.push_back({.first = mode.lambda, .last = mode.lambda});
    }
    families.back().last = mode.lambda;
    (mode.ours ? families.back().ours : families.back().theirs).push_back(mode.number);
  }
  return families;
}

// The part of the band in which the second opinion knows every frequency.
Band known_part(const Band& band, const NearModes& near) {
  const double sigma = near.shift.lambda;
  return {std::max(band.low, sigma - near.radius), std::min(band.high, sigma + near.radius)};
}

// The number of modes of the second opinion that can be compared.
int comparable(const NearModes& near, const Band& band) {
  const Band known = known_part(band, near);
  int count = 0;
  for (const Family& family : families_of({}, near.lambda, band.low)) {
    if (family.within(known.low, known.high)) count += static_cast<int>(family.theirs.size());
  }
  return count;
}

// Sine of the largest angle by which a vector of the span of `theirs`, which is M-orthonormal, leaves the span of
// `ours`: the largest principal angle of the two. 1 when the columns of `ours` are not linearly independent.
double angle_between(const fem::SparseMatrix& node_mass, const MatrixXd& ours, const MatrixXd& theirs) {
  const MatrixXd scaled = ours.colwise().normalized(), heavy = fem::mass_times(node_mass, scaled);
  const dense::Spectrum gram = dense::spectrum(dense::transposed_product(scaled, heavy));
  if (!(gram.values[0] > 1e-6 * gram.values.tail<1>()[0])) return 1;
  const MatrixXd inverse =
      dense::product_transposed(gram.vectors * gram.values.cwiseInverse().asDiagonal(), gram.vectors);
  MatrixXd outside = theirs;
  dense::add_product(outside, -1, scaled, dense::product(inverse, dense::transposed_product(heavy, theirs)));
  const VectorXd squares = dense::eigenvalues(dense::transposed_product(outside, fem::mass_times(node_mass, outside)));
  return std::sqrt(std::max(0.0, squares.tail<1>()[0]));
}

double largest_residual(const fem::System& system, const VectorXd& lambda, const MatrixXd& shapes) {
  const MatrixXd stiff = system.stiffness.selfadjointView<Eigen::Lower>() * shapes;
  const MatrixXd heavy = fem::mass_times(system.node_mass, shapes) * lambda.asDiagonal();
  return ((stiff - heavy).colwise().norm().array() / heavy.colwise().norm().array()).maxCoeff();
}

struct Comparison {
  const fem::System& system;
  const Eigenmodes& modes;
  const NearModes& near;
  const EigenRequest& request;

  [[nodiscard]] std::string other() const { return std::string(near.method); }
  // "mode 12 at 812.3456 Hz": the first vibration is number 1.
  [[nodiscard]] std::string name_of(Index mode) const {
    return formatted("mode {} at {:.8g} Hz", mode + 1 - modes.rigid, request.hertz(modes.lambda[mode]));
  }
  [[nodiscard]] std::string name_of(const Family& family) const {
    if (family.ours.size() == 1) return name_of(family.ours[0]);
    return formatted("{} modes from {} on", family.ours.size(), name_of(family.ours[0]));
  }
  [[nodiscard]] static Result<void> disagree(const std::string& what) {
    return fail(ErrorKind::refused, "the second opinion disagrees: " + what);
  }
  Result<void> of(const Family& family, Agreement& agreement) const;
  Result<void> frequencies_of(const Family& family, Agreement& agreement) const;
  Result<void> count() const;
};

// The mode among `numbers` whose lambda is nearest to `wanted`.
Index nearest(const VectorXd& lambda, const std::vector<Index>& numbers, double wanted) {
  return *std::min_element(numbers.begin(), numbers.end(), [&](Index a, Index b) {
    return std::abs(lambda[a] - wanted) < std::abs(lambda[b] - wanted);
  });
}

// Checks that every frequency of each method equals one of the other method.
Result<void> Comparison::frequencies_of(const Family& family, Agreement& agreement) const {
  if (family.theirs.empty() || family.ours.size() < family.theirs.size()) {
    return disagree(formatted("the number of modes near {:.8g} Hz is {} in the result and {} by {}",
                              request.hertz(family.first), family.ours.size(), family.theirs.size(), other()));
  }
  const auto match = [&](Index mode, Index found) -> Result<void> {
    const double their_lambda = near.lambda[found];
    const double off = std::abs(std::sqrt(modes.lambda[mode] / their_lambda) - 1);
    agreement.frequency = std::max(agreement.frequency, off);
    if (off <= kSameFrequency) return {};
    return disagree(
        formatted("{}, which {} finds at {:.10g} Hz, a relative difference of {:.2g}, where {:.0g} is allowed",
                  name_of(mode), other(), request.hertz(their_lambda), off, kSameFrequency));
  };
  for (const Index mode : family.ours) {
    if (auto same = match(mode, nearest(near.lambda, family.theirs, modes.lambda[mode])); !same) return same;
  }
  for (const Index found : family.theirs) {
    if (auto same = match(nearest(modes.lambda, family.ours, near.lambda[found]), found); !same) return same;
  }
  return {};
}

Result<void> Comparison::of(const Family& family, Agreement& agreement) const {
  if (auto same = frequencies_of(family, agreement); !same) return same;
  const MatrixXd ours = modes.shapes(Eigen::all, family.ours), theirs = near.shapes(Eigen::all, family.theirs);
  const double angle = angle_between(system.node_mass, ours, theirs);
  if (!(angle <= kSameSpace)) {
    return disagree(formatted("the shape of {} lies at an angle of {:.2g} to what {} finds, where {:.0g} is allowed",
                              name_of(family), angle, other(), kSameSpace));
  }
  const double residual = std::max(largest_residual(system, modes.lambda(family.ours), ours),
                                   largest_residual(system, near.lambda(family.theirs), theirs));
  if (!(residual <= kSmallResidual)) {
    return disagree(formatted("{} solves K phi = lambda M phi to {:.2g} only, where {:.0g} is allowed", name_of(family),
                              residual, kSmallResidual));
  }
  agreement.angle = std::max(agreement.angle, angle);
  agreement.residual = std::max(agreement.residual, residual);
  agreement.modes += static_cast<int>(family.ours.size());
  return {};
}

// Checks the number of modes below the shift by Sylvester's law of inertia. Above the top of the band the result has no
// modes to count.
Result<void> Comparison::count() const {
  const Count& shift = near.shift;
  const auto found = (modes.lambda.array() < shift.lambda).count();
  if (shift.lambda > request.highest_lambda || found == shift.below) return {};
  return disagree(
      formatted("{} modes were counted below {:.8g} Hz and {} found", shift.below, request.hertz(shift.lambda), found));
}

// Finds the pairs nearest to the shift, with shapes in the order of the mesh.
Pairs nearest_pairs(Method by, const Pencil& pencil, const Count& shift, int wanted, double tolerance,
                    const KeepGoing& keep_going) {
  const MatrixXd none(pencil.unknowns(), 0);
  if (by == Method::kSpectra) return nearest_by_spectra(pencil, wanted, tolerance, none, keep_going);
  const Window window{.low = -std::numeric_limits<double>::infinity(),
                      .left = std::min(wanted, shift.below),
                      .right = wanted,
                      .high = std::numeric_limits<double>::infinity(),
                      .max_vectors = 8 * wanted + 40 * kWidth,
                      .tolerance = tolerance};
  constexpr unsigned kSeed = 1000;  // differs from the seeds of solve_block_lanczos()
  Pairs pairs = block_lanczos(pencil, window, none, kSeed, keep_going);
  pairs.shapes = pencil.in_mesh_order(pairs.shapes);
  return pairs;
}

}  // namespace

Result<NearModes> find_near(Method by, const Pencil& pencil, const Count& shift, int wanted,
                            const EigenRequest& request, const KeepGoing& keep_going) {
  NearModes near{.method = by == Method::kSpectra ? "Spectra" : "block Lanczos", .shift = shift};
  const Pairs pairs = nearest_pairs(by, pencil, shift, wanted, request.tolerance, keep_going);
  if (!pairs.complete) {
    return fail(ErrorKind::refused,
                "the second opinion, by {}, did not converge near {:.8g} Hz; look for needle-like elements in the mesh",
                near.method, request.hertz(shift.lambda));
  }
  const auto distance = [&](Index i) { return std::abs(pairs.lambda[i] - shift.lambda); };
  std::vector<Index> order(pairs.lambda.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return distance(a) < distance(b); });
  order.resize(std::min<std::size_t>(order.size(), wanted));
  near.lambda = Eigen::Map<const VectorXd>(pairs.lambda.data(), static_cast<Index>(pairs.lambda.size()))(order);
  near.shapes = pairs.shapes(Eigen::all, order);
  near.radius = distance(order.back());
  return near;
}

Result<void> compare(const fem::System& system, const Eigenmodes& modes, const NearModes& near, const Band& band,
                     const EigenRequest& request, Agreement& agreement) {
  const Comparison comparison{system, modes, near, request};
  if (auto counted = comparison.count(); !counted) return counted;
  const Band known = known_part(band, near);
  for (const Family& family : families_of(modes.lambda, near.lambda, known.low)) {
    if (!family.within(known.low, known.high)) continue;
    if (auto same = comparison.of(family, agreement); !same) return same;
  }
  return {};
}

Result<void> SecondOpinion::ask(const Pencil& pencil, const Count& shift) {
  const double start = seconds_now();
  for (int wanted = std::min<int>(kFirstWanted, static_cast<int>(pencil.unknowns()) / 3);; wanted *= 2) {
    Result<NearModes> near = find_near(by_, pencil, shift, wanted, request_, [this](double share) {
      return !progress_ || progress_("second opinion", share);
    });
    if (!near) return fail(near);
    if (comparable(*near, band_) > 0 || 2 * wanted > kMaxWanted || 6 * wanted > pencil.unknowns()) {
      found_.push_back(std::move(*near));
      seconds_ += seconds_now() - start;
      return {};
    }
  }
}

Result<Agreement> SecondOpinion::check(const fem::System& system, const Eigenmodes& modes) const {
  const double start = seconds_now();
  Agreement agreement;
  Band band = band_;
  for (const double rigid : modes.lambda.head(modes.rigid)) band.low = std::max(band.low, 3 * std::abs(rigid));
  for (const NearModes& near : found_) {
    if (auto same = compare(system, modes, near, band, request_, agreement); !same) return fail(same);
  }
  if (agreement.modes == 0 && modes.lambda.size() > modes.rigid) {
    return fail(ErrorKind::refused, "the second opinion found no mode of the band that could be compared");
  }
  agreement.seconds = seconds_ + seconds_now() - start;
  return agreement;
}

}  // namespace ringdown::solve
