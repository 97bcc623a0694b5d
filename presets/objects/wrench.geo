// An open-ended wrench: a shank with a jaw at each end, along x. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ length = 200, shank = 14, thickness = 7, head = 19, jaw = 17, mesh_size = 9 ];
h = 0.5 * length - head;
Box(1) = {-h, -0.5 * shank, 0, 2 * h, shank, thickness};
Cylinder(2) = {-h, 0, 0, 0, 0, thickness, head};
Cylinder(3) = {h, 0, 0, 0, 0, thickness, head};
Box(4) = {-h - 2 * head, -0.5 * jaw, -1, 2 * head + 3, jaw, thickness + 2};
Box(5) = {h - 3, -0.45 * jaw, -1, 2 * head + 3, 0.9 * jaw, thickness + 2};
Rotate { {0, 0, 1}, {-h, 0, 0}, Pi / 12 } { Volume{4}; }
Rotate { {0, 0, 1}, {h, 0, 0}, Pi / 12 } { Volume{5}; }
body[] = BooleanUnion{ Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
BooleanDifference{ Volume{body[]}; Delete; }{ Volume{4, 5}; Delete; }
