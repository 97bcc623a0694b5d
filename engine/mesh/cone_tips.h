// Cuts cones with a tip in the open gmsh model. Links GPL code. [worker, within a GmshSession]
#pragma once

namespace ringdown::mesh {

// Cuts the mantles of OpenCASCADE's full cones that end in a tip, or nearly so, along two straight lines into two
// faces. The shape of the body does not change. gmsh 4.8 hardly ever finishes refining a slender mantle near its tip: a
// cone 10 mm across and 100 mm long takes more than minutes uncut, and 0.1 s cut. Physical groups keep their contents.
void cut_cone_tips();

}  // namespace ringdown::mesh
