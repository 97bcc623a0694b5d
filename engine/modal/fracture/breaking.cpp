#include "engine/modal/fracture/breaking.h"

#include "engine/base/rotation.h"
#include "engine/modal/hearing/contact_pulse.h"

#include <algorithm>
#include <cassert>
#include <cmath>

// The break in numbers
//
// Amplitudes are scaled to energies: alpha_j = w_j q_j - i q'_j, so that the energy of a mode is |alpha_j|^2 / 2 with
// any damping. Then zeta_k = w_k r_k - i r'_k of the piece is
//
//   zeta_k = sum_j P_kj / 2 [ (w_k/w_j + 1) G(w_k - w_j) alpha_j + (w_k/w_j - 1) G(w_k + w_j) conj(alpha_j) ]
//
// which is one product with the real parts and one with the imaginary parts; a rigid motion has only the second. At
// G = 1 this is r_k = sum P_kj q_j and r'_k = sum P_kj q'_j. The formula holds for modes without damping; the decay
// during a crack of some 50 us is left out, but damped amplitudes are converted exactly.
//
// The first six columns of P are not needed: the body's rigid motion gives rigid motions of the pieces alone, those of
// the points of a rigid body.
namespace ringdown::modal {
namespace {

using BodyAxes = std::array<Vec3, 3>;
using ComplexAmplitude = std::complex<double>;

constexpr std::size_t kLanes = 8;

BodyAxes principal_axes(const MassProperties& mass) {
  const Rotation rotation = Rotation::from_xyzw(mass.orientation);
  return {rotated(rotation, {1, 0, 0}), rotated(rotation, {0, 1, 0}), rotated(rotation, {0, 0, 1})};
}

std::array<double, 3> moments_of(const MassProperties& mass) {
  return {mass.inertia_kg_m2.x, mass.inertia_kg_m2.y, mass.inertia_kg_m2.z};
}

[[maybe_unused]] bool is_solid(const MassProperties& mass) {
  const Vec3& inertia = mass.inertia_kg_m2;
  return mass.mass_kg > 0 && inertia.x > 0 && inertia.y > 0 && inertia.z > 0;
}

// Returns the tensor of inertia about the centre of mass, along the axes of the object's frame.
Matrix3 inertia_tensor(const MassProperties& mass) {
  Matrix3 tensor{};
  const BodyAxes axes = principal_axes(mass);
  const std::array<double, 3> moments = moments_of(mass);
  for (std::size_t a = 0; a < 3; ++a) {
    const std::array<double, 3> axis = {axes[a].x, axes[a].y, axes[a].z};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) tensor[i][j] += moments[a] * axis[i] * axis[j];
    }
  }
  return tensor;
}

double undamped_omega(const DampedMode& mode) { return std::sqrt(undamped_lambda(mode)); }

// The sum of products, in eight sums side by side, which the compiler keeps in vector registers. The length is a
// multiple of eight.
template <class Real>
Real inner_product(const Real* a, const Real* b, std::size_t length) {
  std::array<Real, kLanes> sums{};
  for (std::size_t i = 0; i < length; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += a[i + lane] * b[i + lane];
  }
  return ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
}

}  // namespace

template <class Real>
BasicBreaking<Real>::BasicBreaking(std::span<const DampedMode> modes, const MassProperties& mass,
                                   std::span<const BasicPiece<Real>> pieces, double crack_time_s)
    : modes_(modes.begin(), modes.end()),
      mass_(mass),
      crack_time_s_(crack_time_s),
      width_((modes.size() + kLanes - 1) / kLanes * kLanes) {
  assert(is_solid(mass) && crack_time_s >= 0);
  for (const BasicPiece<Real>& piece : pieces) {
    Part& part = parts_.emplace_back();
    part.mass = piece.mass;
    part.modes = piece.modes;
    fill(part, piece);
  }
}

