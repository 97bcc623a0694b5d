#include "clients/cli/picture/response_table.h"

#include "clients/cli/picture/bank_page.h"
#include "clients/cli/picture/canvas.h"
#include "engine/base/formatted.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::cli {
namespace {

constexpr const char* kMark = "    -1\n";

// The number of a direction in universal files: 1 to 3 for x, y and z, negative for the opposite; 0: none of these.
int axis_of(Vec3 direction) {
  constexpr double kAlong = 0.999999;
  const double size = length(direction);
  if (!(size > 0)) return 0;
  int axis = 0;
  for (const double share : {direction.x / size, direction.y / size, direction.z / size}) {
    ++axis;
    if (std::abs(share) > kAlong) return share > 0 ? axis : -axis;
  }
  return 0;
}

}  // namespace

const char* name_of(ResponseTable::Kind kind) {
  constexpr const char* kNames[] = {"receptance", "mobility", "accelerance", "pressure per force", "radiated energy"};
  return kNames[static_cast<int>(kind)];
}

const char* unit_of(ResponseTable::Kind kind) {
  constexpr const char* kUnits[] = {"m/N", "m/(N s)", "1/kg", "Pa/N", "J/Hz/(N s)^2"};
  return kUnits[static_cast<int>(kind)];
}

std::string response_csv(const ResponseTable& table) {
  if (table.kind == ResponseTable::Kind::energy) {
    std::string text = "frequency_hz,energy\n";
    for (std::size_t i = 0; i < table.values.size(); ++i)
      text += formatted("{:.10g},{:.10g}\n", table.frequencies_hz[i], table.values[i].real());
    return text;
  }
  std::string text = "frequency_hz,real,imag,magnitude,phase_deg\n";
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    const std::complex<double>& h = table.values[i];
    text += formatted("{:.10g},{:.10g},{:.10g},{:.10g},{:.6g}\n", table.frequencies_hz[i], h.real(), h.imag(),
                      std::abs(h), std::arg(h) * 180 / std::numbers::pi);
  }
  return text;
}

std::string response_uff(const ResponseTable& table) {
  constexpr int kFrequencyResponse = 4, kComplexDouble = 6, kUneven = 0, kFrequency = 18, kForce = 13;
  constexpr int kMotions[] = {8, 11, 12, 15};  // displacement, velocity, acceleration, pressure
  const int motion = kMotions[static_cast<int>(table.kind)];
  std::string text = formatted("{}{:6}\n", kMark, 15);
  int node = 0;
  for (const Vec3& place : {table.at_m, table.to_m})
    text += formatted("{:10}{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n", ++node, 0, 0, 11, place.x, place.y, place.z);
  text += formatted("{}{}{:6}\n", kMark, kMark, 58);
  const std::string name = clean_text(table.name);
  text += (name.empty() ? "NONE" : name.substr(0, 80)) + "\n";
  text += formatted("{} [{}]\nNONE\n", name_of(table.kind), unit_of(table.kind));
  text += formatted("force along {:.4g} {:.4g} {:.4g}\n", table.direction.x, table.direction.y, table.direction.z);
  text += formatted("response along {:.4g} {:.4g} {:.4g}\n", table.to_direction.x, table.to_direction.y,
                    table.to_direction.z);
  text += formatted("{:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n", kFrequencyResponse, 1, 1, 0, "NONE", 2,
                    axis_of(table.to_direction), "NONE", 1, axis_of(table.direction));
  text += formatted("{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n", kComplexDouble, static_cast<int>(table.values.size()),
                    kUneven, table.frequencies_hz.front(), 0.0, 0.0);
  const auto axis = [&text](int kind, const char* label, const char* unit) {
    text += formatted("{:10}{:5}{:5}{:5} {:<20} {:<20}\n", kind, 0, 0, 0, label, unit);
  };
  axis(kFrequency, "Frequency", "Hz");
  axis(motion, name_of(table.kind), unit_of(table.kind));
  axis(kForce, "Force", "N");
  axis(0, "NONE", "NONE");
  for (std::size_t i = 0; i < table.values.size(); ++i)
    text += formatted("{:13.5E}{:20.12E}{:20.12E}\n", table.frequencies_hz[i], table.values[i].real(),
                      table.values[i].imag());
  return text + kMark;
}

}  // namespace ringdown::cli
