#include "engine/fem/element_kind.h"

#include <algorithm>
#include <array>
#include <string>

namespace ringdown::fem {
namespace {

struct Kind {
  Element element;
  std::string_view name;
  int order;
};

constexpr std::array kKinds = {Kind{Element::kTet4, "tet4", 1}, Kind{Element::kTet4Lumped, "tet4-lumped", 1},
                               Kind{Element::kTet10, "tet10", 2}, Kind{Element::kTet20, "tet20", 3},
                               Kind{Element::kTet35, "tet35", 4}};

const Kind& kind_of(Element element) {
  return *std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& kind) { return kind.element == element; });
}

}  // namespace

std::string_view element_name(Element element) { return kind_of(element).name; }
int order_of(Element element) { return kind_of(element).order; }

Result<Element> parse_element(std::string_view name) {
  for (const Kind& kind : kKinds) {
    if (kind.name == name) return kind.element;
  }
  return fail(ErrorKind::bad_input, "unknown element '{}'; choose tet10, tet20, tet35, tet4 or tet4-lumped", name);
}

}  // namespace ringdown::fem
