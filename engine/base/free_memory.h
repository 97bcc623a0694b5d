// Finds how much more memory this process may use. [any thread]
#pragma once

namespace ringdown {

// Returns the computer's available memory [bytes], or less if the process's limits (RLIMIT_AS, a control group) leave
// less. Infinity if nothing is known.
double free_memory_bytes();

}  // namespace ringdown
