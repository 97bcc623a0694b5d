// Which bus an object gets, and that nobody else's moves.
#include "server/session/buses.h"

#include <gtest/gtest.h>

namespace ringdown::session {
namespace {

TEST(Buses, NoBusMovesWhenAnotherComesOrGoes) {
  Buses buses;
  buses.set_mode(PortMode::objects);
  const auto a = buses.join(0, "a", ""), b = buses.join(1, "b", ""), c = buses.join(2, "c", "");
  ASSERT_TRUE(a && b && c);
  buses.leave(1);
  EXPECT_EQ(buses.names(), (std::map<std::size_t, std::string>{{*a, "a"}, {*c, "c"}}));
  EXPECT_EQ(buses.join(2, "c", ""), c) << "a new bank of the same object";
  EXPECT_EQ(buses.join(3, "d", ""), b) << "the place that is free";
  EXPECT_EQ(buses.names(), (std::map<std::size_t, std::string>{{*a, "a"}, {*b, "d"}, {*c, "c"}}));
}

TEST(Buses, AGroupHasABusAsLongAsItHasAnObject) {
  Buses buses;
  buses.set_mode(PortMode::groups);
  EXPECT_FALSE(buses.join(0, "a", ""));
  const auto metal = buses.join(0, "a", "metal");
  ASSERT_TRUE(metal);
  EXPECT_EQ(buses.join(1, "b", "metal"), metal);
  buses.leave(0);
  EXPECT_EQ(buses.names().size(), 1u);
  const auto wood = buses.join(1, "b", "wood");
  EXPECT_EQ(buses.names(), (std::map<std::size_t, std::string>{{*wood, "wood"}}));
  EXPECT_FALSE(buses.join(1, "b", ""));
  EXPECT_TRUE(buses.names().empty());
}

TEST(Buses, TheMixAloneNeedsNoBus) {
  Buses buses;
  EXPECT_FALSE(buses.join(0, "a", "metal"));
  EXPECT_TRUE(buses.names().empty());
  EXPECT_EQ(buses.overflow(), 0u);
}

TEST(Buses, AnObjectBeyondTheLastBusIsHeardInTheMixOnly) {
  Buses buses;
  buses.set_mode(PortMode::objects);
  for (std::size_t i = 0; i < synth::kMaxBuses; ++i) {
    EXPECT_TRUE(buses.join(static_cast<synth::ObjectNumber>(i), "o" + std::to_string(i), ""));
  }
  EXPECT_EQ(buses.overflow(), 0u);
  EXPECT_FALSE(buses.join(1000, "one more", ""));
  EXPECT_EQ(buses.overflow(), 1u);
  buses.leave(5);
  EXPECT_EQ(buses.join(1000, "one more", ""), 5u);
}

}  // namespace
}  // namespace ringdown::session
