// A rectangular block about the origin. Lengths in mm. Names no mesh size: that is ringdown-bake's to choose.
SetFactory("OpenCASCADE");
DefineConstant[ length = 100, width = 80, thickness = 60 ];
Box(1) = {-0.5 * length, -0.5 * width, -0.5 * thickness, length, width, thickness};
