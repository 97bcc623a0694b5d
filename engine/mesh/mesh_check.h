// Checks that a mesh is valid for finite elements. [worker]
//
//   Result<CheckedMesh> checked = check_mesh(std::move(mesh), "cup.msh");
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"

#include <cstdint>
#include <string>
#include <vector>

namespace ringdown::mesh {

// A group of faces that the mesh's author named. Elements are numbered as in the mesh, whatever its order.
struct FaceGroup {
  std::string name;
  std::vector<std::int64_t> faces;  // 4 element + the corner opposite the face, ascending
};
struct MeshGroups {
  std::vector<std::string> volumes;
  std::vector<std::int32_t> volume_of;  // E: a number in `volumes`, or -1; empty if there are no groups
  std::vector<FaceGroup> surfaces;
  [[nodiscard]] bool empty() const { return volumes.empty() && surfaces.empty(); }
};

// A mesh that has passed check_mesh(): node numbers are in range, every node is used, every element is positively
// oriented and has volume, coordinates are finite, neighbours are joined by whole faces (mesh_joints.h), and no element
// lies inside another.
struct CheckedMesh {
  TetMesh mesh;
  int pieces = 0;        // number of parts that share no node
  int flipped = 0;       // number of elements given inside out, now turned
  int straightened = 0;  // number of curved elements that folded over themselves, now less curved or straight
  int unused_nodes = 0;  // number of nodes dropped as unused
  int duplicates = 0;    // number of elements dropped because an earlier one has equal nodes
  MeshGroups groups = {};
  Eigen::VectorXd gaps_m = {};  // gaps from the mesh's skin to the body's surface (surface_gap.h); empty: none
};

// Repairs faults that have one right repair (counted above) and refuses all others: no elements, a node number out of
// range or twice in an element, a coordinate that is not finite, an element without volume, elements that overlap,
// parts that touch in an edge or a point only. Errors contain `name`. O(E log E).
Result<CheckedMesh> check_mesh(TetMesh mesh, const std::string& name);

// Fails, with one sentence that says where, if the middle of an element lies inside another: a body was given twice, or
// two bodies run through each other. Curved elements are skipped, because their corners do not bound them. The elements
// must be positively oriented. O(E log E), a second for a million.
Result<void> check_overlap(const TetMesh& mesh, const std::string& name);

}  // namespace ringdown::mesh
