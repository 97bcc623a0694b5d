#include "engine/modal/fracture/fracture_file.h"

#include "engine/gltf/meshopt_codec.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace ringdown::modal {
namespace {

constexpr std::size_t kMaxHandover = std::size_t{1} << 26;  // numbers in one pattern
constexpr float kMaxEntry = 1.001F;  // of a handover: at most 1 but for rounding, as both bases are orthonormal
constexpr double kMaxLength_m = 1e6;
constexpr std::size_t kMaxNumbers = std::size_t{1} << 27;  // of all pieces together: 512 MiB
constexpr std::size_t kMaxStressPoints = std::size_t{1} << 14;
constexpr double kMaxStress = 1.01;   // over the mode's largest: at most 1 but for rounding
constexpr double kStressSteps = 512;  // of a packed stress, for the mode's largest
constexpr int kHandoverExponent =
    -17;  // packed entries of handovers from coarser pieces are multiples of 2 to this power
constexpr double kMaxArea_m2 = 1e12, kMaxCrackEnergy_j_m2 = 1e12, kMaxStrength_pa = 1e15, kMaxModulus = 1e4;
constexpr const char* kSolid = "one with massProperties, a mass and three moments of inertia above 0";

// A body without mass or inertia in a direction has no rigid motion to hand over.
bool is_solid(const std::optional<MassProperties>& mass) {
  return mass && mass->mass_kg > 0 &&
         std::min({mass->inertia_kg_m2.x, mass->inertia_kg_m2.y, mass->inertia_kg_m2.z}) > 0;
}

// The size of a piece in memory. Pieces may name one array many times, so a file says less than all pieces have.
std::size_t numbers_of(const Bank& bank) {
  std::size_t count = 3 * (bank.positions.size() + bank.shapes.size() + bank.triangles.size());
  if (!bank.radiation) return count;
  for (const FarField& field : bank.radiation->maps.modes) count += 3 * (field.terms.size() + field.levels.size());
  return count;
}

std::size_t numbers_of(const PieceBank& piece) {
  return numbers_of(piece.bank) + piece.stress.stress.size() + piece.handover.size() + piece.from_coarser.size();
}

Result<double> read_size(const JsonPlace& field, double max) {
  const auto number = field.number();
  if (!number) return fail(number);
  if (!(*number >= 0 && *number <= max)) return field.wrong("at least 0, at most " + Json(max).dump());
  return *number;
}

// A number above 0.
Result<void> read_positive(const JsonPlace& field, double max, double& target) {
  const auto number = field.number();
  if (!number) return fail(number);
  if (!(*number > 0 && *number <= max)) return field.wrong("above 0, at most " + Json(max).dump());
  target = *number;
  return {};
}

Result<std::optional<Strength>> read_strength(const JsonPlace& field) {
  if (!field.present()) return std::nullopt;
  Strength strength;
  for (const auto& read : {read_positive(field["stress"], kMaxStrength_pa, strength.strength_pa),
                           read_positive(field["weibullModulus"], kMaxModulus, strength.weibull_modulus),
                           read_positive(field["area"], kMaxArea_m2, strength.reference_area_m2)}) {
    if (!read) return fail(read);
  }
  if (strength.weibull_modulus < 1) return field["weibullModulus"].wrong("at least 1");
  return strength;
}

// In the file the stress has the modes first, as shapes have, so that each mode can be rounded for itself.
Result<StressTable> read_stress(const Glb& glb, const JsonPlace& field, std::size_t modes) {
  if (!field.present()) return StressTable{};
  const auto positions = read_floats(glb, field["positions"], 3, kMaxStressPoints);
  if (!positions) return fail(positions);
  const auto largest = read_floats(glb, field["largest"], 1, modes);
  if (!largest) return fail(largest);
  if (largest->size() != modes) return field["largest"].wrong(std::to_string(modes) + " numbers, one for each mode");
  const std::size_t points = positions->size() / 3;
  const auto components = read_floats(glb, field["components"], 3, modes * points);
  if (!components) return fail(components);
  if (components->size() != 3 * modes * points)
    return field["components"].wrong(std::to_string(modes * points) + " elements (modes times points)");
  StressTable table{.positions = {}, .stress = std::vector<float>(components->size()), .largest = *largest};
  for (std::size_t p = 0; p < points; ++p)
    table.positions.push_back({(*positions)[3 * p], (*positions)[3 * p + 1], (*positions)[3 * p + 2]});
  for (std::size_t m = 0; m < modes; ++m) {
    if ((*largest)[m] < 0) return field["largest"].wrong("numbers of at least 0");
    for (std::size_t p = 0; p < points; ++p) {
      const float* const s = components->data() + 3 * (points * m + p);
      const double principal =
          std::abs(double{s[0]} + double{s[1]}) / 2 + std::hypot((double{s[0]} - double{s[1]}) / 2, double{s[2]});
      if (!(principal <= kMaxStress * double{(*largest)[m]}))
        return field["components"].wrong("no principal stress above the largest of its mode");
      for (std::size_t k = 0; k < 3; ++k) table.stress[(3 * p + k) * modes + m] = s[k];
    }
  }
  return table;
}

// Reads how a piece breaks again.
Result<void> read_second_break(const Glb& glb, const JsonPlace& field, PieceBank& piece) {
  auto stress = read_stress(glb, field["stress"], piece.bank.mode_count());
  if (!stress) return fail(stress);
  piece.stress = std::move(*stress);
  for (const auto& [key, target] :
       {std::pair("skinArea", &piece.skin_m2), std::pair("crackArea", &piece.crack_area_m2)}) {
    if (!field[key].present()) continue;
    if (auto read = read_positive(field[key], kMaxArea_m2, *target); !read) return fail(read);
  }
  if (!field["coarser"].present()) return {};
  const auto coarser = field["coarser"].index();
  if (!coarser) return fail(coarser);
  piece.coarser = *coarser;
  return {};
}

Result<PieceBank> read_piece(const Glb& glb, const JsonPlace& field, const PieceReaders& readers) {
  const auto bank = [&]() -> Result<Bank> {
    if (!field["model"].present()) return readers.silent(field);
    const auto model = field["model"].index();
    if (!model) return fail(model);
    return readers.model(*model);
  }();
  if (!bank) return fail(bank);
  if (!is_solid(bank->mass)) return field.wrong(kSolid);
  const JsonPlace opens = field["opens"];
  const auto near_m = read_size(opens[0], kMaxLength_m), far_m = read_size(opens[1], kMaxLength_m);
  if (!near_m) return fail(near_m);
  if (!far_m) return fail(far_m);
  if (*far_m < *near_m) return opens.wrong("two distances, the nearer one first");
  PieceBank piece{
      .bank = *bank, .handover = {}, .near_m = *near_m, .far_m = *far_m, .model = field["model"].index().value_or(0)};
  if (auto read = read_second_break(glb, field, piece); !read) return fail(read);
  return piece;
}

// Reads the matrices of all pieces of a pattern, which follow each other: of each piece's motions, and of those motions
// that columns(piece) counts.
template <class Columns>
Result<void> read_handovers(const Glb& glb, const JsonPlace& field, BreakPattern& pattern,
                            std::vector<float> PieceBank::*target, const Columns& columns) {
  const auto numbers = read_floats(glb, field, 1, kMaxHandover);
  if (!numbers) return fail(numbers);
  const auto size_of = [&](const PieceBank& piece) {
    return (kRigidMotions + piece.bank.mode_count()) * (kRigidMotions + columns(piece));
  };
  std::size_t size = 0;
  for (const PieceBank& piece : pattern.pieces) size += size_of(piece);
  if (numbers->size() != size)
    return field.wrong(formatted("{} numbers, one for each motion of a piece and each motion of the whole", size));
  if (!std::ranges::all_of(*numbers, [](float x) { return std::abs(x) <= kMaxEntry; }))
    return field.wrong("numbers from -1 to 1");
  auto from = numbers->begin();
  for (PieceBank& piece : pattern.pieces) {
    const auto to = from + static_cast<std::ptrdiff_t>(size_of(piece));
    (piece.*target).assign(from, to);
    from = to;
  }
  return {};
}

// Reads how the last pattern is nested in the one before. All of its pieces are nested, or none is.
Result<void> read_nesting(const Glb& glb, const JsonPlace& field, std::vector<BreakPattern>& patterns) {
  BreakPattern& pattern = patterns.back();
  const auto nested = [](const PieceBank& piece) { return piece.coarser.has_value(); };
  if (std::ranges::none_of(pattern.pieces, nested)) return {};
  if (patterns.size() < 2 || patterns[patterns.size() - 2].at_m != pattern.at_m)
    return field["pieces"].wrong("pieces without `coarser`, as no pattern of the same place comes before");
  const std::vector<PieceBank>& coarser = patterns[patterns.size() - 2].pieces;
  if (!std::ranges::all_of(pattern.pieces,
                           [&](const PieceBank& p) { return p.coarser && *p.coarser < coarser.size(); })) {
    return field["pieces"].wrong(
        formatted("pieces that all have `coarser`, one of the {} pieces of the pattern before", coarser.size()));
  }
  return read_handovers(glb, field["handoverFromCoarser"], pattern, &PieceBank::from_coarser,
                        [&](const PieceBank& piece) { return coarser[*piece.coarser].bank.mode_count(); });
}

// Adds the components of all modes, each rounded to whole multiples of a power of two.
std::size_t add_packed_stress(GlbWriter& writer, const std::vector<float>& components, const StressTable& table) {
  const std::size_t rows = 3 * table.positions.size();
  std::vector<std::uint32_t> words;
  words.reserve(components.size());
  for (std::size_t m = 0; m < table.largest.size(); ++m) {
    const double step = static_cast<double>(table.largest[m]) / kStressSteps;
    const int exponent = step > 0 ? std::clamp(std::ilogb(step), -kMaxExponent, kMaxExponent) : -kMaxExponent;
    std::vector<std::int32_t> whole;
    for (std::size_t row = 0; row < rows; ++row)
      whole.push_back(static_cast<std::int32_t>(std::lround(std::ldexp(components[rows * m + row], -exponent))));
    const std::vector<std::uint32_t> mode = exponential_words(whole, exponent);
    words.insert(words.end(), mode.begin(), mode.end());
  }
  return writer.add_exponentials(words, 3);
}

std::size_t add_packed_handovers(GlbWriter& writer, const std::vector<float>& handovers) {
  std::vector<std::int32_t> whole;
  for (const float entry : handovers)
    whole.push_back(static_cast<std::int32_t>(std::lround(std::ldexp(entry, -kHandoverExponent))));
  return writer.add_exponentials(exponential_words(whole, kHandoverExponent), 1);
}

Json stress_json(const StressTable& table, GlbWriter& writer, bool packed) {
  const std::size_t modes = table.largest.size(), rows = 3 * table.positions.size();
  std::vector<float> components, positions;
  for (const Vec3f& point : table.positions) positions.insert(positions.end(), point.begin(), point.end());
  components.reserve(table.stress.size());
  for (std::size_t m = 0; m < modes; ++m) {
    for (std::size_t row = 0; row < rows; ++row) components.push_back(table.stress[row * modes + m]);
  }
  const auto add = [&](std::span<const float> values, std::size_t width) {
    return packed ? writer.add_packed_floats(values, width) : writer.add_floats(values, width);
  };
  const float max = modes == 0 ? 0 : *std::ranges::max_element(table.largest);
  const bool rounds = packed && std::ilogb(max) < kMaxExponent;
  return {{"positions", add(positions, 3)},
          {"largest", writer.add_floats(table.largest, 1)},
          {"components", rounds ? add_packed_stress(writer, components, table) : add(components, 3)}};
}

}  // namespace

