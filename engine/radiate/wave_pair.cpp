#include "engine/radiate/wave_pair.h"

#include "engine/modal/radiation_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::radiate {
namespace {

constexpr int kFewestIterated = 1500;  // unknowns; fewer are eliminated
constexpr int kMostSteps = 80;
// The power's error falls with the square of the side or faster, and so halves or better from one grade to the next:
// when half of the last step is added, no more than half a step is left.
constexpr double kExtrapolation = 0.5;  // of the step from the coarser skin to the finer

// The right-hand sides of the equation: modes, and after them the sources.
Eigen::MatrixXcf flow_for(const WaveQuestion& question, const Skin& skin, bool with_sources) {
  const auto modes = static_cast<Eigen::Index>(question.modes.size());
  const auto sources = with_sources ? static_cast<Eigen::Index>(question.sources.size()) : 0;
  Eigen::MatrixXcf flow(skin.panels.node_count(), modes + sources);
  for (Eigen::Index m = 0; m < modes; ++m) flow.col(m) = skin.flow.col(question.modes[m]).cast<std::complex<float>>();
  for (Eigen::Index s = 0; s < sources; ++s) {
    flow.col(modes + s) = source_flow(skin.panels, question.sources[s], question.wavenumber_rad_m);
  }
  return flow;
}

Eigen::MatrixXcd fields_of(const WaveQuestion& question, const Skin& skin, const std::vector<double>& coupling,
                           const Directions& directions, const Eigen::MatrixXcf& layers) {
  return far_fields(skin.panels, question.origin, question.wavenumber_rad_m, coupling, directions,
                    layers.cast<std::complex<double>>());
}

Directions directions_of(const WaveQuestion& question, int most_degree) {
  return directions_for(std::min(most_degree, degree_for(question.wavenumber_rad_m, question.radius_m)));
}

Eigen::VectorXd rms_of(const Directions& directions, const Eigen::MatrixXcd& fields) {
  return (fields.cwiseAbs2().transpose() * directions.weights / (4 * std::numbers::pi)).cwiseSqrt();
}

// The right-hand sides' layers, by the iteration and if that does not converge by elimination. Empty when `go_on`
// returned false.
Eigen::MatrixXcf layers_of(ComplexMatrix& matrix, const Eigen::MatrixXcf& flow, const Preconditioner& precondition,
                           const std::function<bool()>& go_on, bool& eliminated) {
  Eigen::MatrixXcf layers = iterate(matrix, flow, precondition, kMostSteps, go_on);
  eliminated = layers.size() == 0;
  if (eliminated && go_on()) layers = Elimination(matrix).solve(flow);
  return layers;
}

}  // namespace

// The finer and the coarser matrix, the latter eliminated or not.
double wave_memory_bytes(int nodes) { return 8.0 * nodes * nodes * (1 + 0.25 + 0.25); }
double band_memory_bytes(int nodes) { return 3 * 8.0 * nodes * nodes * (1 + 0.25); }

Continuation continuation_of(const Skin& fine, const Skin& coarse) {
  const SurfaceSearch search(coarse.panels);
  const std::vector<Eigen::Vector3d> normals = node_normals(fine.panels);
  std::vector<Eigen::Triplet<float>> entries;
  for (int n = 0; n < fine.panels.node_count(); ++n) {
    const SurfacePlace place = search.nearest(fine.panels.nodes.row(n).transpose(), normals[n]);
    for (int i = 0; i < 3; ++i) {
      entries.emplace_back(n, coarse.panels.corners[place.triangle][i], static_cast<float>(place.weights[i]));
    }
  }
  Continuation continuation;
  continuation.layer.resize(fine.panels.node_count(), coarse.panels.node_count());
  continuation.layer.setFromTriplets(entries.begin(), entries.end());
  continuation.flow =
      node_areas(fine.panels).asDiagonal() * continuation.layer * node_areas(coarse.panels).cwiseInverse().asDiagonal();
  return continuation;
}

