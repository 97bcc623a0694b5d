#include "engine/base/formatted.h"
#include "engine/base/quote.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace ringdown {

std::string quote(std::string_view text) {
  constexpr std::size_t kShown = 48;
  std::string shown(text.substr(0, kShown));
  std::ranges::replace_if(
      shown, [](char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + shown + (text.size() > kShown ? "...'" : "'");
}

std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += formatted("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string toml_number(double number) {
  std::array<char, 32> digits{};
  std::string text(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
  // TOML reads a number without a point or exponent as an integer; integers have no -0 and end at 2^63.
  const bool is_integer = text.find_first_of(".e") == text.npos;
  if (is_integer && (text == "-0" || std::abs(number) > 1e15)) text += ".0";
  return text;
}

std::string toml_vector(const Vec3& v) {
  return formatted("[{}, {}, {}]", toml_number(v.x), toml_number(v.y), toml_number(v.z));
}

}  // namespace ringdown
