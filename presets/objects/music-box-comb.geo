// A music box's comb: teeth of one sheet of steel, C5 to C7, on a base that is screwed down. Lengths in mm. A tooth has
// f = 0.1615 (thickness / length^2) sqrt(E / rho): `stiffness` is 0.1615 sqrt(E / rho) in mm/s, with what a tooth is
// stiffer than a beam; `root` is by how much it begins inside the base, which gives way.
SetFactory("OpenCASCADE");
DefineConstant[ thickness = 0.5, width = 1.1, gap = 0.6, base = 6, stiffness = 838800, root = 0.12, mesh_size = 1.6 ];
pitch() = {523.25, 587.33, 659.26, 698.46, 783.99, 880, 987.77, 1046.5, 1174.66, 1318.51, 1396.91, 1567.98, 1760, 1975.53, 2093};
step = width + gap;
Rectangle(1) = {-base, -gap, 0, base, 15 * step + gap};
For i In {0 : 14}
  Rectangle(i + 2) = {0, i * step, 0, Sqrt(stiffness * thickness / pitch(i)) - root, width};
EndFor
BooleanFragments{ Surface{1}; Delete; }{ Surface{2 : 16}; Delete; }
Extrude {0, 0, thickness} { Surface{1 : 16}; Layers{1}; }
foot() = Surface In BoundingBox {-base - 0.01, -gap - 0.01, -0.01, 0.01, 15 * step + 0.01, 0.01};
Physical Surface("foot") = {foot()};
Physical Volume("comb") = {1 : 16};
