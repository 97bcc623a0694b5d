// A value of one type of a list: each value that is made is destroyed once, whatever is copied, moved and assigned.
#include "engine/base/one_of.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

namespace ringdown {
namespace {

struct Held {
  std::shared_ptr<int> count;
  std::string name;
};
struct Empty {};
using Some = Types<Empty, Held, std::string>;
using One = OneOf<Some>;

TEST(OneOf, KnowsWhichTypeItHolds) {
  const One empty = Empty{}, text = std::string("bell");
  EXPECT_EQ(empty.index(), 0u);
  EXPECT_EQ(text.index(), Some::index_of<std::string>());
  EXPECT_TRUE(text.holds<std::string>());
  EXPECT_EQ(text.get<std::string>(), "bell");
  EXPECT_EQ(text.get_if<Held>(), nullptr);
  EXPECT_EQ(One(std::in_place_type<std::string>, 3, 'a').get<std::string>(), "aaa");
}

TEST(OneOf, CopiesMovesAndDestroysWhatItHolds) {
  const auto count = std::make_shared<int>();
  {
    One first = Held{count, "first"};
    One second = first;
    EXPECT_EQ(count.use_count(), 3);
    One third = std::move(second);
    EXPECT_EQ(count.use_count(), 3);
    EXPECT_EQ(third.get<Held>().name, "first");
    first = third;
    EXPECT_EQ(count.use_count(), 3);
    const One& same = third;
    third = same;
    EXPECT_EQ(third.get<Held>().name, "first");
    third = Empty{};
    EXPECT_EQ(count.use_count(), 2);
    third = std::string("text");
    third = std::move(first);
    EXPECT_EQ(third.get<Held>().name, "first");
  }
  EXPECT_EQ(count.use_count(), 1);
}

TEST(OneOf, OfTrivialTypesIsTrivialAndIsVisitedOnTheAudioThread) {
  using Small = OneOf<Types<int, double, Empty>>;
  static_assert(std::is_trivially_copyable_v<Small> && !std::is_trivially_copyable_v<One>);
  const Overloaded number{[](int one) { return one + 0.5; }, [](double one) { return one; },
                          [](const Empty&) { return -1.0; }};
  EXPECT_EQ(visit_now(number, Small(3)), 3.5);
  EXPECT_EQ(visit_now(number, Small(0.25)), 0.25);
  EXPECT_EQ(visit_now(number, Small(Empty{})), -1);
}

TEST(OneOf, IsVisitedByTheOverloadForItsType) {
  const Overloaded number{[](const Empty&) { return 0; }, [](const Held&) { return 1; },
                          [](const std::string& text) { return static_cast<int>(text.size()); }};
  EXPECT_EQ(visit(number, One(Empty{})), 0);
  EXPECT_EQ(visit(number, One(Held{})), 1);
  EXPECT_EQ(visit(number, One(std::string("bell"))), 4);
}

TEST(OneOf, IsMovedIntoTheVisitorWhenItIsGivenAway) {
  One one = std::string("a text that is too long to be copied without memory");
  std::string taken;
  visit(Overloaded{[](Empty&&) {}, [](Held&&) {}, [&](std::string&& text) { taken = std::move(text); }},
        std::move(one));
  EXPECT_EQ(taken.size(), 51u);
}

}  // namespace
}  // namespace ringdown
