// A cymbal: a bell on a slightly conical bow, of one thickness and without a hole, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 360, thickness = 1, rise = 8, bell = 80, bell_rise = 8, bell_mesh_size = 10, mesh_size = 18 ];
r = 0.5 * diameter; b = 0.5 * bell; t = thickness;
low = bell_rise - (b * b + bell_rise * bell_rise) / (2 * bell_rise);  // the centre of the bell's sphere
Point(1) = {0, 0, bell_rise}; Point(2) = {b, 0, 0}; Point(3) = {r, 0, -rise};
Point(4) = {r, 0, -rise - t}; Point(5) = {b, 0, -t}; Point(6) = {0, 0, bell_rise - t};
Point(7) = {0, 0, low}; Point(8) = {0, 0, low - t};
Circle(1) = {1, 7, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Circle(5) = {5, 8, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1:6};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
Field[1] = Cylinder;  // finer elements where the wall is bent
Field[1].Radius = b; Field[1].ZAxis = 10 * bell_rise; Field[1].VIn = bell_mesh_size; Field[1].VOut = 1000;
Background Field = 1;
