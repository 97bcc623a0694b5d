#include "engine/modal/bank_extras.h"

#include "engine/modal/response/provenance_text.h"

#include "engine/base/version.h"
#include "engine/modal/nonlinear_limits.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::modal {
namespace {

constexpr std::size_t kMaxParts = 1000;  // further parts are not read
constexpr std::size_t kMaxLiquids = 100, kMaxTubes = 100;

Vec3 read_vector(const JsonPlace& list, const Vec3& otherwise) {
  return {list[0].number().value_or(otherwise.x), list[1].number().value_or(otherwise.y),
          list[2].number().value_or(otherwise.z)};
}

std::vector<LiquidNote> read_liquids(const JsonPlace& list) {
  std::vector<LiquidNote> liquids;
  for (std::size_t i = 0; i < std::min(list.size(), kMaxLiquids); ++i) {
    const JsonPlace one = list[i];
    const auto number = [&one](const char* key) { return one[key].number().value_or(0.0); };
    liquids.push_back({.liquid = one["liquid"].text_or(""),
                       .density_kg_m3 = number("density"),
                       .sound_speed_m_s = number("soundSpeed"),
                       .viscosity_pa_s = number("viscosity"),
                       .level_m = number("level"),
                       .volume_m3 = number("volume"),
                       .up = read_vector(one["up"], {0, 0, 1}),
                       .around = one["place"].text_or("") == "around"});
  }
  return liquids;
}

Json liquids_json(const std::vector<LiquidNote>& liquids) {
  Json json = Json::array();
  for (const LiquidNote& one : liquids)
    json.push_back({{"liquid", one.liquid},
                    {"place", one.around ? "around" : "inside"},
                    {"density", one.density_kg_m3},
                    {"soundSpeed", one.sound_speed_m_s},
                    {"viscosity", one.viscosity_pa_s},
                    {"level", one.level_m},
                    {"volume", one.volume_m3},
                    {"up", {one.up.x, one.up.y, one.up.z}}});
  return json;
}

std::vector<ResonatorNote> read_resonators(const JsonPlace& list) {
  std::vector<ResonatorNote> resonators;
  for (std::size_t i = 0; i < std::min(list.size(), kMaxTubes); ++i) {
    const JsonPlace one = list[i];
    const auto number = [&one](const char* key) { return one[key].number().value_or(0.0); };
    resonators.push_back({.diameter_m = number("diameter"),
                          .length_m = number("length"),
                          .mouth_m = read_vector(one["mouth"], {}),
                          .axis = read_vector(one["axis"], {0, 0, -1}),
                          .stopped = one["end"].text_or("") != "open",
                          .frequency_hz = number("frequency"),
                          .decay_per_s = number("decay"),
                          .end_correction_m = number("endCorrection")});
  }
  return resonators;
}

Json resonators_json(const std::vector<ResonatorNote>& resonators) {
  Json json = Json::array();
  for (const ResonatorNote& one : resonators)
    json.push_back({{"diameter", one.diameter_m},
                    {"length", one.length_m},
                    {"mouth", {one.mouth_m.x, one.mouth_m.y, one.mouth_m.z}},
                    {"axis", {one.axis.x, one.axis.y, one.axis.z}},
                    {"end", one.stopped ? "stopped" : "open"},
                    {"frequency", one.frequency_hz},
                    {"decay", one.decay_per_s},
                    {"endCorrection", one.end_correction_m}});
  return json;
}

// Nothing where a value is wrong.
std::optional<Cavity> read_cavity(const JsonPlace& field, std::size_t modes) {
  Cavity cavity{.mouth_m = read_vector(field["mouth"], {}), .diameter_m = field["diameter"].number().value_or(0)};
  const std::size_t count = std::min(field["modes"].size(), modes);
  if (!(cavity.diameter_m > 0 && cavity.diameter_m <= 1e6) || count == 0) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t mode = field["modes"][i].index().value_or(modes);
    const double flux = field["flux"][i].number().value_or(-1);
    if (mode >= modes || !(flux >= 0 && flux <= 1e6)) return std::nullopt;
    cavity.modes.push_back({static_cast<std::uint32_t>(mode), flux});
  }
  return cavity;
}

