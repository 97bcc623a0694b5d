// Method::kBlockLanczos: all eigenvalues below the top, slice by slice of the spectrum, each count proved by inertia.
//
// A factorization at a shift counts the eigenvalues below it. From the bottom up, each slice gets a shift a little
// above what is done; its count says how many eigenvalues lie between, and block_lanczos() goes on until it has those,
// and about as many above. Where fewer are found than counted, more iterations look for the rest with those found
// locked out. The last count is made at the top. Source: Grimes, Lewis & Simon, SIAM J. Matrix Anal. Appl. 15, 1994,
// section 4.
#include "engine/solve/block_lanczos.h"
#include "engine/solve/methods.h"
#include "engine/solve/mode_set.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace ringdown::solve {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBackwardError = 1e-10;  // of a solve; above, the shift moves
constexpr double kStep = 3e-4;            // relative, by which it moves
constexpr double kGap = 1e-5;             // relative, between the last eigenvalue of a slice and the next one's first
constexpr int kDenseAtMost = 4000;        // unknowns; below, dense algebra is quicker when a quarter of all is wanted
constexpr int kMaxRepairs = 12;           // between two counts

struct Count {
  double lambda;
  int below;  // eigenvalues below lambda
};

class Slicer {
 public:
  Slicer(const fem::System& system, const EigenRequest& request, int threads, const Progress& progress)
      : system_(system),
        request_(request),
        progress_(progress),
        team_(threads),
        plan_(plan_elimination(system, threads)),
        ordered_(system, plan_, team_),
        factors_(plan_, ordered_, team_),
        modes_(ordered_) {}

  Result<Eigenmodes> solve();

 private:
  Result<Count> factor(double lambda, double step = -kStep);
  Result<void> slice();
  Result<void> repair(const Count& low, const Count& high);
  void iterate(const Window& window, const Eigen::MatrixXd& locked);
  [[nodiscard]] double lambda_at(double count) const;
  [[nodiscard]] int slices_for(int modes) const;
  [[nodiscard]] Count last_gap(double above) const;
  [[nodiscard]] bool tell(std::string_view stage, double fraction) const {
    return !progress_ || progress_(stage, fraction);
  }
  Eigenmodes result();

  const fem::System& system_;
  const EigenRequest& request_;
  const Progress& progress_;
  Team team_;
  const Elimination plan_;
  const OrderedSystem ordered_;
  Ldlt factors_;
  ModeSet modes_;
  Count done_{-kInfinity, 0};    // all below were found
  Count proved_{-kInfinity, 0};  // the last shift: its count and what was found agree
  Count top_{0, 0};
  unsigned seed_ = 1;
  int solves_ = 0, factorizations_ = 0;
  double factor_seconds_ = 0, iterate_seconds_ = 0;
};

double hertz(double lambda) { return std::sqrt(std::max(0.0, lambda)) / (2 * std::numbers::pi); }

// Factors at lambda, or some steps from it where the factors would lose digits.
Result<Count> Slicer::factor(double lambda, double step) {
  const double start = seconds_now();
  for (int attempt = 0; attempt < 4; ++attempt, lambda *= 1 + step) {
    ++factorizations_;
    if (!factors_.factor(lambda, [this] { return tell("factors", 0); })) continue;
    if (factors_.backward_error() > kBackwardError) continue;
    factor_seconds_ += seconds_now() - start;
    return Count{lambda, factors_.negative()};
  }
  return fail(not_factored(system_));
}

// The eigenvalue of so high a number: that of a similar problem when the request knows one, else guessed between what
// is done and the top, their number growing like f^2.4, between the f of plates and bars and the f^3 of solids.
double Slicer::lambda_at(double count) const {
  const Eigen::VectorXd& expected = request_.expected_lambda;
  const auto number = static_cast<Eigen::Index>(count) - 6;  // without the rigid motions of one piece
  if (number > 0 && number < expected.size()) {
    const double middle = 0.5 * (expected[number - 1] + expected[number]);
    if (middle > done_.lambda && middle > 0 && middle < top_.lambda) return middle;
  }
  constexpr double kPower = 1.2;
  const double share = (count - done_.below) / std::max(1, top_.below - done_.below);
  const double low = std::pow(std::max(0.0, done_.lambda), kPower), high = std::pow(top_.lambda, kPower);
  return std::pow(low + std::clamp(share, 0.0, 1.0) * (high - low), 1 / kPower);
}

