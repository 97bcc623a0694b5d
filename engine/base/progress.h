// The callback by which long work reports its progress and is asked to stop. [the thread that works]
#pragma once

#include "engine/base/result.h"

#include <functional>
#include <string_view>

namespace ringdown {

// Called now and then with the name of the current stage and the finished fraction of that stage, 0..1; 0 if the
// fraction is unknown. If the callback returns false, the work fails with ErrorKind::cancelled.
using Progress = std::function<bool(std::string_view stage, double fraction)>;

[[nodiscard]] inline tl::unexpected<Error> fail_cancelled() { return fail(ErrorKind::cancelled, "cancelled"); }

}  // namespace ringdown
