// The shells of a surface: its parts that hang together through edges, and which of them are bodies or cavities.
// [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::mesh {

inline constexpr std::size_t kMaxShells = 1000;  // compared with each other; beyond, nesting is not looked at

// When a closed shell inside a body is a cavity of that body.
enum class CavityRule : std::int32_t {
  kWoundTheOtherWay,  // if it is wound the other way than the shell around it; otherwise it is part of the body
  kInside,            // always, however it is wound
};

enum class Role {
  kBody,    // it lies in no other shell, or in a cavity; or it runs through others
  kCavity,  // the innermost shell around it is hollow there
  kBuried,  // a body that lies in another as a whole, and adds nothing to it
};

// Two triangles are neighbours through an edge that no third triangle has. Where an edge has more triangles, neighbours
// are those that such edges connect, if they come in pairs; else, as many running in one direction as in the other,
// those that have the inside of a body between them. A shell is what neighbours connect.
struct Shells {
  std::vector<std::int32_t> shell;  // of each triangle; -1: degenerate or a duplicate
  std::vector<bool> turned;         // of each triangle: against the majority of its shell
  int count = 0;
  std::vector<bool> closed;       // of each shell: every triangle has a neighbour through each of its edges
  std::vector<double> volume_m3;  // of each shell, its majority's sign; meaningful when closed
  std::vector<double> area_m2;
  std::vector<int> depth;   // in how many other closed shells it lies as a whole; touching them counts as inside
  std::vector<int> parent;  // the innermost of these; -1: none
  std::vector<Role> role;

  // Returns true where most of a shell faces inward and should face outward, or the other way about.
  [[nodiscard]] bool wound_wrongly(std::size_t s) const { return (volume_m3[s] < 0) != (role[s] == Role::kCavity); }
};

// O(T log T), and for each pair of shells of which one's box lies in the other's up to 2,000 winding numbers.
Shells shells_of(const TriangleMesh& mesh, CavityRule rule = CavityRule::kWoundTheOtherWay);

}  // namespace ringdown::mesh
