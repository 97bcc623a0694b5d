// Finds the shells of a surface, its parts connected through edges, and decides which are bodies or cavities. [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::mesh {

inline constexpr std::size_t kMaxShells = 1000;  // with more shells, nesting is not examined

// The condition under which a closed shell inside a body is a cavity of that body.
enum class CavityRule : std::int32_t {
  kWoundTheOtherWay,  // a cavity if wound opposite to the shell around it, otherwise part of the body
  kInside,            // always a cavity
};

enum class Role {
  kBody,    // lies in no other shell or in a cavity, or runs through other shells
  kCavity,  // a hollow in the innermost shell around it
  kBuried,  // a body that lies entirely inside another and adds nothing
};

// Two triangles are neighbours if they share an edge that no third triangle has. At an edge with more triangles, the
// triangles that other edges connect are neighbours, if they come in pairs. Otherwise, if equally many run in both
// directions, the triangles with the inside of a body between them are neighbours. A shell is a set of triangles
// connected through neighbours.
struct Shells {
  std::vector<std::int32_t> shell;  // shell of each triangle; -1: degenerate or a duplicate
  std::vector<bool> turned;         // per triangle: turned against the majority of its shell
  int count = 0;
  std::vector<bool> closed;       // per shell: every triangle has a neighbour at each edge
  std::vector<double> volume_m3;  // per shell, with the sign of its majority; meaningful if closed
  std::vector<double> area_m2;
  std::vector<int> depth;   // per shell: number of other closed shells that it lies entirely inside of, or touches
  std::vector<int> parent;  // per shell: the innermost closed shell around it; -1: none
  std::vector<Role> role;

  // Returns true if most of shell `s` faces inward and should face outward, or faces outward and should face inward.
  [[nodiscard]] bool wound_wrongly(std::size_t s) const { return (volume_m3[s] < 0) != (role[s] == Role::kCavity); }
};

// Costs O(T log T), and up to 2,000 winding numbers for each pair of shells of which one's box contains the other's.
Shells shells_of(const TriangleMesh& mesh, CavityRule rule = CavityRule::kWoundTheOtherWay);

}  // namespace ringdown::mesh
