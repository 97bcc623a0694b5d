// A kalimba's tines: eight strips of steel side by side, C4 to C5, that stand out from a bridge at x = 0. Lengths in mm.
// A strip clamped at one end has f = 0.1615 (thickness / length^2) sqrt(E / rho): `stiffness` is 0.1615 sqrt(E / rho) in
// mm/s, with what a strip is stiffer than a beam.
SetFactory("OpenCASCADE");
DefineConstant[ thickness = 0.9, width = 4.5, gap = 1.5, stiffness = 846600, mesh_size = 7 ];
pitch() = {293.66, 349.23, 440, 523.25, 493.88, 392, 329.63, 261.63};
For i In {0 : 7}
  length = Sqrt(stiffness * thickness / pitch(i));
  y = (i - 3.5) * (width + gap);
  Box(i + 1) = {0, y - 0.5 * width, 0, length, width, thickness};
EndFor
all() = Curve{:};
Transfinite Curve{all()} = 2;
For i In {0 : 7}
  length = Sqrt(stiffness * thickness / pitch(i));
  y = (i - 3.5) * (width + gap);
  For side In {0 : 1}
    For height In {0 : 1}
      e = 0.01;
      at() = Curve In BoundingBox {-e, y + (side - 0.5) * width - e, height * thickness - e, length + e, y + (side - 0.5) * width + e, height * thickness + e};
      Transfinite Curve{at()} = Ceil(length / mesh_size) + 1;
    EndFor
  EndFor
EndFor
Transfinite Surface{:};
Transfinite Volume{:};
