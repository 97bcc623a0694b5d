// What `ringdown info` says of a bank.
#include "engine/modal/bank_file.h"
#include "tests/integration/process.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace ringdown::test {
namespace {

TEST(InfoVerb, ABankOfWallsThatAreMeshedTooCoarselySaysSoFirst) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "cup.glb";
  modal::Bank bank = single_mode_bank(440, 2);
  const auto said = [&] {
    EXPECT_TRUE(modal::write_bank(bank, path));
    return run({RINGDOWN_BIN_DIR "/ringdown", "info", path.string()}).output;
  };
  EXPECT_EQ(said().find("WRONG"), std::string::npos);
  bank.provenance.wall_elements = 0.4;
  const std::string output = said();
  EXPECT_TRUE(output.starts_with("WRONG")) << output;
  EXPECT_NE(output.find("0.4 elements"), std::string::npos) << output;
}

TEST(InfoVerb, APitchIsPrintedWithWhereItIsFrom) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "tone.glb";
  modal::Bank bank = single_mode_bank(440, 2);
  const auto said = [&] {
    EXPECT_TRUE(modal::write_bank(bank, path));
    const std::string output = run({RINGDOWN_BIN_DIR "/ringdown", "info", path.string()}).output;
    const std::size_t at = output.find("\npitch ");
    return at == output.npos ? output : output.substr(at + 1, output.find('\n', at + 1) - at - 1);
  };
  EXPECT_EQ(said(), "pitch      440.00 Hz (A4 +0 ct), as estimated from its modes");
  bank.pitch_hz = 220;
  EXPECT_EQ(said(), "pitch      220.00 Hz (A3 +0 ct), as its maker states");
  bank.pitch_hz.reset();
  bank.decay_per_s = {1000};
  EXPECT_TRUE(said().starts_with("pitch      none: ")) << said();
}

// The walls do not feel the air, so that no blow has a level for it.
TEST(InfoVerb, AirOfAVesselHasANoteAndNoLevelOfABlow) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "bottle.glb";
  ASSERT_TRUE(modal::write_bank(vessel_bank(), path));
  const std::string output = run({RINGDOWN_BIN_DIR "/ringdown", "info", path.string()}).output;
  EXPECT_NE(output.find("\ncavity     its air rings at 102.50 Hz, Q 37; mouth 20 mm across\n"), std::string::npos)
      << output;
  EXPECT_EQ(output.find("inf "), std::string::npos) << output;
  const std::size_t row = output.find("\n    1 ");
  ASSERT_NE(row, std::string::npos) << output;
  EXPECT_NE(output.find("        - ", row), std::string::npos) << output;
}

}  // namespace
}  // namespace ringdown::test
