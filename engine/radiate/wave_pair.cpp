#include "engine/radiate/wave_pair.h"

#include "engine/modal/radiation_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::radiate {
namespace {

constexpr int kMinIterated = 1500;  // unknowns; smaller matrices are eliminated
constexpr int kMaxSteps = 80;
constexpr double kMinPart = 1e-4;  // of the whole flow; smaller parts in a class are left out
// The power's error falls with the square of the side or faster, so it at least halves from one grade to the next.
// After half of the last step is added, no more than half a step of error is left.
constexpr double kExtrapolation = 0.5;  // of the step from the coarser skin to the finer

// The memory for one matrix per class.
double matrix_bytes(const Skin& skin) {
  return 8.0 * skin.panels.image_count() * skin.panels.node_count() * skin.panels.node_count();
}

// The right-hand sides of the equation for each class: modes first, then the sources.
std::vector<Eigen::MatrixXcf> flows_for(const WaveQuestion& question, const Skin& skin, bool with_sources) {
  const auto modes = static_cast<Eigen::Index>(question.modes.size());
  const auto sources = with_sources ? static_cast<Eigen::Index>(question.sources.size()) : 0;
  std::vector<Eigen::MatrixXcf> flows(skin.flow.size(), Eigen::MatrixXcf(skin.panels.node_count(), modes + sources));
  for (std::size_t c = 0; c < flows.size(); ++c) {
    for (Eigen::Index m = 0; m < modes; ++m) {
      flows[c].col(m) = skin.flow[c].col(question.modes[m]).cast<std::complex<float>>();
    }
  }
  for (Eigen::Index s = 0; s < sources; ++s) {
    const Eigen::MatrixXcf source = source_flow(skin, question.sources[s], question.wavenumber_rad_m);
    for (std::size_t c = 0; c < flows.size(); ++c) flows[c].col(modes + s) = source.col(static_cast<Eigen::Index>(c));
  }
  return flows;
}

// A class's share of the right-hand sides: the numbers of those that are not too small in the class, and the residual
// to which each is solved, so that the error is kResidual of the whole flow.
struct ClassPart {
  std::vector<Eigen::Index> columns;
  std::vector<double> residuals;
};

std::vector<ClassPart> parts_of(const std::vector<Eigen::MatrixXcf>& flows) {
  Eigen::ArrayXd whole = Eigen::ArrayXd::Zero(flows[0].cols());
  for (const Eigen::MatrixXcf& flow : flows) whole += flow.colwise().squaredNorm().transpose().array().cast<double>();
  std::vector<ClassPart> parts(flows.size());
  for (std::size_t c = 0; c < flows.size(); ++c) {
    for (Eigen::Index column = 0; column < whole.size(); ++column) {
      const double share = flows.size() == 1 ? 1 : std::sqrt(flows[c].col(column).squaredNorm() / whole[column]);
      if (!(share >= kMinPart)) continue;
      parts[c].columns.push_back(column);
      parts[c].residuals.push_back(kResidual / share);
    }
  }
  return parts;
}

// The solution of one class: layers on the part for some of the right-hand sides.
struct ClassLayers {
  int image_class = 0;
  std::vector<Eigen::Index> columns;
  Eigen::MatrixXcf layers;
};

// The far fields of all right-hand sides, each the sum over its classes. The waves of the part are computed once for
// all classes.
Eigen::MatrixXcd fields_of(const WaveQuestion& question, const Skin& skin, const std::vector<double>& coupling,
                           const Directions& directions, const std::vector<ClassLayers>& classes,
                           Eigen::Index columns) {
  Eigen::Index count = 0;
  for (const ClassLayers& own : classes) count += own.layers.cols();
  Eigen::MatrixXcd layers(skin.panels.node_count(), count);
  Eigen::Index first = 0;
  for (const ClassLayers& own : classes) {
    layers.middleCols(first, own.layers.cols()) = own.layers.cast<std::complex<double>>();
    first += own.layers.cols();
  }
  const Eigen::MatrixXcd sent =
      far_fields(skin.panels, question.origin, question.wavenumber_rad_m, coupling, directions, layers);
  Eigen::MatrixXcd fields = Eigen::MatrixXcd::Zero(directions.weights.size(), columns);
  for (int image = 0; image < skin.panels.image_count(); ++image) {
    const std::vector<Eigen::Index> from = images_of(directions, image);
    first = 0;
    for (const ClassLayers& own : classes) {
      const double sign = sign_of(own.image_class, image);
      for (const Eigen::Index column : own.columns) {
        for (Eigen::Index d = 0; d < fields.rows(); ++d) fields(d, column) += sign * sent(from[d], first);
        ++first;
      }
    }
  }
  return fields;
}

Directions directions_of(const WaveQuestion& question, int max_degree) {
  return directions_for(std::min(max_degree, degree_for(question.wavenumber_rad_m, question.radius_m)));
}

Eigen::VectorXd rms_of(const Directions& directions, const Eigen::MatrixXcd& fields) {
  return (fields.cwiseAbs2().transpose() * directions.weights / (4 * std::numbers::pi)).cwiseSqrt();
}

// The layers of the right-hand sides, by iteration, or by elimination if the iteration does not converge. Empty when
// `go_on` returned false.
Eigen::MatrixXcf layers_of(ComplexMatrix& matrix, const Eigen::MatrixXcf& flow, const std::vector<double>& residuals,
                           const Preconditioner& precondition, const std::function<bool()>& go_on, bool& eliminated) {
  Eigen::MatrixXcf layers = iterate(matrix, flow, residuals, precondition, kMaxSteps, go_on);
  if (layers.size() != 0) return layers;
  eliminated = true;
  if (go_on()) layers = LuFactors(matrix).solve(flow);
  return layers;
}

// Solves one class on the coarser skin with the elimination at the middle wavenumber, which serves as preconditioner at
// other wavenumbers.
Eigen::MatrixXcf coarse_layers(const Eigen::MatrixXcf& flow, const ClassPart& part, const LuFactors& middle,
                               ComplexMatrix* own_matrix, const std::function<bool()>& go_on) {
  if (own_matrix == nullptr) return middle.solve(flow);
  const auto by_elimination = [&](const Eigen::MatrixXcf& right) -> Eigen::MatrixXcf { return middle.solve(right); };
  bool unused = false;
  return layers_of(*own_matrix, flow, part.residuals, by_elimination, go_on, unused);
}

// The preconditioner of a class on the finer skin.
Preconditioner on_finer(const Skin& fine, int image_class, const ComplexMatrix& matrix, const LuFactors& coarse,
                        const Continuation& continuation) {
  Eigen::VectorXf kept = Eigen::VectorXf::Ones(fine.panels.node_count());
  for (const int n : fine.zero_nodes[image_class]) kept[n] = 0;
  const Eigen::VectorXcf scale = matrix.diagonal().cwiseInverse();
  return [kept, scale, &coarse, &continuation](const Eigen::MatrixXcf& columns) -> Eigen::MatrixXcf {
    const Eigen::MatrixXcf smooth = continuation.layer.transpose() * columns;
    const Eigen::MatrixXcf rough = columns - continuation.flow * smooth;
    return kept.asDiagonal() * (scale.asDiagonal() * rough + continuation.layer * coarse.solve(smooth));
  };
}

}  // namespace

