// Checks that OpenBLAS can allocate its memory; without it OpenBLAS hangs. [main]
#pragma once

#include "engine/base/result.h"

namespace ringdown {

// Fails if the program links OpenBLAS and the address space is too small: OpenBLAS needs 128 MiB for each of our
// threads that calls it. OpenBLAS's own threads allocate as much before main() begins. Without memory OpenBLAS retries
// for ever, and fork() and exit() wait for its threads, so a program whose check has failed must end by std::_Exit().
Result<void> check_blas_memory();

}  // namespace ringdown
