#include "engine/cavity/air_modes.h"

#include "engine/base/in_parallel.h"
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
constexpr double kCoarser = 2;          // nodes of the finer skin over those of the coarser
constexpr double kExtrapolation = 0.5;  // of the step from the coarser skin to the finer
constexpr double kSpan = 5;             // highest over lowest frequency of one search
constexpr int kSearched = 12;           // wavenumbers of it
constexpr double kTolerance = 1e-5;     // of rational functions: matrices are in single precision
constexpr double kMinQ = 5;             // the air around a body has poles, too, of lower Q
constexpr double kMinStrength = 1e-4;   // of a pole; weaker ones come from rounding
constexpr double kAside = 0.03;         // of the wavenumbers on both sides of a pole
constexpr double kSmallest = 0.05;      // k times the body's radius where the search begins
constexpr std::array kBeside = {-0.06, -0.02, 0.02, 0.06, 0.1};  // of the wavenumbers that refine a pole

struct Axis {
  int number = 0, image_class = 0;
};

// One skin and what the body's translations cause on it. A translation across a mirror plane is odd in it.
class Translations {
 public:
  Translations(radiate::Skin skin, const radiate::Symmetry& symmetry, double radius)
      : skin_(std::move(skin)), symmetry_(symmetry), radius_(radius) {
    for (int axis = 0; axis < 3; ++axis) axes_[axis] = {axis, axis < symmetry.mirrors ? 1 << axis : 0};
    for (int image = 0; image < skin_.panels.image_count(); ++image)
      images_.push_back(image == 0 ? skin_.panels : radiate::image_of(skin_.panels, image));
  }

  // The layers of the three translations, V x 3; with a class those of the others are 0.
  [[nodiscard]] MatrixXcd layers_at(double k, const std::vector<double>& coupling, std::optional<int> only,
                                    int threads) const {
    radiate::ClassMatrices matrices;
    radiate::class_matrices(skin_, k, coupling, matrices, threads);
    MatrixXcd layers = MatrixXcd::Zero(skin_.panels.node_count(), 3);
    for (std::size_t c = 0; c < matrices.size(); ++c) {
      std::vector<Index> own;
      for (const Axis& axis : axes_) {
        if (axis.image_class == static_cast<int>(c)) own.push_back(axis.number);
      }
      if (own.empty() || (only && *only != static_cast<int>(c))) continue;
      const Eigen::MatrixXcf right = skin_.flow[c](Eigen::all, own).cast<std::complex<float>>();
      layers(Eigen::all, own) = radiate::LuFactors(matrices[c]).solve(right).cast<Complex>();
    }
    return layers;
  }

  // The far fields of the layers about a point of the body's frame, in harmonics: a column for each axis.
  [[nodiscard]] MatrixXcd fields_of(const MatrixXcd& layers, double k, const std::vector<double>& coupling,
                                    const Eigen::Vector3d& about, int degree) const {
    const radiate::Directions directions = radiate::directions_for(degree);
    const Eigen::Vector3d origin = symmetry_.turn * about - symmetry_.shift;
    MatrixXcd fields = MatrixXcd::Zero(directions.weights.size(), 3), sent;
    std::optional<Eigen::Vector3d> sent_about;
    for (int image = 0; image < skin_.panels.image_count(); ++image) {
      // An image is heard about a point as the part is about the point's image.
      const Eigen::Vector3d turned = radiate::image_of(origin, image);
      if (!sent_about || (turned - *sent_about).norm() > 1e-9 * radius_) {
        sent = radiate::far_fields(skin_.panels, turned, k, coupling, directions, layers);
        sent_about = turned;
      }
      const std::vector<Index> from = radiate::images_of(directions, image);
      for (const Axis& axis : axes_) {
        const double sign = radiate::sign_of(axis.image_class, image);
        for (Index d = 0; d < fields.rows(); ++d) fields(d, axis.number) += sign * sent(from[d], axis.number);
      }
    }
    return radiate::harmonics_of(directions, directions.units * symmetry_.turn, fields);
  }

  // The first harmonics of all three fields, about the middle of the symmetry, at some wavenumbers: a row for each.
  [[nodiscard]] MatrixXcd samples_at(const VectorXd& wavenumbers, std::optional<int> only, int threads) const {
    constexpr int kHarmonics = 4;
    const Eigen::Vector3d middle = symmetry_.turn.transpose() * symmetry_.shift;
    MatrixXcd samples(wavenumbers.size(), 3 * kHarmonics);
    for (Index n = 0; n < wavenumbers.size(); ++n) {
      const double k = wavenumbers[n];
      const std::vector<double> coupling = radiate::coupling_of(skin_, k);
      const MatrixXcd fields =
          fields_of(layers_at(k, coupling, only, threads), k, coupling, middle, radiate::degree_for(k, radius_));
      samples.row(n) = fields.topRows(kHarmonics).reshaped().transpose();
    }
    return samples;
  }

