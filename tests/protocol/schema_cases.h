// Good and bad arguments for every address. They are written by hand, not taken from the table: what the table says
// wrong, they do not repeat.
#pragma once

#include "protocol/schema.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
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

// By the address as the table has it.
const std::map<std::string, Cases>& all_cases();

}  // namespace ringdown::protocol
