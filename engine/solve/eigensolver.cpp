#include "engine/solve/eigensolver.h"

#include "engine/base/in_parallel.h"
#include "engine/base/quote.h"
#include "engine/dense/blas_threads.h"
#include "engine/dense/decompositions.h"
#include "engine/solve/methods.h"
#include "engine/solve/second_opinion.h"
#include "engine/solve/spectra.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

namespace ringdown::solve {
namespace {

constexpr int kSmallProblem = 300;     // unknowns; up to this number, dense algebra is quicker and always succeeds
constexpr int kDenseAtMost = 4000;     // unknowns; below, dense algebra is quicker if a quarter of all is wanted
constexpr int kOneThread = 3000;       // unknowns; below, threads would mostly wait for each other
constexpr double kSecondShift = 0.25;  // of the top; shift of a second opinion when a method leaves no factorization

// kAutomatic chooses Spectra for systems with at most these numbers of unknowns and of modes below the top. The table
// follows from the times in docs/how/eigensolver.md.
struct QuickBySpectra {
  Eigen::Index unknowns;
  int modes;
};
constexpr std::array kQuickBySpectra = {QuickBySpectra{2000, 80}, QuickBySpectra{3000, 60}, QuickBySpectra{10000, 24}};

// Rounding leaves a rigid motion with a lambda of about 1e-16 of the mesh's largest eigenvalue, which is estimated by
// the largest ratio of diagonal entries. The limit stays far below the band (a few Hz to 60 Hz under 20 kHz), so that a
// mesh with a few very bad elements does not make sounding modes look rigid.
double rigid_limit(const fem::System& system, double highest_lambda) {
  double stiffest = 0;
  for (Eigen::Index n = 0; n < system.node_mass.cols(); ++n) {
    const double mass = system.node_mass.coeff(n, n);
    for (int i = 0; i < 3; ++i) stiffest = std::max(stiffest, system.stiffness.coeff(3 * n + i, 3 * n + i) / mass);
  }
  const double rounding = 100 * std::numeric_limits<double>::epsilon() * stiffest;
  return std::clamp(rounding, 1e-8 * highest_lambda, 1e-5 * highest_lambda);
}

int count_below(const Eigen::VectorXd& lambda, double limit) {
  return static_cast<int>((lambda.array() < limit).count());
}

Error too_many_modes(const EigenRequest& request) {
  return {ErrorKind::too_large,
          formatted("more than {} modes lie in the band; narrow the band or allow more modes", request.max_modes)};
}

// `modes` is the number counted at the top, so the choice is the same on every machine.
Method choose(Method wanted, Eigen::Index unknowns, int modes) {
  if (wanted == Method::kDense) return wanted;
  if (4 * Eigen::Index{modes} > unknowns && unknowns < kDenseAtMost) return Method::kDense;
  if (wanted != Method::kAutomatic) return wanted;
  if (unknowns <= kSmallProblem) return Method::kDense;
  const bool quick = std::any_of(kQuickBySpectra.begin(), kQuickBySpectra.end(),
                                 [&](const auto& row) { return unknowns <= row.unknowns && modes <= row.modes; });
  return quick ? Method::kSpectra : Method::kBlockLanczos;
}

Result<Eigenmodes> solve_dense(const fem::System& system) {
  const Eigen::MatrixXd stiffness = Eigen::MatrixXd(system.stiffness).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd mass =
      fem::mass_times(system.node_mass, Eigen::MatrixXd::Identity(stiffness.rows(), stiffness.rows()));
  std::optional<dense::Spectrum> solved = dense::generalized_spectrum(stiffness, mass);
  if (!solved) {
    return fail(ErrorKind::bad_input, "the mass of the mesh is not positive; check the mesh for flat elements");
  }
  Eigenmodes modes;
  modes.lambda = std::move(solved->values);
  modes.shapes = std::move(solved->vectors);
  return modes;
}

// One solve. The factorization at the top counts the modes, a method finds them, and the number found is compared with
// the count. The second opinion is asked at the top and at one more shift, each time while the pencil is factored at
// this shift.
class Solve {
 public:
  Solve(const fem::System& system, const EigenRequest& request, const Progress& progress)
      : system_(system),
        request_(request),
        progress_(progress),
        rigid_limit_(rigid_limit(system, request.highest_lambda)),
        threads_(system.unknowns() < kOneThread ? 1 : thread_count(request.threads)) {}

  Result<Eigenmodes> run();

 private:
  Result<Count> count_at_top();
  Result<void> ask_at(double lambda);
  Result<Eigenmodes> find(Method method, const Count& top);
  Result<void> finish(Eigenmodes& modes);