// How many slices take the least time: few cost many operations to keep vectors orthogonal, many a factorization each.
// Measured: a slice of s modes takes 1.7 s + 160 vectors; one core does 25e9 flop/s in large products and reads 11e9
// byte/s. The minimum is flat: twice as many slices cost a tenth more.
int Slicer::slices_for(int modes) const {
  constexpr double kFlops = 25e9, kBytes = 11e9;
  const auto seconds = [&](int slices) {
    const double vectors = 1.7 * modes / slices + 160;
    const double solves = vectors * 2 * 8 * static_cast<double>(plan_.factor_entries) / kWidth / kBytes;
    const double orthogonal = static_cast<double>(ordered_.unknowns()) * vectors * vectors / kBytes;
    const double ritz = 12 * vectors * vectors * vectors / kFlops;
    return slices * (plan_.flops / kFlops + solves + orthogonal + ritz);
  };
  int best = 1;
  for (int slices = 2; slices <= 64; ++slices) {
    if (seconds(slices) < seconds(best)) best = slices;
  }
  return best;
}

void Slicer::iterate(const Window& window, const Eigen::MatrixXd& locked) {
  const double start = seconds_now(), all = std::max(1, top_.below), before = done_.below / all;
  const double share = (window.left + window.right) / all;
  factors_.release_workspace();
  Pairs pairs = block_lanczos(ordered_, factors_, team_, window, locked, seed_++,
                              [&](double part) { return tell("modes", std::min(0.99, before + part * share)); });
  solves_ += pairs.solves;
  modes_.add(pairs.lambda, std::move(pairs.shapes));
  iterate_seconds_ += seconds_now() - start;
}

// The highest gap between eigenvalues found, not below `above`: everything under it counts as done.
Count Slicer::last_gap(double above) const {
  for (int i = modes_.size() - 1; i > 0 && modes_.lambda(i) > above; --i) {
    const double low = std::max(above, modes_.lambda(i - 1)), high = modes_.lambda(i);
    if (high - low > kGap * high) return {0.5 * (low + high), i};
  }
  return {above, modes_.count(-kInfinity, above)};
}

Result<void> Slicer::slice() {
  const int left = top_.below - done_.below, slices = slices_for(left);
  const double each = static_cast<double>(left) / slices;
  Result<Count> shift = factor(lambda_at(done_.below + 0.5 * each));
  // Far more below it than thought: try again where they would be if they lay evenly.
  if (shift && shift->below - done_.below > 1.5 * each + 20) {
    const double low = std::max(0.0, done_.lambda);
    shift = factor(low + (shift->lambda - low) * 0.6 * each / (shift->below - done_.below));
  }
  if (!shift) return fail(shift.error());
  const bool last = slices == 1;
  const int right = top_.below - shift->below;
  const Window window{.low = done_.lambda,
                      .left = shift->below - done_.below,
                      .right = last ? right : std::min(right, static_cast<int>(0.5 * each)),
                      .high = last ? top_.lambda : kInfinity,
                      .most_vectors = static_cast<int>(4 * each) + 40 * kWidth,
                      .tolerance = request_.tolerance};
  const double seam = done_.lambda;
  iterate(window, Eigen::MatrixXd(ordered_.unknowns(), 0));
  if (std::isfinite(seam)) modes_.join_at(seam);
  if (auto whole = repair(proved_, *shift); !whole) return whole;
  proved_ = *shift;
  if (last) {
    if (auto whole = repair(proved_, top_); !whole) return whole;
    done_ = top_;
  } else {
    done_ = last_gap(shift->lambda);
    modes_.drop_from(done_.lambda);
  }
  return {};
}

