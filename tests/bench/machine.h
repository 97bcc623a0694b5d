// What a measurement is made on.
#pragma once

#include <string>

namespace ringdown::bench {

// "AMD EPYC 9B14; 2 cores; LIBRARY", without commas; `library` is what the speed hangs on besides the processor.
std::string this_machine(const std::string& library);

// This process and its children may run on so many cores only: of those it may use, the first.
void hold_to_cores(int count);

}  // namespace ringdown::bench
