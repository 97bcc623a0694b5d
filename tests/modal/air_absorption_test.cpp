// Against the table of ISO 9613-2 (1996), table 2, which was computed by ISO 9613-1.
#include "engine/modal/air_absorption.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace ringdown::modal {
namespace {

TEST(AirAbsorption, AgreesWithTheTableOfTheStandard) {
  struct Row {
    AirConditions air;
    std::array<double, 6> db_per_km;  // from 250 Hz in octaves
  };
  for (const Row& row :
       {Row{{10, 70}, {1.0, 1.9, 3.7, 9.7, 32.8, 117}}, Row{{20, 70}, {1.1, 2.8, 5.0, 9.0, 22.9, 76.6}},
        Row{{30, 70}, {1.0, 3.1, 7.4, 12.7, 23.1, 59.3}}, Row{{15, 20}, {1.2, 2.7, 8.2, 28.2, 88.8, 202}},
        Row{{15, 50}, {1.2, 2.2, 4.2, 10.8, 36.2, 129}}, Row{{15, 80}, {1.1, 2.4, 4.1, 8.3, 23.7, 82.8}}}) {
    const AirAbsorption absorption(row.air);
    for (std::size_t i = 0; i < row.db_per_km.size(); ++i) {
      const double hz = 1000 * std::pow(2.0, static_cast<double>(i) - 2);
      const double db_per_km = 1000 * 20 / std::log(10.0) * absorption.nepers_per_m(hz);
      EXPECT_NEAR(db_per_km, row.db_per_km[i], 0.06 + 0.02 * row.db_per_km[i])
          << hz << " Hz, " << row.air.temperature_c << " degrees, " << row.air.humidity_percent << " %";
    }
  }
}

TEST(AirAbsorption, ConditionsOutOfRangeCountAsTheNearestWithin) {
  const AirAbsorption beyond(AirConditions{1e9, -5}), within(AirConditions{60, 0});
  EXPECT_EQ(beyond.nepers_per_m(4000), within.nepers_per_m(4000));
  EXPECT_NEAR(sound_speed_m_s({}), 343.2, 0.01);
}

}  // namespace
}  // namespace ringdown::modal
