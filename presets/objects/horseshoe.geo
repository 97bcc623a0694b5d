// A horseshoe: a flat bar bent to an open ring. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ width = 120, length = 125, bar = 22, thickness = 9, mesh_size = 11 ];
r = 0.5 * width; q = r - bar; l = length - r;
Point(1) = {0, 0, 0};
Point(2) = {-l, -0.86 * r, 0}; Point(3) = {0, -r, 0}; Point(4) = {r, 0, 0}; Point(5) = {0, r, 0}; Point(6) = {-l, 0.86 * r, 0};
Point(7) = {-l, 0.86 * r - 0.8 * bar, 0}; Point(8) = {0, q, 0}; Point(9) = {q, 0, 0}; Point(10) = {0, -q, 0}; Point(11) = {-l, -0.86 * r + 0.8 * bar, 0};
Line(1) = {2, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {4, 1, 5}; Line(4) = {5, 6}; Line(5) = {6, 7}; Line(6) = {7, 8};
Circle(7) = {8, 1, 9}; Circle(8) = {9, 1, 10}; Line(9) = {10, 11}; Line(10) = {11, 2};
Curve Loop(1) = {1:10};
Plane Surface(1) = {1};
Extrude {0, 0, thickness} { Surface{1}; }
