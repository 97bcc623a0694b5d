// An opera gong without its turned rim: flat middle and conical shoulder, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 220, thickness = 1, middle = 140, drop = 12, mesh_size = 9 ];
r = 0.5 * diameter; m = 0.5 * middle; t = thickness;
Point(1) = {0, 0, 0}; Point(2) = {m, 0, 0}; Point(3) = {r, 0, -drop};
Point(4) = {r, 0, -drop - t}; Point(5) = {m, 0, -t}; Point(6) = {0, 0, -t};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1:6};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
