// A mesh of few triangles made round: curved PN triangles (Vlachos, Peters, Boyd, Mitchell: "Curved PN Triangles",
// 2001), each cut into small flat ones. Inside this folder only. [any]
#pragma once

#include "clients/viewer/render/drawn_mesh.h"

namespace ringdown::viewer {

// Corners stay where they are and come first, in their order. Edges between two smooth surfaces curve along both, so
// that nothing opens there; where their direction is not clear they stay straight. As many pieces as kMaxPieces
// allows.
DrawnMesh curved(const DrawnMesh& flat);

}  // namespace ringdown::viewer
