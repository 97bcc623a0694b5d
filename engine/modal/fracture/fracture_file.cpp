#include "engine/modal/fracture/fracture_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace ringdown::modal {
namespace {

constexpr std::size_t kMaxHandover = std::size_t{1} << 26;  // numbers in one pattern
constexpr float kMaxEntry = 1.001F;  // of a handover: at most 1 but for rounding, as both bases are orthonormal
constexpr double kMaxLength_m = 1e6;
constexpr std::size_t kMaxNumbers = std::size_t{1} << 27;  // of all pieces together: 512 MiB
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

Result<double> read_size(const JsonPlace& field, double max) {
  const auto number = field.number();
  if (!number) return fail(number.error());
  if (!(*number >= 0 && *number <= max)) return field.wrong("at least 0, at most " + Json(max).dump());
  return *number;
}

Result<PieceBank> read_piece(const JsonPlace& field, const PieceReaders& readers) {
  PieceBank piece;
  const auto bank = [&]() -> Result<Bank> {
    if (!field["model"].present()) return readers.silent(field);
    const auto model = field["model"].index();
    if (!model) return fail(model.error());
    return readers.model(*model);
  }();
  if (!bank) return fail(bank.error());
  if (!is_solid(bank->mass)) return field.wrong(kSolid);
  const JsonPlace opens = field["opens"];
  const auto near_m = read_size(opens[0], kMaxLength_m), far_m = read_size(opens[1], kMaxLength_m);
  if (!near_m) return fail(near_m.error());
  if (!far_m) return fail(far_m.error());
  if (*far_m < *near_m) return opens.wrong("two distances, the nearer one first");
  return PieceBank{
      .bank = *bank, .handover = {}, .near_m = *near_m, .far_m = *far_m, .model = field["model"].index().value_or(0)};
}

Result<void> read_handovers(const Glb& glb, const JsonPlace& field, std::size_t columns, BreakPattern& pattern) {
  const auto numbers = read_floats(glb, field, 1, kMaxHandover);
  if (!numbers) return fail(numbers.error());
  std::size_t rows = 0;
  for (const PieceBank& piece : pattern.pieces) rows += kRigidMotions + piece.bank.mode_count();
  if (numbers->size() != rows * columns) {
    return field.wrong(std::to_string(rows * columns) + " numbers: " + std::to_string(columns) + " for each of " +
                       std::to_string(rows) + " motions of the pieces");
  }
  if (!std::ranges::all_of(*numbers, [](float x) { return std::abs(x) <= kMaxEntry; }))
    return field.wrong("numbers from -1 to 1");
  auto from = numbers->begin();
  for (PieceBank& piece : pattern.pieces) {
    const auto to = from + static_cast<std::ptrdiff_t>((kRigidMotions + piece.bank.mode_count()) * columns);
    piece.handover.assign(from, to);
    from = to;
  }
  return {};
}

}  // namespace

Result<Fracture> read_fracture(const Glb& glb, const JsonPlace& fracture, const Bank& body,
                               const PieceReaders& readers) {
  Fracture out;
  if (!is_solid(body.mass)) return fracture.wrong(std::string("absent, or its model ") + kSolid);
  const JsonPlace patterns = fracture["patterns"];
  if (patterns.size() == 0 || patterns.size() > kMaxPatterns)
    return fracture.wrong("a list `patterns` of 1 to " + std::to_string(kMaxPatterns));
  std::size_t count = 0, numbers = 0;
  for (std::size_t p = 0; p < patterns.size(); ++p) {
    const JsonPlace field = patterns[p], pieces = field["pieces"];
    BreakPattern& pattern = out.patterns.emplace_back();
    count += pieces.size();
    if (pieces.size() < 2 || count > kMaxPieces)
      return field.wrong("a list of 2 or more `pieces`, at most " + std::to_string(kMaxPieces) + " in all patterns");
    for (double* const number : {&pattern.at_m.x, &pattern.at_m.y, &pattern.at_m.z}) {
      const auto read = field["at"][number - &pattern.at_m.x].number();
      if (!read) return fail(read.error());
      if (std::abs(*read) > kMaxLength_m) return field["at"].wrong("a place within a million metres");
      *number = *read;
    }
    const auto area = read_size(field["crackArea"], kMaxLength_m);
    if (!area) return fail(area.error());
    pattern.crack_area_m2 = *area;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      auto piece = read_piece(pieces[i], readers);
      if (!piece) return fail(piece.error());
      pattern.pieces.push_back(std::move(*piece));
      numbers += numbers_of(pattern.pieces.back().bank);
      if (numbers > kMaxNumbers) return pieces.wrong("pieces of at most " + std::to_string(kMaxNumbers) + " numbers");
    }
    if (auto read = read_handovers(glb, field["handover"], kRigidMotions + body.mode_count(), pattern); !read)
      return fail(read.error());
    for (const PieceBank& piece : pattern.pieces) numbers += piece.handover.size();
    if (numbers > kMaxNumbers) return pieces.wrong("pieces of at most " + std::to_string(kMaxNumbers) + " numbers");
  }
  return out;
}

Json fracture_json(const Fracture& fracture, GlbWriter& writer, const std::function<Json(const PieceBank&)>& describe) {
  Json patterns = Json::array();
  for (const BreakPattern& pattern : fracture.patterns) {
    Json pieces = Json::array();
    std::vector<float> handovers;
    for (const PieceBank& piece : pattern.pieces) {
      Json json = describe(piece);
      json["opens"] = {piece.near_m, piece.far_m};
      pieces.push_back(std::move(json));
      handovers.insert(handovers.end(), piece.handover.begin(), piece.handover.end());
    }
    patterns.push_back({{"at", {pattern.at_m.x, pattern.at_m.y, pattern.at_m.z}},
                        {"crackArea", pattern.crack_area_m2},
                        {"handover", writer.add_floats(handovers, 1)},
                        {"pieces", std::move(pieces)}});
  }
  return {{"patterns", std::move(patterns)}};
}

}  // namespace ringdown::modal
