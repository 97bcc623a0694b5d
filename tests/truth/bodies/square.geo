// A square plate about the origin, drawn out in one layer. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ width = 10000, thickness = 50, mesh_size = 500 ];
Rectangle(1) = {-0.5 * width, -0.5 * width, -0.5 * thickness, width, width};
Extrude {0, 0, thickness} { Surface{1}; Layers{1}; }
