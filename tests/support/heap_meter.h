#pragma once

#include <cstdint>

namespace ringdown::test {

// Returns the bytes that malloc has given to this program, all its threads and libraries, and not got back. Exact,
// where mallinfo2() counts what threads keep for themselves as given. 0 in a build with a sanitizer.
std::int64_t bytes_from_malloc();

}  // namespace ringdown::test
