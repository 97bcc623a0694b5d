// One argument against its row of the table. Private to protocol/.
#pragma once

#include "protocol/schema.h"

namespace ringdown::protocol {

// The checked value, or what is wrong: "is 0.5; it must be a whole number from 0 to 16777215".
Result<Value> convert(const ArgumentSpec& spec, const wire::Argument& argument);

// Refuses a number that the spec does not accept, with convert()'s sentence. Values other than numbers are not looked
// at. As in convert(), the 32-bit float nearest to a limit becomes the limit itself.
Result<void> fit(const ArgumentSpec& spec, Value& value);

// A number as the spec accepts it, or nothing.
std::optional<double> fitted_number(const ArgumentSpec& spec, double value);

// Says what the spec accepts: "a number from 0 to 0.1 s".
std::string expectation(const ArgumentSpec& spec);

// The fewest digits that read back as the same number: 0.0002, 16777215, 1e+20.
std::string number_text(double value);

// A value as one writes it: 0.0002, bell, -.
std::string value_text(const Value& value);

}  // namespace ringdown::protocol
