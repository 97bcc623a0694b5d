// The eigenproblem of a body with liquid, in the basis of its dry modes and of static corrections. [worker]
//
//   Result<WetBody> wet = wet_body(*plan, dry, system, clamped, units, top);    // replaces the dry modes
//
//   WetSolver solver(plan, surface, dry, system, clamped, top);                 // the same by steps:
//   solver.solve(response, progress);      // finds the corrections, then the wet modes
//   WetBody wet = *solver.body();          // with losses, errors and the flow through free surfaces
//
// The dry modes should reach to kDryBand times the top of the band.
#pragma once

#include "engine/bake/liquid/wet_body.h"
#include "engine/base/progress.h"
#include "engine/fem/assembly.h"
#include "engine/liquid/potential.h"
#include "engine/liquid/water_modes.h"
#include "engine/liquid/wet_modes.h"
#include "engine/solve/eigensolver.h"
#include "engine/solve/slaved_response.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <vector>

namespace ringdown::bake {

// One liquid's part in the eigenproblem.
struct PartTerms {
  liquid::WetPanels panels;
  std::optional<liquid::WaterModes> modes;  // of an enclosed liquid
  liquid::Potential potential;              // of the body's modes
  Eigen::MatrixXd flow;                     // of them, samples x N
  Eigen::MatrixXd bound;                    // N x all modes of the liquid: integrals of psi_j q_i
  Eigen::Index first = 0, count = 0;        // of the liquid's modes that are oscillators
  Eigen::Index row = 0;                     // of the first one in the eigenproblem

  // Makes the panels, and the modes of an enclosed liquid.
  static Result<PartTerms> of(const WetPart& part);

  // Finds flow, potential and bound of shapes at the skin's nodes (3S x N), with oscillators up to kLiquidBand times
  // the band, whose largest lambda is `top`.
  void add_shapes(const WetPart& part, const liquid::Skin& skin, const Eigen::MatrixXd& shapes, double top);

  // bond() returns the matrix that binds the body's N shapes to the oscillators, N x count; wavenumbers() those of the
  // oscillators, count [rad per length of the unit mesh].
  [[nodiscard]] Eigen::MatrixXd bond(const WetPart& part) const;
  [[nodiscard]] Eigen::VectorXd wavenumbers() const;

  // The amplitudes of the liquid's modes in the potential, beside the still one: y_j / (kappa_j sqrt(rho)).
  [[nodiscard]] Eigen::MatrixXd swing(const WetPart& part, const Eigen::MatrixXd& liquids) const;

  // Returns the decays of m wet modes by the boundary layer, as WetEffects::drag. The modes are given by N x m
  // amplitudes of the shapes and count x m of the oscillators, and move the skin by `on_wall`. The layer takes R_s/2
  // times the square of the slip between liquid and wall (Landau & Lifshitz, Fluid Mechanics, section 24).
  [[nodiscard]] Eigen::VectorXd drag(const WetPart& part, const liquid::Skin& skin, const Eigen::MatrixXd& own,
                                     const Eigen::MatrixXd& liquids, const Eigen::MatrixXd& on_wall) const;
};

// `dry` are modes of `system`, from which the nodes `clamped` were removed. Fails when cancelled (stage "liquid").
Result<WetBody> wet_body(const WetPlan& plan, const mesh::Boundary& surface, const solve::Eigenmodes& dry,
                         const fem::System& system, const std::vector<std::int32_t>& clamped, double top,
                         const Progress& progress = {});

inline constexpr double kResponseShift = -1e-3;  // of the band's top, above which all lies that the corrections hold

class WetSolver {
 public:
  WetSolver(const WetPlan& plan, const mesh::Boundary& surface, const solve::Eigenmodes& dry, const fem::System& system,
            const std::vector<std::int32_t>& clamped, double top);

  // `response` holds the dry modes. Fails when cancelled (stage "liquid").
  Result<void> solve(const solve::SlavedResponse& response, const Progress& progress);

  // The rest needs solve().
  [[nodiscard]] Result<WetBody> body() const;
  // The shapes of the lowest wet modes that are no rigid motions, at the nodes of the system.
  [[nodiscard]] Eigen::MatrixXd lowest(Eigen::Index count) const;
  // The rows of the skin's nodes, of shapes at the nodes of the system.
  [[nodiscard]] Eigen::MatrixXd on_skin(const Eigen::MatrixXd& shapes) const;

 private:
  [[nodiscard]] Eigen::MatrixXd first_pressures(std::size_t part) const;
  [[nodiscard]] Eigen::MatrixXd pressures_of(std::size_t part) const;
  [[nodiscard]] Eigen::MatrixXd forces_of_all(const std::vector<Eigen::MatrixXd>& pressures) const;
  void correct(const Eigen::MatrixXd& responses);
  Result<void> couple();
  [[nodiscard]] Result<Eigen::MatrixXd> mass_errors() const;
  [[nodiscard]] WetBody finish(const Eigen::MatrixXd& mass_errors) const;
  static void add_free_flow(const WetPart& part, const PartTerms& terms, const liquid::FreeSurface& free,
                            const Eigen::MatrixXd& own, const Eigen::MatrixXd& liquids, WetEffects& effects);

  const WetPlan& plan_;
  const mesh::Boundary& surface_;
  const solve::Eigenmodes& dry_;
  const fem::System& system_;
  const double top_;
  std::vector<Eigen::Index> row_of_;  // of each node of the mesh, in the system; -1: clamped
  std::vector<PartTerms> terms_;
  Eigen::MatrixXd corrections_;
  Eigen::MatrixXd basis_;   // 3N x n: dry modes and corrections
  Eigen::VectorXd lambda_;  // n
  liquid::Coupled coupled_;
  liquid::WetModes wet_;
};

}  // namespace ringdown::bake
