#include "engine/modal/levels/levels_file.h"

#include "engine/base/formatted.h"
#include "engine/gltf/meshopt_codec.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace ringdown::modal {
namespace {

constexpr int kMassStep = -16, kOwnStep = -18, kDragStep = -10;  // powers of 2
constexpr std::int32_t kMaxWhole = (1 << 23) - 1;

struct LevelsReader {
  const Glb& glb;
  const JsonPlace& field;

  // Reads an array of `size` floats; none need not be there.
  Result<void> read(const char* key, std::size_t size, std::vector<float>& array) const {
    if (size == 0) return {};
    auto numbers = read_floats(glb, field[key], 1, size);
    if (!numbers) return fail(numbers);
    if (numbers->size() != size) return field[key].wrong(formatted("{} numbers", size));
    array = std::move(*numbers);
    return {};
  }

  Result<void> read_list(const char* key, std::vector<double>& list) const {
    const JsonPlace place = field[key];
    if (place.size() < kMinLevels || place.size() > kMaxLevels)
      return place.wrong(formatted("{} to {} numbers", kMinLevels, kMaxLevels));
    for (std::size_t i = 0; i < place.size(); ++i) {
      const auto number = place[i].number();
      if (!number) return fail(number);
      if (!std::isfinite(*number)) return place[i].wrong("a number");
      list.push_back(*number);
    }
    return {};
  }
};

// Adds numbers as whole multiples of 2^step, where they fit; else as they are.
std::size_t add_rounded(GlbWriter& writer, std::span<const float> numbers, int step) {
  std::vector<std::int32_t> whole;
  whole.reserve(numbers.size());
  for (const float number : numbers) {
    const double steps = std::ldexp(static_cast<double>(number), -step);
    if (!(std::abs(steps) < kMaxWhole)) return writer.add_packed_floats(numbers, 1);
    whole.push_back(static_cast<std::int32_t>(std::lround(steps)));
  }
  return writer.add_exponentials(exponential_words(whole, step), 1);
}

std::size_t add_rounded_to_largest(GlbWriter& writer, std::span<const float> numbers, int step) {
  float largest = 0;
  for (const float number : numbers) largest = std::max(largest, std::abs(number));
  if (!(largest > 0) || std::abs(std::ilogb(largest) + step) > kMaxExponent)
    return writer.add_packed_floats(numbers, 1);
  return add_rounded(writer, numbers, std::ilogb(largest) + step);
}

}  // namespace

Result<LiquidLevels> read_levels(const Glb& glb, const JsonPlace& field, const Bank& bank) {
  const LevelsReader reader{glb, field};
  if (std::ranges::all_of(bank.provenance.liquids, &LiquidNote::around))
    return field.wrong("absent in a bank without a liquid inside");
  LiquidLevels levels;
  for (const auto& [key, list] : {std::pair{"heights", &levels.level_m}, std::pair{"volumes", &levels.volume_m3}}) {
    if (auto read = reader.read_list(key, *list); !read) return fail(read);
  }
  const std::size_t count = levels.levels(), modes = bank.mode_count();
  if (levels.volume_m3.size() != count) return field["volumes"].wrong("a volume for each of the heights");
  for (std::size_t l = 1; l < count; ++l) {
    if (!(levels.level_m[l] > levels.level_m[l - 1])) return field["heights"].wrong("ascending numbers");
  }
  for (const auto& [key, number] : {std::pair{"rigid", &levels.rigid}, std::pair{"further", &levels.further},
                                    std::pair{"liquid", &levels.liquid}}) {
    const auto read = field[key].index_or(0);
    if (!read) return fail(read);
    *number = *read;
  }
  if (levels.rigid != 0 && (levels.rigid != 6 || !bank.mass || !(bank.mass->inertia_kg_m2.x > 0)))
    return field["rigid"].wrong("0, or 6 in a bank that states its mass");
  if (levels.liquid > kMaxLiquidMotions) return field["liquid"].wrong(formatted("at most {}", kMaxLiquidMotions));
  if (levels.further > kMaxLevelColumns || levels.columns(modes) > kMaxLevelColumns)
    return field["further"].wrong(formatted("so few that there are at most {} columns", kMaxLevelColumns));
  const std::size_t columns = levels.columns(modes), body = packed_size(columns), own = packed_size(levels.liquid);
  for (const auto& read :
       {reader.read("stiffness", body, levels.stiffness), reader.read("mass", body, levels.mass),
        reader.read("following", columns * levels.liquid, levels.following),
        reader.read("added", count * body, levels.added),
        reader.read("bond", count * columns * levels.liquid, levels.bond),
        reader.read("liquidMass", count * own, levels.liquid_mass), reader.read("drag", count * modes, levels.drag)}) {
    if (!read) return fail(read);
  }
  if (!field["shapes"].present()) return levels;
  const auto shapes = read_floats(glb, field["shapes"], 3, levels.further * bank.point_count());
  if (!shapes) return fail(shapes);
  if (shapes->size() % (3 * bank.point_count()) != 0)
    return field["shapes"].wrong(formatted("a multiple of {} vectors", bank.point_count()));
  levels.shapes = *shapes;
  return levels;
}

Json levels_json(const LiquidLevels& levels, GlbWriter& writer, bool packed,
                 const std::function<std::size_t(std::span<const float>)>& add_shapes) {
  const auto exact = [&](const std::vector<float>& numbers) {
    return packed ? writer.add_packed_floats(numbers, 1) : writer.add_floats(numbers, 1);
  };
  const auto rounded = [&](const std::vector<float>& numbers, int step) {
    return packed ? add_rounded_to_largest(writer, numbers, step) : writer.add_floats(numbers, 1);
  };
  Json json = {{"heights", levels.level_m},
               {"volumes", levels.volume_m3},
               {"rigid", levels.rigid},
               {"further", levels.further},
               {"liquid", levels.liquid},
               {"stiffness", exact(levels.stiffness)},
               {"mass", exact(levels.mass)},
               {"added", packed ? add_rounded(writer, levels.added, kMassStep) : writer.add_floats(levels.added, 1)},
               {"drag", rounded(levels.drag, kDragStep)}};
  if (!levels.shapes.empty()) json["shapes"] = add_shapes(levels.shapes);
  if (levels.liquid > 0) {
    json["following"] = exact(levels.following);
    json["bond"] = rounded(levels.bond, kOwnStep);
    json["liquidMass"] = rounded(levels.liquid_mass, kOwnStep);
  }
  return json;
}

}  // namespace ringdown::modal
