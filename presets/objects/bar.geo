// A tuned bar: a box along x with an arch cut out below its middle. Lengths in mm.
// The arch's depth sets the second bending mode's place above the first, its share of the length the third's
// (docs/use/tuning.md). The mesh is regular and drawn out to both sides from the middle, so that it
// is symmetric as the bar is.
SetFactory("OpenCASCADE");
DefineConstant[ length = 300, width = 50, thickness = 12.7, arch_share = 0.6, arch_depth = 6, mesh_size = 12 ];
h = 0.5 * length; a = 0.5 * arch_share * length; d = arch_depth;
high = Ceil(0.6 * thickness / mesh_size); across = Ceil(0.28 * width / mesh_size);  // layers, of half the width
Point(1) = {-h, 0, 0};  Point(2) = {-a, 0, 0};  Point(3) = {a, 0, 0};  Point(4) = {h, 0, 0};
Point(5) = {h, 0, thickness};  Point(6) = {a, 0, thickness};  Point(7) = {-a, 0, thickness};  Point(8) = {-h, 0, thickness};
Point(9) = {-0.75 * a, 0, 0.66 * d};  Point(10) = {-0.4 * a, 0, 0.96 * d};  Point(11) = {0, 0, d};
Point(12) = {0.4 * a, 0, 0.96 * d};   Point(13) = {0.75 * a, 0, 0.66 * d};
Line(1) = {1, 2};  Spline(2) = {2, 9, 10, 11, 12, 13, 3};  Line(3) = {3, 4};
Line(4) = {4, 5};  Line(5) = {5, 6};  Line(6) = {6, 7};  Line(7) = {7, 8};  Line(8) = {8, 1};
Line(9) = {2, 7};  Line(10) = {3, 6};
Curve Loop(1) = {1, 9, 7, 8};  Plane Surface(1) = {1};
Curve Loop(2) = {2, 10, 6, -9};  Plane Surface(2) = {2};
Curve Loop(3) = {3, 4, 5, -10};  Plane Surface(3) = {3};
Transfinite Curve{1, 3, 5, 7} = Ceil((h - a) / mesh_size) + 1;
Transfinite Curve{2, 6} = Ceil(2 * a / mesh_size) + 1;
Transfinite Curve{4, 8, 9, 10} = high + 1;
Transfinite Surface{1, 2, 3} Alternated;
Extrude {0, 0.5 * width, 0} { Surface{1, 2, 3}; Layers{across}; }
Extrude {0, -0.5 * width, 0} { Surface{1, 2, 3}; Layers{across}; }
