// A church bell's profile turned about its axis, with a hole for the bolt in the crown. Lengths in mm.
// The profile is drawn for a mouth of diameter 1: thick sound bow, waist of a third of it, rounded shoulder.
SetFactory("OpenCASCADE");
DefineConstant[ diameter = 300, mesh_size = 22 ];
Macro At
  point = newp; Point(point) = {r * diameter, 0, z * diameter};
Return
r = 0.500; z = 0.000; Call At; lip_out = point;
r = 0.488; z = 0.045; Call At; o1 = point;
r = 0.425; z = 0.130; Call At; o2 = point;
r = 0.345; z = 0.270; Call At; o3 = point;
r = 0.295; z = 0.430; Call At; o4 = point;
r = 0.270; z = 0.580; Call At; o5 = point;
r = 0.258; z = 0.690; Call At; shoulder_out = point;
r = 0.215; z = 0.755; Call At; o6 = point;
r = 0.120; z = 0.780; Call At; o7 = point;
r = 0.030; z = 0.785; Call At; crown_out = point;
r = 0.030; z = 0.735; Call At; crown_in = point;
r = 0.110; z = 0.732; Call At; i7 = point;
r = 0.190; z = 0.705; Call At; i6 = point;
r = 0.222; z = 0.665; Call At; shoulder_in = point;
r = 0.236; z = 0.570; Call At; i5 = point;
r = 0.262; z = 0.425; Call At; i4 = point;
r = 0.310; z = 0.265; Call At; i3 = point;
r = 0.375; z = 0.135; Call At; i2 = point;
r = 0.425; z = 0.055; Call At; i1 = point;
r = 0.480; z = 0.000; Call At; lip_in = point;
Spline(1) = {lip_out, o1, o2, o3, o4, o5, shoulder_out};
Spline(2) = {shoulder_out, o6, o7, crown_out};
Line(3) = {crown_out, crown_in};
Spline(4) = {crown_in, i7, i6, shoulder_in};
Spline(5) = {shoulder_in, i5, i4, i3, i2, i1, lip_in};
Line(6) = {lip_in, lip_out};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
