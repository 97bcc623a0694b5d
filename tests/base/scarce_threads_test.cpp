// Teams and helpers where the system gives no more threads.
#include "engine/base/in_parallel.h"
#include "engine/base/within_memory.h"
#include "tests/support/scarcity.h"

#include <gtest/gtest.h>

#include <cstring>

namespace ringdown {
namespace {

class ScarceThreads : public testing::Test {
 protected:
  void SetUp() override {
#ifdef RINGDOWN_SANITIZE
    GTEST_SKIP() << "sanitizers map more memory than a limit allows";
#endif
    GTEST_FLAG_SET(death_test_style, "threadsafe");
  }
};

TEST_F(ScarceThreads, AThreadThatCannotBeStartedIsAnErrorThatSaysWhatToDo) {
  const auto try_it = [] {
    test::run_out_of_threads();
    const auto outcome = within_memory("count", []() -> Result<void> {
      std::jthread([] {}).join();
      return {};
    });
    if (outcome) std::_Exit(1);
    if (outcome.error().kind != ErrorKind::no_memory) std::_Exit(2);
    std::_Exit(std::strstr(outcome.error().message.c_str(), "no thread can be started to count") ? 0 : 3);
  };
  EXPECT_EXIT(try_it(), testing::ExitedWithCode(0), "");
}

TEST_F(ScarceThreads, WorkInParallelThatGetsNoThreadsThrowsAndDoesNotEndTheProgram) {
  const auto try_it = [] {
    test::run_out_of_threads();
    const auto outcome = within_memory("count", []() -> Result<void> {
      in_parallel(4, [](int) {});
      return {};
    });
    std::_Exit(outcome ? 1 : 0);
  };
  EXPECT_EXIT(try_it(), testing::ExitedWithCode(0), "");
}

TEST(WithinMemory, OtherErrorsOfTheSystemPass) {
  EXPECT_THROW(
      static_cast<void>(within_memory(
          "go on", []() -> Result<void> { throw std::system_error(std::make_error_code(std::errc::io_error)); })),
      std::system_error);
}

}  // namespace
}  // namespace ringdown
