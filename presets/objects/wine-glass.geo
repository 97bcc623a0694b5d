// A wine glass: thin bowl, stem and foot in one piece of glass, turned about its axis. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ rim_radius = 32, wall = 1.6, stem = 60, mesh_size = 6 ];
Mesh.MeshSizeFromCurvature = 9;  // the stem is thinner than mesh_size
Mesh.MeshSizeMin = 2.5;          // and on the axis the curvature has no limit
s = rim_radius / 32;
Point(1) = {0, 0, 0};  // foot axis
Point(2) = {34 * s, 0, 0};  // foot low
Point(3) = {34 * s, 0, 2};  // foot rim
Point(4) = {15 * s, 0, 4};  // foot mid
Point(5) = {5, 0, 12};  // stem low
Point(6) = {4, 0, 0.5 * stem};  // stem mid
Point(7) = {5, 0, stem};  // stem top
Point(8) = {20 * s, 0, stem + 12 * s};  // b1
Point(9) = {34 * s, 0, stem + 32 * s};  // b2
Point(10) = {38 * s, 0, stem + 52 * s};  // b3
Point(11) = {36 * s, 0, stem + 75 * s};  // b4
Point(12) = {rim_radius, 0, stem + 100 * s};  // rim out
Point(13) = {rim_radius - wall, 0, stem + 100 * s};  // rim in
Point(14) = {36 * s - wall, 0, stem + 75 * s};  // c4
Point(15) = {38 * s - wall, 0, stem + 52 * s};  // c3
Point(16) = {34 * s - wall, 0, stem + 32.5 * s};  // c2
Point(17) = {19.5 * s - wall, 0, stem + 14 * s};  // c1
Point(18) = {0, 0, stem + 6 * s};  // well
Line(1) = {1, 2};
Line(2) = {2, 3};
Spline(3) = {3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
Line(4) = {12, 13};
Spline(5) = {13, 14, 15, 16, 17, 18};
Line(6) = {18, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
