// A tube along z. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ length = 600, radius = 16, wall = 2, mesh_size = 14 ];
Cylinder(1) = {0, 0, -0.5 * length, 0, 0, length, radius};
Cylinder(2) = {0, 0, -0.5 * length, 0, 0, length, radius - wall};
BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }
