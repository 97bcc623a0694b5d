// A table knife: a thick handle and a thin, rounded blade in one piece, along x. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ handle = 100, blade = 115, thickness = 5, blade_thickness = 1.6, mesh_size = 6 ];
h = 0.5 * thickness; b = 0.5 * blade_thickness;
Box(1) = {-handle, -7.5, -h, handle, 15, thickness};
Point(101) = {-2, -6, -b};              Point(102) = {0.75 * blade, -7, -b};
Point(103) = {0.92 * blade, -4, -b};    Point(104) = {blade, 5, -b};
Point(105) = {0.93 * blade, 10, -b};    Point(106) = {0.3 * blade, 10, -b};
Point(107) = {-2, 6, -b};
Line(101) = {101, 102}; Spline(102) = {102, 103, 104, 105}; Line(103) = {105, 106}; Line(104) = {106, 107}; Line(105) = {107, 101};
Curve Loop(101) = {101, 102, 103, 104, 105};
Plane Surface(101) = {101};
out[] = Extrude {0, 0, blade_thickness} { Surface{101}; };
BooleanUnion{ Volume{1}; Delete; }{ Volume{out[1]}; Delete; }
