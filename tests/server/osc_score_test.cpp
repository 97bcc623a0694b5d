#include "protocol/wire/score.h"

#include "tests/server/osc_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <unistd.h>

namespace ringdown::wire {
namespace {

constexpr std::uint64_t kSecond = std::uint64_t{1} << 32;

std::string message_to(const std::string& address) { return osc_string(address) + osc_string(","); }
std::string framed(const std::string& bundle) { return big_endian(bundle.size(), 4) + bundle; }

// The addresses of the messages in order, or the sentence that refuses the score.
std::string order(const std::string& score) {
  const auto events = parse_score(to_bytes(score), "a.osc");
  if (!events) return events.error().message;
  std::string text;
  for (const ScoreEvent& event : *events) text += event.message.address;
  return text;
}

TEST(OscScore, AScoreMadeByHandIsReadInTheOrderOfItsTimes) {
  const std::string score = framed(osc_bundle(kSecond * 2, {message_to("/c"), message_to("/d")})) +
                            framed(osc_bundle(0, {message_to("/a")})) +
                            framed(osc_bundle(kSecond / 2, {message_to("/b")})) +
                            framed(osc_bundle(kSecond * 2, {message_to("/e")}));
  const auto events = parse_score(to_bytes(score), "a.osc");
  ASSERT_TRUE(events) << events.error().message;
  EXPECT_EQ(order(score), "/a/b/c/d/e");
  const double times[] = {0, 0.5, 2, 2, 2};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(events->at(i).time_s, times[i]);
}

TEST(OscScore, ImmediatelyIsTheStartOfAScore) {
  const auto events = parse_score(to_bytes(framed(osc_bundle(1, {message_to("/a")}))), "a.osc");
  EXPECT_EQ(events->at(0).time_s, 0);
}

TEST(OscScore, AScoreThatWasWrittenIsReadBack) {
  const std::vector<ScoreEvent> events = {
      {0, {"/a", {1}}}, {0, {"/b", {0.5f, "x"}}}, {1.25, {"/c", {}}}, {86400, {"/d", {}}}};
  const test::TemporaryFolder folder;
  const auto path = folder / "a.osc";
  ASSERT_TRUE(write_score(events, path));
  const auto again = read_score(path);
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_EQ(again->size(), events.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(again->at(i).time_s, events[i].time_s);
    EXPECT_EQ(again->at(i).message, events[i].message);
  }
}

TEST(OscScore, AWrittenScoreHasTheBytesThatScsynthReads) {
  const std::vector<ScoreEvent> events = {{0.5, {"/a", {}}}, {0.5, {"/b", {}}}, {3, {"/c", {}}}};
  EXPECT_EQ(encode_score(events), to_bytes(framed(osc_bundle(kSecond / 2, {message_to("/a"), message_to("/b")})) +
                                           framed(osc_bundle(3 * kSecond, {message_to("/c")}))));
}

TEST(OscScore, AMomentOfMoreThanAPacketIsWrittenInSeveralBundles) {
  std::vector<ScoreEvent> events;
  for (int i = 0; i < 3000; ++i) events.push_back({0.25, {"/object/plate.12/impart", {i, 0.5f, -1.0f}}});
  const std::vector<std::byte> bytes = encode_score(events);
  ASSERT_GT(bytes.size(), 2 * kMaxPacketBytes);
  const auto again = parse_score(bytes, "a.osc");
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_EQ(again->size(), events.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(again->at(i).time_s, 0.25);
    EXPECT_EQ(again->at(i).message, events[i].message);
  }
}

TEST(OscScore, AnEmptyFileIsAnEmptyScore) { EXPECT_EQ(order(""), ""); }

TEST(OscScore, BrokenScoresAreRefusedWithFileAndBundle) {
  const std::string good = framed(osc_bundle(0, {message_to("/a")}));
  const std::pair<const char*, std::string> broken[] = {
      {"length cut", good + std::string(3, '\0')},
      {"bundle cut", good + good.substr(0, good.size() - 4)},
      {"length huge", good + big_endian(0xffffffff, 4) + osc_bundle(0, {})},
      {"length zero", good + big_endian(0, 4)},
      {"message without bundle", good + framed(message_to("/a"))},
      {"not OSC", good + framed("hello world!")},
      {"a date as time", good + framed(osc_bundle(std::uint64_t{4000000000} << 32, {message_to("/a")}))},
      {"a day and a second", good + framed(osc_bundle(86401 * kSecond, {message_to("/a")}))},
      {"unknown type inside", good + framed(osc_bundle(0, {osc_string("/a") + osc_string(",Q") + osc_string("a")}))},
  };
  for (const auto& [what, score] : broken) {
    const std::string sentence = order(score);
    EXPECT_TRUE(sentence.starts_with("a.osc: bundle 2 at byte " + std::to_string(good.size())))
        << what << ": " << sentence;
  }
}

TEST(OscScore, EveryCutOfAScoreIsRefusedExceptBetweenBundles) {
  const std::string good = framed(osc_bundle(0, {message_to("/a")}));
  const std::string score = good + good;
  for (std::size_t length = 0; length < score.size(); ++length) {
    const bool whole = length % good.size() == 0;
    EXPECT_EQ(parse_score(to_bytes(score.substr(0, length)), "a").has_value(), whole) << length;
  }
}

TEST(OscScore, AMissingScoreIsOneSentence) {
  const auto events = read_score("/nonexistent/a.osc");
  ASSERT_FALSE(events);
  EXPECT_NE(events.error().message.find("/nonexistent/a.osc"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::wire
