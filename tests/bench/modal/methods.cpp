#include "tests/bench/modal/methods.h"

#include "engine/base/process/child_process.h"
#include "engine/solve/distributed.h"
#include "tests/bench/modal/bodies.h"
#include "tests/bench/modal/calculix.h"
#include "tests/bench/modal/spectra_cholmod.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::bench {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double processor_s() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double peak_mib() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_maxrss) / 1024;
}

double lambda_of(double hz) { return std::pow(2 * std::numbers::pi * hz, 2); }

// Elastic frequencies [Hz]: what lies below a hundred-thousandth of the top's lambda is rigid.
std::vector<double> elastic_hz(const Eigen::VectorXd& lambda, double top_hz) {
  std::vector<double> hz;
  for (const double l : lambda) {
    if (l > 1e-5 * lambda_of(top_hz) && l <= lambda_of(top_hz)) hz.push_back(std::sqrt(l) / (2 * std::numbers::pi));
  }
  return hz;
}

struct Problem {
  mesh::TetMesh mesh;
  fem::Elastic elastic;
  fem::Element element;
};

struct Outcome {
  std::vector<double> hz;
  Measurement measurement;
};

void take_times(Measurement& m, const solve::Eigenmodes& modes) {
  m.factor_s = modes.factor_seconds;
  m.iterate_s = modes.iterate_seconds;
}

Result<Outcome> solve_here(const Spec& spec, const fem::System& system) {
  const solve::EigenRequest request{.highest_lambda = lambda_of(spec.top_hz),
                                    .method = solve::parse_method(spec.method).value_or(solve::Method::kAutomatic),
                                    .threads = spec.threads};
  const double start = now_s(), processor = processor_s();
  const auto modes = spec.method == "spectra-cholmod" ? solve_by_spectra_over_cholmod(system, request, spec.expected)
                                                      : solve::solve_modes(system, request);
  if (!modes) return fail(modes.error());
  Outcome outcome{elastic_hz(modes->lambda, spec.top_hz), {}};
  outcome.measurement.seconds = now_s() - start;
  outcome.measurement.processor_s = processor_s() - processor;
  outcome.measurement.peak_mib = peak_mib();
  take_times(outcome.measurement, *modes);
  return outcome;
}

// Times are those of SLEPc's own setting up and solving: reading and sending matrices is not counted.
Result<Outcome> solve_by_slepc(const Spec& spec, const fem::System& system, double limit_s) {
  const solve::DistributedRun run{
      .processes = spec.threads,
      .options = {"-first", std::to_string(spec.expected), "-st_pc_factor_mat_solver_type", spec.method.substr(6)},
      .limit_s = limit_s};
  const auto solved = run_distributed(system, {.highest_lambda = lambda_of(spec.top_hz)}, run, {});
  if (!solved) return fail(solved.error());
  Outcome outcome{elastic_hz(solved->modes.lambda, spec.top_hz), {}};
  take_times(outcome.measurement, solved->modes);
  outcome.measurement.seconds = solved->modes.factor_seconds + solved->modes.iterate_seconds;
  outcome.measurement.processor_s = solved->run.processor_s;
  outcome.measurement.peak_mib = solved->run.peak_mib;
  return outcome;
}

Result<Outcome> solve_assembled(const Spec& spec, const Problem& problem, double limit_s) {
  const double start = now_s();
  auto system = fem::assemble(problem.mesh, problem.elastic, problem.element, spec.threads);
  if (!system) return fail(system.error());
  if (spec.method == "ccx-mass") system->node_mass = calculix_mass(problem.mesh, problem.elastic.density_kg_m3);
  const double assembled = now_s();
  Result<Outcome> outcome =
      spec.method.starts_with("slepc-") ? solve_by_slepc(spec, *system, limit_s) : solve_here(spec, *system);
  if (!outcome) return outcome;
  outcome->measurement.assemble_s = assembled - start;
  outcome->measurement.seconds += assembled - start;
  return outcome;
}

