// A spoon: a shallow bowl cut from a shell, and a flat handle, along x. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ bowl_length = 62, bowl_width = 42, bowl_depth = 9, handle = 130, thickness = 1.8, mesh_size = 6 ];
a = 0.5 * bowl_length; b = 0.5 * bowl_width; q = bowl_depth + thickness;
Sphere(1) = {0, 0, 0, 1};
Dilate { {0, 0, 0}, {a, b, q} } { Volume{1}; }
Sphere(2) = {0, 0, 0, 1};
Dilate { {0, 0, 0}, {a - 1.2 * thickness, b - 1.2 * thickness, q - thickness} } { Volume{2}; }
Box(3) = {-2 * a, -2 * b, 0, 4 * a, 4 * b, 4 * q};
bowl[] = BooleanDifference{ Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Point(1001) = {a - 3, -5, -1.2 * thickness}; Point(1002) = {a + 0.3 * handle, -2.8, -1.2 * thickness}; Point(1003) = {a + 0.8 * handle, -6.5, -1.2 * thickness};
Point(1004) = {a + handle, 0, -1.2 * thickness};
Point(1005) = {a + 0.8 * handle, 6.5, -1.2 * thickness}; Point(1006) = {a + 0.3 * handle, 2.8, -1.2 * thickness}; Point(1007) = {a - 3, 5, -1.2 * thickness};
Spline(1001) = {1001, 1002, 1003, 1004}; Spline(1002) = {1004, 1005, 1006, 1007}; Line(1003) = {1007, 1001};
Curve Loop(1001) = {1001:1003};
Plane Surface(1001) = {1001};
stick[] = Extrude {0, 0, 1.2 * thickness} { Surface{1001}; };
BooleanUnion{ Volume{bowl[]}; Delete; }{ Volume{stick[1]}; Delete; }
