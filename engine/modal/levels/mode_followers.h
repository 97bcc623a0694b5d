// Which modes of a changed body are those of the body before. [any thread]
#pragma once

#include <cstddef>
#include <vector>

namespace ringdown::modal {

// Returns for each of `modes` modes which one of `count` others follows it; those must be in ascending order of
// frequency, and at least as many. `likeness` (modes x count) is the share of another mode's motion that is along the
// mode, 0 to 1; the surest pairs are made first.
//
// When the level falls, a mode of the liquid rises far above the band, and several modes share its motion, so that none
// is sure to follow it. It goes on in the lowest of those: modes of one pattern repel each other and never cross.
// `body_shares` (modes) are the shares of each mode's strain energy that are in the body, by which modes of the liquid
// are known.
std::vector<std::size_t> followers(std::vector<double> likeness, const std::vector<double>& body_shares,
                                   std::size_t count);

}  // namespace ringdown::modal
