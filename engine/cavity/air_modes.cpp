#include "engine/cavity/air_modes.h"

#include "engine/base/in_parallel.h"
#include "engine/cavity/graded_tiles.h"
#include "engine/cavity/rational.h"
#include "engine/dense/blas_threads.h"
#include "engine/modal/damping.h"
#include "engine/radiate/far_field.h"
#include "engine/radiate/skin.h"
#include "engine/radiate/surface_pressure.h"
#include "engine/radiate/symmetry.h"
#include "engine/radiate/wave_band.h"
#include "engine/radiate/wave_solver.h"
#include "engine/tube/line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace ringdown::cavity {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kPi = std::numbers::pi;
constexpr double kCoarser = 2;                 // nodes of the finer skin over those of the coarser
constexpr double kExtrapolation = 0.5;         // of the step from the coarser skin to the finer
constexpr double kSpan = 5;                    // highest over lowest frequency of one search
constexpr int kSearched = 12;                  // wavenumbers of it
constexpr double kTolerance = 1e-5;            // of rational functions: matrices are in single precision
constexpr double kMinQ = 5;                    // the air around a body has poles, too, of lower Q
constexpr double kMinStrength = 1e-4;          // of a pole; weaker ones come from rounding
constexpr double kAside = 0.03;                // of the wavenumbers on both sides of a pole
constexpr double kBelow = 0.9, kAbove = 1.12;  // ends of the band around a guess in which its pole is found
constexpr double kNear = 0.07;                 // largest distance of the pole from the guess
constexpr double kSmallest = 0.05;             // k times the body's radius where the search begins
constexpr std::array kBeside = {-0.06, -0.02, 0.02, 0.06, 0.1};  // of the wavenumbers that refine a pole

// A motion of the body: a translation along an axis, or number 3, in which all of its surface moves out.
struct Motion {
  int number = 0, image_class = 0;

  [[nodiscard]] double flow(const Eigen::Vector3d& normal) const { return number < 3 ? normal[number] : 1; }
};
constexpr int kMotions = 4;

// One skin and what the body's motions cause on it. A translation across a mirror plane is odd in it.
class Motions {
 public:
  Motions(radiate::Skin skin, const radiate::Symmetry& symmetry, double radius)
      : skin_(std::move(skin)), symmetry_(symmetry), radius_(radius) {
    for (int m = 0; m < kMotions; ++m) motions_[m] = {m, m < symmetry.mirrors ? 1 << m : 0};
    for (int image = 0; image < skin_.panels.image_count(); ++image)
      images_.push_back(image == 0 ? skin_.panels : radiate::image_of(skin_.panels, image));
  }

  // Prepares for some wavenumbers of a band.
  [[nodiscard]] radiate::WaveBand band(double lowest, double highest, int wavenumbers, int threads) const {
    return {skin_, lowest, highest, wavenumbers, threads};
  }

  // The layers of the motions, V x kMotions; with a class those of the others are 0.
  [[nodiscard]] MatrixXcd layers_at(const radiate::WaveBand& band, double k, std::optional<int> only) const {
    radiate::ClassMatrices matrices;
    band.matrices_at(k, matrices);
    MatrixXcd layers = MatrixXcd::Zero(skin_.panels.node_count(), kMotions);
    for (std::size_t c = 0; c < matrices.size(); ++c) {
      std::vector<Index> own;
      for (const Motion& motion : motions_) {
        if (motion.image_class == static_cast<int>(c)) own.push_back(motion.number);
      }
      if (own.empty() || (only && *only != static_cast<int>(c))) continue;
      const Eigen::MatrixXcf right = skin_.flow[c](Eigen::all, own).cast<std::complex<float>>();
      layers(Eigen::all, own) = radiate::LuFactors(matrices[c]).solve(right).cast<Complex>();
    }
    return layers;
  }

