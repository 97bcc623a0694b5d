// How loud a body sounds in each direction: of one mode, or of all modes in a band after a blow. [any]
#pragma once

#include "clients/cli/picture/answer.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/modal/bank.h"

#include <string>
#include <string_view>
#include <vector>

namespace ringdown::cli {

// The modes of which the directions are shown.
struct Sounding {
  std::vector<std::size_t> modes;
  std::string title;  // "mode 3, 512 Hz", "500 to 2000 Hz"
};

// Reads "3", a mode's number, or "500-2000", a band in Hz. Fails for a mode that the bank does not have, a band without
// modes, and a bank without radiation maps.
Result<Sounding> sounding_of(const modal::Bank& bank, std::string_view text);

class Directivity {
 public:
  // Modes of a band add up by energy, each as loud as the blow makes it. `bank` must live longer.
  Directivity(const modal::Bank& bank, const Answer& blow, const Sounding& sounding);

  // The level towards a direction [dB re the mean over all directions].
  [[nodiscard]] double level_db(Vec3 direction) const;

 private:
  struct Part {
    const modal::FarField* field;
    double weight;
  };
  std::vector<Part> parts_;
  int degree_ = 0;
  double mean_ = 0;  // of the squared pressure, over all directions
};

// Columns: azimuth_deg, elevation_deg, x, y, z, level_db; a grid of 5 degrees, azimuth from +x towards +y.
std::string directivity_csv(const Directivity& directivity);

}  // namespace ringdown::cli
