// How an object is named, in addresses, scene files and options. [any thread]
//
// A name is 1 to 64 of A-Z a-z 0-9 _ . - and is not made of digits only: digits are an object's number. "-"
// alone is no name either: it stands for "no object" where an argument allows that.
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
