#include "engine/bake/tubes/tubes.h"

#include "engine/modal/losses.h"
#include "engine/tube/coupled.h"
#include "engine/tube/line.h"
#include "engine/tube/mouth.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <utility>

namespace ringdown::bake {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr int kMaxPartials = 3;      // of a tube
constexpr double kMaxKa = 1;         // above it the air in the mouth is no piston
constexpr double kSameMode = 1e-7;   // share of others below which a mode stays as it was
constexpr double kMinMotion = 0.02;  // of a body's mode, in a tube's higher mode; with less it is left out
constexpr double kMinTerm = 1e-4;    // of a field, as in the radiation of bodies
constexpr double kDbPerNeper = 8.685889638;

// One mode of a tube before it is coupled.
struct Partial {
  tube::TubeMode mode;
  VectorXcd bond;   // of the heard modes [rad/s], with the signs that shapes have in a bank
  VectorXcd field;  // of a tube mode of amplitude 1, in harmonics [m^2 kg^-1/2]
  double frequency_error = 0, bond_error = 0;
  bool lowest = false;  // of its tube
};

VectorXcd dense_terms(const modal::FarField& field, Index size) {
  VectorXcd dense = VectorXcd::Zero(size);
  for (const modal::FarField::Term& term : field.terms) {
    if (term.harmonic < size) dense[term.harmonic] = Complex(term.value);
  }
  return dense;
}

// The major axis of the ellipse that a field's values form, from -90 to 90 degrees, as in modal::DirectionMap.
double phase_of(const VectorXcd& values) { return 0.5 * std::arg((values.transpose() * values).value()); }

class Coupler {
 public:
  Coupler(const RadiatingBody& body, const modal::Air& air, const Vec3& origin_m, double band_high_hz, BodyModes& modes,
          std::vector<HeardMode>& heard)
      : body_(body), air_(air), band_high_hz_(band_high_hz), modes_(modes), heard_(heard) {
    const double length = body.units.length_m;
    origin_ = Eigen::Vector3d(origin_m.x, origin_m.y, origin_m.z) / length;
    std::vector<double> waves;
    for (const HeardMode& mode : heard) waves.push_back(std::sqrt(mode.lambda) * length / air.sound_speed_m_s);
    vibrating_ = radiating_surface(body, waves, heard);
  }

