// What the modal benchmark measures, in order, and what it promises.
#pragma once

#include "tests/bench/modal/measurement.h"
#include "tests/bench/promise.h"

#include <string>
#include <vector>

namespace ringdown::bench {

// The parts, each of which can be run alone:
//   default   errors against exact values as ringdown-bake comes
//   peers     200 modes of 60,000 unknowns, by everybody, on four bodies
//   agreement a small block, where CalculiX must give the frequencies of its own matrices
//   threads   the same by two threads
//   many      1,000 modes of 8,000 unknowns
//   memory    200 modes of 200,000 unknowns
//   choice    small bodies with few modes, by Spectra and by block Lanczos: between which `auto` chooses
//   series    error against time: element orders and mesh sizes
//   growth    time and memory against unknowns and modes
// and `amplitude`, which is not a matter of time and has its own plan (amplitude.h).
//
// `quick` is the same in small: a minute or two, for seeing that everything works. Its figures promise nothing.
std::vector<Spec> plan(bool quick);

// The bell has no exact frequencies: its errors are against this, the finest measured. It is measured before the rest
// of its series.
Spec bell_reference(bool quick);

// `quick`: only that all methods find the same frequencies; times of small meshes say nothing.
std::vector<Promise> promises(const std::vector<Spec>& plan, const Measurements& all, bool quick);

// The fastest of SLEPc's ways on the mesh of `spec`; nullptr when none was measured.
const Measurement* fastest_slepc(const Measurements& all, const Spec& spec);

}  // namespace ringdown::bench