template <class Real>
void BasicBreaking<Real>::fill(Part& part, const BasicPiece<Real>& piece) const {
  const BasicHandover<Real>& p = piece.handover;
  const std::size_t own = piece.modes.size();
  assert(is_solid(piece.mass) && piece.delay_s >= 0);
  assert(p.rows == kRigidMotions + own && p.columns == kRigidMotions + modes_.size());
  assert(p.values.size() == p.rows * p.columns);
  part.real.assign(own * width_, 0);
  part.imaginary.assign(p.rows * width_, 0);
  for (std::size_t j = 0; j < modes_.size(); ++j) {
    const ComplexAmplitude exponent{-modes_[j].decay_per_s, hz_to_rad_per_s(modes_[j].frequency_hz)};
    if (piece.delay_s > 0) part.turns.emplace_back(std::exp(exponent * piece.delay_s));
    if (modes_[j].frequency_hz <= 0) continue;
    const double omega_j = undamped_omega(modes_[j]);
    const auto slowed = [&](double omega) { return pulse_spectrum(rad_per_s_to_hz(std::abs(omega)), crack_time_s_); };
    for (std::size_t k = 0; k < kRigidMotions; ++k) {
      part.imaginary[k * width_ + j] =
          static_cast<Real>(static_cast<double>(p.at(k, kRigidMotions + j)) * slowed(omega_j));
    }
    for (std::size_t k = 0; k < own; ++k) {
      if (piece.modes[k].frequency_hz <= 0) continue;
      const double omega_k = undamped_omega(piece.modes[k]), ratio = omega_k / omega_j;
      const double half = static_cast<double>(p.at(kRigidMotions + k, kRigidMotions + j)) / 2;
      const double along = (ratio + 1) * slowed(omega_k - omega_j), against = (ratio - 1) * slowed(omega_k + omega_j);
      part.real[k * width_ + j] = static_cast<Real>(half * (along + against));
      part.imaginary[(kRigidMotions + k) * width_ + j] = static_cast<Real>(half * (along - against));
    }
  }
}

// Returns real and imaginary parts of alpha_j, after the delay of a part if one is given.
template <class Real>
std::array<std::vector<Real>, 2> BasicBreaking<Real>::scaled_amplitudes(const ModalState& body,
                                                                        const Part* turned) const {
  std::array<std::vector<Real>, 2> parts = {std::vector<Real>(width_), std::vector<Real>(width_)};
  for (std::size_t j = 0; j < modes_.size(); ++j) {
    ComplexAmplitude a = body.amplitudes[j];
    if (turned != nullptr) a *= ComplexAmplitude(turned->turns[j]);
    const ModeMotion motion = motion_of(modes_[j], a);
    parts[0][j] = static_cast<Real>(undamped_omega(modes_[j]) * motion.coordinate);
    parts[1][j] = static_cast<Real>(-motion.velocity);
  }
  return parts;
}

// Takes a rigid motion of all pieces together away from them, such that no momentum is left.
template <class Real>
void BasicBreaking<Real>::remove_momentum(std::span<PieceMotion> pieces) const {
  double mass_kg = 0;
  Vec3 centre, momentum, angular;
  for (std::size_t s = 0; s < parts_.size(); ++s) {
    const MassProperties& piece = parts_[s].mass;
    mass_kg += piece.mass_kg;
    centre = centre + piece.mass_kg * piece.center_of_mass_m;
    momentum = momentum + piece.mass_kg * pieces[s].velocity_m_s;
  }
  centre = (1 / mass_kg) * centre;
  Matrix3 whole{};
  for (std::size_t s = 0; s < parts_.size(); ++s) {
    const MassProperties& piece = parts_[s].mass;
    const Vec3 arm = piece.center_of_mass_m - centre;
    const Matrix3 tensor = inertia_tensor(piece);
    angular = angular + tensor * pieces[s].spin_rad_s + piece.mass_kg * cross(arm, pieces[s].velocity_m_s);
    const std::array<double, 3> r = {arm.x, arm.y, arm.z};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        whole[i][j] += tensor[i][j] + piece.mass_kg * ((i == j ? dot(arm, arm) : 0) - r[i] * r[j]);
    }
  }
  const Vec3 velocity = (1 / mass_kg) * momentum, spin = inverse(whole) * angular;
  for (std::size_t s = 0; s < parts_.size(); ++s) {
    const Vec3 arm = parts_[s].mass.center_of_mass_m - centre;
    pieces[s].velocity_m_s = pieces[s].velocity_m_s - velocity - cross(spin, arm);
    pieces[s].spin_rad_s = pieces[s].spin_rad_s - spin;
  }
}