  // The far fields of the layers about a point of the body's frame, in harmonics: a column for each motion.
  [[nodiscard]] MatrixXcd fields_of(const MatrixXcd& layers, double k, const std::vector<double>& coupling,
                                    const Eigen::Vector3d& about, int degree) const {
    const radiate::Directions directions = radiate::directions_for(degree);
    const Eigen::Vector3d origin = symmetry_.turn * about - symmetry_.shift;
    MatrixXcd fields = MatrixXcd::Zero(directions.weights.size(), kMotions), sent;
    std::optional<Eigen::Vector3d> sent_about;
    for (int image = 0; image < skin_.panels.image_count(); ++image) {
      // An image is heard about a point as the part is about the point's image.
      const Eigen::Vector3d turned = radiate::image_of(origin, image);
      if (!sent_about || (turned - *sent_about).norm() > 1e-9 * radius_) {
        sent = radiate::far_fields(skin_.panels, turned, k, coupling, directions, layers);
        sent_about = turned;
      }
      const std::vector<Index> from = radiate::images_of(directions, image);
      for (const auto& [number, image_class] : motions_) {
        const double sign = radiate::sign_of(image_class, image);
        for (Index d = 0; d < fields.rows(); ++d) fields(d, number) += sign * sent(from[d], number);
      }
    }
    return radiate::harmonics_of(directions, directions.units * symmetry_.turn, fields);
  }

  // The first harmonics of all fields, about the middle of the symmetry: a row for each wavenumber.
  static constexpr int kHarmonics = 4;
  [[nodiscard]] Eigen::RowVectorXcd sample_at(const radiate::WaveBand& band, double k, std::optional<int> only) const {
    const Eigen::Vector3d middle = symmetry_.turn.transpose() * symmetry_.shift;
    const MatrixXcd fields =
        fields_of(layers_at(band, k, only), k, band.coupling(), middle, radiate::degree_for(k, radius_));
    return fields.topRows(kHarmonics).reshaped().transpose();
  }

  // P of a motion's layer at the middles of the part's triangles.
  [[nodiscard]] VectorXcd pressure_of(const VectorXcd& layer, const Motion& motion, double k,
                                      const std::vector<double>& coupling, int threads) const {
    const MatrixXcd layers = layer;
    const radiate::SurfacePressure at(images_, motion.image_class, k, coupling, layers);
    VectorXcd pressure(skin_.panels.triangle_count());
    in_parallel(threads, [&](int thread) {
      for (int t = thread; t < skin_.panels.triangle_count(); t += threads) pressure[t] = at.at(t)[0];
    });
    return pressure;
  }

  [[nodiscard]] const radiate::Skin& skin() const { return skin_; }
  [[nodiscard]] const std::array<Motion, kMotions>& motions() const { return motions_; }
  [[nodiscard]] double radius() const { return radius_; }

 private:
  radiate::Skin skin_;
  const radiate::Symmetry& symmetry_;
  double radius_;
  std::array<Motion, kMotions> motions_;
  std::vector<radiate::Panels> images_;
};

// The integrals over the walls of psi^2 and of the square of its slope along them.
struct OnWalls {
  double squares = 0, slopes = 0;
};

