// An object in text: its name (engine/base/object_name.h) or its number. [any thread]
#pragma once

#include "engine/base/object_name.h"
#include "engine/base/quote.h"
#include "engine/base/result.h"
#include "protocol/request.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace ringdown::protocol {

inline constexpr std::string_view kObjectPrefix = "/object/";  // then its name or number, then what to do with it
inline constexpr std::uint32_t kMaxNumber = (1u << 24) - 1;    // exact in a float, the only number Pure Data sends

// "bell" or "3" -> the reference; anything else gives a sentence that quotes it and says what is allowed.
Result<ObjectRef> parse_object(std::string_view text);

// The inverse: the name, or the number in decimal.
std::string to_text(const ObjectRef& object);

using ringdown::quote;  // for error messages

}  // namespace ringdown::protocol
