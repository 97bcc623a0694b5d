#include "protocol/convert.h"

#include "protocol/names.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::protocol {
namespace {

constexpr std::size_t kMaxTextBytes = 4096;

std::string shown(const std::string& text) { return "the text " + quote(text); }
std::string shown(std::int32_t value) { return std::to_string(value); }
std::string shown(std::int64_t value) { return std::to_string(value); }
std::string shown(double value) {
  if (std::isnan(value)) return "not a number (NaN)";
  if (std::isinf(value)) return value > 0 ? "infinite" : "minus infinite";
  return number_text(value);
}
std::string shown(const wire::Blob& blob) { return formatted("a blob of {} bytes", blob.size()); }
std::string shown(bool value) { return value ? "true" : "false"; }
std::string shown(wire::Tag tag) {
  switch (tag.type) {
    case 'I':
      return "an impulse (type I)";
    case 'c':
      return "a character (type c)";
    case 'm':
      return "a MIDI message (type m)";
    case 'r':
      return "a colour (type r)";
    case 't':
      return "a time tag (type t)";
    default:
      return "nil (type N)";
  }
}
std::string shown(const wire::Argument& argument) {
  return std::visit([](const auto& value) { return shown(value); }, argument);
}

tl::unexpected<Error> refuse(const ArgumentSpec& spec, const std::string& what) {
  return fail(ErrorKind::bad_input, "is {}; it must be {}", what, expectation(spec));
}

// An int64 above 2^53 loses digits here, but is outside every range of the table anyway.
std::optional<double> as_number(const wire::Argument& argument) {
  if (const auto* value = std::get_if<std::int32_t>(&argument)) return *value;
  if (const auto* value = std::get_if<std::int64_t>(&argument)) return static_cast<double>(*value);
  if (const auto* value = std::get_if<float>(&argument)) return *value;
  if (const auto* value = std::get_if<double>(&argument)) return *value;
  return std::nullopt;
}

// The number within the spec's limits, or nothing.
//
// Who has only 32-bit floats cannot send a limit like 0.1: the nearest float is 0.1000000015. So where the number may
// have been a float, the float nearest to a limit stands for this limit.
std::optional<double> within(const ArgumentSpec& spec, double number, bool may_be_float) {
  if (number >= spec.min && number <= spec.max) return number;  // false for NaN
  if (!may_be_float || !std::isfinite(number)) return std::nullopt;
  const auto is_float_of = [number](double limit) { return number == static_cast<double>(static_cast<float>(limit)); };
  if (is_float_of(spec.min)) return spec.min;
  if (is_float_of(spec.max)) return spec.max;
  return std::nullopt;
}

Result<Value> convert_number(const ArgumentSpec& spec, const wire::Argument& argument) {
  const std::optional<double> given = as_number(argument);
  // A float may have become a double on its way here, but whole numbers are not sent so.
  const bool may_be_float = spec.type == ValueType::number || std::holds_alternative<float>(argument);
  const std::optional<double> number = given ? within(spec, *given, may_be_float) : std::nullopt;
  if (!number) return refuse(spec, shown(argument));
  if (spec.type == ValueType::number) return Value(*number);
  if (*number != std::floor(*number)) return refuse(spec, shown(argument));
  return Value(static_cast<std::int32_t>(*number));
}

Result<Value> convert_flag(const ArgumentSpec& spec, const wire::Argument& argument) {
  if (const auto* on = std::get_if<bool>(&argument)) return Value(std::int32_t{*on});
  return convert_number(spec, argument);
}

Result<Value> convert_object(const ArgumentSpec& spec, const wire::Argument& argument) {
  if (const std::optional<double> number = as_number(argument)) {
    const bool fits = *number >= 0 && *number <= kMaxNumber && *number == std::floor(*number);
    if (!fits) return refuse(spec, shown(argument));
    return Value(ObjectRef{"", static_cast<std::uint32_t>(*number)});
  }
  if (spec.type == ValueType::object_or_none && argument == wire::Argument(wire::Tag{'N'})) return Value();
  const auto* named = std::get_if<std::string>(&argument);
  if (!named) return refuse(spec, shown(argument));
  const std::string& text = *named;
  if (spec.type == ValueType::object_or_none && text == kNoObject) return Value();
  Result<ObjectRef> object = parse_object(text);
  if (!object) return refuse(spec, shown(argument));
  return Value(std::move(*object));
}

Result<Value> convert_text(const ArgumentSpec& spec, const wire::Argument& argument) {
  const auto* text = std::get_if<std::string>(&argument);
  if (!text) return refuse(spec, (as_number(argument) ? "the number " : "") + shown(argument));
  if (spec.type == ValueType::any_text) return Value(*text);
  const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == 127; };
  const bool good = spec.type == ValueType::name
                        ? is_object_name(*text)
                        : !text->empty() && text->size() <= kMaxTextBytes && std::ranges::none_of(*text, is_control);
  if (!good) return refuse(spec, shown(argument));
  return Value(*text);
}

