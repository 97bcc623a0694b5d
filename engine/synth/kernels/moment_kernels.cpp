// The kernels that compute modes by the moments of their bands. They are one translation unit, because everything they
// include is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/synth/kernels/moment_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once for each instruction set

#include "engine/synth/kernels/field_sums-inl.h"
#include "engine/synth/kernels/heard_moments-inl.h"
#include "engine/synth/kernels/moment_synthesis-inl.h"
#include "engine/synth/kernels/moments-inl.h"
