// A round rod along x. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ length = 300, diameter = 12, mesh_size = 10 ];
Disk(1) = {0, 0, 0, 0.5 * diameter};
Rotate { {0, 1, 0}, {0, 0, 0}, 0.5 * Pi } { Surface{1}; }
Translate {-0.5 * length, 0, 0} { Surface{1}; }
Extrude {length, 0, 0} { Surface{1}; Layers{ Ceil(length / mesh_size) }; }
