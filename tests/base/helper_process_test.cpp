// Helpers that misbehave are shells: what they write is what a broken or hostile program could.
#include "engine/base/process/helper_process.h"

#include <gtest/gtest.h>

#include <csignal>

namespace ringdown {
namespace {

HelperAnswer ask(const std::string& script, const HelperLimits& limits = {}, const Progress& progress = {}) {
  HelperProcess helper;
  const auto started = helper.start({"/bin/sh", "-c", script}, {}, limits);
  EXPECT_TRUE(started);
  return helper.ask("question", progress);
}

// A head of two little-endian numbers, the kind and the length, in the octal of printf.
std::string head(int kind, int length) {
  char text[64];
  std::snprintf(text, sizeof text, "\\%03o\\0\\0\\0\\0\\0\\0\\0\\%03o\\0\\0\\0\\0\\0\\0\\0", kind, length);
  return text;
}

TEST(HelperProcess, AnAnswerComesBackWithTheReportsBeforeIt) {
  std::string seen;
  const auto answer =
      ask("printf '" + head(1, 12) + "\\0\\0\\0\\0\\0\\0\\340\\077m\\033sh'; printf '" + head(0, 3) + "abc'; sleep 5",
          {}, [&](std::string_view stage, double fraction) {
            seen = std::string(stage) + " " + std::to_string(fraction);
            return true;
          });
  EXPECT_EQ(answer.end, HelperEnd::answered);
  EXPECT_EQ(answer.bytes, "abc");
  EXPECT_EQ(seen, "m?sh 0.500000") << "no control characters";
}

TEST(HelperProcess, WhateverItDoesThereIsAnEnd) {
  EXPECT_EQ(ask("exit 0").end, HelperEnd::silent);
  EXPECT_EQ(ask("exit 71").end, HelperEnd::out_of_memory);
  EXPECT_EQ(ask("exec yes").end, HelperEnd::silent) << "what is no head";
  EXPECT_EQ(ask("printf '" + head(0, 3) + "ab'").end, HelperEnd::silent) << "cut off";
  EXPECT_EQ(ask("printf '" + head(0, 3) + "abcd'; sleep 5").end, HelperEnd::silent) << "more than it said";
  EXPECT_EQ(ask("printf '" + head(1, 255) + "'; sleep 5").end, HelperEnd::silent) << "a report that is too long";
  EXPECT_EQ(ask("printf '\\0\\0\\0\\0\\0\\0\\0\\0\\377\\377\\377\\377\\377\\377\\377\\377'; sleep 5").end,
            HelperEnd::too_long);
  const auto crashed = ask("kill -SEGV $$");
  EXPECT_EQ(crashed.end, HelperEnd::crashed);
  EXPECT_EQ(crashed.signal, SIGSEGV);
}

TEST(HelperProcess, AnEndlessHelperIsEndedByProcessorTimeByWallTimeAndByRequest) {
  EXPECT_EQ(ask("while :; do :; done", {.processor_s = 0.2}).end, HelperEnd::out_of_time);
  EXPECT_EQ(ask("sleep 100", {.processor_s = 0.1}).end, HelperEnd::out_of_time);
  EXPECT_EQ(ask("trap '' TERM; sleep 100", {}, [](std::string_view, double) { return false; }).end, HelperEnd::stopped);
}

TEST(HelperProcess, AHelperThatFailedCanBeStartedAgain) {
  HelperProcess helper;
  ASSERT_TRUE(helper.start({"/bin/sh", "-c", "exit 1"}, {}, {}));
  EXPECT_EQ(helper.ask("", {}).end, HelperEnd::silent);
  EXPECT_FALSE(helper.running());
  ASSERT_TRUE(helper.start({"/bin/sh", "-c", "printf '" + head(0, 2) + "'$A; sleep 5"}, {"A=ok"}, {}));
  EXPECT_EQ(helper.ask("", {}).bytes, "ok");
}

}  // namespace
}  // namespace ringdown
