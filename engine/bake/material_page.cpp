#include "engine/bake/material_page.h"

#include "engine/bake/material_library.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

namespace ringdown::bake {
namespace {

struct Figure {
  const char *key, *symbol;
  double value;  // in the table's unit
};

std::array<Figure, 5> figures_of(const modal::Material& material) {
  return {{{"youngs_modulus_pa", "E", material.youngs_modulus_pa / 1e9},
           {"poisson_ratio", "nu", material.poisson_ratio},
           {"density_kg_m3", "rho", material.density_kg_m3},
           {"alpha_per_s", "alpha", material.damping.alpha_per_s},
           {"beta_s", "beta", material.damping.beta_s}}};
}

std::string text(double value, const char* format = "%.5g") {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

bool holds(const std::string& source, std::string_view words) { return source.find(words) != std::string::npos; }

std::string marked(const std::string& figure, const std::string& source) {
  const std::string shown = holds(source, kOurChoice) ? "*" + figure + "*" : figure;
  return holds(source, kToBeChecked) ? shown + " ?" : shown;
}

// Seconds in which a mode of an undamped 1 kHz falls by 60 dB: ln(1000) / d with d = (alpha + beta lambda) / 2.
double t60_at_1_khz(modal::RayleighDamping damping) {
  const double omega = 2 * M_PI * 1000;
  return std::log(1000.0) / ((damping.alpha_per_s + damping.beta_s * omega * omega) / 2);
}

std::string figure_row(const MaterialEntry& entry) {
  std::string row = "| `" + entry.material.name + "` | " + entry.description + " |";
  for (const Figure& figure : figures_of(entry.material)) {
    row += " " + marked(text(figure.value), entry.sources.at(figure.key)) + " |";
  }
  return row + " " + text(t60_at_1_khz(entry.material.damping), "%.2g") + " |\n";
}

// One row for each source of the material, with all figures that share it.
std::string source_rows(const MaterialEntry& entry) {
  std::vector<std::pair<std::string, std::string>> groups;  // source, symbols
  for (const Figure& figure : figures_of(entry.material)) {
    const std::string& source = entry.sources.at(figure.key);
    if (!groups.empty() && groups.back().first == source) {
      groups.back().second += std::string(", ") + figure.symbol;
    } else {
      groups.emplace_back(source, figure.symbol);
    }
  }
  std::string rows;
  for (const auto& [source, symbols] : groups) {
    rows += "| `" + entry.material.name + "` | " + symbols + " | " + source + " |\n";
  }
  return rows;
}

}  // namespace

Result<std::string> materials_as_markdown(const std::filesystem::path& folder) {
  const std::vector<std::string> names = names_in(folder);
  if (names.empty()) return fail(ErrorKind::bad_input, "there are no materials in " + folder.string());
  std::string figures =
      "| material | what it is | E [GPa] | nu | rho [kg/m^3] | alpha [1/s] | beta [s] | T60 at 1 kHz [s] |\n"
      "|---|---|---|---|---|---|---|---|\n";
  std::string sources = "| material | figures | source |\n|---|---|---|\n";
  for (const std::string& name : names) {
    const Result<MaterialEntry> entry = read_material(folder / (name + ".toml"));
    if (!entry) return fail(entry.error());
    figures += figure_row(*entry);
    sources += source_rows(*entry);
  }
  return figures + "\n" + sources;
}

}  // namespace ringdown::bake