Json cavity_json(const Cavity& cavity) {
  Json modes = Json::array(), flux = Json::array();
  for (const Cavity::Mode& one : cavity.modes) modes.push_back(one.mode), flux.push_back(one.flux);
  return {{"mouth", {cavity.mouth_m.x, cavity.mouth_m.y, cavity.mouth_m.z}},
          {"diameter", cavity.diameter_m},
          {"modes", modes},
          {"flux", flux}};
}

Provenance read_provenance(const JsonPlace& extras) {
  const auto number = [&extras](const char* key) { return extras[key].number().value_or(0.0); };
  const auto count = [&extras](const char* key) { return static_cast<std::int64_t>(extras[key].index().value_or(0)); };
  const JsonPlace dropped = extras["dropped"];
  std::vector<std::string> parts;
  for (std::size_t p = 0; p < std::min(extras["parts"].size(), kMaxParts); ++p)
    parts.push_back(extras["parts"][p].text_or(""));
  return {.body = extras["body"].text_or(""),
          .wall_elements = number("wallElements"),
          .element = extras["element"].text_or(""),
          .unknowns = count("unknowns"),
          .rigid_modes = count("rigidModes"),
          .counted_modes = count("modesCounted"),
          .band_low_hz = number("bandLow"),
          .band_high_hz = number("bandHigh"),
          .largest_residual = number("largestResidual"),
          .dropped_modes = static_cast<std::int64_t>(dropped["count"].index().value_or(0)),
          .floor_db = dropped["floor"].number().value_or(0.0),
          .loss_db = dropped["loss"].number().value_or(0.0),
          .parts = std::move(parts),
          .liquids = read_liquids(extras["liquids"]),
          .resonators = read_resonators(extras["resonators"]),
          .peak_pa = number("peakPressure")};
}

// Returns the list if it has one number >= 0 for each mode, else an empty list.
std::vector<double> read_numbers(const JsonPlace& list, std::size_t modes) {
  std::vector<double> numbers;
  if (list.size() != modes) return numbers;
  for (std::size_t m = 0; m < modes; ++m) {
    const double number = list[m].number().value_or(-1);
    if (number < 0) return {};
    numbers.push_back(number);
  }
  return numbers;
}

// Returns an empty list, without which the bank still plays, unless every mode has parts that add up to its decay. A
// part that is missing from the file, air or heat, is 0.
std::vector<ModeLoss> read_losses(const JsonPlace& field, const std::vector<double>& decay_per_s) {
  constexpr double kRounding = 1e-5;
  const std::vector<double> material = read_numbers(field["material"], decay_per_s.size()),
                            support = read_numbers(field["support"], decay_per_s.size());
  const auto or_none = [&](const char* key) {
    if (field[key].present()) return read_numbers(field[key], decay_per_s.size());
    return std::vector<double>(decay_per_s.size(), 0.0);
  };
  const std::vector<double> air = or_none("air"), heat = or_none("heat");
  if (material.empty() || support.empty() || air.empty() || heat.empty()) return {};
  std::vector<ModeLoss> losses;
  for (std::size_t m = 0; m < decay_per_s.size(); ++m) {
    losses.push_back(
        {.material_per_s = material[m], .air_per_s = air[m], .support_per_s = support[m], .heat_per_s = heat[m]});
    if (std::abs(losses[m].total_per_s() - decay_per_s[m]) > kRounding * decay_per_s[m]) return {};
  }
  return losses;
}

