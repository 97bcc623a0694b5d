#include "engine/materials/material_library.h"

#include "engine/base/quote.h"
#include "engine/base/toml_table.h"
#include "engine/fem/elastic.h"
#include "engine/materials/material_grain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace ringdown::bake {
namespace {

// Bounds that no solid exceeds; fem::check_elastic() is stricter.
constexpr Range kYoungsModulus_pa{1e3, 1e13};
constexpr Range kPoissonRatio{-1, 0.5};
constexpr Range kDensity_kg_m3{0.1, 1e5};
constexpr Range kAlpha_per_s{0, 1e6};
constexpr Range kBeta_s{0, 1};
constexpr Range kFrequency_hz{1e-3, 1e9};
constexpr Range kLossFactor{1e-12, 10};
constexpr Range kUncertainty{1, 100};
constexpr Range kExpansion_per_k{1e-9, 1e-2};
constexpr Range kConductivity_w_mk{1e-3, 1e4};
constexpr Range kHeatCapacity_j_kgk{10, 1e4};
constexpr Range kStrength_pa{1e3, 1e12};
constexpr Range kWeibullModulus{1, 1000};
constexpr Range kStrengthArea_m2{1e-9, 1e3};
constexpr Range kToughness_pa_sqrt_m{1, 1e9};

// One figure of a material: its key in a file, and how a table writes it.
struct Figure {
  const char* key;
  double& value;
  Range range;
  double table_unit = 1;
};

std::array<Figure, 5> figures_of(modal::Material& material) {
  return {{{"youngs_modulus_pa", material.youngs_modulus_pa, kYoungsModulus_pa, 1e9},
           {"poisson_ratio", material.poisson_ratio, kPoissonRatio},
           {"density_kg_m3", material.density_kg_m3, kDensity_kg_m3},
           {"alpha_per_s", material.damping.alpha_per_s, kAlpha_per_s},
           {"beta_s", material.damping.beta_s, kBeta_s}}};
}

Result<void> check_stable(const modal::Material& material) {
  return fem::check_elastic({material.youngs_modulus_pa, material.poisson_ratio, material.density_kg_m3});
}

// Rayleigh's constants, which a list replaces.
bool is_damping(const Figure& figure, const modal::Material& material) {
  return &figure.value == &material.damping.alpha_per_s || &figure.value == &material.damping.beta_s;
}

std::array<Figure, 3> figures_of(modal::Thermal& thermal) {
  return {{{"expansion_per_k", thermal.expansion_per_k, kExpansion_per_k, 1e-6},
           {"conductivity_w_mk", thermal.conductivity_w_mk, kConductivity_w_mk},
           {"heat_capacity_j_kgk", thermal.heat_capacity_j_kgk, kHeatCapacity_j_kgk}}};
}

// The last one, the area, may be left out.
std::array<Figure, 4> figures_of(modal::Brittleness& brittleness) {
  auto& [strength_pa, weibull_modulus, area_m2] = brittleness.strength;
  return {{{"strength_pa", strength_pa, kStrength_pa, 1e6},
           {"weibull_modulus", weibull_modulus, kWeibullModulus},
           {"toughness_pa_sqrt_m", brittleness.toughness_pa_sqrt_m, kToughness_pa_sqrt_m, 1e6},
           {"strength_area_m2", area_m2, kStrengthArea_m2, 1e-4}}};
}

void read_figure(TomlTable& file, const Figure& wanted, MaterialEntry& entry) {
  const auto& [key, target, range, unit] = wanted;
  file.require({key});
  std::optional<TomlTable> figure = file.table(key);
  if (!figure) return;
  figure->require({"value", "source"});
  figure->number("value", target, range);
  figure->text("source", entry.sources[key]);
}

// The source that is given for the two fitted figures.
std::string source_of_fit(const MaterialEntry& entry, const std::set<std::string>& sources) {
  std::string text = "fitted to the loss factor";
  const std::vector<modal::LossFactor>& factors = entry.material.loss_factors;
  for (const modal::LossFactor& point : factors) {
    text += formatted("{} {:.3g} at {:.5g} Hz", &point == &factors.front() ? "" : ",", point.eta, point.frequency_hz);
  }
  text += " at the octaves from 125 Hz to 8 kHz: ";
  for (const std::string& source : sources) text += (source == *sources.begin() ? "" : "; ") + source;
  return text;
}

void read_loss_factors(TomlTable& file, MaterialEntry& entry) {
  std::set<std::string> sources;
  std::vector<modal::LossFactor>& factors = entry.material.loss_factors;
  for (TomlTable& table : file.tables("loss_factor")) {
    table.require({"frequency_hz", "eta", "source"});
    modal::LossFactor point{1, 1};
    std::string source;
    table.number("frequency_hz", point.frequency_hz, kFrequency_hz);
    table.number("eta", point.eta, kLossFactor);
    table.text("source", source);
    sources.insert(source);
    factors.push_back(point);
  }
  std::ranges::sort(factors, {}, &modal::LossFactor::frequency_hz);
  for (const char* key : {"alpha_per_s", "beta_s"}) {
    if (file.has(key)) file.complain(key, formatted("give either [[loss_factor]] or {}, not both", key));
  }
  if (factors.size() > modal::kMaxLossFactors)
    file.complain("loss_factor", formatted("at most {} loss factors can be given", modal::kMaxLossFactors));
  const auto same = std::ranges::adjacent_find(factors, {}, &modal::LossFactor::frequency_hz);
  if (same != factors.end())
    file.complain("loss_factor",
                  formatted("give one loss factor at each frequency; there are two at {:.5g} Hz", same->frequency_hz));
  if (factors.empty()) return;
  entry.material.damping = modal::fit_rayleigh_to_list(factors);
  entry.sources["alpha_per_s"] = entry.sources["beta_s"] = source_of_fit(entry, sources);
}

}  // namespace

