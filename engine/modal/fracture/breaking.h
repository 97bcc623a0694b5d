// A body that breaks: the motion of its pieces from the motion of the whole. [any]
//
// At the break, displacement and velocity of every point go on. Piece s takes over the projection of the body's motion
// on its own motions, by one matrix that is computed when body and pieces are baked:
//
//   P_kj = integral over the piece of  rho psi_k . phi_j
//
// Its columns j are six rigid motions of the body and the M modes of the body's bank; its rows k are six rigid motions
// of the piece and the K modes of the piece's bank. All motions are mass-normalised, so P has no unit and stays when
// size, density or stiffness of the body change. The six rigid motions of anything with mass m, centre c and principal
// moments I_i about the axes a_i (MassProperties) are
//
//   e_i / m^1/2   along the axes of the object's frame,   and   a_i x (x - c) / I_i^1/2.
//
// The projection contains the sudden unloading of the crack's faces: nothing must be added for it. A crack that takes
// the time T takes its traction away by a curve g(t) from 1 to 0. With G the spectrum of -g', which is a half sine
// (engine/modal/hearing/contact_pulse.h), and q_j = Re(a_j exp(i w_j t)) about the middle of the crack's opening, mode
// k of the piece then rings by
//
//   z_k = sum_j P_kj / 2 [ (1 + w_j/w_k) a_j G(w_k - w_j) + (1 - w_j/w_k) conj(a_j) G(w_k + w_j) ]
//
// with undamped angular frequencies w, and a rigid motion has the velocity sum_j P_kj q'_j G(w_j). At T = 0 both are
// the projection itself. A piece without modes only flies.
//
// Rigid velocities are taken at the break for all pieces, also for those that the crack reaches later, because only
// then do they keep the momentum.
//
// Energy. The body's rigid motion goes on in the pieces exactly. All else is the *rest*, which has no linear and no
// angular momentum; it pays for the crack and is multiplied by (1 - crack energy / energy of the rest)^1/2. The rest's
// energy never grows: modes left out take energy away. A piece that the crack reaches late takes over a state that has
// moved on since the rigid velocities were taken, which could make energy; then the rest is scaled down to the energy
// that there was.
#pragma once

#include "engine/modal/fracture/modal_state.h"

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::modal {

inline constexpr std::size_t kRigidMotions = 6;

// P of one piece. Files and programs hold floats; doubles serve where rounding is measured.
template <class Real>
struct BasicHandover {
  std::size_t rows = 0, columns = 0;  // 6 + K, 6 + M
  std::vector<Real> values;           // row after row
  [[nodiscard]] Real at(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};
using Handover = BasicHandover<float>;

template <class Real>
struct BasicPiece {
  MassProperties mass;            // in the body's frame, in size and material of the body
  std::vector<DampedMode> modes;  // K, may be 0
  BasicHandover<Real> handover;   // P
  double delay_s = 0;             // from the break until the crack reaches the piece, >= 0: distance over crack speed
};
using Piece = BasicPiece<float>;

// The motion of one piece after the break. Its amplitudes z_k [kg^1/2 m] are those at `delay_s` after the break, when
// the piece begins to ring.
struct PieceMotion {
  Vec3 velocity_m_s;  // of the piece's centre of mass, along the body's axes
  Vec3 spin_rad_s;    // along the body's axes
  std::vector<std::complex<double>> amplitudes;
};

struct Broken {
  std::vector<PieceMotion> pieces;
  double before_j = 0;   // energy of the body's modes at the break
  double crack_j = 0;    // paid for the crack: what was asked for, at most before_j
  double flight_j = 0;   // energy of the pieces' rigid motion beyond that of the body's own
  double ringing_j = 0;  // energy of the pieces' modes
  double limit = 1;      // factor on energies, below 1 where a delay would have made energy
};

// Holds all that a break needs, so that the break itself is a few products of matrices and vectors.
template <class Real>
class BasicBreaking {
 public:
  // `modes` and `mass` are those of the body. The masses of the pieces have to sum to the body's, and their moments of
  // inertia, too, or the body's rigid momentum is not kept. Every piece needs a mass and three moments above 0, and a
  // handover of its size; these are asserted. Cost: 30 ns for each number of a handover; memory: twice the handovers.
  // [worker]
  BasicBreaking(std::span<const DampedMode> modes, const MassProperties& mass, std::span<const BasicPiece<Real>> pieces,
                double crack_time_s);

  // Breaks the body in this state; the present of the state is the middle of the crack's opening. A crack energy above
  // the energy of the modes leaves pieces that only share the body's rigid motion. Linear and angular momentum are kept
  // to rounding, whatever the handovers: the momentum of their rounding is taken out. Cost: 0.12 ms for 60 pieces of 40
  // modes and a body of 100; 0.04 ms for 60 pieces of 4. Allocates the result. [any]
  [[nodiscard]] Broken operator()(const ModalState& body, double crack_energy_j) const;

  [[nodiscard]] double crack_time_s() const { return crack_time_s_; }

 private:
  struct Part {
    MassProperties mass;
    std::vector<DampedMode> modes;
    std::vector<std::complex<Real>> turns;  // M: motion during the delay; empty: no delay
    std::vector<Real> real, imaginary;      // K and 6 + K rows of width_, for real and imaginary parts
  };
  void fill(Part& part, const BasicPiece<Real>& piece) const;
  [[nodiscard]] std::array<std::vector<Real>, 2> scaled_amplitudes(const ModalState& body, const Part* turned) const;
  void remove_momentum(std::span<PieceMotion> pieces) const;

  std::vector<DampedMode> modes_;
  MassProperties mass_;
  double crack_time_s_;
  std::size_t width_;  // M, rounded up to whole lanes
  std::vector<Part> parts_;
};
using Breaking = BasicBreaking<float>;

extern template class BasicBreaking<float>;
extern template class BasicBreaking<double>;

}  // namespace ringdown::modal
