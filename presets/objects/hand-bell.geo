// A hand bell: thin skirt, rounded shoulder, a thick crown with a stub for the handle. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 100, wall = 2.6, mesh_size = 9 ];
d = diameter; w = wall;
Point(1) = {0.500 * d, 0, 0};  // lip out
Point(2) = {0.465 * d, 0, 0.080 * d};
Point(3) = {0.405 * d, 0, 0.250 * d};
Point(4) = {0.355 * d, 0, 0.450 * d};
Point(5) = {0.315 * d, 0, 0.620 * d};
Point(6) = {0.230 * d, 0, 0.740 * d};
Point(7) = {0.110 * d, 0, 0.780 * d};
Point(8) = {0.110 * d, 0, 0.860 * d};  // stub
Point(9) = {0, 0, 0.860 * d};
Point(10) = {0, 0, 0.730 * d};
Point(11) = {0.110 * d, 0, 0.725 * d};
Point(12) = {0.215 * d, 0, 0.690 * d};
Point(13) = {0.315 * d - 1.15 * w, 0, 0.595 * d};
Point(14) = {0.355 * d - w, 0, 0.445 * d};
Point(15) = {0.405 * d - w, 0, 0.245 * d};
Point(16) = {0.465 * d - 1.25 * w, 0, 0.080 * d};
Point(17) = {0.500 * d - 1.5 * w, 0, 0};  // lip in
Spline(1) = {1, 2, 3, 4, 5, 6, 7};
Line(2) = {7, 8};
Line(3) = {8, 9};
Line(4) = {9, 10};
Spline(5) = {10, 11, 12, 13, 14, 15, 16, 17};
Line(6) = {17, 1};
Curve Loop(1) = {1:6};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
