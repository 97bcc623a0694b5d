// One argument against its row of the table. Private to protocol/.
#pragma once

#include "protocol/schema.h"

namespace ringdown::protocol {

// The checked value, or what is wrong: "is 0.5; it must be a whole number from 0 to 16777215".
Result<Value> convert(const ArgumentSpec& spec, const wire::Argument& argument);

// Whether a number is what the spec accepts; other values are not looked at. The sentence is as convert()'s.
Result<void> check_range(const ArgumentSpec& spec, const Value& value);

// Says what the spec accepts: "a number from 0 to 0.1 s".
std::string expectation(const ArgumentSpec& spec);

// The fewest digits that read back as the same number: 0.0002, 16777215, 1e+20.
std::string number_text(double value);

// A value as one writes it: 0.0002, bell, -.
std::string value_text(const Value& value);

}  // namespace ringdown::protocol
