#include "engine/radiate/wave_pair.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::radiate {
namespace {

constexpr int kFewestIterated = 1500;  // unknowns; fewer are eliminated
constexpr int kMostSteps = 80;

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

Directions directions_of(const WaveQuestion& question) {
  return directions_for(degree_for(question.wavenumber_rad_m, question.radius_m));
}

}  // namespace

double wave_memory_bytes(int nodes) { return 8.0 * nodes * nodes * (1 + 0.3); }

SkinPair pair_of(const Skin& fine, const Skin& coarse) {
  SkinPair pair{&fine, &coarse, {}};
  const SurfaceSearch search(coarse.panels);
  const std::vector<Eigen::Vector3d> normals = node_normals(fine.panels);
  std::vector<Eigen::Triplet<float>> entries;
  for (int n = 0; n < fine.panels.node_count(); ++n) {
    const SurfacePlace place = search.nearest(fine.panels.nodes.row(n).transpose(), normals[n]);
    for (int i = 0; i < 3; ++i) {
      entries.emplace_back(n, coarse.panels.corners[place.triangle][i], static_cast<float>(place.weights[i]));
    }
  }
  pair.continuation.resize(fine.panels.node_count(), coarse.panels.node_count());
  pair.continuation.setFromTriplets(entries.begin(), entries.end());
  return pair;
}

// The iteration is preconditioned by the sum of two parts: the inverse of the diagonal, for what changes from node to
// node, and the coarser skin's elimination, for all that the coarser skin can show.
std::optional<WaveAnswer> answer(const WaveQuestion& question, const SkinPair& skins, WaveMemory& memory,
                                 const std::function<bool()>& go_on) {
  const double k = question.wavenumber_rad_m;
  const Directions directions = directions_of(question);
  const std::vector<double> coarse_coupling = coupling_of(*skins.coarse, k), coupling = coupling_of(*skins.fine, k);
  wave_matrix(skins.coarse->panels, skins.coarse->near, k, coarse_coupling, memory.coarse);
  const Elimination coarse(memory.coarse);
  if (!go_on()) return std::nullopt;
  WaveAnswer answer;
  answer.coarse = harmonics_of(directions, fields_of(question, *skins.coarse, coarse_coupling, directions,
                                                     coarse.solve(flow_for(question, *skins.coarse, false))));
  wave_matrix(skins.fine->panels, skins.fine->near, k, coupling, memory.fine);
  const Eigen::MatrixXcf flow = flow_for(question, *skins.fine, true);
  Eigen::MatrixXcf layers;
  if (memory.fine.rows() >= kFewestIterated) {
    const Eigen::VectorXcf scale = memory.fine.diagonal().cwiseInverse();
    const auto precondition = [&](const Eigen::MatrixXcf& columns) -> Eigen::MatrixXcf {
      return scale.asDiagonal() * columns + skins.continuation * coarse.solve(skins.continuation.transpose() * columns);
    };
    layers = iterate(memory.fine, flow, precondition, kMostSteps, go_on);
  }
  if (!go_on()) return std::nullopt;
  if (layers.size() == 0) {
    layers = Elimination(memory.fine).solve(flow);
    answer.eliminated = memory.fine.rows() >= kFewestIterated;
  }
  const Eigen::MatrixXcd fields = fields_of(question, *skins.fine, coupling, directions, layers);
  const auto modes = static_cast<Eigen::Index>(question.modes.size());
  for (Eigen::Index s = modes; s < fields.cols(); ++s) {
    const double power = directions.weights.dot(fields.col(s).cwiseAbs2());  // |F| = 1 / (4 pi)
    answer.source_db = std::max(answer.source_db, std::abs(10 * std::log10(power * 4 * std::numbers::pi)));
  }
  answer.fine = harmonics_of(directions, fields.leftCols(modes));
  return answer;
}

Eigen::MatrixXcd answer_on(const WaveQuestion& question, const Skin& skin, WaveMemory& memory) {
  const Directions directions = directions_of(question);
  const std::vector<double> coupling = coupling_of(skin, question.wavenumber_rad_m);
  wave_matrix(skin.panels, skin.near, question.wavenumber_rad_m, coupling, memory.coarse);
  const Eigen::MatrixXcf layers = Elimination(memory.coarse).solve(flow_for(question, skin, false));
  return harmonics_of(directions, fields_of(question, skin, coupling, directions, layers));
}

}  // namespace ringdown::radiate