  Result<modal::ResonatorNote> add(const Resonator& resonator, const Progress& progress) {
    const double length = body_.units.length_m;
    tube::Line line{resonator.radius_m, resonator.length_m.value_or(0), resonator.stopped};
    double wanted_rad_s = 0;
    if (!resonator.length_m) {
      const Result<double> tuned = wanted_frequency(resonator);
      if (!tuned) return fail(tuned);
      wanted_rad_s = *tuned;
    }
    const double first =
        resonator.length_m ? tube::partial_rad_s(line, tube::kFreeEnd * line.radius_m, air_, 0) : wanted_rad_s;
    const auto at = [&](const Vec3& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
    const double shown = resonator.length_m.value_or(std::numbers::pi * air_.sound_speed_m_s / (2 * first));
    const Result<tube::Mouth> mouth = tube::Mouth::of(
        vibrating_,
        {at(resonator.mouth_m) / length, at(resonator.axis).normalized(), line.radius_m / length, shown / length});
    if (!mouth) return fail(mouth);
    modal::ResonatorNote note;
    double guess = first;
    for (int n = 0; n < kMaxPartials; ++n) {
      const double k = guess / air_.sound_speed_m_s;
      if (n > 0 && (k * line.radius_m > kMaxKa || modal::rad_per_s_to_hz(guess) > band_high_hz_)) break;
      if (progress && !progress("tubes", static_cast<double>(n) / kMaxPartials)) return fail_cancelled();
      tube::MouthAnswer answer = mouth->at(k * length, origin_);
      answer.outside.end_m *= length;
      answer.outside.wavenumber_rad_m = k;
      if (n == 0 && !resonator.length_m) {
        const auto tuned = tube::length_for(line, answer.outside, air_, 0, wanted_rad_s);
        if (!tuned) return fail(ErrorKind::bad_input, too_wide(line, wanted_rad_s));
        line.length_m = *tuned;
      }
      const auto mode = tube::tube_mode(line, answer.outside, air_, guess);
      if (!mode && n == 0) return fail(ErrorKind::bad_input, too_wide(line, guess));
      if (!mode) break;
      partials_.push_back(partial_of(*mode, answer, line, length));
      partials_.back().lowest = n == 0;
      if (n == 0) note = note_of(resonator, line, answer.outside, *mode);
      guess = tube::partial_rad_s(line, -answer.outside.end_m.real(), air_, n + 1);
    }
    return note;
  }

  // Puts the modes of body and tubes in the place of the body's.
  void couple() {
    const auto bars = static_cast<Index>(heard_.size()), tubes = static_cast<Index>(partials_.size());
    tube::Oscillators oscillators{VectorXcd(bars), VectorXcd(tubes), Eigen::MatrixXcd(bars, tubes)};
    for (Index j = 0; j < bars; ++j) {
      const modal::DampedMode& mode = heard_[j].mode;
      oscillators.bar[j] = Complex(modal::hz_to_rad_per_s(mode.frequency_hz), -mode.decay_per_s);
    }
    for (Index t = 0; t < tubes; ++t) {
      oscillators.tube[t] = partials_[t].mode.omega_rad_s;
      oscillators.bond.col(t) = partials_[t].bond;
    }
    const tube::CoupledModes coupled = tube::coupled_modes(oscillators);
    Index terms = 1;
    for (const HeardMode& mode : heard_) {
      if (!mode.field.terms.empty()) terms = std::max<Index>(terms, mode.field.terms.back().harmonic + 1);
    }
    for (const Partial& partial : partials_) terms = std::max(terms, partial.field.size());
    const Eigen::MatrixXd shapes = shapes_of(heard_, modes_);
    std::vector<HeardMode> changed;
    modes_.shapes.conservativeResize(Eigen::NoChange, modes_.shapes.cols() + tubes);
    modes_.shapes.rightCols(tubes).setZero();
    for (Index n = 0; n < bars + tubes; ++n) {
      const VectorXcd mix = coupled.mixing.col(n);
      if (n < bars && mix.cwiseAbs2().sum() - std::norm(mix[n]) < kSameMode * kSameMode &&
          std::abs(coupled.omega_rad_s[n] - oscillators.bar[n]) < kSameMode * std::abs(oscillators.bar[n])) {
        changed.push_back(heard_[n]);
        continue;
      }
      if (n >= bars && !partials_[n - bars].lowest && mix.head(bars).cwiseAbs().maxCoeff() < kMinMotion) continue;
      changed.push_back(mixed(n, coupled.omega_rad_s[n], mix, shapes, terms, changed));
    }
    heard_ = std::move(changed);
  }

 private:
  [[nodiscard]] Result<double> wanted_frequency(const Resonator& resonator) const {
    const double detune = std::exp2(resonator.detune_cents / 1200);
    if (resonator.tuned_hz) return modal::hz_to_rad_per_s(detune * *resonator.tuned_hz);
    std::vector<double> sorted;
    for (const HeardMode& mode : heard_) sorted.push_back(mode.mode.frequency_hz);
    std::ranges::sort(sorted);
    const auto number = static_cast<std::size_t>(resonator.tuned_mode);
    if (number > sorted.size())
      return fail(ErrorKind::bad_input, "a resonator is tuned to mode " + std::to_string(number) + " of " +
                                            std::to_string(sorted.size()) + " in the band");
    return modal::hz_to_rad_per_s(detune * sorted[number - 1]);
  }

  static std::string too_wide(const tube::Line& line, double omega_rad_s) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "a tube of %.3g m across cannot be tuned to %.4g Hz; it would be shorter than its radius",
                  2 * line.radius_m, modal::rad_per_s_to_hz(omega_rad_s));
    return text;
  }

