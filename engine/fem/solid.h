// The material of a body, element by element. [any thread]
//
//   Solid same_everywhere = Elastic{.youngs_modulus_pa = 2e11, .poisson_ratio = 0.3, .density_kg_m3 = 7850};
//   Solid parts({steel, pine}, {0, 0, 1, ...});     // element e is of laws[law_of[e]]
//
// An anisotropic law is the 6 x 6 matrix C in the axes of the mesh: stress = C strain, both in the order 11 22 33 23 13
// 12, with engineering shear strains.
#pragma once

#include "engine/base/result.h"
#include "engine/fem/elastic.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace ringdown::fem {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct Law {
  Elastic elastic;                                     // if `stiffness_pa` is set, only the density counts
  std::optional<Matrix6> stiffness_pa = std::nullopt;  // symmetric, positive definite
};

class Solid {
 public:
  Solid(const Elastic& elastic) : laws_{Law{elastic}} {}  // NOLINT(google-explicit-constructor): one material
  Solid(std::vector<Law> laws, std::vector<std::int32_t> law_of) : laws_(std::move(laws)), law_of_(std::move(law_of)) {}

  [[nodiscard]] const Law& at(Eigen::Index element) const {
    return law_of_.empty() ? laws_.front()
                           : laws_[static_cast<std::size_t>(law_of_[static_cast<std::size_t>(element)])];
  }
  [[nodiscard]] const std::vector<Law>& laws() const { return laws_; }
  [[nodiscard]] const std::vector<std::int32_t>& law_of() const { return law_of_; }  // empty: all have the first law

 private:
  std::vector<Law> laws_;
  std::vector<std::int32_t> law_of_;
};

// Fails with one sentence when a law is not that of a stable solid.
Result<void> check_solid(const Solid& solid);

// C of an isotropic solid.
Matrix6 isotropic_stiffness(const Elastic& elastic);

// C from engineering constants, as the inverse of the compliance S (modal/orthotropy.h). The axes of C are 1 2 3. Fails
// when no stable solid has such constants.
struct EngineeringConstants {
  Eigen::Array3d youngs, poisson, shear;  // E1 E2 E3, nu12 nu13 nu23, G12 G13 G23
};
Result<Matrix6> orthotropic_stiffness(const EngineeringConstants& constants);

// The imaginary part of C, which describes the loss per cycle, to first order. E1 E2 E3 G12 G13 G23 are complex, each
// with its loss factor eta, and Poisson's ratios are real (McIntyre & Woodhouse, Acta Metallurgica 36, 1988).
Matrix6 lost_stiffness(const EngineeringConstants& constants, const Eigen::Array<double, 6, 1>& eta);

// Rotates C of a solid whose axes 1 2 3 lie along the columns of `axes` into the axes in which these columns are
// written (Bond's matrices; Auld, Acoustic Fields and Waves in Solids, section 3.D).
Matrix6 rotated(const Matrix6& stiffness, const Eigen::Matrix3d& axes);

// C as the 9 x 9 matrix that turns products of gradients into stiffness: with G = integral of g_a g_b^T, the block of
// nodes a and b is K(i, j) = sum_kl C(ik, jl) G(k, l), so that vec(K) = blocks * vec(G), columns one after the other.
using GradientToStiffness = Eigen::Matrix<double, 9, 9>;
GradientToStiffness gradient_to_stiffness(const Matrix6& stiffness);

// The position of component ij in the order 11 22 33 23 13 12.
constexpr int voigt(int i, int j) { return i == j ? i : 6 - i - j; }

}  // namespace ringdown::fem
