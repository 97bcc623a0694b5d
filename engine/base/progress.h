// How long work reports its progress and is asked to stop. [the thread that works]
#pragma once

#include "engine/base/result.h"

#include <functional>
#include <string_view>

namespace ringdown {

// The work calls it now and then with the name of the current stage and the fraction of that stage that is done, 0..1;
// 0 where the fraction is not known. When it returns false the work fails with ErrorKind::cancelled.
using Progress = std::function<bool(std::string_view stage, double fraction)>;

[[nodiscard]] inline tl::unexpected<Error> fail_cancelled() { return fail(ErrorKind::cancelled, "cancelled"); }

}  // namespace ringdown
