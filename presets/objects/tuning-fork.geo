// A tuning fork: two square tines, a round yoke and a stem, along x. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ tine = 95, width = 4, gap = 8, thickness = 6, yoke = 11, stem = 40, mesh_size = 5 ];
a = 0.5 * gap; b = a + width;
Point(1) = {0, -b, 0}; Point(2) = {tine, -b, 0}; Point(3) = {tine, -a, 0}; Point(4) = {0, -a, 0};
Point(5) = {0, 0, 0}; Point(6) = {0, a, 0}; Point(7) = {tine, a, 0}; Point(8) = {tine, b, 0}; Point(9) = {0, b, 0};
Point(10) = {-yoke, 3, 0}; Point(11) = {-yoke - stem, 3, 0}; Point(12) = {-yoke - stem, -3, 0}; Point(13) = {-yoke, -3, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Point(14) = {-a, 0, 0}; Circle(4) = {4, 5, 14}; Circle(13) = {14, 5, 6}; Line(5) = {6, 7}; Line(6) = {7, 8}; Line(7) = {8, 9};
Line(8) = {9, 10}; Line(9) = {10, 11}; Line(10) = {11, 12}; Line(11) = {12, 13}; Line(12) = {13, 1};
Curve Loop(1) = {1:4, 13, 5:12};
Plane Surface(1) = {1};
Extrude {0, 0, thickness} { Surface{1}; }
