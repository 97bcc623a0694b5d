// A small anvil: foot, waist, body and horn, along x. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ length = 220, width = 60, height = 130, mesh_size = 32 ];
l = length; w = width; h = height;
Box(1) = {-0.28 * l, -0.75 * w, 0, 0.56 * l, 1.5 * w, 0.22 * h};
Box(2) = {-0.17 * l, -0.36 * w, 0.1 * h, 0.34 * l, 0.72 * w, 0.6 * h};
Box(3) = {-0.5 * l, -0.5 * w, 0.62 * h, 0.72 * l, w, 0.38 * h};
Cone(4) = {0.2 * l, 0, 0.81 * h, 0.42 * l, 0, 0.06 * h, 0.19 * h, 0.03 * h};
BooleanUnion{ Volume{1}; Delete; }{ Volume{2, 3, 4}; Delete; }
