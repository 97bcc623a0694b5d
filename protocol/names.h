// How an object is named, in addresses, scene files and options. [any thread]
//
// A name is 1 to 64 of A-Z a-z 0-9 _ . - and is not made of digits only: digits are an object's number. "-"
// alone is no name either: it stands for "no object" where an argument allows that.
#pragma once

#include "engine/base/quoted.h"
#include "engine/base/result.h"
#include "protocol/request.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace ringdown::protocol {

inline constexpr std::size_t kMaxName = 64;
inline constexpr std::uint32_t kMaxNumber = (1u << 24) - 1;  // exact in a float, the only number Pure Data sends
inline constexpr std::string_view kNoObject = "-";

bool is_object_name(std::string_view text);

// "bell" or "3" -> the reference; anything else gives a sentence that quotes it and says what is allowed.
Result<ObjectRef> parse_object(std::string_view text);

// The inverse: the name, or the number in decimal.
std::string to_text(const ObjectRef& object);

using ringdown::quoted;  // for error messages

}  // namespace ringdown::protocol