Result<Value> convert_blob(const ArgumentSpec& spec, const wire::Argument& argument) {
  const auto* blob = std::get_if<wire::Blob>(&argument);
  const auto bytes = static_cast<std::size_t>(spec.min), max = static_cast<std::size_t>(spec.max);
  const bool good = blob && !blob->empty() && blob->size() % bytes == 0 && blob->size() / bytes <= max;
  if (!good) return refuse(spec, shown(argument));
  return Value(*blob);
}

}  // namespace

Result<Value> convert(const ArgumentSpec& spec, const wire::Argument& argument) {
  switch (spec.type) {
    case ValueType::number:
    case ValueType::integer:
      return convert_number(spec, argument);
    case ValueType::flag:
      return convert_flag(spec, argument);
    case ValueType::text:
    case ValueType::any_text:
    case ValueType::name:
      return convert_text(spec, argument);
    case ValueType::blob:
      return convert_blob(spec, argument);
    case ValueType::object:
    case ValueType::object_or_none:
      break;
  }
  return convert_object(spec, argument);
}

std::optional<double> fitted_number(const ArgumentSpec& spec, double value) { return within(spec, value, true); }

Result<void> fit(const ArgumentSpec& spec, Value& value) {
  if (auto* real = std::get_if<double>(&value)) {
    const std::optional<double> fitted = within(spec, *real, true);
    if (!fitted) return refuse(spec, shown(*real));
    *real = *fitted;
  } else if (const auto* integer = std::get_if<std::int32_t>(&value)) {
    if (*integer < spec.min || *integer > spec.max) return refuse(spec, shown(*integer));
  }
  return {};
}

std::string expectation(const ArgumentSpec& spec) {
  const std::string unit = spec.unit.empty() ? "" : " " + std::string(spec.unit);
  const std::string range = " from " + number_text(spec.min) + " to " + number_text(spec.max) + unit;
  switch (spec.type) {
    case ValueType::number:
      return "a number" + range;
    case ValueType::integer:
      return "a whole number" + range;
    case ValueType::flag:
      return "0 or 1";
    case ValueType::text:
      return "text of 1 to 4096 bytes without control characters";
    case ValueType::any_text:
      return "text";
    case ValueType::name:
      return "a name of 1 to 64 of A-Z a-z 0-9 _ . - that is not all digits";
    case ValueType::object:
      return "an object's name or number";
    case ValueType::blob:
      return formatted("a blob of 1 to {} records of {} bytes", number_text(spec.max), number_text(spec.min));
    case ValueType::object_or_none:
      break;
  }
  return "an object's name or number, or - for none";
}

std::string number_text(double value) { return formatted("{:.10g}", value); }

std::string value_text(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return number_text(*number);
  if (const auto* integer = std::get_if<std::int32_t>(&value)) return std::to_string(*integer);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* object = std::get_if<ObjectRef>(&value)) return to_text(*object);
  if (const auto* blob = std::get_if<wire::Blob>(&value)) return formatted("{} bytes", blob->size());
  return std::string(kNoObject);
}

}  // namespace ringdown::protocol