// The coarser skin's iteration is preconditioned by its elimination at the middle wavenumber, that of the finer by the
// sum of two parts: the same elimination, for all that the coarser skin can show, and the inverse of the diagonal for
// the rest. Without taking the coarser skin's part out of that rest, a half to three quarters more steps were needed.
bool answer(const std::vector<WaveQuestion>& questions, const BandPair& bands, WaveMemory& memory,
            const std::function<bool()>& go_on,
            const std::function<void(const WaveQuestion&, const WaveAnswer&)>& keep) {
  const double middle = (questions.front().wavenumber_rad_m + questions.back().wavenumber_rad_m) / 2;
  bands.coarse.matrix_at(middle, memory.factors);
  const Elimination eliminated(memory.factors);
  const auto by_elimination = [&](const Eigen::MatrixXcf& columns) -> Eigen::MatrixXcf {
    return eliminated.solve(columns);
  };
  for (const WaveQuestion& question : questions) {
    if (!go_on()) return false;
    const double k = question.wavenumber_rad_m;
    const Directions directions = directions_of(question, modal::kMaxHarmonicDegree);
    const Skin &fine = bands.fine.skin(), &coarse = bands.coarse.skin();
    WaveAnswer answer;
    Eigen::MatrixXcf coarse_layers = flow_for(question, coarse, false);
    if (questions.size() == 1) {
      coarse_layers = eliminated.solve(std::move(coarse_layers));
    } else {
      bool unused = false;
      bands.coarse.matrix_at(k, memory.coarse);
      coarse_layers = layers_of(memory.coarse, coarse_layers, by_elimination, go_on, unused);
    }
    bands.fine.matrix_at(k, memory.fine);
    const Eigen::MatrixXcf flow = flow_for(question, fine, true);
    Eigen::MatrixXcf layers;
    if (memory.fine.rows() >= kFewestIterated) {
      const Eigen::VectorXcf scale = memory.fine.diagonal().cwiseInverse();
      const Continuation& continuation = bands.continuation;
      const auto precondition = [&](const Eigen::MatrixXcf& columns) -> Eigen::MatrixXcf {
        const Eigen::MatrixXcf smooth = continuation.layer.transpose() * columns;
        const Eigen::MatrixXcf rough = columns - continuation.flow * smooth;
        return scale.asDiagonal() * rough + continuation.layer * eliminated.solve(smooth);
      };
      layers = layers_of(memory.fine, flow, precondition, go_on, answer.eliminated);
    } else {
      layers = Elimination(memory.fine).solve(flow);
    }
    if (coarse_layers.size() == 0 || layers.size() == 0) return false;
    const Eigen::MatrixXcd coarse_fields =
        fields_of(question, coarse, bands.coarse.coupling(), directions, coarse_layers);
    const Eigen::MatrixXcd fields = fields_of(question, fine, bands.fine.coupling(), directions, layers);
    const auto modes = static_cast<Eigen::Index>(question.modes.size());
    const Eigen::VectorXd rms = rms_of(directions, fields);
    for (Eigen::Index s = modes; s < fields.cols(); ++s) {  // |F| = 1 / (4 pi)
      answer.source_db = std::max(answer.source_db, std::abs(20 * std::log10(rms[s] * 4 * std::numbers::pi)));
    }
    const Eigen::MatrixXcd extrapolated =
        fields.leftCols(modes) + kExtrapolation * (fields.leftCols(modes) - coarse_fields);
    answer.finer_rms = rms.head(modes);
    answer.rms = rms_of(directions, extrapolated);
    answer.harmonics = harmonics_of(directions, extrapolated);
    keep(question, answer);
  }
  return true;
}

Eigen::VectorXd rms_on(const WaveQuestion& question, const Skin& skin, WaveMemory& memory) {
  constexpr int kMostDegree = 33;
  const Directions directions = directions_of(question, kMostDegree);
  const std::vector<double> coupling = coupling_of(skin, question.wavenumber_rad_m);
  wave_matrix(skin.panels, skin.near, question.wavenumber_rad_m, coupling, memory.factors);
  const Eigen::MatrixXcf layers = Elimination(memory.factors).solve(flow_for(question, skin, false));
  return rms_of(directions, fields_of(question, skin, coupling, directions, layers));
}

}  // namespace ringdown::radiate
