// How a second opinion is made.
//
// The other method is asked for the few modes nearest to the shift. Of a multiple eigenvalue an iteration may return
// fewer vectors than there are, so it is asked again with all found so far locked out, until nothing new turns up
// within the radius of the first answer. A family that reaches across that radius or across the top of the band cannot
// be compared; when no family is left, more modes are asked for.
#include "engine/solve/second_opinion.h"

#include "engine/solve/methods.h"
#include "engine/solve/spectra.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <string>

namespace ringdown::solve {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kFirstWanted = 8, kMaxWanted = 256;  // modes near a shift
constexpr int kWantedAgain = 2;                    // modes, of a run that only looks for what an earlier one missed
constexpr double kGap = 2 * kSameFamily;           // relative, of lambda

std::string in_words(const char* format, double a, double b = 0, double c = 0) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b, c);
  return text;
}

// Modes closer together than kSameFamily, of both methods.
struct Family {
  double first = 0, last = 0;       // lambda
  std::vector<Index> ours, theirs;  // numbers of modes, ascending in lambda

  [[nodiscard]] bool within(double low, double high) const {
    return first * (1 - kGap) > low && last * (1 + kGap) < high;
  }
};

// All families above band.low, ascending. `lambda` and `other` in any order.
std::vector<Family> families_of(const VectorXd& lambda, const VectorXd& other, double low) {
  struct Mode {
    double lambda;
    Index number;
    bool ours;
  };
  std::vector<Mode> all;
  for (Index i = 0; i < lambda.size(); ++i) all.push_back({lambda[i], i, true});
  for (Index i = 0; i < other.size(); ++i) all.push_back({other[i], i, false});
  std::erase_if(all, [low](const Mode& mode) { return mode.lambda <= low; });
  std::stable_sort(all.begin(), all.end(), [](const Mode& a, const Mode& b) { return a.lambda < b.lambda; });
  std::vector<Family> families;
  for (const Mode& mode : all) {
    if (families.empty() || mode.lambda - families.back().last > kGap * mode.lambda) {
      families.push_back({.first = mode.lambda, .last = mode.lambda});
    }
    families.back().last = mode.lambda;
    (mode.ours ? families.back().ours : families.back().theirs).push_back(mode.number);
  }
  return families;
}

Band known_part(const Band& band, const NearModes& near) {
  return {std::max(band.low, near.sigma - near.radius), std::min(band.high, near.sigma + near.radius)};
}

// How many of the modes can be compared.
int comparable(const NearModes& near, const Band& band) {
  const Band known = known_part(band, near);
  int count = 0;
  for (const Family& family : families_of({}, near.lambda, band.low)) {
    if (family.within(known.low, known.high)) count += static_cast<int>(family.theirs.size());
  }
  return count;
}

// Sine of the largest angle between the spans of two sets of as many vectors, the second M-orthonormal. 1 when the
// first do not span as many dimensions.
double angle_between(const fem::SparseMatrix& node_mass, const MatrixXd& ours, const MatrixXd& theirs) {
  const MatrixXd scaled = ours.colwise().normalized(), heavy = fem::mass_times(node_mass, scaled);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> gram(scaled.transpose() * heavy);
  if (!(gram.eigenvalues()[0] > 1e-6 * gram.eigenvalues().tail<1>()[0])) return 1;
  const MatrixXd inverse =
      gram.eigenvectors() * gram.eigenvalues().cwiseInverse().asDiagonal() * gram.eigenvectors().transpose();
  const MatrixXd outside = theirs - scaled * (inverse * (heavy.transpose() * theirs));
  const Eigen::SelfAdjointEigenSolver<MatrixXd> squares(outside.transpose() * fem::mass_times(node_mass, outside));
  return std::sqrt(std::max(0.0, squares.eigenvalues().tail<1>()[0]));
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
    return "mode " + std::to_string(mode + 1 - modes.rigid) +
           in_words(" at %.8g Hz", request.hertz(modes.lambda[mode]));
  }
  [[nodiscard]] std::string name_of(const Family& family) const {
    if (family.ours.size() == 1) return name_of(family.ours[0]);
    return std::to_string(family.ours.size()) + " modes from " + name_of(family.ours[0]) + " on";
  }
  Result<void> of(const Family& family, Agreement& agreement) const;
};

