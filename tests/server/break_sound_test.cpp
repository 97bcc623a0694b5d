// How the break of the preset pane sounds: when the pane ends, when its pieces begin, and which lines are left.
#include "engine/breaking/piece_set.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/fracture/fracture.h"
#include "server/session/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace ringdown::session::break_sound_test {
namespace {

constexpr double kRate_hz = 48000;
constexpr std::size_t kStruck = 100, kBreak = 4800, kFrames = 16000;
const std::filesystem::path kPane = std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets/banks/window-pane.glb";

const breaking::PieceSet& pieces_of_pane() {
  static const auto bank = std::make_shared<const modal::Bank>(modal::read_bank(kPane).value());
  static const breaking::PieceSet pieces(modal::StrikeMap(bank), {}, 0);
  return pieces;
}

// The pane rings from a blow, and breaks under another one at kBreak. The second blow may be none.
std::vector<double> broken_pane(std::size_t block, double impulse_ns, bool hears_pieces) {
  Session session(kRate_hz);
  EXPECT_TRUE(session.perform(protocol::LoadObject{"pane", kPane.string()}, 0));
  EXPECT_TRUE(session.perform(protocol::ArmObject{{.name = "pane"}}, 0));
  for (const ObjectSnapshot& object : session.rack().objects()) {
    if (hears_pieces || object->name == "pane") continue;
    EXPECT_TRUE(session.rack().push(synth::Producer::worker, {0, object->number, synth::verb::Gain{0}}));
  }
  const Vec3 at_m{0.03, 0.02, 0.0015};
  EXPECT_TRUE(session.play(protocol::Strike{{.name = "pane"}, {at_m, {0, 0, -0.02}, 1e-4}}, kStruck));
  EXPECT_TRUE(session.perform(protocol::BreakObject{{.name = "pane"}, at_m, {0, 0, -impulse_ns}, 1e-4}, kBreak));
  std::vector<float> left(kFrames), right(kFrames);
  for (std::size_t at = 0; at < kFrames; at += block) {
    const std::size_t now = std::min(block, kFrames - at);
    session.rack().mixer().render(std::span(left).subspan(at, now), std::span(right).subspan(at, now));
    session.rack().collect();
  }
  return {left.begin(), left.end()};
}

double rms(const std::vector<double>& samples, std::size_t from, std::size_t to) {
  double sum = 0;
  for (std::size_t n = from; n < to; ++n) sum += samples[n] * samples[n];
  return std::sqrt(sum / static_cast<double>(to - from));
}

TEST(BreakSound, APaneIsSilentAMillisecondAfterItsCrack) {
  const std::vector<double> heard = broken_pane(500, 0, false);
  const double silent_s = pieces_of_pane().breaking().crack_time_s() + 1e-3;
  const std::size_t from = kBreak + static_cast<std::size_t>(std::ceil(silent_s * kRate_hz));
  EXPECT_LT(rms(heard, from, from + 480), 1e-3 * rms(heard, kBreak - 480, kBreak));
}

TEST(BreakSound, PiecesBeginWhenTheCrackReachesThemWhateverTheBlocks) {
  double nearest_s = 1;
  for (const breaking::BodyPiece& piece : pieces_of_pane().pieces()) {
    if (piece.map) nearest_s = std::min(nearest_s, piece.delay_s);
  }
  const double half_crack_s = pieces_of_pane().breaking().crack_time_s() / 2;
  for (const std::size_t block : {std::size_t{1}, std::size_t{64}, std::size_t{255}, std::size_t{1024}, kFrames}) {
    const std::vector<double> with = broken_pane(block, 0.05, true), without = broken_pane(block, 0.05, false);
    std::size_t first = 0;
    while (first < kFrames && std::abs(with[first] - without[first]) < 1e-9) ++first;
    const double late_s = (static_cast<double>(first) - static_cast<double>(kBreak)) / kRate_hz;
    EXPECT_GE(late_s, nearest_s) << "blocks of " << block;
    EXPECT_LE(late_s, nearest_s + half_crack_s + 2 / kRate_hz) << "blocks of " << block;
  }
}

// From 5 ms after the break on, no line of the pane is left, and the lowest line is that of the lowest piece.
TEST(BreakSound, OnlyLinesOfPiecesAreLeft) {
  const std::vector<double> heard = broken_pane(500, 0.05, true);
  const auto level = [&](double hz) {  // of one line, in a Hann window
    double re = 0, im = 0;
    const std::size_t from = kBreak + 240, count = 9600;
    for (std::size_t n = 0; n < count; ++n) {
      const double window = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * static_cast<double>(n) / count);
      const double turn = 2 * std::numbers::pi * hz * static_cast<double>(n) / kRate_hz;
      re += window * heard[from + n] * std::cos(turn);
      im += window * heard[from + n] * std::sin(turn);
    }
    return std::hypot(re, im);
  };
  double lowest_hz = 1e9, loudest = 0;
  for (const breaking::BodyPiece& piece : pieces_of_pane().pieces()) {
    for (const modal::DampedMode& mode : piece.modes) {
      lowest_hz = std::min(lowest_hz, mode.frequency_hz);
      loudest = std::max(loudest, level(mode.frequency_hz));
    }
  }
  const modal::Bank pane = modal::read_bank(kPane).value();
  std::size_t gone = 0;
  for (const double hz : pane.frequency_hz) {
    if (hz > 0.9 * lowest_hz) continue;
    EXPECT_LT(level(hz), 1e-4 * loudest) << hz;
    ++gone;
  }
  EXPECT_GE(gone, 5u);
  EXPECT_GT(level(lowest_hz), 10 * level(0.95 * lowest_hz)) << lowest_hz;
}

}  // namespace
}  // namespace ringdown::session::break_sound_test
