// A disc about the origin, drawn out in one layer, its axis along z. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 200, thickness = 1, mesh_size = 12 ];
Disk(1) = {0, 0, -0.5 * thickness, 0.5 * diameter};
Extrude {0, 0, thickness} { Surface{1}; Layers{1}; }
