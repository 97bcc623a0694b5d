// An empty tin, open above: a thin wall with a bead at its rim and a flat floor, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 37, height = 110, wall = 0.5, bead = 1.5, mesh_size = 8 ];
r = radius; h = height; w = wall;
Point(1) = {0, 0, 0}; Point(2) = {r, 0, 0}; Point(3) = {r, 0, h - 2 * bead}; Point(4) = {r + bead, 0, h - 2 * bead}; Point(5) = {r + bead, 0, h};
Point(6) = {r - w, 0, h}; Point(7) = {r - w, 0, w}; Point(8) = {0, 0, w};
For i In {1:7}
  Line(i) = {i, i + 1};
EndFor
Line(8) = {8, 1};
Curve Loop(1) = {1:8};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
