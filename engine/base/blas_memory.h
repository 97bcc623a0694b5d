// Asks whether OpenBLAS gets the memory without which it waits for ever. [main]
#pragma once

#include "engine/base/result.h"

namespace ringdown {

// Fails where the address space does not suffice for OpenBLAS in a program that links it: 128 MiB for each of our
// threads that calls it. Its own threads ask for as much before main() begins. Where OpenBLAS gets no memory it asks
// again and again, and fork() and exit() wait for its threads: a program whose check has failed ends by std::_Exit().
Result<void> check_blas_memory();

}  // namespace ringdown
