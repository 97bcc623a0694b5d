// A rice bowl on a foot ring, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 70, wall = 3.5, mesh_size = 9 ];
s = radius / 70;
Macro At
  point = newp; Point(point) = {r, 0, z};
Return
r = 0;            z = 5 * s;         Call At; below = point;
r = 22 * s;       z = 5 * s;         Call At; ring_in_top = point;
r = 23 * s;       z = 0;             Call At; ring_in = point;
r = 27 * s;       z = 0;             Call At; ring_out = point;
r = 28 * s;       z = 7 * s;         Call At; ring_out_top = point;
r = 48 * s;       z = 18 * s;        Call At; o1 = point;
r = 62 * s;       z = 36 * s;        Call At; o2 = point;
r = 70 * s;       z = 64 * s;        Call At; rim_out = point;
r = 70 * s - 0.8 * wall;  z = 64 * s;                Call At; rim_in = point;
r = 62 * s - wall;        z = 37 * s;                Call At; i2 = point;
r = 46.5 * s - 0.7 * wall;    z = 18 * s + wall;     Call At; i1 = point;
r = 26 * s;       z = 7 * s + 1.2 * wall;            Call At; i0 = point;
r = 0;            z = 5 * s + 1.3 * wall;            Call At; above = point;
Line(1) = {below, ring_in_top};
Line(2) = {ring_in_top, ring_in};
Line(3) = {ring_in, ring_out};
Line(4) = {ring_out, ring_out_top};
Spline(5) = {ring_out_top, o1, o2, rim_out};
Line(6) = {rim_out, rim_in};
Spline(7) = {rim_in, i2, i1, i0, above};
Line(8) = {above, below};
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7, 8};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
