// A mug with a handle: turned body, and a bent round rod that the wall cuts off inside. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 41, height = 92, wall = 4, handle = 9, mesh_size = 11 ];
Mesh.MeshSizeFromCurvature = 7;  // the handle is thinner than mesh_size
Cylinder(1) = {0, 0, 0, 0, 0, height, radius};
Cylinder(2) = {0, 0, 1.4 * wall, 0, 0, height, radius - wall};
Torus(3) = {0, 0, 0, 0.29 * height, 0.5 * handle};
Rotate { {1, 0, 0}, {0, 0, 0}, 0.5 * Pi } { Volume{3}; }
Rotate { {0, 1, 0}, {0, 0, 0}, 0.9 * Pi } { Volume{3}; }
Translate {radius - 1.5, 0, 0.5 * height} { Volume{3}; }
body() = BooleanUnion{ Volume{1}; Delete; }{ Volume{3}; Delete; };
BooleanDifference{ Volume{body()}; Delete; }{ Volume{2}; Delete; }