// Counts the finer matrices, and the coarser ones twice: as they are and eliminated.
double wave_memory_bytes(const Skin& skin) { return matrix_bytes(skin) * (1 + 0.25 + 0.25); }
double band_memory_bytes(const Skin& skin) { return 3 * matrix_bytes(skin) * (1 + 0.25); }

Continuation continuation_of(const Skin& fine, const Skin& coarse) {
  const SurfaceSearch search(coarse.panels);
  const std::vector<Eigen::Vector3d> normals = node_normals(fine.panels);
  std::vector<Eigen::Triplet<float>> entries;
  for (int n = 0; n < fine.panels.node_count(); ++n) {
    const NearestPoint place = search.nearest(fine.panels.nodes.row(n).transpose(), normals[n]);
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

// The coarser skin's iteration is preconditioned by its elimination at the middle wavenumber. The finer skin's
// iteration is preconditioned by the sum of two parts: this elimination, for the part of a field that the coarser skin
// can represent, and the inverse of the diagonal for the rest. Unless the coarser skin's part is removed from the rest,
// a half to three quarters more steps are needed.
bool answer(const std::vector<WaveQuestion>& questions, const BandPair& bands, WaveMemory& memory,
            const std::function<bool()>& go_on,
            const std::function<void(const WaveQuestion&, const WaveAnswer&)>& keep) {
  const double middle = (questions.front().wavenumber_rad_m + questions.back().wavenumber_rad_m) / 2;
  bands.coarse.matrices_at(middle, memory.factors);
  std::vector<LuFactors> eliminated;
  for (ComplexMatrix& matrix : memory.factors) eliminated.emplace_back(matrix);
  const Skin &fine = bands.fine.skin(), &coarse = bands.coarse.skin();
  for (const WaveQuestion& question : questions) {
    if (!go_on()) return false;
    const double k = question.wavenumber_rad_m;
    const auto modes = static_cast<Eigen::Index>(question.modes.size());
    WaveAnswer answer;
    const std::vector<Eigen::MatrixXcf> flows = flows_for(question, fine, true);
    const std::vector<Eigen::MatrixXcf> coarse_flows = flows_for(question, coarse, false);
    const std::vector<ClassPart> parts = parts_of(flows);
    if (questions.size() > 1) bands.coarse.matrices_at(k, memory.coarse);
    bands.fine.matrices_at(k, memory.fine);
    std::vector<ClassLayers> on_coarse, on_fine;
    for (std::size_t c = 0; c < parts.size(); ++c) {
      const ClassPart& part = parts[c];
      const auto own_class = static_cast<int>(c);
      const auto own_modes = std::lower_bound(part.columns.begin(), part.columns.end(), modes);  // no sources
      if (own_modes != part.columns.begin()) {
        const std::vector<Eigen::Index> columns(part.columns.begin(), own_modes);
        ComplexMatrix* const own_matrix = questions.size() > 1 ? &memory.coarse[c] : nullptr;
        on_coarse.push_back(
            {own_class, columns,
             coarse_layers(coarse_flows[c](Eigen::all, columns), part, eliminated[c], own_matrix, go_on)});
        if (on_coarse.back().layers.size() == 0) return false;
      }
      if (part.columns.empty()) continue;
      ComplexMatrix& matrix = memory.fine[c];
      Eigen::MatrixXcf layers = flows[c](Eigen::all, part.columns);
      if (matrix.rows() >= kMinIterated) {
        const auto precondition = on_finer(fine, own_class, matrix, eliminated[c], bands.continuation);
        layers = layers_of(matrix, layers, part.residuals, precondition, go_on, answer.eliminated);
      } else {
        layers = LuFactors(matrix).solve(std::move(layers));
      }
      if (layers.size() == 0) return false;
      on_fine.push_back({own_class, part.columns, std::move(layers)});
    }
    const Directions directions = directions_of(question, modal::kMaxHarmonicDegree);
    const Eigen::MatrixXcd coarse_fields =
        fields_of(question, coarse, bands.coarse.coupling(), directions, on_coarse, modes);
    const Eigen::MatrixXcd fields =
        fields_of(question, fine, bands.fine.coupling(), directions, on_fine, flows[0].cols());
    const Eigen::VectorXd rms = rms_of(directions, fields);
    for (Eigen::Index s = modes; s < fields.cols(); ++s) {  // |F| = 1 / (4 pi)
      answer.source_db = std::max(answer.source_db, std::abs(20 * std::log10(rms[s] * 4 * std::numbers::pi)));
    }
    const Eigen::MatrixXcd extrapolated =
        fields.leftCols(modes) + kExtrapolation * (fields.leftCols(modes) - coarse_fields);
    answer.finer_rms = rms.head(modes);
    answer.rms = rms_of(directions, extrapolated);
    answer.harmonics = harmonics_of(directions, directions.units * question.turn, extrapolated);
    keep(question, answer);
  }
  return true;
}

Eigen::VectorXd rms_on(const WaveQuestion& question, const Skin& skin, WaveMemory& memory) {
  constexpr int kMaxDegree = 33;
  const Directions directions = directions_of(question, kMaxDegree);
  const std::vector<double> coupling = coupling_of(skin, question.wavenumber_rad_m);
  class_matrices(skin, question.wavenumber_rad_m, coupling, memory.factors);
  const std::vector<Eigen::MatrixXcf> flows = flows_for(question, skin, false);
  const std::vector<ClassPart> parts = parts_of(flows);
  std::vector<ClassLayers> solved;
  for (std::size_t c = 0; c < parts.size(); ++c) {
    const std::vector<Eigen::Index>& columns = parts[c].columns;
    if (columns.empty()) continue;
    solved.push_back({static_cast<int>(c), columns, LuFactors(memory.factors[c]).solve(flows[c](Eigen::all, columns))});
  }
  return rms_of(directions, fields_of(question, skin, coupling, directions, solved, flows[0].cols()));
}

}  // namespace ringdown::radiate
