// The shells of a surface: its parts that hang together through edges. [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::mesh {

inline constexpr std::size_t kMaxShells = 64;  // compared with each other; beyond, nesting is not looked at

// Two triangles are neighbours through an edge that no third triangle has. A shell is what neighbours connect.
struct Shells {
  std::vector<std::int32_t> shell;  // of each triangle; -1: degenerate or a duplicate
  std::vector<bool> turned;         // of each triangle: against the majority of its shell
  int count = 0;
  std::vector<bool> closed;       // of each shell
  std::vector<double> volume_m3;  // of each shell, its majority's sign; meaningful when closed
  std::vector<double> area_m2;
  std::vector<int> depth;   // in how many other closed shells it lies
  std::vector<int> parent;  // the innermost of these; -1: none
};

// O(T log T); nesting O(shells T).
Shells shells_of(const TriangleMesh& mesh);

}  // namespace ringdown::mesh
