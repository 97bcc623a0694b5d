#include "tests/hostile/messages.h"

#include "protocol/bulk.h"
#include "protocol/schema.h"

#include <algorithm>

namespace ringdown::hostile {
namespace {

using protocol::ArgumentSpec;
using protocol::ValueType;

// A number that the table allows: an end of its range, one near 0, or one in between by size.
double allowed(const ArgumentSpec& spec, Random& random) {
  const double small = std::clamp(random.power(-12, 0) * (random.one_in(2) ? 1 : -1), spec.min, spec.max);
  switch (random.below(6)) {
    case 0:
      return spec.min;
    case 1:
      return spec.max;
    case 2:
      return std::clamp(0.0, spec.min, spec.max);
    case 3:
      return small;
    case 4:
      return std::clamp(small * spec.max, spec.min, spec.max);
    default:
      return random.uniform(spec.min, spec.max);
  }
}

wire::Argument as_number(double value, Random& random) {
  if (random.one_in(3)) return static_cast<float>(value);
  return value;
}

wire::Argument forbidden(const ArgumentSpec& spec, Random& random) {
  switch (random.below(7)) {
    case 0:
      return random.no_number();
    case 1:
      return random.extreme();
    case 2:
      return std::nextafter(spec.max, INFINITY);
    case 3:
      return static_cast<std::int64_t>(random.engine()());
    case 4:
      return static_cast<std::int32_t>(random.engine()());
    case 5:
      return std::string(random.below(300), static_cast<char>(1 + random.below(255)));
    default:
      return wire::Blob(random.below(100));
  }
}

// Records of four-byte numbers, as /strikes and /poses have them: mostly small integers and floats of any size.
wire::Blob records(const ArgumentSpec& spec, Random& random) {
  const auto bytes = static_cast<std::size_t>(spec.min);
  const std::size_t count = 1 + random.below(random.one_in(20) ? static_cast<std::size_t>(spec.max) : 4);
  if (bytes == protocol::kBytesPerStrike && random.one_in(2)) {
    std::vector<protocol::BulkStrike> strikes(count);
    for (protocol::BulkStrike& strike : strikes) {
      strike.object = static_cast<std::uint32_t>(random.below(8));
      strike.impulse_ns = {1e4 * random.uniform(-1, 1), random.power(-9, 4), 0};
      strike.contact_time_s = random.uniform(0, 0.09);
    }
    return protocol::encode_strikes(strikes);
  }
  std::vector<float> numbers(count * bytes / sizeof(float));
  for (float& number : numbers) {
    number = static_cast<float>(random.one_in(10) ? random.extreme() : random.uniform(-1, 1) * random.power(-6, 3));
  }
  return wire::encode_floats(numbers);
}

std::string text(const Names& names, Random& random) {
  if (!random.one_in(8)) return random.pick(names.files);
  std::string odd;
  for (std::size_t n = random.below(40); n > 0; --n) odd += static_cast<char>(random.below(256));
  return odd;
}

std::string object(const Names& names, Random& random) {
  if (random.one_in(8)) return std::to_string(random.below(12));
  return random.pick(names.objects);
}

wire::Argument valid(const ArgumentSpec& spec, const Names& names, Random& random) {
  switch (spec.type) {
    case ValueType::number:
      return as_number(allowed(spec, random), random);
    case ValueType::integer: {
      const double max = random.one_in(2) ? std::min(spec.max, 20.0) : spec.max;
      return static_cast<std::int32_t>(allowed({.min = spec.min, .max = std::max(max, spec.min)}, random));
    }
    case ValueType::flag:
      return static_cast<std::int32_t>(random.below(2));
    case ValueType::text:
    case ValueType::any_text:
      return text(names, random);
    case ValueType::name:
    case ValueType::object:
      return object(names, random);
    case ValueType::object_or_none:
      return random.one_in(3) ? std::string("-") : object(names, random);
    case ValueType::blob:
      return records(spec, random);
  }
  return 0;
}

}  // namespace

wire::Message hostile_message(Random& random, const Names& names) {
  const protocol::AddressSpec& spec = random.pick(protocol::addresses());
  wire::Message message{std::string(spec.address), {}};
  if (const std::size_t brace = message.address.find('{'); brace != std::string::npos) {
    const std::size_t end = message.address.find('}');
    const std::string name = random.one_in(20) ? "*" : object(names, random);
    message.address.replace(brace, end - brace + 1, name);
  }
  const bool honest = !random.one_in(4);
  for (std::size_t a = spec.arguments_in_address(); a < spec.arguments.size(); ++a) {
    const ArgumentSpec& argument = spec.arguments[a];
    if (argument.optional && random.one_in(6)) break;
    const bool lies = !honest && random.one_in(4);
    message.arguments.push_back(lies ? forbidden(argument, random) : valid(argument, names, random));
  }
  if (!honest && random.one_in(8)) message.arguments.emplace_back(random.extreme());
  if (!honest && random.one_in(8) && !message.arguments.empty()) message.arguments.pop_back();
  return message;
}

}  // namespace ringdown::hostile
