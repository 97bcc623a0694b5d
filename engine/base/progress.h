// What long work says of itself, and how it is stopped. [the thread that works]
#pragma once

#include "engine/base/result.h"

#include <functional>
#include <string_view>

namespace ringdown {

// Called now and then with what is being done and how far that is, 0..1 of that stage; 0 where it cannot be told.
// Return false to stop: the work then fails with ErrorKind::cancelled.
using Progress = std::function<bool(std::string_view stage, double fraction)>;

[[nodiscard]] inline tl::unexpected<Error> fail_cancelled() { return fail(ErrorKind::cancelled, "cancelled"); }

}  // namespace ringdown
