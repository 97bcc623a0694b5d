// Understands the names that artists give to materials: "wine glass 02", "Steel_brushed", "Oak", "porcelain_white".
// [any thread]
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace ringdown::bake {

// Returns the material of the library that a name means, if one of its words, in any case and with any digits and
// signs around it, is the name of a material in `known` or a word for one: "oak" is maple, "chrome" is steel. Of
// several words the last one counts, as in "glass table wood". Returns nothing if no word is known.
std::optional<std::string> understood_material(std::string_view name, std::span<const std::string> known);

}  // namespace ringdown::bake
