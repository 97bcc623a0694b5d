// A fork: a flat handle and four tines, along x. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ length = 200, width = 24, thickness = 2.4, mesh_size = 5 ];
a = 0.5 * length; w = 0.5 * width;
t = 0.15 * width;            // a tine
p = (width - t) / 3;         // from tine to tine
Point(1) = {-a, -8, 0};          Point(2) = {-0.6 * a, -7, 0};
Point(3) = {0.1 * a, -3.5, 0};   Point(4) = {0.3 * a, -5, 0};
Point(5) = {0.45 * a, -w, 0};    Point(6) = {a, -w, 0};
Point(7) = {a, -w + t, 0};       Point(8) = {0.5 * a, -w + t, 0};
Point(9) = {0.5 * a, -w + p, 0}; Point(10) = {a, -w + p, 0};
Point(11) = {a, -w + p + t, 0};  Point(12) = {0.5 * a, -w + p + t, 0};
Point(13) = {0.5 * a, w - p - t, 0}; Point(14) = {a, w - p - t, 0};
Point(15) = {a, w - p, 0};       Point(16) = {0.5 * a, w - p, 0};
Point(17) = {0.5 * a, w - t, 0}; Point(18) = {a, w - t, 0};
Point(19) = {a, w, 0};           Point(20) = {0.45 * a, w, 0};
Point(21) = {0.3 * a, 5, 0};     Point(22) = {0.1 * a, 3.5, 0};
Point(23) = {-0.6 * a, 7, 0};    Point(24) = {-a, 8, 0};
Spline(1) = {1, 2, 3, 4, 5};
For i In {5:19}
  Line(i) = {i, i + 1};
EndFor
Spline(20) = {20, 21, 22, 23, 24};
Line(21) = {24, 1};
Curve Loop(1) = {1, 5:21};
Plane Surface(1) = {1};
Extrude {0, 0, thickness} { Surface{1}; }
