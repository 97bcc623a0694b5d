// A drinking glass: straight wall widening to the rim, thick floor, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ rim_radius = 40, floor_radius = 30, height = 110, wall = 2, floor = 7, mesh_size = 9 ];
Point(1) = {0, 0, 0};
Point(2) = {floor_radius, 0, 0};
Point(3) = {rim_radius, 0, height};
Point(4) = {rim_radius - wall, 0, height};
Point(5) = {floor_radius - wall + (rim_radius - floor_radius) * (floor + 3) / height, 0, floor + 3};
Point(6) = {floor_radius - wall - 3, 0, floor};
Point(7) = {0, 0, floor};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 1};
Curve Loop(1) = {1:7};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
