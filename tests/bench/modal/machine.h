// What a measurement was made on.
#pragma once

#include <string>

namespace ringdown::bench {

// "AMD EPYC 9B14; 2 cores; OpenBLAS 0.3.21 (SkylakeX)", without commas.
std::string this_machine();

}  // namespace ringdown::bench
