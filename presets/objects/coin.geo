// A coin: a disc about the origin, its axis along z. Lengths in mm. Meshed as a triangulated disc
// with `edges` sides, so that the hull of few points still rolls; then drawn out in one layer.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 38, thickness = 2.4, edges = 48, mesh_size = 4 ];
Circle(1) = {0, 0, -0.5 * thickness, 0.5 * diameter};
Curve Loop(1) = {1};
Plane Surface(1) = {1};
Transfinite Curve{1} = edges + 1;
Extrude {0, 0, thickness} { Surface{1}; Layers{1}; }
