// A dinner plate: flat well, wide rim, a foot ring, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 130, wall = 4.5, mesh_size = 15 ];
s = radius / 130; w = wall;
Point(1) = {0, 0, 3 * s};
Point(2) = {74 * s, 0, 3 * s};
Point(3) = {75 * s, 0, 0};
Point(4) = {80 * s, 0, 0};
Point(5) = {82 * s, 0, 4 * s};
Point(6) = {94 * s, 0, 14 * s};
Point(7) = {128 * s, 0, 22 * s};
Point(8) = {130 * s, 0, 24 * s};
Point(9) = {129 * s, 0, 22 * s + 0.8 * w};
Point(10) = {92 * s, 0, 14 * s + 1.1 * w};
Point(11) = {78 * s, 0, 4 * s + 1.3 * w};
Point(12) = {68 * s, 0, 3 * s + w};
Point(13) = {0, 0, 3 * s + w};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 7};
Line(7) = {7, 8}; Line(8) = {8, 9}; Line(9) = {9, 10}; Line(10) = {10, 11}; Line(11) = {11, 12}; Line(12) = {12, 13}; Line(13) = {13, 1};
Curve Loop(1) = {1:13};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