Result<MaterialEntry> read_material(const std::filesystem::path& path) {
  Result<TomlTable> file = TomlTable::read(path);
  if (!file) return fail(file);
  MaterialEntry entry;
  modal::Material& material = entry.material;
  file->require({"name", "description"});
  file->text("name", material.name);
  file->text("description", entry.description);
  if (material.name != path.stem()) file->complain("name", "name must be the file's, " + quote(path.stem().string()));
  const bool curve = file->has("loss_factor");
  for (const Figure& figure : figures_of(material)) {
    if (!(curve && is_damping(figure, material))) read_figure(*file, figure, entry);
  }
  if (curve) read_loss_factors(*file, entry);
  file->number("uncertainty", entry.uncertainty, kUncertainty);
  if (std::optional<TomlTable> thermal = file->table("thermal")) {
    material.thermal.emplace();
    for (const Figure& figure : figures_of(*material.thermal)) read_figure(*thermal, figure, entry);
  }
  if (std::optional<TomlTable> brittle = file->table("brittle")) {
    for (const Figure& figure : figures_of(material.brittleness.emplace())) {
      const bool required = &figure.value != &material.brittleness->strength.reference_area_m2;
      if (required || brittle->has(figure.key)) read_figure(*brittle, figure, entry);
    }
  }
  read_grain_constants(*file, material.orthotropy, entry.sources);
  if (auto good = file->finish(); !good) return fail(good);
  if (const auto stable = check_stable(material); !stable) return fail(path.string() + ":1", stable);
  return entry;
}