Result<Fracture> read_fracture(const Glb& glb, const JsonPlace& fracture, const Bank& body,
                               const PieceReaders& readers) {
  Fracture out;
  if (!is_solid(body.mass)) return fracture.wrong(std::string("absent, or its model ") + kSolid);
  const JsonPlace patterns = fracture["patterns"];
  if (patterns.size() == 0 || patterns.size() > kMaxPatterns)
    return fracture.wrong("a list `patterns` of 1 to " + std::to_string(kMaxPatterns));
  auto stress = read_stress(glb, fracture["stress"], body.mode_count());
  if (!stress) return fail(stress);
  out.stress = std::move(*stress);
  const auto strength = read_strength(fracture["strength"]);
  if (!strength) return fail(strength);
  out.strength = *strength;
  for (const auto& [key, target, max] : {std::tuple("skinArea", &out.skin_m2, kMaxArea_m2),
                                         std::tuple("crackEnergy", &out.crack_energy_j_m2, kMaxCrackEnergy_j_m2)}) {
    if (!fracture[key].present()) continue;
    if (auto read = read_positive(fracture[key], max, *target); !read) return fail(read);
  }
  if (out.strength && out.skin_m2 == 0) return fracture["skinArea"].wrong("an area above 0, which strength refers to");
  std::size_t count = 0, numbers = out.stress.stress.size();
  for (std::size_t p = 0; p < patterns.size(); ++p) {
    const JsonPlace field = patterns[p], pieces = field["pieces"];
    BreakPattern& pattern = out.patterns.emplace_back();
    count += pieces.size();
    if (pieces.size() < 2 || count > kMaxPieces)
      return field.wrong("a list of 2 or more `pieces`, at most " + std::to_string(kMaxPieces) + " in all patterns");
    for (double* const number : {&pattern.at_m.x, &pattern.at_m.y, &pattern.at_m.z}) {
      const auto read = field["at"][number - &pattern.at_m.x].number();
      if (!read) return fail(read);
      if (std::abs(*read) > kMaxLength_m) return field["at"].wrong("a place within a million metres");
      *number = *read;
    }
    const auto area = read_size(field["crackArea"], kMaxLength_m);
    if (!area) return fail(area);
    pattern.crack_area_m2 = *area;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      auto piece = read_piece(glb, pieces[i], readers);
      if (!piece) return fail(piece);
      pattern.pieces.push_back(std::move(*piece));
      numbers += numbers_of(pattern.pieces.back());
      if (numbers > kMaxNumbers) return pieces.wrong("pieces of at most " + std::to_string(kMaxNumbers) + " numbers");
    }
    if (auto read = read_handovers(glb, field["handover"], pattern, &PieceBank::handover,
                                   [&](const PieceBank& /*piece*/) { return body.mode_count(); });
        !read)
      return fail(read);
    if (auto read = read_nesting(glb, field, out.patterns); !read) return fail(read);
    for (const PieceBank& piece : pattern.pieces) numbers += piece.handover.size() + piece.from_coarser.size();
    if (numbers > kMaxNumbers) return pieces.wrong("pieces of at most " + std::to_string(kMaxNumbers) + " numbers");
  }
  return out;
}