// Returns psi and its slopes on the walls, from psi at the middles of triangles (`at`) and from its jump at the wall,
// the layer at nodes, which is linear on triangles. The rest, psi behind the wall, changes slowly, because the wall is
// rigid from there, too; its means smooth the errors that middles have near thin walls, which would be larger than its
// slopes.
OnWalls on_walls(const radiate::Skin& skin, const VectorXcd& at, const VectorXcd& layer, int image_class) {
  const radiate::Panels& panels = skin.panels;
  const auto middles_of = [&](const VectorXcd& nodes) {
    VectorXcd middles(panels.triangle_count());
    for (int t = 0; t < panels.triangle_count(); ++t) {
      const auto& [a, b, c] = panels.corners[t];
      middles[t] = (nodes[a] + nodes[b] + nodes[c]) / 3.0;
    }
    return middles;
  };
  const auto nodes_of = [&](const VectorXcd& middles) -> VectorXcd {
    VectorXcd sums = VectorXcd::Zero(panels.node_count());
    VectorXd weights = VectorXd::Zero(panels.node_count());
    for (int t = 0; t < panels.triangle_count(); ++t) {
      for (const int n : panels.corners[t]) {
        sums[n] += panels.areas[t] * middles[t];
        weights[n] += panels.areas[t];
      }
    }
    return sums.array() / weights.array();
  };
  const VectorXcd behind = nodes_of(at - middles_of(layer));
  VectorXcd nodes = layer + nodes_of(middles_of(behind));
  for (const int n : skin.zero_nodes[image_class]) nodes[n] = 0;
  OnWalls sums;
  for (int t = 0; t < panels.triangle_count(); ++t) {
    Eigen::Vector3cd slope = Eigen::Vector3cd::Zero();
    for (int i = 0; i < 3; ++i) slope += nodes[panels.corners[t][i]] * panels.curls[t][i].cast<Complex>();
    sums.slopes += panels.image_count() * panels.areas[t] * slope.squaredNorm();
    sums.squares += panels.image_count() * panels.areas[t] * std::norm(at[t]);
  }
  return sums;
}

class Finder {
 public:
  Finder(const Vessel& vessel, const modal::Air& air, const Progress& progress)
      : vessel_(vessel), air_(air), progress_(progress), threads_(thread_count(0)) {}

  Result<std::vector<AirMode>> find() {
    if (const auto made = make_skins(); !made) return fail(made);
    std::vector<AirMode> modes;
    const double per_hz = 2 * kPi / air_.sound_speed_m_s, end = vessel_.highest_hz * per_hz;
    double low = std::max(vessel_.lowest_hz * per_hz, kSmallest / coarsest_->radius());
    for (int round = 0; low < end && static_cast<int>(modes.size()) < vessel_.modes; ++round, low *= kSpan) {
      const double high = std::min(end, kSpan * low);
      for (const double k : poles_between(low, high)) {
        if (!go_on(static_cast<double>(modes.size()) / vessel_.modes)) return fail_cancelled();
        if (static_cast<int>(modes.size()) == vessel_.modes) break;
        if (auto mode = mode_at(k)) modes.push_back(std::move(*mode));
      }
      if (!go_on(static_cast<double>(modes.size()) / vessel_.modes)) return fail_cancelled();
    }
    return modes;
  }

 private:
  bool go_on(double fraction) const { return !progress_ || progress_("cavity", fraction); }

  // Flows are those of the motions in the symmetry's frame.
  Result<void> make_skins() {
    symmetry_ = radiate::symmetry_of(vessel_.body.surface);
    body_ = radiate::moved(vessel_.body, symmetry_);
    body_.flow.flow.resize(body_.flow.areas.size(), kMotions);
    body_.flow.flow << (body_.flow.areas.asDiagonal() * body_.flow.normals).cast<float>(),
        body_.flow.areas.cast<float>();
    body_.frequency_hz.assign(kMotions, 1);
    const double radius =
        (vessel_.body.surface.nodes.rowwise() - vessel_.origin.transpose()).rowwise().norm().maxCoeff();
    const Result<radiate::Original> original = radiate::Original::of(body_, symmetry_.mirrors);
    if (!original) return fail(original);
    double nodes = vessel_.nodes;
    for (std::optional<Motions>* motions : {&fine_, &coarse_, &coarsest_}) {
      Result<mesh::TriangleMesh> tiles = graded_tiles(*original, static_cast<int>(nodes));
      nodes /= kCoarser;
      if (!tiles) return fail(tiles);
      Result<radiate::Skin> skin = radiate::skin_of(*original, std::move(*tiles));
      if (!skin) return fail(skin);
      motions->emplace(std::move(*skin), symmetry_, radius);
    }
    return {};
  }