Result<void> set_figure(modal::Material& material, const std::string& key, double value) {
  std::string known;
  for (const Figure& figure : figures_of(material)) {
    known += (known.empty() ? "" : ", ") + std::string(figure.key);
    if (key != figure.key) continue;
    if (auto good = check_range(value, figure.range); !good) return fail(key, good);
    figure.value = value;
    if (is_damping(figure, material)) material.loss_factors.clear();
    return check_stable(material);
  }
  if (key == "loss_factor") {
    if (auto good = check_range(value, kLossFactor); !good) return fail(key, good);
    constexpr double kAnywhere_hz = 1000;
    material.loss_factors = {{kAnywhere_hz, value}};
    material.damping = modal::fit_rayleigh_to_list(material.loss_factors);
    return {};
  }
  if (key == "expansion_per_k" && value == 0) {  // what does not expand has no heat that flows
    material.thermal.reset();
    return {};
  }
  if (material.thermal) {
    for (const Figure& figure : figures_of(*material.thermal)) {
      known += std::string(", ") + figure.key;
      if (key != figure.key) continue;
      if (auto good = check_range(value, figure.range); !good) return fail(key, good);
      figure.value = value;
      return {};
    }
  }
  known += ", loss_factor";
  if (material.brittleness) {
    for (const Figure& figure : figures_of(*material.brittleness)) {
      known += std::string(", ") + figure.key;
      if (key != figure.key) continue;
      if (auto good = check_range(value, figure.range); !good) return fail(key, good);
      figure.value = value;
      return {};
    }
  }
  if (auto set = set_grain_constant(material, key, value)) return *set;
  if (material.orthotropy) {
    for (const GrainFigure& figure : grain_figures(*material.orthotropy)) known += std::string(", ") + figure.key;
  }
  return fail(ErrorKind::bad_input, "a material has no figure '{}'; choose one of: {}", key, known);
}

