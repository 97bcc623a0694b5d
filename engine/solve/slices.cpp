// Method::kBlockLanczos: all eigenvalues below the top, slice by slice of the spectrum, each count proved by inertia.
//
// A factorization at a shift counts the eigenvalues below it. From the bottom up, each slice gets a shift a little
// above the eigenvalues that are done. The count at the shift says how many eigenvalues lie between, and
// block_lanczos() iterates until it has found them, and about as many above the shift. If fewer are found than counted,
// more iterations look for the rest, with the found ones locked. The top was counted before the first slice. Source:
// Grimes, Lewis & Simon, SIAM J. Matrix Anal. Appl. 15, 1994, section 4.
#include "engine/solve/block_lanczos.h"
#include "engine/solve/methods.h"
#include "engine/solve/mode_set.h"
#include "engine/solve/second_opinion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace ringdown::solve {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSliceGap = 1e-5;      // relative, between the last eigenvalue of a slice and the first of the next
constexpr int kMaxRepairs = 12;         // iterations between two counts
constexpr Eigen::Index kGapSearch = 4;  // eigenvalues to either side of the wanted number

class Slicer {
 public:
  Slicer(Pencil& pencil, const Count& top, const EigenRequest& request, SecondOpinion* opinion,
         const Progress& progress)
      : pencil_(pencil),
        request_(request),
        opinion_(opinion),
        progress_(progress),
        modes_(pencil.ordered()),
        top_(top) {}

  Result<Eigenmodes> solve();

 private:
  Result<Count> factor(double lambda) {
    return pencil_.factor(lambda, Pencil::kDown, [this](double) { return tell("factors", 0); });
  }
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

  Pencil& pencil_;
  const EigenRequest& request_;
  SecondOpinion* opinion_;  // asked at the first slice, then null
  const Progress& progress_;
  ModeSet modes_;
  Count done_{-kInfinity, 0};    // all eigenvalues below were found
  Count proved_{-kInfinity, 0};  // the last shift at which the count and the number found agreed
  const Count top_;
  unsigned seed_ = 1;
  int solves_ = 0;
  double iterate_seconds_ = 0;
};

// A shift below which about `count` eigenvalues lie. If the request has expected eigenvalues, the shift is the middle
// of the widest gap among the few around number `count`. A shift next to an eigenvalue, such as the middle of a pair of
// equal ones, would cost the farther modes their accuracy. Without expected eigenvalues, the shift is interpolated
// between the finished eigenvalues and the top, as if the number of modes grew like f^2.4: between the f of plates and
// bars and the f^3 of solids.
double Slicer::lambda_at(double count) const {
  const Eigen::VectorXd& expected = request_.expected_lambda;
  const auto number = static_cast<Eigen::Index>(count) - 6;  // minus the rigid motions of one piece
  double widest = 0, middle = 0;
  for (Eigen::Index i = std::max<Eigen::Index>(1, number - kGapSearch); i <= number + kGapSearch && i < expected.size();
       ++i) {
    const double gap = (expected[i] - expected[i - 1]) / expected[i], between = 0.5 * (expected[i - 1] + expected[i]);
    if (gap > widest && between > done_.lambda && between < top_.lambda) {
      widest = gap;
      middle = between;
    }
  }
  if (widest > kSliceGap) return middle;
  constexpr double kPower = 1.2;
  const double share = (count - done_.below) / std::max(1, top_.below - done_.below);
  const double low = std::pow(std::max(0.0, done_.lambda), kPower), high = std::pow(top_.lambda, kPower);
  return std::pow(low + std::clamp(share, 0.0, 1.0) * (high - low), 1 / kPower);
}

