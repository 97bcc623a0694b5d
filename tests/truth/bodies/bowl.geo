// Half of a spherical shell about the origin, open upwards. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 100, thickness = 0.5, mesh_size = 12 ];
Sphere(1) = {0, 0, 0, radius + 0.5 * thickness, -0.5 * Pi, 0};
Sphere(2) = {0, 0, 0, radius - 0.5 * thickness, -0.5 * Pi, 0};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