Result<MaterialEntry> find_material(const std::filesystem::path& folder, const std::string& name) {
  const std::vector<std::string> known = names_in(folder);
  if (std::find(known.begin(), known.end(), name) != known.end()) return read_material(folder / (name + ".toml"));
  if (known.empty())
    return fail(ErrorKind::bad_input,
                "there are no materials in " + folder.string() + "; name their folder with --materials");
  std::string list;
  for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
  return fail(ErrorKind::bad_input, "there is no material '{}' in {}; choose one of: {}", name, folder.string(), list);
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& file : std::filesystem::directory_iterator(folder, error)) {
    if (file.path().extension() == ".toml") names.push_back(file.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

// The page of materials
namespace {

bool holds(const std::string& source, std::string_view words) { return source.find(words) != std::string::npos; }

std::string marked(const std::string& figure, const std::string& source) {
  const std::string shown = holds(source, kOurChoice) ? "*" + figure + "*" : figure;
  return holds(source, kToBeChecked) ? shown + " ?" : shown;
}

// Seconds in which a mode of an undamped 1 kHz falls by 60 dB.
double t60_at_1_khz(const modal::Material& material) {
  const double omega = modal::hz_to_rad_per_s(1000);
  return modal::t60_s(modal::mode_loss(material.damping_law(), omega * omega).total_per_s());
}

std::string grain_row(const MaterialEntry& entry) {
  std::string row = "| `" + entry.material.name + "` |";
  const modal::Orthotropy& solid = *entry.material.orthotropy;
  for (const GrainFigure& figure : grain_figures(solid)) {
    const auto source = entry.sources.find(std::string("grain.") + figure.key);
    row += " " +
           marked(formatted("{:.3g}", figure.value / figure.table_unit),
                  source == entry.sources.end() ? "" : source->second) +
           " |";
  }
  row += " ";
  for (const double& loss : solid.loss) row += formatted("{}{:.3g}", &loss == solid.loss.data() ? "" : ", ", loss);
  return row + " |\n";
}

std::string loss_cells(const MaterialEntry& entry) {
  const modal::MaterialDamping law = entry.material.damping_law();
  std::string row;
  for (const double frequency_hz : {100.0, 1000.0, 10000.0}) {
    const double eta = law.loss_factors.empty() ? modal::loss_factor(law.rayleigh, frequency_hz)
                                                : modal::loss_factor_at(law.loss_factors, frequency_hz);
    row += " " + marked(formatted("{:.2g}", eta), entry.sources.at("beta_s")) + " |";
  }
  return row + (entry.uncertainty > 0 ? formatted(" {:.2g}", entry.uncertainty) : "") + " |";
}

std::string thermal_cells(const MaterialEntry& entry) {
  if (!entry.material.thermal) return " | | |";
  modal::Thermal thermal = *entry.material.thermal;
  std::string row;
  for (const Figure& figure : figures_of(thermal))
    row += " " + marked(formatted("{:.3g}", figure.value / figure.table_unit), entry.sources.at(figure.key)) + " |";
  return row;
}

std::string strength_row(MaterialEntry entry) {
  std::string row = "| `" + entry.material.name + "` |";
  for (const Figure& figure : figures_of(*entry.material.brittleness)) {
    const auto source = entry.sources.find(figure.key);
    row += " " +
           marked(formatted("{:.3g}", figure.value / figure.table_unit),
                  source == entry.sources.end() ? "" : source->second) +
           " |";
  }
  const modal::Material& material = entry.material;
  return row + " " +
         formatted("{:.2g}", modal::crack_energy_j_m2(material.brittleness->toughness_pa_sqrt_m,
                                                      material.youngs_modulus_pa, material.poisson_ratio)) +
         " |\n";
}

std::string figure_row(MaterialEntry entry) {
  std::string row = "| `" + entry.material.name + "` |";
  for (const Figure& figure : figures_of(entry.material)) {
    if (is_damping(figure, entry.material)) continue;
    row += " " + marked(formatted("{:.5g}", figure.value / figure.table_unit), entry.sources.at(figure.key)) + " |";
  }
  return formatted("{}{}{} {:.2g} |\n", row, loss_cells(entry), thermal_cells(entry), t60_at_1_khz(entry.material));
}

// The header of a table, and a row for each material for which `row_of` returns one.
Result<std::string> table_of(const std::filesystem::path& folder, std::string header,
                             std::string (*row_of)(const MaterialEntry&)) {
  for (const std::string& name : names_in(folder)) {
    const Result<MaterialEntry> entry = read_material(folder / (name + ".toml"));
    if (!entry) return fail(entry);
    header += row_of(*entry);
  }
  return header;
}

}  // namespace

Result<std::string> grains_as_markdown(const std::filesystem::path& folder) {
  return table_of(folder,
                  "| material | E1 [GPa] | E2 | E3 | nu12 | nu13 | nu23 | G12 [GPa] | G13 | G23 | losses of E1 E2 E3 "
                  "G12 G13 G23 |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
                  [](const MaterialEntry& entry) { return entry.material.orthotropy ? grain_row(entry) : ""; });
}

Result<std::string> strengths_as_markdown(const std::filesystem::path& folder) {
  return table_of(folder,
                  "| material | strength [MPa] | Weibull modulus | toughness [MPa m^1/2] | area [cm^2] | energy of a "
                  "crack [J/m^2] |\n|---|---|---|---|---|---|\n",
                  [](const MaterialEntry& entry) { return entry.material.brittleness ? strength_row(entry) : ""; });
}

Result<std::string> materials_as_markdown(const std::filesystem::path& folder) {
  if (names_in(folder).empty()) return fail(ErrorKind::bad_input, "there are no materials in " + folder.string());
  return table_of(
      folder,
      "| material | E [GPa] | nu | rho [kg/m^3] | loss factor at 100 Hz | at 1 kHz | at 10 kHz | within a factor | "
      "expansion [1e-6/K] | conductivity [W/(m K)] | heat capacity [J/(kg K)] | T60 at 1 kHz [s] |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      [](const MaterialEntry& entry) { return figure_row(entry); });
}

}  // namespace ringdown::bake
