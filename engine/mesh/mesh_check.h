// Checks that a mesh is one that finite elements can be built on. [worker]
//
//   Result<CheckedMesh> checked = check_mesh(std::move(mesh), "cup.msh");
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"

#include <cstdint>
#include <string>
#include <vector>

namespace ringdown::mesh {

// A group of faces that the mesh's author named. Elements and their faces are numbered as in the mesh, whatever its
// order.
struct FaceGroup {
  std::string name;
  std::vector<std::int64_t> faces;  // 4 element + the corner that the face lies opposite to, ascending
};
struct MeshGroups {
  std::vector<std::string> volumes;
  std::vector<std::int32_t> volume_of;  // E: a number in `volumes`, or -1; empty when there are none
  std::vector<FaceGroup> surfaces;
  [[nodiscard]] bool empty() const { return volumes.empty() && surfaces.empty(); }
};

// A mesh that the other folders may trust: node numbers in range, every node used, every element positively oriented
// and with volume, coordinates finite, neighbours joined by whole faces (mesh_joints.h), no element inside another.
struct CheckedMesh {
  TetMesh mesh;
  int pieces = 0;        // parts that share no node
  int flipped = 0;       // elements given inside out, now turned
  int straightened = 0;  // curved elements that folded over themselves, now less curved or straight
  int unused_nodes = 0;  // dropped
  int duplicates = 0;    // elements with the same nodes as another, dropped
  MeshGroups groups = {};
  Eigen::VectorXd gaps_m =
      {};  // from the mesh's skin to the body's surface (surface_gap.h); empty: the mesh is the body
};

// Repairs what has one right repair (the counts above) and refuses the rest: no elements, a node number out of range or
// twice in an element, a coordinate that is not finite, an element without volume, elements that overlap, parts that
// touch in an edge or a point only. `name` stands in the sentence. O(E log E).
Result<CheckedMesh> check_mesh(TetMesh mesh, const std::string& name);

// Fails with one sentence, which says where, when the middle of an element lies inside another: the same body given
// twice, or two that run through each other. Curved elements are passed over; what they enclose is not what their
// corners do. The elements must be positively oriented. O(E log E), a second for a million.
Result<void> check_overlap(const TetMesh& mesh, const std::string& name);

}  // namespace ringdown::mesh
