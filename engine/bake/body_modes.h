// The modes of a shape, free of units: what is left of a body's eigenproblem when E, rho and size are divided out.
//
// Count lengths in L, moduli in E and masses in rho L^3; then K phi = lambda M phi of an isotropic solid depends on its
// shape and Poisson's ratio alone, and
//
//   lambda = E / (rho L^2) lambda',      phi = rho^-1/2 L^-3/2 phi'
//
// are exact, and so they are of any other body with ratios of moduli and densities in the place of Poisson's ratio
// (fitted_makeup.h). So one solution serves every E, rho, damping and size of a body; the cache keeps it (ModeCache),
// and a bake always goes through it, so that a cached bank and a fresh one are the same. L is the diagonal of the
// mesh's bounding box.
#pragma once

#include "engine/bake/liquid/wet_body.h"
#include "engine/bake/nonlinear_modes.h"
#include "engine/base/content_cache.h"
#include "engine/fem/assembly.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/modal/bank.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace ringdown::bake {

struct BodyUnits {
  double length_m = 1, modulus_pa = 1, density_kg_m3 = 1;

  [[nodiscard]] double lambda() const { return modulus_pa / (density_kg_m3 * length_m * length_m); }
  [[nodiscard]] double shape() const;
  [[nodiscard]] modal::MassProperties mass(const modal::MassProperties& body) const;
};

// Each mode's energy, divided among the parts and supports that damp it (fitted_makeup.h). Empty for a free body of one
// material.
struct ModeShares {
  Eigen::MatrixXd strain, motion;  // parts x m: phi^T K phi, weighed by the part's losses, and phi^T M phi
  Eigen::MatrixXd springs;         // 2 supports x m: integrals of |phi|^2 along the normal, and across it
  Eigen::MatrixXd points;          // held points x m: |phi|^2
};

// The eigenproblem of a body, all its nodes included.
struct Equations {
  fem::System system;                 // with glued masses, without springs
  fem::SparseMatrix springs;          // 3N x 3N, lower triangle: what supports add to the stiffness; no rows: nothing
  std::vector<std::int32_t> clamped;  // nodes, ascending
  Eigen::MatrixXd rigid;              // 3N x r motions that cost no energy, mass-normalised
};

// Modes at every node of the body, which take many times the memory of those at its surface.
struct Interior {
  Eigen::MatrixXd shapes;       // 3N x m
  fem::SparseMatrix node_mass;  // N x N
  std::optional<Equations> equations = {};
};

struct BodyModes {
  Eigen::VectorXd lambda;     // m, ascending; the rigid motions are left out
  Eigen::MatrixXd shapes;     // 3S x m, at the S nodes of mesh::boundary_of(), in its order
  Eigen::VectorXd residuals;  // m, as in solve::Eigenmodes
  Eigen::VectorXd errors;     // m, estimated relative errors of the frequencies; or empty: none was made
  double complete_to = 0;     // every mode with lambda up to here is in the set: inertia counted `rigid` + m of them
  int rigid = 0;
  bool verified = false;  // a second method agreed
  std::int64_t unknowns = 0;
  modal::MassProperties mass;  // of density 1
  ModeShares shares;
  Eigen::MatrixXd heat;                     // 2 fem::kHeatPairs x m (fem/heat_flow.h); or empty: it was not asked for
  std::optional<Interior> interior;         // if it was asked for; not in the ModeCache
  std::optional<WetEffects> wet;            // of a body with liquids: these are its modes with them; not in the cache
  std::optional<NonlinearModes> nonlinear;  // of the first modes, where they were asked for; not in the ModeCache
};

// The first modes only, those with lambda up to `top`.
BodyModes up_to(BodyModes modes, double top);

// The diagonal of the bounding box [m]; > 0 for a checked mesh.
double characteristic_length(const mesh::Points& nodes);

// Modes found before, by the content of what they were found for. Any number of processes may use one folder. [worker]
//
//   const ModeCache cache{ContentCache(folder)};
//   const BodyQuestion question{unit_mesh, surface.nodes.size(), element, nu, tolerance};
//   if (auto modes = cache.find(question, top, max_modes)) ...no need to solve...
//
// The key is the hash of all that the unit-free eigenproblem depends on: the elements' node numbers, the nodes in units
// of the body's length, the kind of element, Poisson's ratio, the solver's tolerance, what makes a body more than one
// free piece of isotropic material, and a format version. A file
// name, E, rho, damping, size, band or surface points are not in it.
//
// Nodes enter the key rounded to 2^-24 of the length, because the same mesh in another unit differs in its last bits;
// an entry therefore holds its nodes and is used only when they agree to 1e-13. Shapes are kept in double: the same
// request again gives the same bank, byte for byte. An entry takes 24 S m bytes and some.

struct BodyQuestion {
  const mesh::TetMesh& unit_mesh;  // of the element's order, in units of its characteristic length
  std::size_t surface_nodes = 0;   // S
  fem::Element element = fem::Element::kTet20;
  double poisson_ratio = 0;
  double tolerance = 0;     // of the solver
  std::string makeup = {};  // what else the modes depend on (FittedMakeup::key)
};

class ModeCache {
 public:
  explicit ModeCache(ContentCache cache) : cache_(std::move(cache)) {}

  // All modes up to `top` (free of units), when an entry has them and they are no more than `max_modes`.
  [[nodiscard]] std::optional<BodyModes> find(const BodyQuestion& question, double top, int max_modes) const;

  // Replaces the entry of the same key: call it when find() had none.
  Result<void> store(const BodyQuestion& question, const BodyModes& modes) const;

  // Returns the eigenvalues of a similar body that was solved before: free of units, ascending, without rigid motions;
  // empty if there is none. They serve planning only, because the similar body has another Poisson's ratio, element or
  // mesh size. Similar bodies share a `family`, a name for the shape; if that is empty, the mesh's node numbers decide.
  [[nodiscard]] Eigen::VectorXd expected(const BodyQuestion& question, const std::string& family) const;
  Result<void> expect(const BodyQuestion& question, const std::string& family, const Eigen::VectorXd& lambda) const;

 private:
  ContentCache cache_;
};

// Mass, centre and inertia of a meshed solid, from the mesh and its node mass matrix M. Position is interpolated by the
// same shape functions as displacement, so with X the nodes (N x 3) the integrals of rho, rho x and rho x x^T are
// exactly 1^T M 1, 1^T M X and X^T M X, curved elements included (exact for consistent mass). Principal moments ascend;
// the frame is right-handed, and its signs are fixed, so equal meshes give equal frames.
modal::MassProperties mass_properties(const mesh::TetMesh& mesh, const fem::SparseMatrix& node_mass);

}  // namespace ringdown::bake
