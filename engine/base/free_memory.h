// How much memory this process may still take. [any thread]
#pragma once

namespace ringdown {

// Bytes: what the computer has available, or less where the process's limits (RLIMIT_AS, a control group) leave less.
// Infinity where nothing of this is known.
double free_memory_bytes();

}  // namespace ringdown
