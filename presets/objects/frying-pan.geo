// A frying pan: turned dish and a flat handle, in one piece. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 120, height = 42, wall = 3, handle = 180, mesh_size = 16 ];
r = radius; h = height; w = wall;
Point(1) = {0, 0, 0}; Point(2) = {0.76 * r, 0, 0}; Point(3) = {0.84 * r, 0, 0.12 * h}; Point(4) = {r, 0, h};
Point(5) = {r - w, 0, h}; Point(6) = {0.84 * r - w, 0, 0.12 * h + 0.9 * w}; Point(7) = {0.76 * r - 0.5 * w, 0, w}; Point(8) = {0, 0, w};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 8}; Line(8) = {8, 1};
Curve Loop(1) = {1:8};
Plane Surface(1) = {1};
dish[] = Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; };
Box(100) = {0.9375 * r, -11, h - 14, handle, 22, 5};
BooleanUnion{ Volume{dish[1]}; Delete; }{ Volume{100}; Delete; }  // the handle ends inside the wall
