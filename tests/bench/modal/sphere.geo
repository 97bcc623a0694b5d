// A ball about the origin. Lengths in mm. Names no mesh size: that is ringdown-bake's to choose.
SetFactory("OpenCASCADE");
DefineConstant[ radius = 100 ];
Sphere(1) = {0, 0, 0, radius};
