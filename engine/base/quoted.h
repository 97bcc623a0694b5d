// A stranger's text inside our sentences. [any thread]
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace ringdown {

// `text` in single quotes for an error message: unprintable characters become '?', long text is cut.
// Call it qualified: <iomanip> brings std::quoted, which argument-dependent lookup finds too.
inline std::string quoted(std::string_view text) {
  constexpr std::size_t kShown = 48;
  std::string shown(text.substr(0, kShown));
  std::ranges::replace_if(
      shown, [](char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + shown + (text.size() > kShown ? "...'" : "'");
}

}  // namespace ringdown