  [[nodiscard]] Partial partial_of(const tube::TubeMode& mode, const tube::MouthAnswer& answer, const tube::Line& line,
                                   double length) const {
    const auto bars = static_cast<Index>(heard_.size());
    const double area = std::numbers::pi * line.radius_m * line.radius_m;
    Partial partial{.mode = mode, .bond = VectorXcd(bars), .field = {}};
    const double omega_t = mode.omega_rad_s.real();
    const double per_unit = 1 / std::sqrt(body_.units.density_kg_m3 * length);
    for (Index j = 0; j < bars; ++j) {
      const double omega_j = modal::hz_to_rad_per_s(heard_[j].mode.frequency_hz);
      const double sign = sign_of(modes_.shapes.col(heard_[j].number));
      partial.bond[j] = sign * per_unit * answer.from_body[j] *
                        std::sqrt(air_.density_kg_m3 * area * omega_j * omega_t / (2.0 * mode.reach_m));
    }
    partial.field = Eigen::Map<const VectorXcd>(answer.field.data(), static_cast<Index>(answer.field.size())) *
                    (length * length * std::sqrt(2.0 / (air_.density_kg_m3 * area * mode.reach_m)));
    partial.frequency_error = answer.end_error_m * length / std::abs(mode.reach_m);
    partial.bond_error = answer.bond_error;
    return partial;
  }

  [[nodiscard]] modal::ResonatorNote note_of(const Resonator& resonator, const tube::Line& line,
                                             const tube::Outside& outside, const tube::TubeMode& mode) const {
    return {.diameter_m = 2 * line.radius_m,
            .length_m = line.length_m,
            .mouth_m = resonator.mouth_m,
            .axis = resonator.axis,
            .stopped = resonator.stopped,
            .frequency_hz = modal::rad_per_s_to_hz(mode.omega_rad_s.real()),
            .decay_per_s = -mode.omega_rad_s.imag(),
            .end_correction_m = -outside.end_m.real()};
  }

  // Mode n of body and tubes, with its shape in column `number` of the body's modes.
  HeardMode mixed(Index n, Complex omega, const VectorXcd& mix, const Eigen::MatrixXd& shapes, Index terms,
                  const std::vector<HeardMode>& before) {
    const auto bars = static_cast<Index>(heard_.size());
    const VectorXcd own = mix.head(bars);
    Index partner = 0;
    own.cwiseAbs().maxCoeff(&partner);
    const bool of_tube = n >= bars;
    HeardMode mode = heard_[of_tube ? partner : n];
    mode.lambda = std::norm(omega);
    mode.mode = {modal::rad_per_s_to_hz(omega.real()), -omega.imag()};
    const double k = omega.real() / air_.sound_speed_m_s;
    const Complex turn = std::polar(1.0, phase_of(own));
    VectorXd shape = (shapes * (own / turn)).real();
    VectorXcd field = VectorXcd::Zero(terms);
    for (Index j = 0; j < bars; ++j) {
      if (heard_[j].field.terms.empty()) continue;
      field += own[j] * modal::level_ratio(heard_[j].field, k) * dense_terms(heard_[j].field, terms);
    }
    for (std::size_t t = 0; t < partials_.size(); ++t)
      field.head(partials_[t].field.size()) += mix[bars + static_cast<Index>(t)] * partials_[t].field;
    field *= turn;
    if (of_tube) oppose(before[partner].field, shape, field);
    set_losses(mix, n, of_tube, partner, mode);
    set_field(field, k, of_tube, mode);
    set_errors(mix, mode);
    if (of_tube) mode.number = modes_.shapes.cols() - static_cast<Index>(partials_.size()) + (n - bars);
    modes_.shapes.col(mode.number) = shape;
    mode.turned = sign_of(shape) < 0;
    return mode;
  }

  // Turns a tube mode's field to its own phase, and gives the shape the sign that it has beside its partner, which the
  // mixer hears at the partner's own phase.
  static void oppose(const modal::FarField& partner, VectorXd& shape, VectorXcd& field) {
    const VectorXcd beside = dense_terms(partner, field.size());
    const double phase = phase_of(beside);
    field *= std::polar(1.0, -phase);
    field *= std::polar(1.0, -phase_of(field));
    if (((beside * std::polar(1.0, -phase)).adjoint() * field).value().real() >= 0) return;
    field = -field;
    shape = -shape;
  }

