#include "protocol/names.h"

#include <gtest/gtest.h>

namespace ringdown::protocol {
namespace {

TEST(Names, LettersDigitsAndThreeSignsMakeAName) {
  for (const char* good : {"a", "Bell", "bell.2", "_", "..", "1a", "a-b", "-a"})
    EXPECT_TRUE(is_object_name(good)) << good;
  for (const char* bad : {"", "-", "1", "007", "a b", "a/b", "a*", "ä", "a\n", "{object}", "#a"}) {
    EXPECT_FALSE(is_object_name(bad)) << bad;
  }
}

TEST(Names, ANameIsAcceptedAtTheLimitOfLengthAndRefusedPastIt) {
  EXPECT_TRUE(is_object_name(std::string(64, 'a')));
  EXPECT_FALSE(is_object_name(std::string(65, 'a')));
}

TEST(Names, DigitsAreAnObjectNumberUpToTheLargest) {
  EXPECT_EQ(parse_object("0")->number, 0u);
  EXPECT_EQ(parse_object("16777215")->number, 16777215u);
  for (const char* bad : {"16777216", "4294967296", "99999999999999999999", "+1", "-1 "}) {
    EXPECT_FALSE(parse_object(bad)) << bad;
  }
}

TEST(Names, TextOfAReferenceReadsBack) {
  for (const char* text : {"bell", "12", "a.b"}) EXPECT_EQ(to_text(*parse_object(text)), text);
}

TEST(Names, ARefusalQuotesWithoutControlCharacters) {
  const std::string sentence = parse_object("a\x1b[2J\n").error().message;
  EXPECT_NE(sentence.find("'a?[2J?'"), std::string::npos) << sentence;
  EXPECT_LT(protocol::quote(std::string(1000, 'a')).size(), 60u);
}

}  // namespace
}  // namespace ringdown::protocol
