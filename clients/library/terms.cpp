#include "clients/library/terms.h"

#include <array>
#include <string>
#include <string_view>

namespace ringdown::library {
namespace {

// "impulse_ns[2]"
std::string name_of(const protocol::AddressSpec& spec, std::size_t argument) {
  const std::string name = protocol::member_name(spec.arguments[argument]);
  const std::string_view group = spec.arguments[argument].group;
  if (group.empty()) return name;
  std::size_t first = argument;
  while (first > 0 && spec.arguments[first - 1].group == group) --first;
  return formatted("{}[{}]", name, argument - first);
}

std::string text_of(double value) { return formatted("{:.10g}", value); }

}  // namespace

tl::unexpected<Error> out_of_range(const protocol::AddressSpec& spec, const protocol::OutOfRange& wrong) {
  return fail(ErrorKind::bad_input, name_of(spec, wrong.argument) + " " + wrong.complaint);
}

Result<void> check(protocol::Request& request) {
  if (const auto wrong = protocol::find_out_of_range(request)) return out_of_range(protocol::spec_of(request), *wrong);
  return {};
}

Result<void> check_index(const char* name, std::size_t index, std::size_t count) {
  if (index < count) return {};
  return fail(ErrorKind::bad_input, "{} is {}; it must be a whole number from 0 to {}", name, index, count - 1);
}

Result<void> check_within(const char* name, double value, double min, double max, const char* or_else) {
  if (value >= min && value <= max) return {};  // false for NaN
  return fail(ErrorKind::bad_input, "{} is {}; it must be from {} to {}{}", name, text_of(value), text_of(min),
              text_of(max), or_else);
}

tl::unexpected<Error> missing(const char* name) {
  return fail(ErrorKind::bad_input, std::string(name) + " must not be NULL");
}

const char* first_null(std::initializer_list<std::pair<const char*, const void*>> pointers) {
  for (const auto& [name, pointer] : pointers) {
    if (!pointer) return name;
  }
  return nullptr;
}

}  // namespace ringdown::library
