// A frequency response as a table: CSV, and the Universal File Format's dataset 58. [any]
#pragma once

#include "engine/base/vec3.h"

#include <complex>
#include <string>
#include <vector>

namespace ringdown::cli {

struct ResponseTable {
  enum class Kind { receptance, mobility, accelerance, pressure, energy };  // energy: real, of an impulse of 1 N s
  Kind kind = Kind::mobility;
  std::string name;  // of the body
  Vec3 at_m, direction, to_m, to_direction;
  std::vector<double> frequencies_hz;  // ascending
  std::vector<std::complex<double>> values;
};

const char* name_of(ResponseTable::Kind kind);  // "mobility"
const char* unit_of(ResponseTable::Kind kind);  // "m/(N s)"

// Columns: frequency_hz, real, imag, magnitude, phase_deg; of an energy frequency_hz, energy.
std::string response_csv(const ResponseTable& table);

// Returns one dataset 58 with complex doubles and uneven spacing; a table of energies has none. The places are nodes 1
// and 2, with their coordinates in a dataset 15 before it. A direction along an axis of the body is stated; any other
// one is stated as a scalar, with its components in the description.
std::string response_uff(const ResponseTable& table);

}  // namespace ringdown::cli
