// A wine bottle: straight body, shoulder, neck with a ring at the mouth, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 37, height = 300, wall = 3.5, mesh_size = 14 ];
r = radius; h = height; w = wall;
Point(1) = {0, 0, 0.05 * h};            // the punt
Point(2) = {0.75 * r, 0, 0};
Point(3) = {r, 0, 0.03 * h};
Point(4) = {r, 0, 0.60 * h};
Point(5) = {0.85 * r, 0, 0.68 * h};
Point(6) = {0.46 * r, 0, 0.78 * h};
Point(7) = {0.38 * r, 0, 0.94 * h};
Point(8) = {0.43 * r, 0, 0.95 * h};
Point(9) = {0.43 * r, 0, h};
Point(10) = {0.26 * r, 0, h};
Point(11) = {0.27 * r, 0, 0.94 * h};
Point(12) = {0.46 * r - w, 0, 0.775 * h};
Point(13) = {0.85 * r - w, 0, 0.67 * h};
Point(14) = {r - w, 0, 0.595 * h};
Point(15) = {r - w, 0, 0.045 * h};
Point(16) = {0.75 * r, 0, 1.2 * w};
Point(17) = {0, 0, 0.05 * h + 1.3 * w};
Spline(1) = {1, 2, 3}; Line(2) = {3, 4}; Spline(3) = {4, 5, 6, 7}; Line(4) = {7, 8}; Line(5) = {8, 9}; Line(6) = {9, 10};
Line(7) = {10, 11}; Spline(8) = {11, 12, 13, 14}; Line(9) = {14, 15}; Spline(10) = {15, 16, 17}; Line(11) = {17, 1};
Curve Loop(1) = {1:11};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