// Returns an empty list unless every mode has a strength and a time [s] for each of its relaxations, in the ranges of
// solids, and they give the loss to heat that the bank states.
std::vector<ModeHeat> read_heat(const JsonPlace& list, const std::vector<double>& frequency_hz,
                                const std::vector<double>& decay_per_s, const std::vector<ModeLoss>& losses) {
  constexpr std::size_t kNumbers = std::size_t{2} * kRelaxations;
  constexpr double kMaxStrength = 10, kMaxTime_s = 1e9, kRounding = 1e-3;
  const std::vector<double> numbers = read_numbers(list, kNumbers * frequency_hz.size());
  if (losses.empty()) return {};
  std::vector<ModeHeat> heat(numbers.size() / kNumbers);
  for (std::size_t i = 0; i < numbers.size(); i += 2) {
    if (numbers[i] > kMaxStrength || numbers[i + 1] > kMaxTime_s) return {};
    heat[i / kNumbers][i % kNumbers / 2] = {.strength = numbers[i], .time_s = numbers[i + 1]};
  }
  for (std::size_t m = 0; m < heat.size(); ++m) {
    const double omega = std::sqrt(undamped_lambda({frequency_hz[m], decay_per_s[m]}));
    const double stated = losses[m].heat_per_s;
    if (std::abs(heat_loss(heat[m], omega) - stated) > kRounding * stated) return {};
  }
  return heat;
}

// Returns nothing unless all three figures are there and above 0.
std::optional<Thermal> read_thermal(const JsonPlace& field) {
  const auto figure = [&field](const char* key) { return field[key].number().value_or(0); };
  const Thermal thermal{figure("expansion"), figure("conductivity"), figure("heatCapacity")};
  const bool whole = thermal.expansion_per_k > 0 && thermal.conductivity_w_mk > 0 && thermal.heat_capacity_j_kgk > 0;
  return whole ? std::optional(thermal) : std::nullopt;
}

// Returns an empty list unless all elements are pairs of an ascending frequency > 0 and a loss factor > 0.
std::vector<LossFactor> read_loss_factors(const JsonPlace& list) {
  constexpr double kMaxHz = 1e9, kMaxEta = 10, kMinEta = 1e-12;
  std::vector<LossFactor> factors;
  if (list.size() > kMaxLossFactors) return {};
  for (std::size_t i = 0; i < list.size(); ++i) {
    const LossFactor point{list[i][0].number().value_or(0), list[i][1].number().value_or(0)};
    const double before_hz = factors.empty() ? 0 : factors.back().frequency_hz;
    if (!(point.frequency_hz > before_hz && point.frequency_hz <= kMaxHz)) return {};
    if (!(point.eta >= kMinEta && point.eta <= kMaxEta)) return {};
    factors.push_back(point);
  }
  return factors;
}

Json losses_json(const std::vector<ModeLoss>& losses) {
  Json json;
  bool air = false, heat = false;
  for (const ModeLoss& loss : losses) {
    json["material"].push_back(loss.material_per_s);
    json["air"].push_back(loss.air_per_s);
    json["support"].push_back(loss.support_per_s);
    json["heat"].push_back(loss.heat_per_s);
    air = air || loss.air_per_s > 0;
    heat = heat || loss.heat_per_s > 0;
  }
  if (!air) json.erase("air");
  if (!heat) json.erase("heat");
  return json;
}

Json heat_json(const std::vector<ModeHeat>& heat) {
  Json json = Json::array();
  for (const ModeHeat& mode : heat) {
    for (const auto& [strength, time_s] : mode) {
      json.push_back(strength);
      json.push_back(time_s);
    }
  }
  return json;
}

Json loss_factors_json(const std::vector<LossFactor>& factors) {
  Json json = Json::array();
  for (const LossFactor& point : factors) json.push_back({point.frequency_hz, point.eta});
  return json;
}

Json orthotropy_json(const Orthotropy& solid) {
  return {{"youngsModuli", solid.youngs_modulus_pa},
          {"poissonRatios", solid.poisson_ratio},
          {"shearModuli", solid.shear_modulus_pa},
          {"losses", solid.loss}};
}

