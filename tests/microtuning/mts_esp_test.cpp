// A client of MTS-ESP, with a stand-in for the library of its master.
#include "engine/microtuning/mts_esp.h"
#include "tests/microtuning/mts_esp_master.h"

#include <gtest/gtest.h>

#include <optional>

namespace ringdown::microtuning {
namespace {

TEST(MtsEsp, WithoutTheLibraryThereIsNoTuning) {
  EXPECT_FALSE(MtsEsp("/nowhere/libMTS.so").tuning());
  EXPECT_FALSE(MtsEsp(RINGDOWN_BIN_DIR "/ringdown").tuning()) << "a program is no library";
}

TEST(MtsEsp, AClientHasItsMastersTuningWhileThereIsAMaster) {
  test::MtsEspMaster master;
  const MtsEsp client;
  EXPECT_FALSE(client.tuning());
  master.set_present(true);
  master.tune(69, 442);
  master.tune(70, 440, true);
  const auto tuning = client.tuning();
  ASSERT_TRUE(tuning);
  EXPECT_NEAR(tuning->semitones[69], 12 * std::log(442.0 / 440) / std::log(2.0), 1e-12);
  EXPECT_NEAR(tuning->semitones[70], -1, 1e-12);
  EXPECT_NEAR(tuning->semitones[71], 0, 1e-12);
  EXPECT_EQ(tuning->unmapped, KeySet().set(70));
  master.tune(69, 0);
  EXPECT_EQ(client.tuning()->semitones[69], 0) << "a frequency of no pitch changes nothing";
  master.set_present(false);
  EXPECT_FALSE(client.tuning());
}

TEST(MtsEsp, ClientsComeAndGo) {
  test::MtsEspMaster master;
  ASSERT_EQ(master.clients(), 0);
  std::optional<MtsEsp> first(std::in_place), second(std::in_place);
  EXPECT_EQ(master.clients(), 2);
  first.reset();
  second.reset();
  EXPECT_EQ(master.clients(), 0);
}

}  // namespace
}  // namespace ringdown::microtuning
