// The function by which a document's other files are read. [worker]
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <functional>
#include <string>

namespace ringdown::modal {

// Reads a file beside a document. `relative` is a relative path without a scheme; the file has at most `limit_bytes`.
using ReadBeside = std::function<Result<std::string>(const std::string& relative, std::size_t limit_bytes)>;

}  // namespace ringdown::modal
