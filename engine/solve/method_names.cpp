// The names of the methods, apart from the methods themselves, for readers that solve nothing.
#include "engine/base/quote.h"
#include "engine/solve/eigensolver.h"

#include <array>
#include <string_view>

namespace ringdown::solve {
namespace {

struct Name {
  Method method;
  std::string_view name;
};

constexpr std::array kNames = {Name{Method::kAutomatic, "auto"}, Name{Method::kDense, "dense"},
                               Name{Method::kSpectra, "spectra"}, Name{Method::kBlockLanczos, "block"},
                               Name{Method::kSlepc, "slepc"}};

}  // namespace

std::string_view method_name(Method method) {
  for (const Name& entry : kNames) {
    if (entry.method == method) return entry.name;
  }
  return "";
}

Result<Method> parse_method(std::string_view name) {
  for (const Name& entry : kNames) {
    if (entry.name == name) return entry.method;
  }
  return fail(ErrorKind::bad_input,
              "there is no solver " + quote(name) + "; choose auto, dense, spectra, block or slepc");
}

}  // namespace ringdown::solve
