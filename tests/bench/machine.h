// What a measurement is made on.
#pragma once

#include <string>

namespace ringdown::bench {

// "AMD EPYC 9B14; 2 cores; LIBRARY", without commas; `library` is what the speed hangs on besides the processor.
std::string this_machine(const std::string& library);

// This thread, and what it starts from here on, may run on so many cores only: of those it could use at the first call,
// the first.
void hold_to_cores(int count);

}  // namespace ringdown::bench
