// The nonlinear terms of a body on their way into a bank, and their cache. [worker]
#pragma once

#include "engine/base/content_cache.h"
#include "engine/bake/heard_modes.h"
#include "engine/bake/nonlinear_modes.h"

#include <optional>
#include <utility>

namespace ringdown::bake {

// Terms found before, by the content of the modes that they belong to: inside a family of equal frequencies the basis
// is arbitrary, and the terms are those of one basis.
class NonlinearCache {
 public:
  explicit NonlinearCache(ContentCache cache) : cache_(std::move(cache)) {}

  // Those of the first `count` modes of the body, or of all that it has.
  [[nodiscard]] std::optional<NonlinearModes> find(const BodyModes& modes, int count) const;
  Result<void> store(const BodyModes& modes, const NonlinearModes& terms) const;

 private:
  ContentCache cache_;
};

// Refuses a body whose own linear stress turns with it so much that the slaved motions are not what they were taken
// for: a deep shell. `name` stands at the beginning of the sentence.
Result<void> check_shallow(const NonlinearModes& terms, const std::string& name);

// The terms that a bank holds: those of the modes `kept`, numbered by their places in that list. Returns nothing if no
// kept mode has terms.
std::optional<modal::NonlinearTerms> bank_terms(const NonlinearModes& terms, const std::vector<HeardMode>& kept,
                                                const BodyModes& modes, const BodyUnits& units, double thickness_m);

}  // namespace ringdown::bake
