// Writes values into a pattern, checked by the compiler: formatted("{} of {} bodies at {:.3g} s", done, all, time_s).
// fmt has the patterns (https://fmt.dev/latest/syntax); its header that costs least is included here and nowhere else.
// base/result.h brings this header. Allocates. [any thread but audio]
#pragma once

#include <fmt/core.h>

#include <string>

namespace ringdown {

template <class... Values>
using Pattern = fmt::format_string<const Values&...>;

template <class... Values>
[[nodiscard]] std::string formatted(Pattern<Values...> pattern, const Values&... values) {
  return fmt::vformat(pattern, fmt::make_format_args(values...));
}

}  // namespace ringdown
