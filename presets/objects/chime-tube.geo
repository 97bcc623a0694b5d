// A tube along z. Lengths in mm. Its end is meshed as a ring and drawn out in layers, so that the thin wall needs few
// elements: 16 around, one through the wall, and mesh_size along.
SetFactory("OpenCASCADE");
DefineConstant[ length = 600, radius = 16, wall = 2, mesh_size = 20 ];
Circle(1) = {0, 0, 0, radius};
Circle(2) = {0, 0, 0, radius - wall};
Curve Loop(1) = {1};
Curve Loop(2) = {2};
Plane Surface(1) = {1, 2};
Transfinite Curve{1, 2} = 17;
Extrude {0, 0, length} { Surface{1}; Layers{ Ceil(length / mesh_size) }; }
