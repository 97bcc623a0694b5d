// A wood block: a slab with a slot sawn into each long side, above and below the middle. Lengths in mm.
SetFactory("OpenCASCADE");
DefineConstant[ length = 180, width = 70, height = 42, slot = 5, slot_depth = 52, slot_length = 140, plate = 9, mesh_size = 13 ];
Box(1) = {-0.5 * length, -0.5 * width, 0, length, width, height};
Box(2) = {-0.5 * slot_length, -0.5 * width - 1, plate, slot_length, slot_depth + 1, slot};
Box(3) = {-0.5 * slot_length, 0.5 * width - slot_depth, height - plate - slot, slot_length, slot_depth + 1, slot};
BooleanDifference{ Volume{1}; Delete; }{ Volume{2, 3}; Delete; }
