#include "engine/bake/liquid/filling.h"

#include "engine/base/range.h"
#include "engine/modal/levels/liquid_levels.h"

#include <string_view>

namespace ringdown::bake {
namespace {

constexpr Range kHeight_m{-1e6, 1e6}, kLiquidDepth_m{1e-9, 1e6}, kLiquid_ml{1e-6, 1e15}, kUpward{-1e6, 1e6};
constexpr std::size_t kMaxBasins = 64;
constexpr double kMl_m3 = 1e-6;

void read_up(TomlTable& table, Vec3& up) {
  table.vector("up", up, kUpward);
  if (!(up.x * up.x + up.y * up.y + up.z * up.z > 0)) table.complain("up", "up must be a direction, not 0");
}

Filling read_filling(TomlTable& table) {
  using Kind = liquid::Amount::Kind;
  Filling filling;
  table.text("liquid", filling.liquid.name);
  read_up(table, filling.up);
  int amounts = 0;
  const auto amount = [&](std::string_view key, Kind kind, const Range& range, double unit) {
    if (!table.has(key)) return;
    ++amounts;
    filling.amount.kind = kind;
    table.number(key, filling.amount.value, range);
    filling.amount.value *= unit;
  };
  amount("level_m", Kind::kLevel, kHeight_m, 1);
  amount("depth_m", Kind::kDepth, kLiquidDepth_m, 1);
  amount("volume_ml", Kind::kVolume, kLiquid_ml, kMl_m3);
  bool full = false;
  table.boolean("full", full);
  if (amounts + (full ? 1 : 0) != 1)
    table.complain("level_m", "say how far it is filled by one of level_m, depth_m, volume_ml or full = true");
  std::uint64_t levels = 0;
  table.whole("levels", levels, 0, modal::kMaxLevels);
  if (levels > 0 && levels < modal::kMinLevels) table.complain("levels", "levels must be 0, or 4 to 64");
  filling.levels = levels;
  std::vector<double> places;
  table.numbers("basin", places);
  if (places.size() % 3 != 0 || places.size() > 3 * kMaxBasins)
    table.complain("basin", "basin must be three numbers for each basin, in metres, of at most 64 basins");
  for (std::size_t i = 0; i + 2 < places.size(); i += 3)
    filling.basins_m.push_back({places[i], places[i + 1], places[i + 2]});
  return filling;
}

}  // namespace

Liquids Liquids::scaled(double scale) const {
  Liquids other = *this;
  if (other.fill) {
    if (other.fill->amount.kind != liquid::Amount::Kind::kVolume) other.fill->amount.value *= scale;
    for (Vec3& basin : other.fill->basins_m) basin = scale * basin;
  }
  if (other.bath) other.bath->level_m *= scale;
  return other;
}

std::filesystem::path liquid_folder(const std::filesystem::path& materials) {
  return (materials.has_filename() ? materials : materials.parent_path()).parent_path() / "liquids";
}

void read_liquids(TomlTable& file, Liquids& liquids) {
  if (std::optional<TomlTable> one = file.table("fill")) liquids.fill = read_filling(*one);
  if (std::optional<TomlTable> table = file.table("bath")) {
    Bath& bath = liquids.bath.emplace();
    table->require({"level_m"});
    table->text("liquid", bath.liquid.name);
    table->number("level_m", bath.level_m, kHeight_m);
    read_up(*table, bath.up);
  }
}

}  // namespace ringdown::bake
