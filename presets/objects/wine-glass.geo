// A wine glass: thin bowl, stem and foot in one piece of glass, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ rim_radius = 32, wall = 1.6, stem = 60, mesh_size = 6 ];
s = rim_radius / 32;
Macro At
  point = newp; Point(point) = {r, 0, z};
Return
r = 0;              z = 0;               Call At; foot_axis = point;
r = 34 * s;         z = 0;               Call At; foot_low = point;
r = 34 * s;         z = 2;               Call At; foot_rim = point;
r = 15 * s;         z = 4;               Call At; foot_mid = point;
r = 5;              z = 12;              Call At; stem_low = point;
r = 4;              z = 0.5 * stem;      Call At; stem_mid = point;
r = 5;              z = stem;            Call At; stem_top = point;
r = 20 * s;         z = stem + 12 * s;   Call At; b1 = point;
r = 34 * s;         z = stem + 32 * s;   Call At; b2 = point;
r = 38 * s;         z = stem + 52 * s;   Call At; b3 = point;
r = 36 * s;         z = stem + 75 * s;   Call At; b4 = point;
r = rim_radius;     z = stem + 100 * s;  Call At; rim_out = point;
r = rim_radius - wall;   z = stem + 100 * s;       Call At; rim_in = point;
r = 36 * s - wall;  z = stem + 75 * s;   Call At; c4 = point;
r = 38 * s - wall;  z = stem + 52 * s;   Call At; c3 = point;
r = 34 * s - wall;  z = stem + 32.5 * s; Call At; c2 = point;
r = 19.5 * s - wall; z = stem + 14 * s;  Call At; c1 = point;
r = 0;              z = stem + 6 * s;    Call At; well = point;
Line(1) = {foot_axis, foot_low};
Line(2) = {foot_low, foot_rim};
Spline(3) = {foot_rim, foot_mid, stem_low, stem_mid, stem_top, b1, b2, b3, b4, rim_out};
Line(4) = {rim_out, rim_in};
Spline(5) = {rim_in, c4, c3, c2, c1, well};
Line(6) = {well, foot_axis};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