Result<void> Comparison::of(const Family& family, Agreement& agreement) const {
  const std::string disagrees = "the second opinion disagrees: ";
  const auto count = static_cast<Index>(family.ours.size());
  if (family.ours.size() != family.theirs.size()) {
    return fail(ErrorKind::refused, "the second opinion disagrees about the number of modes near " +
                                        in_words("%.8g", request.hertz(family.first)) +
                                        " Hz: " + std::to_string(family.ours.size()) + " in the result, " +
                                        std::to_string(family.theirs.size()) + " by " + other());
  }
  for (Index k = 0; k < count; ++k) {
    const double theirs = near.lambda[family.theirs[k]];
    const double off = std::abs(std::sqrt(modes.lambda[family.ours[k]] / theirs) - 1);
    if (!(off <= kSameFrequency)) {
      return fail(ErrorKind::refused, disagrees + name_of(family.ours[k]) + ", which " + other() + " finds at " +
                                          in_words("%.10g Hz, %.2g of it away, where %.0g is allowed",
                                                   request.hertz(theirs), off, kSameFrequency));
    }
    agreement.frequency = std::max(agreement.frequency, off);
  }
  const MatrixXd ours = modes.shapes(Eigen::all, family.ours), theirs = near.shapes(Eigen::all, family.theirs);
  const double angle = angle_between(system.node_mass, ours, theirs);
  if (!(angle <= kSameSpace)) {
    return fail(ErrorKind::refused, disagrees + "the shape of " + name_of(family) + " lies at an angle of " +
                                        in_words("%.2g to what ", angle) + other() +
                                        in_words(" finds, where %.0g is allowed", kSameSpace));
  }
  const double residual = std::max(largest_residual(system, modes.lambda(family.ours), ours),
                                   largest_residual(system, near.lambda(family.theirs), theirs));
  if (!(residual <= kSmallResidual)) {
    return fail(ErrorKind::refused, disagrees + name_of(family) +
                                        in_words(" solves K phi = lambda M phi to %.2g only, where %.0g is allowed",
                                                 residual, kSmallResidual));
  }
  agreement.angle = std::max(agreement.angle, angle);
  agreement.residual = std::max(agreement.residual, residual);
  agreement.modes += static_cast<int>(count);
  return {};
}

// Adds what another run found within the radius, and makes the radius smaller when there are more than `wanted`.
// Returns whether there was any.
bool take(NearModes& near, const Pairs& pairs, int wanted) {
  const auto before = near.lambda.size();
  const auto distance = [&](double lambda) { return std::abs(lambda - near.sigma); };
  std::vector<Index> inside;
  for (std::size_t i = 0; i < pairs.lambda.size(); ++i) {
    if (before == 0 || distance(pairs.lambda[i]) < near.radius) inside.push_back(static_cast<Index>(i));
  }
  if (inside.empty()) return false;
  const auto count = static_cast<Index>(inside.size());
  VectorXd lambda(before + count);
  lambda << near.lambda, Eigen::Map<const VectorXd>(pairs.lambda.data(), pairs.lambda.size())(inside);
  MatrixXd shapes(pairs.shapes.rows(), before + count);
  shapes << near.shapes, pairs.shapes(Eigen::all, inside);
  std::vector<Index> order(before + count);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return distance(lambda[a]) < distance(lambda[b]); });
  order.resize(std::min<std::size_t>(order.size(), wanted));
  near.lambda = lambda(order);
  near.shapes = shapes(Eigen::all, order);
  near.radius = distance(near.lambda.tail<1>()[0]);
  return true;
}

// In the order of the mesh, without those known.
Pairs find_nearest(Method by, const Pencil& pencil, const Count& shift, int wanted, const NearModes& known,
                   double tolerance, const KeepGoing& keep_going) {
  if (by == Method::kSpectra) return nearest_by_spectra(pencil, wanted, tolerance, known.shapes, keep_going);
  const auto known_below = static_cast<int>((known.lambda.array() < shift.lambda).count());
  const Window window{.low = -std::numeric_limits<double>::infinity(),
                      .left = std::min(wanted, shift.below - known_below),
                      .right = wanted,
                      .high = std::numeric_limits<double>::infinity(),
                      .most_vectors = 8 * wanted + 40 * kWidth,
                      .tolerance = tolerance};
  const auto seed = 1000 + static_cast<unsigned>(known.lambda.size());
  Pairs pairs = block_lanczos(pencil, window, pencil.in_elimination_order(known.shapes), seed, keep_going);
  pairs.shapes = pencil.in_mesh_order(pairs.shapes);
  return pairs;
}

}  // namespace

Result<NearModes> find_near(Method by, const Pencil& pencil, const Count& shift, int wanted,
                            const EigenRequest& request, const KeepGoing& keep_going) {
  NearModes near{.method = by == Method::kSpectra ? "Spectra" : "block Lanczos",
                 .sigma = shift.lambda,
                 .shapes = MatrixXd(pencil.unknowns(), 0)};
  for (int count = wanted;; count = kWantedAgain) {
    const Pairs pairs = find_nearest(by, pencil, shift, count, near, request.tolerance, keep_going);
    if (!pairs.complete) {
      return fail(ErrorKind::refused, "the second opinion, by " + std::string(near.method) +
                                          ", did not converge near " + in_words("%.8g", request.hertz(shift.lambda)) +
                                          " Hz; look for needle-like elements in the mesh");
    }
    if (!take(near, pairs, wanted)) return near;
  }
}

Result<void> compare(const fem::System& system, const Eigenmodes& modes, const NearModes& near, const Band& band,
                     const EigenRequest& request, Agreement& agreement) {
  const Comparison comparison{system, modes, near, request};
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
    if (!near) return fail(near.error());
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
    if (auto same = compare(system, modes, near, band, request_, agreement); !same) return fail(same.error());
  }
  if (agreement.modes == 0 && modes.lambda.size() > modes.rigid) {
    return fail(ErrorKind::refused, "the second opinion found no mode of the band that could be compared");
  }
  agreement.seconds = seconds_ + seconds_now() - start;
  return agreement;
}

}  // namespace ringdown::solve
