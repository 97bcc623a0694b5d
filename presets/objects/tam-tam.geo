// A tam-tam without its turned rim: a slightly domed disc with a flat margin, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 600, thickness = 1.6, dome = 6, margin = 40, mesh_size = 23 ];
r = 0.5 * diameter; m = r - margin; t = thickness; c = (dome * dome - m * m) / (2 * dome);
Point(1) = {0, 0, dome}; Point(2) = {m, 0, 0}; Point(3) = {r, 0, 0};
Point(4) = {r, 0, -t}; Point(5) = {m, 0, -t}; Point(6) = {0, 0, dome - t};
Point(7) = {0, 0, c}; Point(8) = {0, 0, c - t};
Circle(1) = {1, 7, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Circle(5) = {5, 8, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1:6};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
