// A singing bowl: hammered wall, thickened lip, flat floor, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 85, height = 85, wall = 3.2, lip = 4.5, mesh_size = 14 ];
r = radius; h = height; w = wall;
Point(1) = {0, 0, 0};
Point(2) = {0.50 * r, 0, 0.02 * h};
Point(3) = {0.80 * r, 0, 0.17 * h};
Point(4) = {0.97 * r, 0, 0.50 * h};
Point(5) = {1.00 * r, 0, 0.80 * h};
Point(6) = {0.97 * r, 0, h};            // lip out
Point(7) = {0.97 * r - lip, 0, h};      // lip in
Point(8) = {1.00 * r - 1.15 * w, 0, 0.80 * h};
Point(9) = {0.97 * r - w, 0, 0.50 * h + 0.2 * w};
Point(10) = {0.80 * r - 0.7 * w, 0, 0.17 * h + 0.75 * w};
Point(11) = {0.50 * r - 0.1 * w, 0, 0.02 * h + w};
Point(12) = {0, 0, w};
Spline(1) = {1, 2, 3, 4, 5, 6};
Line(2) = {6, 7};
Spline(3) = {7, 8, 9, 10, 11, 12};
Line(4) = {12, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
