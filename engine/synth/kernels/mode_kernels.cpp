// The kernels that compute modes one by one, and mix the results. They are one translation unit, because everything
// they include is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/synth/kernels/mode_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles the rest of this file once for each instruction set

#include "engine/synth/kernels/coupled_kernel-inl.h"
#include "engine/synth/kernels/direction_kernel-inl.h"
#include "engine/synth/kernels/drive_kernel-inl.h"
#include "engine/synth/kernels/glide_kernel-inl.h"
#include "engine/synth/kernels/mix_kernel-inl.h"
#include "engine/synth/kernels/mode_kernel-inl.h"
#include "engine/synth/kernels/pulse_kernel-inl.h"
