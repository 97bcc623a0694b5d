// Good and bad arguments for every address. They are written by hand, not taken from the table: what the table says
// wrong, they do not repeat.
#pragma once

#include "protocol/schema.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace ringdown::protocol {

using Arguments = std::vector<wire::Argument>;
using Claim = std::function<bool(const Request&)>;

struct Good {
  std::string address;
  Arguments arguments;
  Claim claim;
};
struct Bad {
  std::string address;
  Arguments arguments;
  std::string argument;  // the one the sentence must name
};
struct Cases {
  std::vector<Good> good;
  std::vector<Bad> bad;
};

inline ObjectRef named(std::string name) { return {std::move(name), std::nullopt}; }
inline ObjectRef numbered(std::uint32_t number) { return {"", number}; }

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

template <class Struct>
Claim claim(std::function<bool(const Struct&)> predicate) {
  return [predicate](const Request& request) {
    const auto* parsed = request.get_if<Struct>();
    return parsed && predicate(*parsed);
  };
}
template <class Struct>
Claim is_a() {
  return [](const Request& request) { return request.holds<Struct>(); };
}

// Of everything that touches an object for some time.
Cases bow_cases();
Cases mallet_cases();
Cases couple_cases();
Cases contact_cases();
Cases pickup_cases();
Cases hold_cases();

// By the address as the table has it.
const std::map<std::string, Cases>& all_cases();

}  // namespace ringdown::protocol