  // P of an axis' layer at the middles of the part's triangles.
  [[nodiscard]] VectorXcd pressure_of(const VectorXcd& layer, const Axis& axis, double k,
                                      const std::vector<double>& coupling, int threads) const {
    VectorXcd pressure(skin_.panels.triangle_count());
    in_parallel(threads, [&](int thread) {
      for (int t = thread; t < skin_.panels.triangle_count(); t += threads)
        pressure[t] = radiate::pressure_at(images_, axis.image_class, t, k, coupling, layer)[0];
    });
    return pressure;
  }

  [[nodiscard]] const radiate::Skin& skin() const { return skin_; }
  [[nodiscard]] const std::array<Axis, 3>& axes() const { return axes_; }
  [[nodiscard]] double radius() const { return radius_; }

 private:
  radiate::Skin skin_;
  const radiate::Symmetry& symmetry_;
  double radius_;
  std::array<Axis, 3> axes_;
  std::vector<radiate::Panels> images_;
};

// The integrals over the walls of psi^2 and of the square of its slope along them, from values at triangles' middles.
struct OnWalls {
  double squares = 0, slopes = 0;
};

OnWalls on_walls(const radiate::Skin& skin, const VectorXcd& at, int image_class) {
  const radiate::Panels& panels = skin.panels;
  VectorXcd nodes = VectorXcd::Zero(panels.node_count());
  VectorXd weights = VectorXd::Zero(panels.node_count());
  for (int t = 0; t < panels.triangle_count(); ++t) {
    for (const int n : panels.corners[t]) {
      nodes[n] += panels.areas[t] * at[t];
      weights[n] += panels.areas[t];
    }
  }
  nodes.array() /= weights.array();
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
    double low = std::max(vessel_.lowest_hz * per_hz, kSmallest / coarse_->radius());
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

  // Flows are those of translations along the axes of the symmetry's frame.
  Result<void> make_skins() {
    symmetry_ = radiate::symmetry_of(vessel_.body.surface);
    body_ = radiate::moved(vessel_.body, symmetry_);
    body_.flow.flow = (body_.flow.areas.asDiagonal() * body_.flow.normals).cast<float>();
    body_.frequency_hz.assign(3, 1);
    const double radius =
        (vessel_.body.surface.nodes.rowwise() - vessel_.origin.transpose()).rowwise().norm().maxCoeff();
    const Result<radiate::Original> original = radiate::Original::of(body_, symmetry_.mirrors);
    if (!original) return fail(original);
    const double area = original->panels->area() / (1 << symmetry_.mirrors);
    for (const bool fine : {false, true}) {
      const double nodes = fine ? vessel_.nodes : vessel_.nodes / kCoarser;
      Result<radiate::Skin> skin = radiate::skin_of(*original, std::sqrt(area / (0.866 * nodes)));
      if (!skin) return fail(skin);
      (fine ? fine_ : coarse_).emplace(std::move(*skin), symmetry_, radius);
    }
    return {};
  }

  static bool rings(const Pole& pole) {
    return pole.at.real() > 0 && std::abs(pole.at.real()) > 2 * kMinQ * std::abs(pole.at.imag()) &&
           pole.strength > kMinStrength;
  }

  // The real parts of the poles that ring, ascending, by the coarser skin.
  [[nodiscard]] std::vector<double> poles_between(double low, double high) const {
    VectorXd wavenumbers(kSearched);
    for (int n = 0; n < kSearched; ++n) wavenumbers[n] = low * std::pow(high / low, n / (kSearched - 1.0));
    std::vector<double> found;
    for (const Pole& pole : poles_of(wavenumbers, coarse_->samples_at(wavenumbers, {}, threads_), kTolerance)) {
      if (rings(pole) && pole.at.real() >= low && pole.at.real() < high) found.push_back(pole.at.real());
    }
    std::ranges::sort(found);
    return found;
  }

  // The pole next to a guess, by wavenumbers on both sides of it; with a class, by motions of that class alone.
  [[nodiscard]] std::optional<Complex> pole_near(const Translations& on, double guess, std::optional<int> only) const {
    constexpr double kNear = 0.08;
    VectorXd wavenumbers(static_cast<Index>(kBeside.size()));
    for (std::size_t n = 0; n < kBeside.size(); ++n) wavenumbers[static_cast<Index>(n)] = guess * (1 + kBeside[n]);
    std::optional<Complex> nearest;
    for (const Pole& pole : poles_of(wavenumbers, on.samples_at(wavenumbers, only, threads_), kTolerance)) {
      if (!rings(pole) || std::abs(pole.at - guess) > kNear * guess) continue;
      if (!nearest || std::abs(pole.at - guess) < std::abs(*nearest - guess)) nearest = pole.at;
    }
    return nearest;
  }

  // Nothing where two wavenumbers on the sides of the guess see no pole: it came from rounding.
  [[nodiscard]] std::optional<AirMode> mode_at(double guess) const {
    const auto coarse = pole_near(*coarse_, guess, {});
    if (!coarse) return std::nullopt;
    const auto [rough, image_class] = shape_of(*coarse_, *coarse, {});
    const auto fine = pole_near(*fine_, coarse->real(), image_class);
    if (!fine) return std::nullopt;
    const double step = kExtrapolation * (fine->real() - coarse->real()), kappa = fine->real() + step;
    AirMode mode = shape_of(*fine_, *fine, image_class).mode;
    const double loss = 1 / mode.wall_q;
    mode.wall_q = 1 / (loss + kExtrapolation * (loss - 1 / rough.wall_q));
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
  [[nodiscard]] Shape shape_of(const Translations& on, Complex pole, std::optional<int> only) const {
    struct Beside {
      std::vector<double> coupling;
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
      here.coupling = radiate::coupling_of(on.skin(), here.k);
      here.layers = on.layers_at(here.k, here.coupling, only, threads_);
      rise += (side == 0 ? 1.0 : -1.0) / (pole * pole - here.k * here.k);
    }
    const auto field_steps = [&](const Eigen::Vector3d& about) -> MatrixXcd {
      const auto at = [&](const Beside& here) {
        return on.fields_of(here.layers, here.k, here.coupling, about, degree);
      };
      return at(beside[0]) - at(beside[1]);
    };
    const MatrixXcd fields = field_steps(vessel_.origin);
    const Axis axis =
        *std::ranges::max_element(on.axes(), {}, [&](const Axis& one) { return fields.col(one.number).norm(); });
    const auto pressure = [&](const Beside& here) {
      return on.pressure_of(here.layers.col(axis.number), axis, here.k, here.coupling, threads_);
    };
    const VectorXcd step = pressure(beside[0]) - pressure(beside[1]);
    const radiate::Panels& panels = on.skin().panels;
    Complex driven = 0;  // integral of P q
    for (int t = 0; t < panels.triangle_count(); ++t)
      driven += static_cast<double>(panels.image_count()) * panels.areas[t] * panels.normals[t][axis.number] * step[t];
    const Complex c = std::sqrt(driven / rise);
    const OnWalls walls = on_walls(on.skin(), step / (c * rise), axis.image_class);
    const tube::WallLayers layers = tube::wall_layers(air_, kappa * air_.sound_speed_m_s);
    AirMode mode;
    mode.wall_q = 1 / (layers.viscous_m / (2 * kappa * kappa) * walls.slopes +
                       (tube::kHeatRatio - 1) * layers.thermal_m / 2 * walls.squares);
    // A velocity potential psi / (kappa sqrt(rho)) has a kinetic energy of 1/2 at a modal velocity of 1.
    const Complex unit = 1.0 / (c * rise * kappa * std::sqrt(air_.density_kg_m3));
    const VectorXcd field = unit * fields.col(axis.number);
    mode.field.assign(field.begin(), field.end());
    // A simple source of flux 1 has F = 1/(4 pi), and so a first harmonic of 1/sqrt(4 pi).
    mode.flux = std::sqrt(4 * kPi) * std::abs(unit * field_steps(vessel_.mouth)(0, axis.number));
    return {std::move(mode), axis.image_class};
  }

  const Vessel& vessel_;
  const modal::Air& air_;
  const Progress& progress_;
  const int threads_;
  radiate::Symmetry symmetry_;
  radiate::Body body_;
  std::optional<Translations> coarse_, fine_;
};

}  // namespace

Result<std::vector<AirMode>> air_modes(const Vessel& vessel, const modal::Air& air, const Progress& progress) {
  const dense::BlasThreads one(1);
  return Finder(vessel, air, progress).find();
}

}  // namespace ringdown::cavity
