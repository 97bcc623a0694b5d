#include "engine/bake/tuning/tune.h"

#include "engine/base/progress.h"
#include "engine/dense/decompositions.h"

#include <algorithm>
#include <optional>
#include <utility>

// Levenberg-Marquardt with Broyden's slopes
//
// One step minimises |cents + slopes step|^2 + damping |step|^2 over the parameters that are not held at a bound
// (propose()). A step that makes the cents smaller is taken, and the damping falls; otherwise the damping rises and a
// shorter step is tried. Either way the evaluation improves the slopes by a rank-one update. When no step helps, slopes
// are measured again by differences; when not even a step on fresh slopes helps, the search is over.
namespace ringdown::bake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFirstDamping = 1e-4, kMaxDamping = 1e6;  // of the largest squared slope
constexpr double kMaxStep = 0.3;                           // of a parameter's range
constexpr double kMinStep = 1e-7;

class Tuner {
 public:
  Tuner(const std::vector<TuneVariable>& variables, const CentsOf& cents_of, const TuneOptions& options)
      : cents_of_(cents_of), options_(options), slopes_(options.slopes) {
    const auto count = static_cast<Index>(variables.size());
    low_.resize(count);
    range_.resize(count);
    at_.resize(count);
    for (Index i = 0; i < count; ++i) {
      const TuneVariable& variable = variables[i];
      low_[i] = variable.low;
      range_[i] = variable.high - variable.low;
      at_[i] = std::clamp((variable.start - variable.low) / range_[i], 0.0, 1.0);
    }
  }

  Result<Tuned> run() {
    Result<VectorXd> first = evaluate(at_);
    if (!first) return fail(first);
    cents_ = std::move(*first);
    bool fresh = false;
    while (!reached() && affordable()) {
      if (slopes_.rows() != cents_.size() || slopes_.cols() != at_.size()) {
        if (auto measured = measure_slopes(); !measured) return fail(measured);
        fresh = true;
        continue;
      }
      const Result<bool> better = step();
      if (!better) return fail(better);
      if (*better) {
        fresh = false;
      } else if (fresh) {
        break;
      } else {
        slopes_.resize(0, 0);
        damping_ = kFirstDamping;
      }
    }
    return Tuned{low_ + range_.cwiseProduct(at_), cents_, slopes_, evaluations_, reached()};
  }

 private:
  [[nodiscard]] bool reached() const { return worst(cents_) <= options_.tolerance_cents; }
  [[nodiscard]] bool affordable() const { return evaluations_ < options_.max_evaluations; }
  static double worst(const VectorXd& cents) { return cents.size() == 0 ? 0 : cents.cwiseAbs().maxCoeff(); }

  Result<VectorXd> evaluate(const VectorXd& at) {
    if (options_.stopped && options_.stopped()) return fail_cancelled();
    ++evaluations_;
    return cents_of_(low_ + range_.cwiseProduct(at));
  }

  Result<void> measure_slopes() {
    MatrixXd slopes(cents_.size(), at_.size());
    for (Index i = 0; i < at_.size(); ++i) {
      const double inward = at_[i] > 0.5 ? -options_.probe : options_.probe;
      std::optional<VectorXd> column;
      Error why{ErrorKind::bad_input, ""};
      for (const double probe : {inward, -inward}) {
        VectorXd near = at_;
        near[i] = std::clamp(near[i] + probe, 0.0, 1.0);
        if (near[i] == at_[i]) continue;
        const Result<VectorXd> cents = evaluate(near);
        if (cents) {
          column = (*cents - cents_) / (near[i] - at_[i]);
          break;
        }
        if (cents.error().kind == ErrorKind::cancelled) return fail(cents);
        why = cents.error();
      }
      if (!column) return fail(why);
      slopes.col(i) = *column;
    }
    slopes_ = std::move(slopes);
    return {};
  }

  // The damped step in the parameters that are not held at a bound.
  [[nodiscard]] VectorXd propose() const {
    std::vector<bool> held(at_.size(), false);
    const double scale = std::max(slopes_.colwise().squaredNorm().maxCoeff(), 1e-30);
    for (Index round = 0; round <= at_.size(); ++round) {
      MatrixXd slopes = slopes_;
      for (Index i = 0; i < at_.size(); ++i) {
        if (held[i]) slopes.col(i).setZero();
      }
      MatrixXd normal = slopes.transpose() * slopes;
      normal.diagonal().array() += damping_ * scale;
      VectorXd step = -dense::solve_symmetric(normal, slopes.transpose() * cents_);
      const double longest = step.cwiseAbs().maxCoeff();
      if (longest > kMaxStep) step *= kMaxStep / longest;
      bool inside = true;
      for (Index i = 0; i < at_.size(); ++i) {
        const bool outwards = (at_[i] <= 0 && step[i] < 0) || (at_[i] >= 1 && step[i] > 0);
        if (outwards && !held[i]) {
          held[i] = true;
          inside = false;
        }
      }
      if (inside) return (at_ + step).cwiseMax(0.0).cwiseMin(1.0) - at_;
    }
    return VectorXd::Zero(at_.size());
  }

  // False when no step from here makes it better.
  Result<bool> step() {
    for (; damping_ < kMaxDamping && affordable(); damping_ *= 10) {
      const VectorXd move = propose();
      if (move.cwiseAbs().maxCoeff() < kMinStep) return false;
      const Result<VectorXd> cents = evaluate(at_ + move);
      if (!cents) {
        if (cents.error().kind == ErrorKind::cancelled) return fail(cents);
        damping_ *= 10;
        continue;
      }
      const bool better = cents->squaredNorm() < cents_.squaredNorm();
      slopes_ += (*cents - cents_ - slopes_ * move) * move.transpose() / move.squaredNorm();
      if (!better) continue;
      const bool much = cents->norm() < 0.999 * cents_.norm();
      at_ += move;
      cents_ = *cents;
      damping_ = std::max(damping_ / 10, 1e-9);
      return much;
    }
    return false;
  }

  const CentsOf& cents_of_;
  const TuneOptions& options_;
  VectorXd low_, range_, at_, cents_;
  MatrixXd slopes_;
  double damping_ = kFirstDamping;
  int evaluations_ = 0;
};

}  // namespace

Result<Tuned> tune(const std::vector<TuneVariable>& variables, const CentsOf& cents_of, const TuneOptions& options) {
  return Tuner(variables, cents_of, options).run();
}

}  // namespace ringdown::bake
