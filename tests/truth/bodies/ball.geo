// A ball about the origin. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 50, mesh_size = 20 ];
Sphere(1) = {0, 0, 0, radius};