// The number of slices that takes the least time. With few slices, keeping the vectors orthogonal costs many
// operations; with many slices, each costs a factorization. Measured: a slice of s modes takes 1.7 s + 160 vectors; one
// core does 25e9 flop/s in large products and reads 11e9 byte/s. The minimum is flat: twice as many slices cost a tenth
// more.
int Slicer::slices_for(int modes) const {
  constexpr double kFlops = 25e9, kBytes = 11e9;
  const auto seconds = [&](int slices) {
    const double vectors = 1.7 * modes / slices + 160;
    const double solves = vectors * 2 * 8 * static_cast<double>(pencil_.plan().factor_entries) / kWidth / kBytes;
    const double orthogonal = static_cast<double>(pencil_.unknowns()) * vectors * vectors / kBytes;
    const double ritz = 12 * vectors * vectors * vectors / kFlops;
    return slices * (pencil_.plan().flops / kFlops + solves + orthogonal + ritz);
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
  pencil_.release_workspace();
  Pairs pairs = block_lanczos(pencil_, window, locked, seed_++,
                              [&](double part) { return tell("modes", std::min(0.99, before + part * share)); });
  solves_ += pairs.solves;
  modes_.add(pairs.lambda, std::move(pairs.shapes));
  iterate_seconds_ += seconds_now() - start;
}

// The highest gap between eigenvalues found, not below `above`. All eigenvalues below the gap count as done.
Count Slicer::last_gap(double above) const {
  for (int i = modes_.size() - 1; i > 0 && modes_.lambda(i) > above; --i) {
    const double low = std::max(above, modes_.lambda(i - 1)), high = modes_.lambda(i);
    if (high - low > kSliceGap * high) return {0.5 * (low + high), i};
  }
  return {above, modes_.count(-kInfinity, above)};
}

Result<void> Slicer::slice() {
  const int left = top_.below - done_.below, slices = slices_for(left);
  const double each = static_cast<double>(left) / slices;
  Result<Count> shift = factor(lambda_at(done_.below + 0.5 * each));
  // If far more eigenvalues than expected lie below the shift, assume they are evenly spaced and try a lower shift.
  if (shift && shift->below - done_.below > 1.5 * each + 20) {
    const double low = std::max(0.0, done_.lambda);
    shift = factor(low + (shift->lambda - low) * 0.6 * each / (shift->below - done_.below));
  }
  if (!shift) return fail(shift);
  const bool last = slices == 1;
  const int right = top_.below - shift->below;
  const Window window{.low = done_.lambda,
                      .left = shift->below - done_.below,
                      .right = last ? right : std::min(right, static_cast<int>(0.5 * each)),
                      .high = last ? top_.lambda : kInfinity,
                      .max_vectors = static_cast<int>(4 * each) + 40 * kWidth,
                      .tolerance = request_.tolerance};
  const double seam = done_.lambda;
  iterate(window, Eigen::MatrixXd(pencil_.unknowns(), 0));
  if (SecondOpinion* const opinion = std::exchange(opinion_, nullptr)) {
    if (auto asked = opinion->ask(pencil_, *shift); !asked) return asked;
  }
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

// Looks for the eigenvalues that are missing between two counts, with the found ones locked.
Result<void> Slicer::repair(const Count& low, const Count& high) {
  const int wanted = high.below - low.below;
  for (int attempt = 0; modes_.count(low.lambda, high.lambda) < wanted && attempt < kMaxRepairs; ++attempt) {
    const double bottom = std::max(0.0, low.lambda), share = 0.1 + 0.8 * std::fmod(0.5 + 0.382 * attempt, 1.0);
    const Result<Count> shift = factor(bottom + share * (high.lambda - bottom));
    if (!shift) return fail(shift);
    Window window{.low = low.lambda, .high = high.lambda, .tolerance = request_.tolerance};
    window.left = shift->below - low.below - modes_.count(low.lambda, shift->lambda);
    window.right = high.below - shift->below - modes_.count(shift->lambda, high.lambda);
    if (window.left < 0 || window.right < 0) break;
    window.max_vectors = 4 * (window.left + window.right) + 40 * kWidth;
    const double margin = 1e-3 * high.lambda;
    iterate(window, modes_.shapes(low.lambda - margin, high.lambda + margin));
  }
  const int found = modes_.count(low.lambda, high.lambda);
  if (found == wanted) return {};
  return fail(ErrorKind::refused,
              "{} modes were counted and {} found between {} and {} Hz; look for needle-like elements in the mesh",
              wanted, found, request_.hertz(low.lambda), request_.hertz(high.lambda));
}

Result<Eigenmodes> Slicer::solve() {
  while (done_.below < top_.below) {
    if (auto went = slice(); !went) return fail(went);
  }
  Eigenmodes result;
  result.lambda.resize(modes_.size());
  for (int m = 0; m < modes_.size(); ++m) result.lambda[m] = modes_.lambda(m);
  result.shapes.resize(pencil_.unknowns(), modes_.size());
  for (int m = 0; m < modes_.size(); ++m) result.shapes.col(m) = pencil_.in_mesh_order(modes_.shape(m));
  result.solves = solves_;
  result.iterate_seconds = iterate_seconds_;
  return result;
}

}  // namespace

Result<Eigenmodes> solve_block_lanczos(Pencil& pencil, const Count& top, const EigenRequest& request,
                                       SecondOpinion* opinion, const Progress& progress) {
  return Slicer(pencil, top, request, opinion, progress).solve();
}

}  // namespace ringdown::solve
