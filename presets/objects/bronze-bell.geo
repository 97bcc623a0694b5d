// A church bell's profile turned about its axis, with a hole for the bolt in the crown. Lengths in mm.
// The profile is drawn for a mouth of diameter 1: thick sound bow, waist of a third of it, rounded shoulder.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 300, mesh_size = 22 ];
d = diameter;
Point(1) = {0.500 * d, 0, 0.000 * d};  // lip out
Point(2) = {0.488 * d, 0, 0.045 * d};  // o1
Point(3) = {0.425 * d, 0, 0.130 * d};  // o2
Point(4) = {0.345 * d, 0, 0.270 * d};  // o3
Point(5) = {0.295 * d, 0, 0.430 * d};  // o4
Point(6) = {0.270 * d, 0, 0.580 * d};  // o5
Point(7) = {0.258 * d, 0, 0.690 * d};  // shoulder out
Point(8) = {0.215 * d, 0, 0.755 * d};  // o6
Point(9) = {0.120 * d, 0, 0.780 * d};  // o7
Point(10) = {0.030 * d, 0, 0.785 * d};  // crown out
Point(11) = {0.030 * d, 0, 0.735 * d};  // crown in
Point(12) = {0.110 * d, 0, 0.732 * d};  // i7
Point(13) = {0.190 * d, 0, 0.705 * d};  // i6
Point(14) = {0.222 * d, 0, 0.665 * d};  // shoulder in
Point(15) = {0.236 * d, 0, 0.570 * d};  // i5
Point(16) = {0.262 * d, 0, 0.425 * d};  // i4
Point(17) = {0.310 * d, 0, 0.265 * d};  // i3
Point(18) = {0.375 * d, 0, 0.135 * d};  // i2
Point(19) = {0.425 * d, 0, 0.055 * d};  // i1
Point(20) = {0.480 * d, 0, 0.000 * d};  // lip in
Spline(1) = {1, 2, 3, 4, 5, 6, 7};
Spline(2) = {7, 8, 9, 10};
Line(3) = {10, 11};
Spline(4) = {11, 12, 13, 14};
Spline(5) = {14, 15, 16, 17, 18, 19, 20};
Line(6) = {20, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
