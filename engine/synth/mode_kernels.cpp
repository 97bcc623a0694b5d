// The kernels that compute modes one by one, and mix what they make. They are one unit, because what they include is
// compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/synth/mode_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once for each instruction set

#include "engine/synth/coupled_kernel-inl.h"
#include "engine/synth/direction_kernel-inl.h"
#include "engine/synth/drive_kernel-inl.h"
#include "engine/synth/mix_kernel-inl.h"
#include "engine/synth/mode_kernel-inl.h"