template <class Real>
Broken BasicBreaking<Real>::operator()(const ModalState& body, double crack_energy_j) const {
  assert(body.amplitudes.size() == modes_.size() && crack_energy_j >= 0);
  Broken broken{.pieces = std::vector<PieceMotion>(parts_.size()), .before_j = modal_energy(body).total_j()};
  const std::array<std::vector<Real>, 2> at_once = scaled_amplitudes(body, nullptr);
  // First the rest of the motion. Rigid velocities are those at the break, for all pieces at one time, because only
  // then they have no momentum.
  for (std::size_t s = 0; s < parts_.size(); ++s) {
    const Part& part = parts_[s];
    const BodyAxes axes = principal_axes(part.mass);
    const std::array<double, 3> moments = moments_of(part.mass);
    std::array<double, kRigidMotions> row{};
    for (std::size_t k = 0; k < kRigidMotions; ++k)
      row[k] = -static_cast<double>(inner_product(&part.imaginary[k * width_], at_once[1].data(), width_));
    PieceMotion& piece = broken.pieces[s];
    piece.velocity_m_s = (1 / std::sqrt(part.mass.mass_kg)) * Vec3{row[0], row[1], row[2]};
    for (std::size_t a = 0; a < 3; ++a)
      piece.spin_rad_s = piece.spin_rad_s + (row[3 + a] / std::sqrt(moments[a])) * axes[a];
    const std::array<std::vector<Real>, 2> late =
        part.turns.empty() ? std::array<std::vector<Real>, 2>{} : scaled_amplitudes(body, &part);
    const auto& [real, imaginary] = part.turns.empty() ? at_once : late;
    for (std::size_t k = 0; k < part.modes.size(); ++k) {
      const double re = static_cast<double>(inner_product(&part.real[k * width_], real.data(), width_));
      const double im =
          static_cast<double>(inner_product(&part.imaginary[(kRigidMotions + k) * width_], imaginary.data(), width_));
      broken.ringing_j += (re * re + im * im) / 2;
      piece.amplitudes.push_back(
          part.modes[k].frequency_hz <= 0
              ? 0
              : amplitude_of(part.modes[k], {.coordinate = re / undamped_omega(part.modes[k]), .velocity = -im}));
    }
  }
  remove_momentum(broken.pieces);
  for (std::size_t s = 0; s < parts_.size(); ++s) {
    broken.flight_j += rigid_energy_j(parts_[s].mass, broken.pieces[s].velocity_m_s, broken.pieces[s].spin_rad_s);
  }
  broken.crack_j = std::min(crack_energy_j, broken.before_j);
  const double after_j = broken.flight_j + broken.ringing_j;
  if (after_j > broken.before_j) broken.limit = broken.before_j / after_j;
  const double left = broken.before_j > 0 ? broken.limit * (1 - broken.crack_j / broken.before_j) : 0;
  broken.flight_j *= left;
  broken.ringing_j *= left;
  for (std::size_t s = 0; s < parts_.size(); ++s) {
    PieceMotion& piece = broken.pieces[s];
    for (ComplexAmplitude& z : piece.amplitudes) z *= std::sqrt(left);
    const Vec3 arm = parts_[s].mass.center_of_mass_m - mass_.center_of_mass_m;
    piece.velocity_m_s = std::sqrt(left) * piece.velocity_m_s + body.velocity_m_s + cross(body.spin_rad_s, arm);
    piece.spin_rad_s = std::sqrt(left) * piece.spin_rad_s + body.spin_rad_s;
  }
  return broken;
}

template class BasicBreaking<float>;
template class BasicBreaking<double>;

}  // namespace ringdown::modal
