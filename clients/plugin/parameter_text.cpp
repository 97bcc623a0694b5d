#include "clients/plugin/parameter_text.h"

#include "clients/plugin/mallets.h"
#include "clients/plugin/sources.h"
#include "clients/plugin/tunings.h"
#include "engine/base/formatted.h"
#include "engine/base/note.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace ringdown::plugin {
namespace {

constexpr const char* kRingsOn = "rings on";

bool is(std::size_t parameter, Parameter one) { return parameter == static_cast<std::size_t>(one); }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) != 0) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.remove_suffix(1);
  return text;
}

bool equal(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

// The name of a whole value; "" for values without a name.
std::string name_of(std::size_t parameter, int value) {
  if (is(parameter, Parameter::object)) return choice_name(static_cast<std::size_t>(value));
  if (is(parameter, Parameter::tuning)) return value == 0 ? "concert pitch" : "own pitch";
  if (is(parameter, Parameter::root_key)) return key_name(value);
  if (is(parameter, Parameter::mallet)) return kMalletInfo[static_cast<std::size_t>(value)].name;
  if (is(parameter, Parameter::scale)) return tuning_name(static_cast<std::size_t>(value));
  if (kParameterInfo[parameter].scale == Scale::toggle) return value == 0 ? "off" : "on";
  return "";
}

bool is_whole(Scale scale) { return scale == Scale::whole || scale == Scale::choice || scale == Scale::toggle; }

// Three significant digits: as many decimals as the rounded value leaves.
std::string three_digits(double value) {
  if (value == 0) return "0.00";
  const std::string rounded = formatted("{:.2e}", value);
  const long exponent = std::strtol(rounded.c_str() + rounded.find('e') + 1, nullptr, 10);
  return formatted("{:.{}f}", value, static_cast<int>(std::max(0L, 2 - exponent)));
}

}  // namespace

std::string number_of(std::size_t parameter, double value) {
  if (parameter >= kParameters) return "";
  const ParameterInfo& info = kParameterInfo[parameter];
  const double inside = std::isfinite(value)
                            ? std::clamp(value, static_cast<double>(info.min), static_cast<double>(info.max))
                            : static_cast<double>(info.standard);
  if (!is_whole(info.scale)) return three_digits(inside);
  const std::string name = name_of(parameter, static_cast<int>(std::lround(inside)));
  return name.empty() ? formatted("{}", std::lround(inside)) : name;
}

std::string text_of(std::size_t parameter, double value) {
  if (is(parameter, Parameter::release) && value >= kRingsOn_s) return kRingsOn;
  const std::string number = number_of(parameter, value);
  const bool has_unit = parameter < kParameters && *kParameterInfo[parameter].unit != 0;
  return has_unit ? number + " " + kParameterInfo[parameter].unit : number;
}

std::optional<double> value_of(std::size_t parameter, std::string_view text) {
  if (parameter >= kParameters) return std::nullopt;
  const ParameterInfo& info = kParameterInfo[parameter];
  text = trimmed(text);
  if (is_whole(info.scale)) {
    for (int value = static_cast<int>(info.min); value <= static_cast<int>(info.max); ++value) {
      if (const std::string name = name_of(parameter, value); !name.empty() && equal(name, text)) return value;
    }
    if (is(parameter, Parameter::root_key)) {
      if (const auto key = note_number(text)) return *key;  // flats, too
    }
  }
  if (is(parameter, Parameter::release) && equal(text, kRingsOn)) return static_cast<double>(info.max);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  const std::string_view rest = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  if (!rest.empty() && !equal(rest, info.unit)) return std::nullopt;
  value = std::clamp(value, static_cast<double>(info.min), static_cast<double>(info.max));
  return is_whole(info.scale) ? std::round(value) : value;
}

}  // namespace ringdown::plugin
