// A crotale (antique cymbal): a thick disc with a boss in its middle and a hole for the cord. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 110, thickness = 4.5, boss = 11, boss_radius = 13, hole = 3.5, mesh_size = 8 ];
r = 0.5 * diameter; t = thickness;
Point(1) = {hole, 0, 0}; Point(2) = {r, 0, 0}; Point(3) = {r, 0, t}; Point(4) = {boss_radius + 5, 0, t};
Point(5) = {boss_radius, 0, boss}; Point(6) = {hole, 0, boss};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1:6};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
