// Work for which memory may not suffice, because its size comes from outside: reading a file, carrying out a request.
// An allocation that fails becomes an error of kind no_memory, and the program goes on. [any thread but audio]
//
//   return within_memory("read " + path.string(), [&] { return parse(*text); });
#pragma once

#include "engine/base/result.h"

#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace ringdown {

// Returns what `work` returns, a Result, or the error "there is not enough memory to `what`; ...".
template <class Work>
std::invoke_result_t<Work> within_memory(const std::string& what, Work work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {  // a container was asked to be larger than any memory
  }
  return fail(ErrorKind::no_memory, "there is not enough memory to " + what +
                                        "; end other programs, or raise the limit of this one's memory");
}

}  // namespace ringdown
