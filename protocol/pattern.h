// Address patterns of OSC 1.0: one message for many objects, "/object/glass*/gain". [any thread but audio]
//
// In a part of an address ? stands for one character, * for any number of them, [abc], [a-z] and [!a-z] for one of a
// set or not of it, {low,high} for one of these words. Patterns may stand for the object (they are matched with names,
// not with numbers) and for what follows it: "/object/{bell,bowl}/*clear". Elsewhere they are not taken.
#pragma once

#include "engine/base/result.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::protocol {

[[nodiscard]] inline bool is_pattern(std::string_view address) { return address.find_first_of("?*[{") != address.npos; }

// Returns true if one part of an address, a pattern, matches `text` of up to 127 characters. A pattern whose [ or { is
// not closed, or whose set is empty, matches nothing. Takes |pattern| |text| steps at most, whatever the pattern.
[[nodiscard]] bool matches(std::string_view pattern, std::string_view text);

// The addresses that a pattern stands for when there are objects of these names; at least one, or a sentence that says
// what matches nothing.
Result<std::vector<std::string>> expand(std::string_view pattern, std::span<const std::string> names);

}  // namespace ringdown::protocol
