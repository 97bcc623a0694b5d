// A ring of round section about z, drawn out in two halves. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 120, section_radius = 2, mesh_size = 8 ];
Disk(1) = {radius, 0, 0, section_radius};
Rotate { {1, 0, 0}, {radius, 0, 0}, 0.5 * Pi } { Surface{1}; }
half[] = Extrude { {0, 0, 1}, {0, 0, 0}, Pi } { Surface{1}; Layers{ Ceil(Pi * radius / mesh_size) }; };
Extrude { {0, 0, 1}, {0, 0, 0}, Pi } { Surface{half[0]}; Layers{ Ceil(Pi * radius / mesh_size) }; }
Coherence;
