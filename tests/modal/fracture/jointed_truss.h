// A small body of known pieces: point masses joined by springs, in three trusses that share some of their points.
//
// A shared point has a part of its mass in each truss. When the body breaks each truss takes its part along, as in a
// finite-element mesh that is cut between elements, so no spring and no mass is lost.
#pragma once

#include "engine/dense/decompositions.h"
#include "engine/modal/fracture/breaking.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace ringdown::test {

// Points with masses and springs, and all of its motions.
struct Truss {
  std::vector<int> points;    // numbers in the whole body
  Eigen::MatrixXd places;     // n x 3 [m]
  Eigen::VectorXd masses;     // n [kg]
  Eigen::MatrixXd stiffness;  // 3n x 3n [N/m]
  modal::MassProperties mass;
  Eigen::MatrixXd motions;               // 3n x 3n: six rigid ones and all elastic ones, mass-normalised
  std::vector<modal::DampedMode> modes;  // 3n - 6
};

inline Vec3 vec3(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
inline Eigen::Vector3d eigen(const Vec3& v) { return {v.x, v.y, v.z}; }

inline Eigen::VectorXd unknown_masses(const Truss& truss) {
  Eigen::VectorXd all(3 * truss.masses.size());
  for (Eigen::Index i = 0; i < all.size(); ++i) all[i] = truss.masses[i / 3];
  return all;
}

// Fills mass, motions and modes from the rest. Every elastic mode has the damping ratio `damping`.
inline void solve(Truss& truss, double damping) {
  const Eigen::Index n = truss.masses.size();
  const double total = truss.masses.sum();
  const Eigen::Vector3d centre = truss.places.transpose() * truss.masses / total;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (Eigen::Index p = 0; p < n; ++p) {
    const Eigen::Vector3d arm = truss.places.row(p).transpose() - centre;
    inertia += truss.masses[p] * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  }
  dense::Spectrum3 principal = dense::spectrum_of_3(inertia);
  if (principal.vectors.determinant() < 0) principal.vectors.col(2) *= -1;
  const Eigen::Quaterniond turn(principal.vectors);
  truss.mass = {.mass_kg = total,
                .center_of_mass_m = vec3(centre),
                .inertia_kg_m2 = vec3(principal.values),
                .orientation = {turn.x(), turn.y(), turn.z(), turn.w()}};
  const Eigen::VectorXd masses = unknown_masses(truss);
  const dense::Spectrum spectrum = *dense::generalized_spectrum(truss.stiffness, masses.asDiagonal());
  truss.motions = spectrum.vectors;
  truss.modes.clear();
  for (int i = 0; i < 3; ++i) {
    for (Eigen::Index p = 0; p < n; ++p) {
      const Eigen::Vector3d axis = principal.vectors.col(i), arm = truss.places.row(p).transpose() - centre;
      truss.motions.col(i).segment<3>(3 * p) = Eigen::Vector3d::Unit(i) / std::sqrt(total);
      truss.motions.col(3 + i).segment<3>(3 * p) = axis.cross(arm) / std::sqrt(principal.values[i]);
    }
  }
  for (Eigen::Index k = 6; k < 3 * n; ++k) {
    const double omega = std::sqrt(spectrum.values[k]);
    truss.modes.push_back({omega * std::sqrt(1 - damping * damping) / (2 * std::numbers::pi), damping * omega});
  }
}

struct JointedTruss {
  Truss whole;
  std::vector<Truss> pieces;
};

// Three pieces of seven points each; neighbours share three points.
inline JointedTruss jointed_truss(unsigned seed, double damping = 0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(0, 1);
  JointedTruss body;
  constexpr int kPoints = 15;
  body.whole.places.resize(kPoints, 3);
  for (int p = 0; p < kPoints; ++p) {
    body.whole.points.push_back(p);
    body.whole.places.row(p) << 0.03 * p + 0.05 * number(random), 0.2 * number(random), 0.1 * number(random);
  }
  body.whole.masses = Eigen::VectorXd::Zero(kPoints);
  body.whole.stiffness = Eigen::MatrixXd::Zero(3 * kPoints, 3 * kPoints);
  for (int s = 0; s < 3; ++s) {
    Truss& piece = body.pieces.emplace_back();
    const int count = 7;
    for (int i = 0; i < count; ++i) piece.points.push_back(4 * s + i);
    piece.places = body.whole.places(piece.points, Eigen::all);
    piece.masses.resize(count);
    for (double& mass : piece.masses) mass = 0.01 + 0.04 * number(random);
    piece.stiffness = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    for (int a = 0; a < count; ++a) {
      for (int b = a + 1; b < count; ++b) {
        const Eigen::Vector3d along = (piece.places.row(a) - piece.places.row(b)).normalized();
        const Eigen::Matrix3d spring = 1e6 * (0.2 + number(random)) * along * along.transpose();
        piece.stiffness.block<3, 3>(3 * a, 3 * a) += spring;
        piece.stiffness.block<3, 3>(3 * b, 3 * b) += spring;
        piece.stiffness.block<3, 3>(3 * a, 3 * b) -= spring;
        piece.stiffness.block<3, 3>(3 * b, 3 * a) -= spring;
      }
    }
    for (int a = 0; a < count; ++a) {
      body.whole.masses[piece.points[a]] += piece.masses[a];
      for (int b = 0; b < count; ++b) {
        body.whole.stiffness.block<3, 3>(3 * piece.points[a], 3 * piece.points[b]) +=
            piece.stiffness.block<3, 3>(3 * a, 3 * b);
      }
    }
    solve(piece, damping);
  }
  solve(body.whole, damping);
  return body;
}

// P between all motions.
inline Eigen::MatrixXd handover(const Truss& whole, const Truss& piece) {
  Eigen::MatrixXd there(piece.motions.rows(), whole.motions.cols());
  for (std::size_t i = 0; i < piece.points.size(); ++i) {
    there.middleRows<3>(3 * static_cast<Eigen::Index>(i)) =
        whole.motions.middleRows<3>(3 * Eigen::Index{piece.points[i]});
  }
  return piece.motions.transpose() * unknown_masses(piece).asDiagonal() * there;
}

// The pieces as they are handed over, with the lowest `piece_modes` and `body_modes` alone.
template <class Real>
std::vector<modal::BasicPiece<Real>> pieces_of(const JointedTruss& body, std::size_t piece_modes,
                                               std::size_t body_modes) {
  std::vector<modal::BasicPiece<Real>> pieces;
  for (const Truss& truss : body.pieces) {
    const std::size_t own = std::min(piece_modes, truss.modes.size());
    const Eigen::MatrixXd p = handover(body.whole, truss);
    modal::BasicPiece<Real>& piece = pieces.emplace_back();
    piece.mass = truss.mass;
    piece.modes.assign(truss.modes.begin(), truss.modes.begin() + static_cast<std::ptrdiff_t>(own));
    piece.handover.rows = 6 + own;
    piece.handover.columns = 6 + body_modes;
    for (std::size_t k = 0; k < 6 + own; ++k) {
      for (std::size_t j = 0; j < 6 + body_modes; ++j) {
        piece.handover.values.push_back(
            static_cast<Real>(p(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(j))));
      }
    }
  }
  return pieces;
}

}  // namespace ringdown::test
