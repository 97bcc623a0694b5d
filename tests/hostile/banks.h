// Banks whose structure is valid and whose numbers are not those of any body: what finds sums that are no numbers.
#pragma once

#include "engine/modal/bank.h"
#include "tests/hostile/random.h"

#include <string>

namespace ringdown::hostile {

// A bank of `modes` modes that bend a plate and exchange energy, `stretching` times as hard as real plates do.
modal::Bank bending_bank(Random& random, std::size_t modes, double stretching);

// The bytes of a .glb file: a small bank of which some numbers have become extreme, or all of one kind have been
// multiplied by a power of ten. Now and then its node has a scale, too.
std::string hostile_bank(Random& random);

}  // namespace ringdown::hostile
