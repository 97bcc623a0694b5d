#include "protocol/names.h"

#include <charconv>

namespace ringdown::protocol {

Result<ObjectRef> parse_object(std::string_view text) {
  if (is_object_name(text)) return ObjectRef{std::string(text), std::nullopt};
  std::uint32_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (!text.empty() && error == std::errc() && stop == end && number <= kMaxNumber) {
    return ObjectRef{"", number};
  }
  return fail(ErrorKind::bad_input,
              "{} is not an object: give its number, up to {}, or a name of 1 to 64 of A-Z a-z 0-9 _ . - that is not "
              "all digits",
              quote(text), kMaxNumber);
}

std::string to_text(const ObjectRef& object) { return object.number ? std::to_string(*object.number) : object.name; }

}  // namespace ringdown::protocol