Json provenance_json(const Provenance& provenance) {
  Json json = {{"version", kBankVersion},
               {"element", provenance.element},
               {"unknowns", provenance.unknowns},
               {"rigidModes", provenance.rigid_modes},
               {"bandLow", provenance.band_low_hz},
               {"bandHigh", provenance.band_high_hz},
               {"largestResidual", provenance.largest_residual}};
  if (provenance.peak_pa > 0) json["peakPressure"] = provenance.peak_pa;
  if (!provenance.body.empty()) json["body"] = provenance.body;
  if (!provenance.parts.empty()) json["parts"] = provenance.parts;
  if (!provenance.liquids.empty()) json["liquids"] = liquids_json(provenance.liquids);
  if (!provenance.resonators.empty()) json["resonators"] = resonators_json(provenance.resonators);
  if (provenance.wall_elements > 0) json["wallElements"] = provenance.wall_elements;
  if (provenance.counted_modes > 0) json["modesCounted"] = provenance.counted_modes;
  if (provenance.dropped_modes > 0) {
    json["dropped"] = {{"count", provenance.dropped_modes}, {"loss", provenance.loss_db}};
    if (provenance.floor_db > 0) json["dropped"]["floor"] = provenance.floor_db;
  }
  return json;
}

// Returns the number that was read if it lies in the range, else `otherwise`.
double number_in(const Result<double>& read, double low, double high, double otherwise) {
  const double number = read.value_or(otherwise);
  return number >= low && number <= high ? number : otherwise;
}

Result<std::optional<BankRadiation>> read_radiation(const Glb& glb, const JsonPlace& field, std::size_t modes) {
  constexpr double kMin = 1e-6, kMax = 1e6;  // SI units; wide enough for every medium that carries sound
  constexpr std::size_t kMaxBytes = 32768;   // for each mode
  if (!field["maps"].present()) return std::nullopt;
  const auto bytes = read_bytes(glb, field["maps"], kMaxBytes * (modes + 1));
  if (!bytes) return fail(bytes);
  auto maps = unpack(*bytes, field["maps"].path());
  if (!maps) return fail(maps);
  if (maps->modes.size() != modes) {
    return fail(ErrorKind::bad_input, "{} is of {} modes, expected {} as in frequencies", field["maps"].path(),
                maps->modes.size(), modes);
  }
  BankRadiation radiation{.maps = std::move(*maps), .error_db = read_numbers(field["errors"], modes)};
  Air& air = radiation.air;
  air.density_kg_m3 = number_in(field["air"]["density"].number(), kMin, kMax, air.density_kg_m3);
  air.sound_speed_m_s = number_in(field["air"]["soundSpeed"].number(), kMin, kMax, air.sound_speed_m_s);
  const JsonPlace doubtful = field["doubtful"];
  for (std::size_t i = 0; i < std::min(doubtful.size(), modes); ++i) {
    const std::size_t mode = doubtful[i]["mode"].index().value_or(modes);
    if (mode >= modes) continue;
    radiation.reason.resize(modes);
    radiation.reason[mode] = doubtful[i]["reason"].text_or("");
  }
  return radiation;
}

Json radiation_json(const BankRadiation& radiation, GlbWriter& writer) {
  Json json = {{"maps", writer.add_bytes(pack(radiation.maps).bytes)},
               {"air", {{"density", radiation.air.density_kg_m3}, {"soundSpeed", radiation.air.sound_speed_m_s}}}};
  if (!radiation.error_db.empty()) json["errors"] = radiation.error_db;
  for (std::size_t m = 0; m < radiation.reason.size(); ++m) {
    if (!radiation.reason[m].empty()) json["doubtful"].push_back({{"mode", m}, {"reason", radiation.reason[m]}});
  }
  return json;
}

