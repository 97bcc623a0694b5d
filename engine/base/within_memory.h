// Runs work that may exhaust memory or threads: reading a file, carrying out a request, starting a service. If an
// allocation fails or a thread cannot be started, the result is an error of kind no_memory, and the program continues.
// [any thread but audio]
//
//   return within_memory("read " + path.string(), [&] { return parse(*text); });
#pragma once

#include "engine/base/result.h"

#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <type_traits>

namespace ringdown {

// Returns what `work` returns, a Result, or the error "there is not enough memory to `what`; ...", or "no thread can be
// started to `what`; ...".
template <class Work>
std::invoke_result_t<Work> within_memory(const std::string& what, Work work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {  // a container was asked to be larger than any memory
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::resource_unavailable_try_again) throw;
    return fail(ErrorKind::no_memory, "no thread can be started to " + what +
                                          "; end other programs, or raise the limits of processes (ulimit -u) and of "
                                          "memory (ulimit -v)");
  }
  return fail(ErrorKind::no_memory, "there is not enough memory to " + what +
                                        "; end other programs, or raise the limit of this one's memory");
}

}  // namespace ringdown