  static bool rings(const Pole& pole) {
    return pole.at.real() > 0 && std::abs(pole.at.real()) > 2 * kMinQ * std::abs(pole.at.imag()) &&
           pole.strength > kMinStrength;
  }

  // One row for each wavenumber, by matrices of the band around it.
  template <class BandAt>
  [[nodiscard]] MatrixXcd samples_at(const Motions& on, const VectorXd& wavenumbers, const BandAt& band_at,
                                     std::optional<int> only) const {
    MatrixXcd samples(wavenumbers.size(), kMotions * Motions::kHarmonics);
    in_parallel(threads_, [&](int thread) {
      for (Index n = thread; n < wavenumbers.size(); n += threads_)
        samples.row(n) = on.sample_at(band_at(wavenumbers[n]), wavenumbers[n], only);
    });
    return samples;
  }

  // The real parts of the poles that ring, ascending, by the coarsest skin.
  [[nodiscard]] std::vector<double> poles_between(double low, double high) const {
    VectorXd wavenumbers(kSearched);
    for (int n = 0; n < kSearched; ++n) wavenumbers[n] = low * std::pow(high / low, n / (kSearched - 1.0));
    std::vector<double> found;
    const MatrixXcd samples =
        samples_at(*coarsest_, wavenumbers, [&](double k) { return coarsest_->band(k, k, 1, 1); }, {});
    for (const Pole& pole : poles_of(wavenumbers, samples, kTolerance)) {
      if (rings(pole) && pole.at.real() >= low && pole.at.real() < high) found.push_back(pole.at.real());
    }
    std::ranges::sort(found);
    return found;
  }

  // A pole on a skin, and a band around it.
  struct Place {
    const Motions& on;
    radiate::WaveBand band;
    Complex pole;
  };

  // The pole next to a guess, by wavenumbers on both sides of it; with a class, by motions of that class alone. Nothing
  // where they see no pole: the guess came from rounding.
  [[nodiscard]] std::optional<Place> pole_near(const Motions& on, double guess, std::optional<int> only) const {
    radiate::WaveBand band = on.band(kBelow * guess, kAbove * guess, static_cast<int>(kBeside.size()) + 2, threads_);
    VectorXd wavenumbers(static_cast<Index>(kBeside.size()));
    for (std::size_t n = 0; n < kBeside.size(); ++n) wavenumbers[static_cast<Index>(n)] = guess * (1 + kBeside[n]);
    std::optional<Complex> nearest;
    const auto around = [&](double) -> const radiate::WaveBand& { return band; };
    for (const Pole& pole : poles_of(wavenumbers, samples_at(on, wavenumbers, around, only), kTolerance)) {
      if (!rings(pole) || std::abs(pole.at - guess) > kNear * guess) continue;
      if (!nearest || std::abs(pole.at - guess) < std::abs(*nearest - guess)) nearest = pole.at;
    }
    if (!nearest) return std::nullopt;
    return Place{on, std::move(band), *nearest};
  }

  [[nodiscard]] std::optional<AirMode> mode_at(double guess) const {
    const auto coarse = pole_near(*coarse_, guess, {});
    if (!coarse) return std::nullopt;
    const int image_class = shape_of(*coarse, {}).image_class;
    const auto fine = pole_near(*fine_, coarse->pole.real(), image_class);
    if (!fine) return std::nullopt;
    const double step = kExtrapolation * (fine->pole.real() - coarse->pole.real());
    const double kappa = fine->pole.real() + step;
    AirMode mode = shape_of(*fine, image_class).mode;
    const double omega = kappa * air_.sound_speed_m_s;
    mode.rigid_hz = omega / (2 * kPi);
    mode.frequency_hz = mode.rigid_hz * (1 - 1 / (2 * mode.wall_q));
    mode.wall_decay_per_s = omega / (2 * mode.wall_q);
    mode.frequency_error = std::abs(step) / kappa;
    double squares = 0;
    for (const Complex& value : mode.field) squares += std::norm(value);
    mode.radiation_decay_per_s = modal::radiation_decay_per_s(std::sqrt(squares / (4 * kPi)), omega, air_);
    return mode;
  }