struct NonlinearReader {
  const Glb& glb;
  const JsonPlace field;
  const Bank& bank;
  Result<std::optional<NonlinearTerms>> operator()() const;
};

Result<std::optional<NonlinearTerms>> NonlinearReader::operator()() const {
  if (!field["bending"].present()) return std::nullopt;
  const JsonPlace list = field["modes"];
  const std::size_t modes = bank.mode_count();
  NonlinearTerms terms;
  std::vector<bool> named(modes);
  for (std::size_t i = 0; i < std::min(list.size(), kMaxNonlinearModes + 1); ++i) {
    const std::size_t mode = list[i].index().value_or(modes);
    if (mode >= modes || named[mode]) return list[i].wrong("the number of a mode, each once");
    named[mode] = true;
    terms.modes.push_back(static_cast<std::uint32_t>(mode));
  }
  if (terms.modes.empty() || terms.modes.size() > kMaxNonlinearModes)
    return list.wrong(formatted("a list of 1 to {} modes", kMaxNonlinearModes));
  auto curving = read_floats(glb, field["curving"], 1, kMaxNonlinearFunctions * terms.mode_count());
  if (!curving) return fail(curving);
  terms.curving = std::move(*curving);
  auto bending = read_floats(glb, field["bending"], 1, kMaxNonlinearFunctions * terms.pairs());
  if (!bending) return fail(bending);
  terms.bending = std::move(*bending);
  const std::size_t functions = terms.function_count();
  if (functions == 0 || terms.curving.size() != functions * terms.mode_count() ||
      terms.bending.size() != functions * terms.pairs()) {
    return fail(ErrorKind::bad_input, "{} has {} elements, expected {} (functions times pairs of modes)",
                field["bending"].path(), terms.bending.size(), functions * terms.pairs());
  }
  terms.thickness_m = field["thickness"].number().value_or(0);
  terms.residual = number_in(field["residual"].number(), 0, 1, 0);
  terms.coupled = static_cast<std::uint32_t>(std::min<std::size_t>(field["coupled"].index().value_or(0), kMaxCoupled));
  terms.errors = read_numbers(field["errors"], terms.mode_count());
  if (const auto checked = check(terms, bank, field.path()); !checked) return fail(checked);
  return terms;
}

Json nonlinear_json(const NonlinearTerms& terms, GlbWriter& writer) {
  Json json = {{"modes", terms.modes},
               {"bending", writer.add_floats(terms.bending, 1)},
               {"curving", writer.add_floats(terms.curving, 1)},
               {"thickness", terms.thickness_m},
               {"residual", terms.residual}};
  if (terms.coupled > 0) json["coupled"] = terms.coupled;
  if (!terms.errors.empty()) json["errors"] = terms.errors;
  return json;
}

}  // namespace

bool rayleigh_reproduces_material(const Bank& bank) {
  constexpr double kTolerance = 0.01;
  const MaterialDamping law = bank.material->damping_law();
  if (law.loss_factors.empty()) return true;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double lambda = undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
    const double fitted = 0.5 * (law.rayleigh.alpha_per_s + law.rayleigh.beta_s * lambda);
    if (std::abs(fitted / mode_loss(law, lambda).material_per_s - 1) > kTolerance) return false;
  }
  return true;
}

