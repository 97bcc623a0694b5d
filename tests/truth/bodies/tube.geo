// A tube along z. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ length = 1200, outer = 16, inner = 14.5, mesh_size = 12 ];
Disk(1) = {0, 0, -0.5 * length, outer};
Disk(2) = {0, 0, -0.5 * length, inner};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
Extrude {0, 0, length} { Surface{3}; Layers{ Ceil(length / mesh_size) }; }