  struct Shape {
    AirMode mode;  // its losses, field and flux
    int image_class = 0;
  };

  // The mode at a pole of a skin, by two wavenumbers k beside the pole. What is smooth in k drops out of the difference
  // of both. With a class, by motions of that class alone.
  [[nodiscard]] Shape shape_of(const Place& place, std::optional<int> only) const {
    const auto& [on, band, pole] = place;
    struct Beside {
      MatrixXcd layers;
      double k = 0;
    };
    std::array<Beside, 2> beside;
    const double kappa = pole.real();
    const int degree = radiate::degree_for(kappa, on.radius());
    Complex rise = 0;  // of 1 / (kappa^2 - k^2) from one to the other
    for (int side = 0; side < 2; ++side) {
      Beside& here = beside[side];
      here.k = kappa * (side == 0 ? 1 - kAside : 1 + kAside);
      here.layers = on.layers_at(band, here.k, only);
      rise += (side == 0 ? 1.0 : -1.0) / (pole * pole - here.k * here.k);
    }
    const auto field_steps = [&](const Eigen::Vector3d& about) -> MatrixXcd {
      const auto at = [&](const Beside& here) {
        return on.fields_of(here.layers, here.k, band.coupling(), about, degree);
      };
      return at(beside[0]) - at(beside[1]);
    };
    const MatrixXcd fields = field_steps(vessel_.origin);
    const Motion motion =
        *std::ranges::max_element(on.motions(), {}, [&](const Motion& one) { return fields.col(one.number).norm(); });
    const auto pressure = [&](const Beside& here) {
      return on.pressure_of(here.layers.col(motion.number), motion, here.k, band.coupling(), threads_);
    };
    const VectorXcd step = pressure(beside[0]) - pressure(beside[1]);
    const radiate::Panels& panels = on.skin().panels;
    Complex driven = 0;  // integral of P q
    for (int t = 0; t < panels.triangle_count(); ++t)
      driven += static_cast<double>(panels.image_count()) * panels.areas[t] * motion.flow(panels.normals[t]) * step[t];
    const Complex c = std::sqrt(driven / rise);
    const VectorXcd layer = beside[0].layers.col(motion.number) - beside[1].layers.col(motion.number);
    const OnWalls walls = on_walls(on.skin(), step / (c * rise), layer / (c * rise), motion.image_class);
    const tube::WallLayers layers = tube::wall_layers(air_, kappa * air_.sound_speed_m_s);
    AirMode mode;
    mode.wall_q = 1 / (layers.viscous_m / (2 * kappa * kappa) * walls.slopes +
                       (tube::kHeatRatio - 1) * layers.thermal_m / 2 * walls.squares);
    // A velocity potential psi / (kappa sqrt(rho)) has a kinetic energy of 1/2 at a modal velocity of 1.
    const Complex unit = 1.0 / (c * rise * kappa * std::sqrt(air_.density_kg_m3));
    const VectorXcd field = unit * fields.col(motion.number);
    mode.field.assign(field.begin(), field.end());
    // A simple source of flux 1 has F = 1/(4 pi), and so a first harmonic of 1/sqrt(4 pi).
    mode.flux = std::sqrt(4 * kPi) * std::abs(unit * field_steps(vessel_.mouth)(0, motion.number));
    return {std::move(mode), motion.image_class};
  }

  const Vessel& vessel_;
  const modal::Air& air_;
  const Progress& progress_;
  const int threads_;
  radiate::Symmetry symmetry_;
  radiate::Body body_;
  std::optional<Motions> coarsest_, coarse_, fine_;
};

}  // namespace

Result<std::vector<AirMode>> air_modes(const Vessel& vessel, const modal::Air& air, const Progress& progress) {
  const dense::BlasThreads one(1);
  return Finder(vessel, air, progress).find();
}

}  // namespace ringdown::cavity