Result<void> read_extras(const Glb& glb, const JsonPlace& extras, Bank& bank) {
  bank.frequency_error = read_numbers(extras["frequencyErrors"], bank.mode_count());
  bank.shape_error = read_numbers(extras["shapeErrors"], bank.mode_count());
  bank.losses = read_losses(extras["losses"], bank.decay_per_s);
  bank.heat = read_heat(extras["relaxations"], bank.frequency_hz, bank.decay_per_s, bank.losses);
  if (bank.material) {
    bank.material->loss_factors = read_loss_factors(extras["lossFactors"]);
    if (!bank.material->loss_factors.empty())
      bank.material->damping = fit_rayleigh_to_list(bank.material->loss_factors);
    bank.material->thermal = read_thermal(extras["thermal"]);
  }
  // Returns nothing unless all constants are present and describe a stable solid; the bank plays without them.
  const auto read_orthotropy = [field = extras["orthotropic"]]() -> std::optional<Orthotropy> {
    Orthotropy solid;
    const auto read = [&field](const char* key, auto& target) {
      if (field[key].size() != target.size()) return false;
      for (std::size_t i = 0; i < target.size(); ++i) target[i] = field[key][i].number().value_or(NAN);
      return std::ranges::all_of(target, [](double number) { return std::isfinite(number); });
    };
    const bool whole = read("youngsModuli", solid.youngs_modulus_pa) && read("poissonRatios", solid.poisson_ratio) &&
                       read("shearModuli", solid.shear_modulus_pa) && read("losses", solid.loss);
    return whole && is_stable(solid) ? std::optional(solid) : std::nullopt;
  };
  if (bank.material) bank.material->orthotropy = read_orthotropy();
  bank.held = extras["held"].present() && extras["held"].json() == Json(true);
  const double pitch_hz = extras["pitch"].number().value_or(0);
  if (kStatedPitch_hz.holds(pitch_hz)) bank.pitch_hz = pitch_hz;
  bank.provenance = read_provenance(extras);
  bank.cavity = read_cavity(extras["cavity"], bank.mode_count());
  auto radiation = read_radiation(glb, extras["radiation"], bank.mode_count());
  if (!radiation) return fail(radiation);
  bank.radiation = std::move(*radiation);
  auto nonlinear = NonlinearReader{glb, extras["nonlinear"], bank}();
  if (!nonlinear) return fail(nonlinear);
  bank.nonlinear = std::move(*nonlinear);
  return {};
}

Json extras_json(const Bank& bank, GlbWriter& writer) {
  Json json = provenance_json(bank.provenance);
  if (!bank.frequency_error.empty()) json["frequencyErrors"] = bank.frequency_error;
  if (!bank.shape_error.empty()) json["shapeErrors"] = bank.shape_error;
  if (!bank.losses.empty()) json["losses"] = losses_json(bank.losses);
  if (!bank.heat.empty()) json["relaxations"] = heat_json(bank.heat);
  if (bank.material && !bank.material->loss_factors.empty())
    json["lossFactors"] = loss_factors_json(bank.material->loss_factors);
  if (bank.material && bank.material->thermal) {
    const auto& [expansion_per_k, conductivity_w_mk, heat_capacity_j_kgk] = *bank.material->thermal;
    json["thermal"] = {
        {"expansion", expansion_per_k}, {"conductivity", conductivity_w_mk}, {"heatCapacity", heat_capacity_j_kgk}};
  }
  if (bank.material && bank.material->orthotropy) json["orthotropic"] = orthotropy_json(*bank.material->orthotropy);
  if (bank.held) json["held"] = true;
  if (bank.pitch_hz) json["pitch"] = *bank.pitch_hz;
  if (bank.cavity) json["cavity"] = cavity_json(*bank.cavity);
  if (bank.radiation) json["radiation"] = radiation_json(*bank.radiation, writer);
  if (bank.nonlinear) json["nonlinear"] = nonlinear_json(*bank.nonlinear, writer);
  return json;
}

std::string provenance_text(const Bank& bank) {
  Json json = provenance_json(bank.provenance);
  json["generator"] = bank.provenance.generator;
  json["held"] = bank.held;
  if (bank.radiation) {
    const auto& [maps, air, errors, reasons] = *bank.radiation;
    json["air"] = {{"density", air.density_kg_m3}, {"soundSpeed", air.sound_speed_m_s}};
    for (std::size_t m = 0; m < reasons.size(); ++m) {
      if (!reasons[m].empty()) json["doubtful"].push_back({{"mode", m}, {"reason", reasons[m]}});
    }
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace ringdown::modal
