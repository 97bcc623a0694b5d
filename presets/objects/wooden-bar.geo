// A xylophone bar: a box with an arch cut out below its middle. Lengths in mm.
// The arch lowers the first mode more than the second, and so tunes their ratio.
SetFactory("OpenCASCADE");
DefineConstant[ length = 340, width = 45, thickness = 22, arch_length = 180, arch_depth = 9, mesh_size = 12 ];
h = 0.5 * length; a = 0.5 * arch_length;
Point(1) = {-h, 0, 0};          Point(2) = {-a, 0, 0};
Point(3) = {-0.6 * a, 0, 0.72 * arch_depth};
Point(4) = {0, 0, arch_depth};  Point(5) = {0.6 * a, 0, 0.72 * arch_depth};
Point(6) = {a, 0, 0};           Point(7) = {h, 0, 0};
Point(8) = {h, 0, thickness};   Point(9) = {-h, 0, thickness};
Line(1) = {1, 2}; Spline(2) = {2, 3, 4, 5, 6}; Line(3) = {6, 7}; Line(4) = {7, 8}; Line(5) = {8, 9}; Line(6) = {9, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Extrude {0, width, 0} { Surface{1}; }
