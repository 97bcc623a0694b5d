// Modes found before, by the content of what they were found for. [worker; any number of processes]
//
//   const ModeCache cache{ContentCache(folder)};
//   const BodyQuestion question{unit_mesh, surface.nodes.size(), element, nu, tolerance};
//   if (auto modes = cache.find(question, top, most_modes)) ...no need to solve...
//
// The key is the hash of all that the unit-free eigenproblem depends on: the elements' node numbers, the nodes in units
// of the body's length, the kind of element, Poisson's ratio, the solver's tolerance, and a format version. A file
// name, E, rho, damping, size, band or surface points are not in it.
//
// Nodes enter the key rounded to 2^-24 of the length, because the same mesh in another unit differs in its last bits;
// an entry therefore holds its nodes and is used only when they agree to 1e-13. Shapes are kept in double: the same
// request again gives the same bank, byte for byte. An entry takes 24 S m bytes and some.
#pragma once

#include "engine/bake/body_modes.h"
#include "engine/base/content_cache.h"
#include "engine/fem/assembly.h"

#include <optional>

namespace ringdown::bake {

struct BodyQuestion {
  const mesh::TetMesh& unit_mesh;  // of the element's order, in units of its characteristic length
  std::size_t surface_nodes = 0;   // S
  fem::Element element = fem::Element::kTet20;
  double poisson_ratio = 0;
  double tolerance = 0;  // of the solver
};

class ModeCache {
 public:
  explicit ModeCache(ContentCache cache) : cache_(std::move(cache)) {}

  // All modes up to `top` (free of units), when an entry has them and they are no more than `most_modes`.
  [[nodiscard]] std::optional<BodyModes> find(const BodyQuestion& question, double top, int most_modes) const;

  // Replaces the entry of the same key: call it when find() had none.
  Result<void> store(const BodyQuestion& question, const BodyModes& modes) const;

  // Where the modes of a near relative were: lambdas free of units, ascending, rigid motions left out; empty when there
  // is none. For planning only: a relative has another Poisson's ratio, element or mesh size. Relatives share a
  // `family`, a name for the shape; when that is empty, the mesh's node numbers are the family.
  [[nodiscard]] Eigen::VectorXd expected(const BodyQuestion& question, const std::string& family) const;
  Result<void> expect(const BodyQuestion& question, const std::string& family, const Eigen::VectorXd& lambda) const;

 private:
  ContentCache cache_;
};

}  // namespace ringdown::bake
