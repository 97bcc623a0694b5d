// The words of ringdown.h in place of the protocol's. Private to clients/library. [any thread]
//
// Functions of the library make the requests of the protocol, whose ranges hold for both; but a sentence for a C
// programmer names the function's own parameter ("impulse_ns[2]", not "jz").
#pragma once

#include "engine/base/result.h"
#include "protocol/request.h"
#include "protocol/schema.h"

#include <cstddef>
#include <initializer_list>
#include <utility>

namespace ringdown::library {

// The sentence about a number of a request that is out of range.
tl::unexpected<Error> out_of_range(const protocol::AddressSpec& spec, const protocol::OutOfRange& wrong);

// Refuses a request with a number outside of its range. A 32-bit float nearest to a limit becomes the limit. Allocates
// nothing while all are good.
Result<void> check(protocol::Request& request);
template <class Struct>
Result<void> check(Struct& one) {
  protocol::Request request(std::move(one));
  Result<void> good = check(request);
  one = std::move(request.get<Struct>());
  return good;
}

// Refuses an index that is not below `count`; the sentence calls it `name`.
Result<void> check_index(const char* name, std::size_t index, std::size_t count);

// Refuses a setting outside of its range; the sentence calls it `name` and ends with `or_else`.
Result<void> check_within(const char* name, double value, double min, double max, const char* or_else = "");

// The sentence about a pointer that must not be NULL.
tl::unexpected<Error> missing(const char* name);

// The name of the first pointer that is NULL, or nullptr.
const char* first_null(std::initializer_list<std::pair<const char*, const void*>> pointers);

}  // namespace ringdown::library
