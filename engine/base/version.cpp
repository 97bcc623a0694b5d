#include "engine/base/version.h"

namespace ringdown {

// No other file is compiled with the version, so that a release compiles this file alone.
const char* const kVersion = RINGDOWN_VERSION;

}  // namespace ringdown
