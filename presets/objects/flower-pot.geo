// A flower pot with a collar and a hole in its floor, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 70, height = 130, wall = 6, mesh_size = 15 ];
r = radius; h = height; w = wall;
Point(1) = {10, 0, 0}; Point(2) = {0.66 * r, 0, 0}; Point(3) = {0.90 * r, 0, 0.78 * h}; Point(4) = {0.97 * r, 0, 0.78 * h};
Point(5) = {r, 0, h}; Point(6) = {r - 1.4 * w, 0, h}; Point(7) = {0.90 * r - w, 0, 0.78 * h}; Point(8) = {0.66 * r - 0.8 * w, 0, 1.3 * w}; Point(9) = {10, 0, 1.3 * w};
For i In {1:8}
  Line(i) = {i, i + 1};
EndFor
Line(9) = {9, 1};
Curve Loop(1) = {1:9};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
