// Cones of the open gmsh model that run to a tip. Links GPL code. [worker, within a GmshSession]
#pragma once

namespace ringdown::mesh {

// Cuts the mantles of OpenCASCADE's cones that go all around and end in a tip, or nearly so, along two straight lines
// into two faces. The body stays the same. gmsh 4.8 does not come to an end of refining such a mantle near its tip when
// it is slender: a cone of 10 mm across and 100 mm long takes more than minutes, and 0.1 s when it is cut. Physical
// groups keep what they hold.
void cut_cone_tips();

}  // namespace ringdown::mesh
