// A rectangular block about the origin. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ length = 250, width = 180, thickness = 3, mesh_size = 12 ];
Box(1) = {-0.5 * length, -0.5 * width, -0.5 * thickness, length, width, thickness};
