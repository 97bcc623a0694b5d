#include "engine/mesh/stuffing.h"

namespace ringdown::mesh {

Result<Stuffed> stuff(const TriangleMesh&, const StuffOptions&, const Progress&) { return fail("stuffing: not yet"); }

}  // namespace ringdown::mesh