  // Each oscillator takes its own decay times its share of the energy; the tube's walls and what its mouth radiates
  // count as air.
  void set_losses(const VectorXcd& mix, Index n, bool of_tube, Index partner, HeardMode& mode) const {
    const double all = mix.squaredNorm();
    modal::ModeLoss loss;
    double shares = 0;
    for (std::size_t j = 0; j < heard_.size(); ++j) {
      const double share = std::norm(mix[static_cast<Index>(j)]) / all;
      shares += share;
      loss.material_per_s += share * heard_[j].loss.material_per_s;
      loss.support_per_s += share * heard_[j].loss.support_per_s;
      loss.heat_per_s += share * heard_[j].loss.heat_per_s;
    }
    const double rest = mode.mode.decay_per_s - loss.total_per_s();
    if (rest < 0) {  // by rounding
      const double less = mode.mode.decay_per_s / loss.total_per_s();
      loss.material_per_s *= less, loss.support_per_s *= less, loss.heat_per_s *= less;
    }
    loss.air_per_s = std::max(rest, 0.0);
    mode.loss = loss;
    mode.heat = modal::multiplied(heard_[of_tube ? partner : n].heat, shares, 1);
  }

  static void set_field(const VectorXcd& field, double k, bool of_tube, HeardMode& mode) {
    const double before = modal::rms(mode.field);
    mode.field.wavenumber_rad_m = k;
    mode.field.unit = 0;
    mode.field.terms = modal::terms_of(std::span(field.data(), static_cast<std::size_t>(field.size())), kMinTerm);
    const double ratio = before > 0 ? modal::rms(mode.field) / before : 0;
    if (of_tube || !(ratio > 0)) mode.field.levels.clear();
    for (modal::FarField::Level& level : mode.field.levels) level.rms = static_cast<float>(level.rms * ratio);
  }

  void set_errors(const VectorXcd& mix, HeardMode& mode) const {
    const auto bars = static_cast<Index>(heard_.size());
    double frequency = 0, of_frequency = 0, bond = 0;
    for (Index j = 0; j < bars; ++j)
      frequency = std::max(frequency, std::norm(mix[j]) / mix.squaredNorm() * heard_[j].frequency_error);
    for (std::size_t t = 0; t < partials_.size(); ++t) {
      const double share = std::norm(mix[bars + static_cast<Index>(t)]) / mix.squaredNorm();
      of_frequency = std::max(of_frequency, share * partials_[t].frequency_error);
      if (share > 1e-6) bond = std::max(bond, partials_[t].bond_error);
    }
    mode.frequency_error = frequency + of_frequency;
    if (kDbPerNeper * bond <= mode.radiation_error_db) return;
    mode.radiation_error_db = kDbPerNeper * bond;
    if (mode.radiation_error_db > 0.5) mode.radiation_doubt = "a coarser surface gives the tube another pull";
  }

  const RadiatingBody& body_;
  const modal::Air& air_;
  const double band_high_hz_;
  BodyModes& modes_;
  std::vector<HeardMode>& heard_;
  Eigen::Vector3d origin_;
  radiate::Body vibrating_;
  std::vector<Partial> partials_;
};

}  // namespace

Result<std::vector<modal::ResonatorNote>> add_tubes(const RadiatingBody& body, const std::vector<Resonator>& resonators,
                                                    const modal::Air& air, const Vec3& origin_m, double band_high_hz,
                                                    BodyModes& modes, std::vector<HeardMode>& heard,
                                                    const Progress& progress) {
  Coupler coupler(body, air, origin_m, band_high_hz, modes, heard);
  std::vector<modal::ResonatorNote> notes;
  for (const Resonator& resonator : resonators) {
    Result<modal::ResonatorNote> note = coupler.add(resonator, progress);
    if (!note) return fail(note);
    notes.push_back(*note);
  }
  coupler.couple();
  return notes;
}

}  // namespace ringdown::bake