Result<Outcome> solve_by_calculix(const Spec& spec, const Problem& problem, double limit_s) {
  if (problem.element != fem::Element::kTet10) return fail(ErrorKind::bad_input, "CalculiX is asked for C3D10 only");
  const auto run = run_calculix(problem.mesh, problem.elastic, spec.expected, limit_s);
  if (!run) return fail(run.error());
  Outcome outcome;
  for (const double hz : run->frequencies_hz) {
    if (hz > 0.003 * spec.top_hz && hz <= spec.top_hz) outcome.hz.push_back(hz);
  }
  outcome.measurement.seconds = run->seconds;
  outcome.measurement.processor_s = run->processor_s;
  outcome.measurement.peak_mib = run->peak_mib;
  return outcome;
}

Result<Outcome> bake_by_default(Spec& spec, const Body& body) {
  bake::ObjectRecipe recipe = default_recipe(body);
  recipe.options.band_high_hz = spec.top_hz;
  const double start = now_s(), processor = processor_s();
  const auto baked = bake::bake_object(recipe, body.materials);
  if (!baked) return fail(baked.error());
  Outcome outcome{baked->baked.bank.frequency_hz, {}};
  std::sort(outcome.hz.begin(), outcome.hz.end());
  Measurement& m = outcome.measurement;
  m.seconds = now_s() - start;
  m.processor_s = processor_s() - processor;
  m.peak_mib = peak_mib();
  m.unknowns = baked->baked.report.unknowns;
  m.assemble_s = baked->baked.report.assemble_seconds;
  m.factor_s = baked->baked.report.factor_seconds;
  m.iterate_s = baked->baked.report.iterate_seconds;
  return outcome;
}

Result<Outcome> run(Spec& spec, const Body& body, double limit_s) {
  if (spec.method == "bake") return bake_by_default(spec, body);
  const auto element = fem::parse_element(spec.element);
  if (!element) return fail(element.error());
  const auto elastic = elastic_of(body);
  if (!elastic) return fail(elastic.error());
  auto mesh = mesh_of(body, spec.mesh, fem::order_of(*element));
  if (!mesh) return fail(mesh.error());
  const Problem problem{std::move(*mesh), *elastic, *element};
  Result<Outcome> outcome =
      spec.method == "ccx" ? solve_by_calculix(spec, problem, limit_s) : solve_assembled(spec, problem, limit_s);
  if (outcome) outcome->measurement.unknowns = 3 * problem.mesh.nodes.rows();
  return outcome;
}

double percent(double difference) { return difference < 0 ? -1 : 100 * difference; }

}  // namespace

bool installed(const std::string& method) {
  if (method == "ccx") return run_child({.command = {"ccx", "-v"}}).has_value();
  return !method.starts_with("slepc-") || find_beside("ringdown-modes-slepc").has_value();
}

Measurement measure(const Spec& wanted, double limit_s, const std::filesystem::path& frequencies,
                    const std::vector<double>& reference) {
  Measurement failed{.spec = wanted};
  const auto body = find_body(wanted.body);
  if (!body) return failed.complaint = body.error().message, failed;
  Spec spec = wanted;
  const double start = now_s();
  const Result<Outcome> outcome = run(spec, *body, limit_s);
  if (!outcome) {
    failed.complaint = outcome.error().message;
    failed.seconds = now_s() - start;
    if (failed.complaint.find("longer than its limit") != std::string::npos) failed.status = Status::kOverLimit;
    return failed;
  }
  Measurement m = outcome->measurement;
  m.spec = spec;
  m.status = Status::kDone;
  m.modes = static_cast<long>(outcome->hz.size());
  const std::vector<double>& exact = body->exact_hz.empty() ? reference : body->exact_hz;
  m.error_10 = percent(worst_difference(outcome->hz, exact, 10));
  m.error_50 = percent(worst_difference(outcome->hz, exact, std::min<std::size_t>(50, exact.size())));
  if (frequencies.empty()) return m;
  if (auto written = write_frequencies(frequencies, outcome->hz); !written) {
    failed.complaint = written.error().message;
    return failed;
  }
  return m;
}

}  // namespace ringdown::bench
