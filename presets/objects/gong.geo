// A gong: thin disc, slightly domed, with a turned rim, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 260, thickness = 2.5, dome = 8, rim = 30, mesh_size = 16 ];
Mesh.MeshSizeFromCurvature = 9;  // the bend at the rim is tighter than mesh_size
r = 0.5 * diameter; t = thickness; b = 12;  // b: radius of the bend
Point(1) = {0, 0, 0};
Point(2) = {0.45 * r, 0, -0.25 * dome};
Point(3) = {r - b, 0, -dome};
Point(4) = {r - b, 0, -dome - b};
Point(5) = {r, 0, -dome - b};
Point(6) = {r - 0.15 * rim, 0, -dome - rim};
Point(7) = {r - 0.15 * rim - t, 0, -dome - rim};
Point(8) = {r - t, 0, -dome - b};
Point(9) = {r - b, 0, -dome - t};
Point(10) = {0.45 * r, 0, -0.25 * dome - t};
Point(11) = {0, 0, -t};
Spline(1) = {1, 2, 3}; Circle(2) = {3, 4, 5}; Line(3) = {5, 6}; Line(4) = {6, 7}; Line(5) = {7, 8}; Circle(6) = {8, 4, 9}; Spline(7) = {9, 10, 11}; Line(8) = {11, 1};
Curve Loop(1) = {1:8};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
