// A disc or a short cylinder about the origin, its axis along z. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 40, thickness = 3, mesh_size = 4 ];
Cylinder(1) = {0, 0, -0.5 * thickness, 0, 0, thickness, 0.5 * diameter};
