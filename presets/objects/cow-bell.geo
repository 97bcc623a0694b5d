// A cow bell: a hollow frustum of a rectangle, closed above, open below. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ height = 130, mouth_x = 100, mouth_y = 60, crown_x = 62, crown_y = 34, wall = 2.4, mesh_size = 14 ];
For k In {0:3}
  inside = (k >= 2) ? wall : 0;                 // 0, 1: outside, mouth and crown; 2, 3: inside
  above = (k == 1 || k == 3) ? 1 : 0;
  x = 0.5 * (above ? crown_x : mouth_x) - inside;
  y = 0.5 * (above ? crown_y : mouth_y) - inside;
  z = above ? height - inside : 0;
  Point(4 * k + 1) = {-x, -y, z}; Point(4 * k + 2) = {x, -y, z}; Point(4 * k + 3) = {x, y, z}; Point(4 * k + 4) = {-x, y, z};
  Line(4 * k + 1) = {4 * k + 1, 4 * k + 2}; Line(4 * k + 2) = {4 * k + 2, 4 * k + 3};
  Line(4 * k + 3) = {4 * k + 3, 4 * k + 4}; Line(4 * k + 4) = {4 * k + 4, 4 * k + 1};
  Curve Loop(k + 1) = {4 * k + 1, 4 * k + 2, 4 * k + 3, 4 * k + 4};
EndFor
Ruled ThruSections(1) = {1, 2};
Ruled ThruSections(2) = {3, 4};
BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }
