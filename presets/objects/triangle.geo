// A triangle: a round rod bent twice, open at its third corner, in the plane of x and y. Lengths in mm.
// `side` is from corner to corner, as if the bends were sharp. The section is a disc of few elements drawn out along the rod.
SetFactory("OpenCASCADE");
DefineConstant[ side = 165, rod = 9, bend = 14, gap = 18, around = 10, mesh_size = 9 ];
k = bend * Sqrt(3);  // from a corner to where its bend begins
c = 0.5; s = Sqrt(3) / 2;
bent = Ceil(2 * Pi / 3 * bend / mesh_size) + 1;
Circle(1) = {0, 0, 0, 0.5 * rod};
Transfinite Curve{1} = around + 1;
Curve Loop(1) = {1};
Plane Surface(1) = {1};
Rotate { {0, 1, 0}, {0, 0, 0}, 0.5 * Pi } { Surface{1}; }
Translate {gap, 0, 0} { Surface{1}; }
a[] = Extrude {side - k - gap, 0, 0} { Surface{1}; Layers{ Ceil((side - k - gap) / mesh_size) }; };
b[] = Extrude { {0, 0, 1}, {side - k, bend, 0}, 2 * Pi / 3 } { Surface{a[0]}; Layers{bent}; };
e[] = Extrude {-c * (side - 2 * k), s * (side - 2 * k), 0} { Surface{b[0]}; Layers{ Ceil((side - 2 * k) / mesh_size) }; };
f[] = Extrude { {0, 0, 1}, {c * side, s * side - 2 * bend, 0}, 2 * Pi / 3 } { Surface{e[0]}; Layers{bent}; };
Extrude {-c * (side - k - gap), -s * (side - k - gap), 0} { Surface{f[0]}; Layers{ Ceil((side - k - gap) / mesh_size) }; }