Json fracture_json(const Fracture& fracture, GlbWriter& writer, bool packed,
                   const std::function<Json(const PieceBank&)>& describe) {
  Json patterns = Json::array();
  for (const BreakPattern& pattern : fracture.patterns) {
    Json pieces = Json::array();
    std::vector<float> handovers, from_coarser;
    for (const PieceBank& piece : pattern.pieces) {
      Json json = describe(piece);
      json["opens"] = {piece.near_m, piece.far_m};
      if (piece.coarser) json["coarser"] = *piece.coarser;
      if (piece.skin_m2 > 0) json["skinArea"] = piece.skin_m2;
      if (piece.crack_area_m2 > 0) json["crackArea"] = piece.crack_area_m2;
      if (!piece.stress.positions.empty()) json["stress"] = stress_json(piece.stress, writer, packed);
      pieces.push_back(std::move(json));
      handovers.insert(handovers.end(), piece.handover.begin(), piece.handover.end());
      from_coarser.insert(from_coarser.end(), piece.from_coarser.begin(), piece.from_coarser.end());
    }
    Json json = {{"at", {pattern.at_m.x, pattern.at_m.y, pattern.at_m.z}},
                 {"crackArea", pattern.crack_area_m2},
                 {"handover", writer.add_floats(handovers, 1)},
                 {"pieces", std::move(pieces)}};
    if (!from_coarser.empty())
      json["handoverFromCoarser"] =
          packed ? add_packed_handovers(writer, from_coarser) : writer.add_floats(from_coarser, 1);
    patterns.push_back(std::move(json));
  }
  Json json = {{"patterns", std::move(patterns)}};
  if (!fracture.stress.positions.empty()) json["stress"] = stress_json(fracture.stress, writer, packed);
  if (fracture.skin_m2 > 0) json["skinArea"] = fracture.skin_m2;
  if (fracture.crack_energy_j_m2 > 0) json["crackEnergy"] = fracture.crack_energy_j_m2;
  if (fracture.strength) {
    json["strength"] = {{"stress", fracture.strength->strength_pa},
                        {"weibullModulus", fracture.strength->weibull_modulus},
                        {"area", fracture.strength->reference_area_m2}};
  }
  return json;
}

}  // namespace ringdown::modal