// Looks for what is missing between two counts, with what was found locked out.
Result<void> Slicer::repair(const Count& low, const Count& high) {
  const int wanted = high.below - low.below;
  for (int attempt = 0; modes_.count(low.lambda, high.lambda) < wanted && attempt < kMaxRepairs; ++attempt) {
    const double bottom = std::max(0.0, low.lambda), share = 0.1 + 0.8 * std::fmod(0.5 + 0.382 * attempt, 1.0);
    const Result<Count> shift = factor(bottom + share * (high.lambda - bottom));
    if (!shift) return fail(shift.error());
    Window window{.low = low.lambda, .high = high.lambda, .tolerance = request_.tolerance};
    window.left = shift->below - low.below - modes_.count(low.lambda, shift->lambda);
    window.right = high.below - shift->below - modes_.count(shift->lambda, high.lambda);
    if (window.left < 0 || window.right < 0) break;
    window.most_vectors = 4 * (window.left + window.right) + 40 * kWidth;
    const double margin = 1e-3 * high.lambda;
    iterate(window, modes_.shapes(low.lambda - margin, high.lambda + margin));
  }
  const int found = modes_.count(low.lambda, high.lambda);
  if (found == wanted) return {};
  return fail(ErrorKind::refused, std::to_string(wanted) + " modes were counted and " + std::to_string(found) +
                                      " found between " + std::to_string(hertz(low.lambda)) + " and " +
                                      std::to_string(hertz(high.lambda)) +
                                      " Hz; look for needle-like elements in the mesh");
}

Eigenmodes Slicer::result() {
  Eigenmodes result;
  result.counted = modes_.count(-kInfinity, request_.highest_lambda);
  result.lambda.resize(result.counted);
  result.shapes.resize(ordered_.unknowns(), result.counted);
  team_.run_together([&](int, const Member& member) {
    for (int m = member.begin(result.counted); m < member.end(result.counted); ++m) {
      result.lambda[m] = modes_.lambda(m);
      const auto shape = modes_.shape(m);
      for (int n = 0; n < plan_.node_count(); ++n) {
        result.shapes.col(m).segment<3>(3 * plan_.old_of[n]) = shape.segment<3>(3 * n);
      }
    }
  });
  result.residuals = ordered_.residuals(result.lambda, result.shapes);
  result.solves = solves_;
  result.factorizations = factorizations_;
  result.factor_seconds = factor_seconds_;
  result.iterate_seconds = iterate_seconds_;
  return result;
}

Result<Eigenmodes> Slicer::solve() {
  const Result<Count> top = factor(request_.highest_lambda, +kStep);
  if (!top) return fail(top.error());
  top_ = *top;
  if (top_.below > 2 * request_.most_modes + 1000) return fail(too_many_modes(request_));
  if (4 * Eigen::Index{top_.below} > system_.unknowns() && system_.unknowns() < kDenseAtMost) {
    Result<Eigenmodes> all = solve_dense(system_);
    if (all) all->counted = top_.below;
    return all;
  }
  while (done_.below < top_.below) {
    if (auto went = slice(); !went) return fail(went.error());
  }
  return result();
}

}  // namespace

Result<int> count_modes(const fem::System& system, double highest_lambda, int threads) {
  Team team(threads);
  const Elimination plan = plan_elimination(system, threads);
  const OrderedSystem ordered(system, plan, team);
  Ldlt factors(plan, ordered, team);
  if (!factors.factor(highest_lambda) || factors.backward_error() > kBackwardError) return fail(not_factored(system));
  return factors.negative();
}

Result<Eigenmodes> solve_block_lanczos(const fem::System& system, const EigenRequest& request, int threads,
                                       const Progress& progress) {
  if (progress && !progress("factors", 0)) throw Cancelled{};
  return Slicer(system, request, threads, progress).solve();
}

}  // namespace ringdown::solve
