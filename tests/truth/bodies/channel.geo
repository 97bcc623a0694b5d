// Three plates that form a U, open downwards: a top and two legs. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ width = 120, height = 300, depth = 150, wall = 10, mesh_size = 12 ];
Box(1) = {0, 0, -height, width, depth, height};
Box(2) = {wall, 0, -height, width - 2 * wall, depth, height - wall};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
