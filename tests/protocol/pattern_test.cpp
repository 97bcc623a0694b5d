// Address patterns against what the OSC 1.0 specification says of them.
#include "protocol/pattern.h"

#include <gtest/gtest.h>

namespace ringdown::protocol {
namespace {

using Names = std::vector<std::string>;

TEST(Pattern, EachSignOfAPatternMeansWhatOsc10Says) {
  EXPECT_TRUE(matches("bell", "bell"));
  EXPECT_FALSE(matches("bell", "bells"));
  EXPECT_TRUE(matches("b?ll", "ball"));
  EXPECT_FALSE(matches("b?ll", "bll"));
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("glass*", "glass"));
  EXPECT_TRUE(matches("*ass*9", "glass-19"));
  EXPECT_FALSE(matches("*ass", "glass-19"));
  EXPECT_TRUE(matches("glass[0-3]", "glass2"));
  EXPECT_FALSE(matches("glass[0-3]", "glass4"));
  EXPECT_TRUE(matches("glass[!0-3]", "glass4"));
  EXPECT_FALSE(matches("glass[!0-3]", "glass"));
  EXPECT_TRUE(matches("[abc-]x", "-x"));
  EXPECT_TRUE(matches("[a!]", "!"));
  EXPECT_TRUE(matches("{bell,bowl}", "bowl"));
  EXPECT_FALSE(matches("{bell,bowl}", "bellbowl"));
  EXPECT_TRUE(matches("{b,be}{ll,l}", "bell"));
  EXPECT_TRUE(matches("x{,y}", "x"));
}

TEST(Pattern, BeginningsAndEndsMayOverlapInTheTextOnlyOnce) {
  EXPECT_TRUE(matches("ab*ab", "abab"));
  EXPECT_FALSE(matches("ab*ab", "ab"));
  EXPECT_FALSE(matches("ab*ba", "aba"));
  EXPECT_TRUE(matches("[a-z]bc", "abc"));
  EXPECT_FALSE(matches("[a-z]bc", "bc"));
  EXPECT_FALSE(matches("{a,b}c", "c"));
  EXPECT_FALSE(matches("bell", "ll"));
}

TEST(Pattern, APatternThatIsNotClosedMatchesNothing) {
  for (const char* pattern : {"[a", "{a", "[", "{", "[]", "{}", "a]["}) {
    EXPECT_FALSE(matches(pattern, "a")) << pattern;
  }
}

// Backtracking would take some 10^30 steps.
TEST(Pattern, ManyStarsTakeNoTime) {
  std::string pattern;
  for (int i = 0; i < 100; ++i) pattern += "*a";
  EXPECT_FALSE(matches(pattern + "b", std::string(127, 'a')));
  EXPECT_TRUE(matches(pattern, std::string(127, 'a')));
}

TEST(Pattern, APatternExpandsOverObjectsAndWhatTheyCanDo) {
  const Names names = {"bell", "glass1", "glass2"};
  EXPECT_EQ(*expand("/object/glass*/gain", names), (Names{"/object/glass1/gain", "/object/glass2/gain"}));
  EXPECT_EQ(*expand("/object/bell/{gain,pan}", names), (Names{"/object/bell/gain", "/object/bell/pan"}));
  EXPECT_EQ(expand("/object/*/{gain,pan}", names)->size(), 6u);
}

TEST(Pattern, APatternThatMatchesNothingIsRefusedByName) {
  const Names names = {"bell"};
  const std::pair<const char*, const char*> refused[] = {{"/object/x*/gain", "none of the 1 objects"},
                                                         {"/object/*/gian", "gian"},
                                                         {"/object/*", "matches no address"},
                                                         {"/obj*/bell/gain", "stand for objects"},
                                                         {"/*", "stand for objects"},
                                                         {"/object/[/gain", "none of the 1 objects"}};
  for (const auto& [pattern, sentence] : refused) {
    const auto expanded = expand(pattern, names);
    ASSERT_FALSE(expanded) << pattern;
    EXPECT_NE(expanded.error().message.find(sentence), std::string::npos) << expanded.error().message;
    EXPECT_NE(expanded.error().message.find(pattern), std::string::npos) << expanded.error().message;
  }
}

}  // namespace
}  // namespace ringdown::protocol