  const fem::System& system_;
  const EigenRequest& request_;
  const Progress& progress_;
  const double rigid_limit_;
  const int threads_;
  std::optional<Pencil> pencil_;
  std::optional<SecondOpinion> opinion_;
};

Result<Count> Solve::count_at_top() {
  pencil_.emplace(system_, threads_);
  return pencil_->factor(request_.highest_lambda, Pencil::kUp,
                         [this](double) { return !progress_ || progress_("factors", 0); });
}

Result<void> Solve::ask_at(double lambda) {
  const Result<Count> shift = pencil_->factor(lambda, Pencil::kDown);
  return shift ? opinion_->ask(*pencil_, *shift) : Result<void>(fail(shift));
}

Result<Eigenmodes> Solve::find(Method method, const Count& top) {
  if (method == Method::kBlockLanczos)
    return solve_block_lanczos(*pencil_, top, request_, opinion_ ? &*opinion_ : nullptr, progress_);
  if (method == Method::kSpectra) {
    Result<Eigenmodes> modes = solve_spectra(*pencil_, top, request_, progress_);
    const Ldlt& factors = pencil_->factors();
    if (!modes || !opinion_) return modes;
    return opinion_->ask(*pencil_, {factors.sigma(), factors.negative()}).map([&] { return std::move(*modes); });
  }
  if (opinion_) {
    if (auto asked = ask_at(kSecondShift * top.lambda); !asked) return fail(asked);
  }
  return solve_dense(system_);
}

// Keeps the modes below the requested top. The top at which modes were counted may have moved above it.
Result<void> Solve::finish(Eigenmodes& modes) {
  const Eigen::Index count = modes.counted = count_below(modes.lambda, request_.highest_lambda);
  modes.lambda.conservativeResize(count);
  modes.shapes.conservativeResize(Eigen::NoChange, count);
  modes.rigid = request_.rigid >= 0 ? std::min(request_.rigid, modes.counted) : count_below(modes.lambda, rigid_limit_);
  if (modes.counted - modes.rigid > request_.max_modes) return fail(too_many_modes(request_));
  modes.residuals = pencil_->ordered().residuals(modes.lambda, modes.shapes);
  modes.residuals.head(modes.rigid).setZero();
  if (!opinion_) return {};
  return opinion_->check(system_, modes).map([&](const Agreement& agreement) { modes.agreement = agreement; });
}

Result<Eigenmodes> Solve::run() {
  const bool elsewhere = request_.method == Method::kSlepc;
  Result<Eigenmodes> modes = elsewhere ? solve_slepc(system_, request_, progress_) : Eigenmodes();
  if (!modes) return modes;
  if (elsewhere && !request_.verify) {
    pencil_.emplace(system_, threads_);
    return finish(*modes).map([&] { return std::move(*modes); });
  }
  const Result<Count> top = count_at_top();
  if (!top) return fail(top);
  if (top->below > 2 * request_.max_modes + 1000) return fail(too_many_modes(request_));
  const Method method = choose(request_.method, system_.unknowns(), top->below);
  if (request_.verify) {
    opinion_.emplace(method == Method::kSpectra ? Method::kBlockLanczos : Method::kSpectra,
                     Band{rigid_limit_, request_.highest_lambda}, request_, progress_);
    if (auto asked = opinion_->ask(*pencil_, *top); !asked) return fail(asked);
  }
  if (elsewhere) {
    if (auto asked = ask_at(kSecondShift * top->lambda); !asked) return fail(asked);
  } else {
    modes = find(method, *top);
    if (!modes) return modes;
    modes->factorizations = pencil_->factorizations();
    modes->factor_seconds = pencil_->factor_seconds();
  }
  const int found = count_below(modes->lambda, top->lambda);
  if (!elsewhere && found != top->below) {
    return fail(ErrorKind::refused, "{} modes were counted and {} found", top->below, found);
  }
  modes->method = method;
  return finish(*modes).map([&] { return std::move(*modes); });
}

}  // namespace

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double EigenRequest::hertz(double lambda) const {
  return unit_hz * std::sqrt(std::max(0.0, lambda)) / (2 * std::numbers::pi);
}

Result<Eigenmodes> solve_modes(const fem::System& system, const EigenRequest& request, const Progress& progress) {
  const dense::BlasThreads one(1);
  try {
    return Solve(system, request, progress).run();
  } catch (const Cancelled&) {
    return fail_cancelled();
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::no_memory, "not enough memory for {} unknowns; make the mesh coarser", system.unknowns());
  } catch (const std::exception& error) {
    return fail(ErrorKind::refused, std::string("the eigensolver failed: ") + error.what());
  }
}

}  // namespace ringdown::solve
