// Requests with the numbers that hurt: made from the protocol's table, so that a new address is attacked as soon as it
// stands there.
#pragma once

#include "protocol/wire/message.h"
#include "tests/hostile/random.h"

#include <string>
#include <vector>

namespace ringdown::hostile {

// The objects and files that messages name.
struct Names {
  std::vector<std::string> objects, files;
};

// Most messages are valid, and their numbers stand at the ends of their ranges as often as within; the rest has values
// out of range, of another type, too many or too few.
wire::Message hostile_message(Random& random, const Names& names);

}  // namespace ringdown::hostile
