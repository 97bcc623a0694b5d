#include "server/turns.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

namespace ringdown::server {
namespace {

TEST(Turns, ATurnForWhichMemoryDoesNotSufficeIsFollowedByTheNext) {
  std::stop_source stop;
  int turns = 0;
  take_turns("count", stop.get_token(), [&] {
    if (++turns == 2) throw std::bad_alloc();
    if (turns == 4) stop.request_stop();
  });
  EXPECT_EQ(turns, 4);
}

TEST(Turns, OtherExceptionsEndTheLoop) {
  const std::stop_source stop;
  EXPECT_THROW(take_turns("count", stop.get_token(), [] { throw std::logic_error("a mistake"); }), std::logic_error);
}

}  // namespace
}  // namespace ringdown::server
