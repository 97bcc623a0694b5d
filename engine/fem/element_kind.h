// The kinds of elements, by name. [any thread]
#pragma once

#include "engine/base/result.h"

#include <string_view>

namespace ringdown::fem {

enum class Element {
  kTet4,        // linear, consistent mass
  kTet4Lumped,  // linear, lumped mass, as in the course report; far too stiff in bending (docs/how/physics.md)
  kTet10,       // quadratic, consistent mass
  kTet20,       // cubic
  kTet35,       // quartic
};

// Names: "tet4", "tet4-lumped", "tet10", "tet20", "tet35".
std::string_view element_name(Element element);
Result<Element> parse_element(std::string_view name);

// The degree of the element's polynomials. The mesh must have this order.
int order_of(Element element);

}  // namespace ringdown::fem
