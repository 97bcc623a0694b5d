// A rice bowl on a foot ring, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 70, wall = 3.5, mesh_size = 9 ];
s = radius / 70;
Point(1) = {0, 0, 5 * s};  // below
Point(2) = {22 * s, 0, 5 * s};  // ring in top
Point(3) = {23 * s, 0, 0};  // ring in
Point(4) = {27 * s, 0, 0};  // ring out
Point(5) = {28 * s, 0, 7 * s};  // ring out top
Point(6) = {48 * s, 0, 18 * s};  // o1
Point(7) = {62 * s, 0, 36 * s};  // o2
Point(8) = {70 * s, 0, 64 * s};  // rim out
Point(9) = {70 * s - 0.8 * wall, 0, 64 * s};  // rim in
Point(10) = {62 * s - wall, 0, 37 * s};  // i2
Point(11) = {46.5 * s - 0.7 * wall, 0, 18 * s + wall};  // i1
Point(12) = {26 * s, 0, 7 * s + 1.2 * wall};  // i0
Point(13) = {0, 0, 5 * s + 1.3 * wall};  // above
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Spline(5) = {5, 6, 7, 8};
Line(6) = {8, 9};
Spline(7) = {9, 10, 11, 12, 13};
Line(8) = {13, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7, 8};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
