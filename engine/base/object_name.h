// The rules for names of objects in addresses, scene files and options. [any thread]
//
// A name has 1 to 64 of the characters A-Z a-z 0-9 _ . - and is not digits only, because digits are an object's number.
// "-" alone is not a name: where an argument allows it, "-" means "no object".
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace ringdown {

inline constexpr std::size_t kMaxName = 64;  // characters
inline constexpr std::string_view kNoObject = "-";

inline bool is_object_name(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto is_allowed = [&](char c) {
    return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '.' || c == '-';
  };
  return !text.empty() && text.size() <= kMaxName && text != kNoObject && std::ranges::all_of(text, is_allowed) &&
         !std::ranges::all_of(text, is_digit);
}

}  // namespace ringdown
