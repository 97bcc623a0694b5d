#include "engine/bake/bake.h"

#include "engine/bake/importance.h"
#include "engine/bake/mass_properties.h"
#include "engine/mesh/surface.h"
#include "engine/solve/eigensolver.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <numbers>
#include <cstdio>
#include <numeric>
#include <vector>

namespace ringdown::bake {
namespace {

using solve::Eigenmodes;

class Stopwatch {
 public:
  // Seconds since the last call, or since construction.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

struct HeardMode {
  Eigen::Index number;  // in Eigenmodes
  modal::DampedMode mode;
  double importance;
};

double surface_rms(const mesh::Surface& surface, const std::vector<double>& weights,
                   const Eigen::Ref<const Eigen::VectorXd>& shape) {
  double sum = 0;
  for (std::size_t p = 0; p < weights.size(); ++p) {
    sum += weights[p] * shape.segment<3>(3 * surface.nodes[p]).squaredNorm();
  }
  return std::sqrt(sum);
}

std::vector<HeardMode> modes_in_band(const Eigenmodes& modes, const mesh::Surface& surface,
                                     const std::vector<double>& weights, modal::RayleighDamping damping,
                                     const BakeOptions& options, BakeReport& report) {
  std::vector<HeardMode> heard;
  for (Eigen::Index m = modes.rigid; m < modes.lambda.size(); ++m) {
    const modal::DampedMode mode = modal::damp(modes.lambda[m], damping);
    if (mode.frequency_hz == 0) {
      ++report.over_damped;
    } else if (mode.frequency_hz < options.band_low_hz) {
      ++report.below_band;
    } else if (mode.frequency_hz <= options.band_high_hz) {
      heard.push_back({m, mode, importance(mode, surface_rms(surface, weights, modes.shapes.col(m)))});
    }
  }
  std::stable_sort(heard.begin(), heard.end(),
                   [](const HeardMode& a, const HeardMode& b) { return a.importance > b.importance; });
  const auto keep = static_cast<std::size_t>(std::max(0, options.keep_modes));
  if (keep > 0 && heard.size() > keep) {
    report.unimportant = static_cast<int>(heard.size() - keep);
    heard.resize(keep);
  }
  return heard;
}

void add_mode(modal::Bank& bank, const HeardMode& heard, const Eigen::Ref<const Eigen::VectorXd>& shape,
              const std::vector<std::int32_t>& nodes) {
  Eigen::Index largest = 0;
  shape.cwiseAbs().maxCoeff(&largest);
  const double sign = shape[largest] < 0 ? -1 : 1;
  bank.frequency_hz.push_back(heard.mode.frequency_hz);
  bank.decay_per_s.push_back(heard.mode.decay_per_s);
  for (const std::int32_t node : nodes) {
    const Eigen::Vector3f value = (sign * shape.segment<3>(3 * node)).cast<float>();
    bank.shapes.push_back({value[0], value[1], value[2]});
  }
}

std::string element_text(fem::Element element) {
  if (element == fem::Element::kTet4Lumped) return "tet4 lumped";
  return std::string(fem::element_name(element)) + " consistent";
}

Result<void> check_options(const BakeOptions& options) {
  if (!(options.band_low_hz >= 0 && options.band_high_hz > options.band_low_hz && options.band_high_hz < 1e9)) {
    return fail("the band must go from a frequency >= 0 Hz to a higher one");
  }
  if (options.most_points < 4) return fail("a bank needs at least 4 surface points");
  if (options.most_modes < 1) return fail("a bank needs at least 1 mode");
  return {};
}

Result<void> check_rigid(const Eigenmodes& modes, int pieces) {
  if (modes.rigid == 6 * pieces) return {};
  const std::string found = std::to_string(modes.rigid) + " motions without energy where a mesh of " +
                            std::to_string(pieces) + (pieces == 1 ? " piece has " : " pieces has ") +
                            std::to_string(6 * pieces);
  return fail(modes.rigid > 6 * pieces
                  ? "found " + found + ": parts of it hang together at an edge or a point only; join them by a face"
                  : "found " + found + ": the elements are too distorted to solve; mesh the object again");
}

// About how many modes a solid has below a frequency: Debye's count V omega^3/(6 pi^2) (1/c_l^3 + 2/c_t^3) of waves
// with the two speeds of sound (Landau & Lifshitz, Statistical Physics, section 64; Theory of Elasticity, section 22).
// Plates and shells have more.
double debye_count(double volume_m3, const modal::Material& material, double lambda) {
  const double e = material.youngs_modulus_pa, nu = material.poisson_ratio, rho = material.density_kg_m3;
  const double transverse = std::sqrt(e / (2 * (1 + nu) * rho));
  const double longitudinal = transverse * std::sqrt((2 - 2 * nu) / (1 - 2 * nu));
  const double slowness = std::pow(longitudinal, -3) + 2 * std::pow(transverse, -3);
  return volume_m3 * std::pow(lambda, 1.5) / (6 * std::numbers::pi * std::numbers::pi) * slowness;
}

Result<void> check_count(const fem::System& system, const modal::Material& material, const BakeOptions& options,
                         double highest_lambda) {
  const double count = debye_count(system.node_mass.sum() / material.density_kg_m3, material, highest_lambda);
  if (count <= 4.0 * options.most_modes) return {};
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", count);
  return fail(std::string("about ") + text + " modes lie below " + std::to_string(std::lround(options.band_high_hz)) +
              " Hz, and a bank holds " + std::to_string(options.most_modes) +
              ": check the unit of its lengths (--unit 0.001 for millimetres), or narrow the band (--band)");
}

modal::Provenance provenance(const BakeOptions& options, const BakeReport& report, const Eigenmodes& modes) {
  return {.generator = "Ringdown " RINGDOWN_VERSION,
          .element = element_text(options.element),
          .unknowns = report.unknowns,
          .rigid_modes = report.rigid,
          .band_low_hz = options.band_low_hz,
          .band_high_hz = options.band_high_hz,
          .largest_residual = modes.residuals.size() > 0 ? modes.residuals.maxCoeff() : 0.0};
}

}  // namespace

double highest_lambda_in_band(double band_high_hz, modal::RayleighDamping damping) {
  const double omega = modal::hz_to_rad_per_s(band_high_hz);
  const double alpha = damping.alpha_per_s, beta = damping.beta_s;
  if (beta <= 0) return omega * omega + alpha * alpha / 4;
  // (beta^2/4) lambda^2 - (1 - alpha beta/2) lambda + omega^2 + alpha^2/4 = 0; smaller root without
  // cancellation.
  const double half = (1 - alpha * beta / 2) / 2, last = omega * omega + alpha * alpha / 4;
  const double discriminant = half * half - beta * beta / 4 * last;
  if (half > 0 && discriminant > 0) return last / (half + std::sqrt(discriminant));
  return std::max(half * 4 / (beta * beta), 0.0);
}

Result<Baked> bake(const mesh::CheckedMesh& checked, const modal::Material& material, const BakeOptions& options,
                   const std::string& name, const Progress& progress) {
  if (auto good = check_options(options); !good) return fail(good.error());
  if (progress && !progress("assemble", 0)) return fail(std::string(kCancelled));
  Stopwatch watch;
  Baked baked;
  auto& [bank, report] = baked;

  const mesh::TetMesh mesh = mesh::to_order(checked.mesh, fem::order_of(options.element));
  const fem::Elastic elastic{material.youngs_modulus_pa, material.poisson_ratio, material.density_kg_m3};
  const Result<fem::System> system = fem::assemble(mesh, elastic, options.element);
  if (!system) return fail(material.name + ": " + system.error().message);
  report.unknowns = system->unknowns();
  report.elements = mesh.elements.rows();
  report.assemble_seconds = watch.lap();

  const solve::EigenRequest request{.highest_lambda = highest_lambda_in_band(options.band_high_hz, material.damping),
                             .most_modes = options.most_modes,
                             .method = options.solver,
                             .processes = options.processes};
  if (!(request.highest_lambda > 0)) return fail(material.name + " is damped so strongly that nothing of it rings");
  if (auto few = check_count(*system, material, options, request.highest_lambda); !few) {
    return fail(name + ": " + few.error().message);
  }
  const Result<Eigenmodes> modes = solve::solve_modes(*system, request, progress);
  if (!modes) return fail(modes.error());
  report.rigid = modes->rigid;
  report.factor_seconds = modes->factor_seconds;
  report.iterate_seconds = modes->iterate_seconds;
  if (auto rigid = check_rigid(*modes, checked.pieces); !rigid) return fail(name + ": " + rigid.error().message);

  watch.lap();
  if (progress && !progress("finish", 0)) return fail(std::string(kCancelled));
  const mesh::Surface surface = mesh::boundary_surface(mesh);
  const Result<mesh::Surface> points = mesh::decimate(surface, mesh.nodes, options.most_points);
  if (!points) return fail(name + ": " + points.error().message);
  const std::vector<HeardMode> heard =
      modes_in_band(*modes, surface, area_weights(surface, mesh.nodes), material.damping, options, report);
  if (heard.empty()) {
    return fail(name + " has no mode between " + std::to_string(std::lround(options.band_low_hz)) + " and " +
                std::to_string(std::lround(options.band_high_hz)) +
                " Hz; it may be too small or too large (check the unit of its mesh)");
  }

  bank.name = name;
  for (const HeardMode& mode : heard) add_mode(bank, mode, modes->shapes.col(mode.number), points->nodes);
  for (const std::int32_t node : points->nodes) {
    const Eigen::Vector3f at = mesh.nodes.row(node).transpose().cast<float>();
    bank.positions.push_back({at[0], at[1], at[2]});
  }
  bank.triangles = points->triangles;
  bank.material = material;
  bank.mass = mass_properties(mesh, system->node_mass);
  bank.provenance = provenance(options, report, *modes);
  report.finish_seconds = watch.lap();
  return baked;
}

}  // namespace ringdown::bake
