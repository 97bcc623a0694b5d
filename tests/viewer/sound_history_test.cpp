// The sound as it comes in pieces: every sample in its place, and every gap counted.
#include "clients/viewer/link/sound_history.h"

#include "protocol/wire/message.h"

#include <gtest/gtest.h>

namespace ringdown::viewer {
namespace {

constexpr double kRate_hz = 8000;
constexpr std::size_t kPiece = 100;

// Frame n is n on the left and -n on the right.
protocol::NotifySound piece(std::int32_t first, std::size_t frames = kPiece, double rate_hz = kRate_hz) {
  std::vector<float> samples;
  for (std::size_t i = 0; i < frames; ++i) {
    const float n = static_cast<float>((first + i) % protocol::kFrameModulus);
    samples.insert(samples.end(), {n, -n});
  }
  return {first, rate_hz, wire::encode_floats(samples)};
}

struct Heard {
  std::vector<float> left, right;
};
Heard last(const SoundHistory& sound, std::size_t frames) {
  Heard heard;
  sound.last(frames, heard.left, heard.right);
  return heard;
}

TEST(SoundHistory, LastFramesComeInOrder) {
  SoundHistory sound;
  for (int i = 0; i < 500; ++i) sound.take(piece(1000 + 100 * i));
  const auto [left, right] = last(sound, sound.capacity());
  ASSERT_EQ(left.size(), 16000u);
  for (std::size_t i = 0; i < left.size(); ++i) {
    ASSERT_EQ(left[i], static_cast<float>(51000 - 16000 + i));
    ASSERT_EQ(right[i], -left[i]);
  }
  EXPECT_EQ(sound.gaps(), 0u);
  EXPECT_EQ(sound.end(), 50000u);
}

TEST(SoundHistory, BeforeTheFirstPieceIsSilence) {
  SoundHistory sound;
  sound.take(piece(5, 3));
  EXPECT_EQ(last(sound, 5).left, (std::vector<float>{0, 0, 5, 6, 7}));
  EXPECT_EQ(last(SoundHistory(), 2).left, (std::vector<float>{0, 0}));
}

TEST(SoundHistory, AGapBetweenPiecesIsFilledWithSilenceAndCounted) {
  SoundHistory sound;
  sound.take(piece(10, 2));
  sound.take(piece(15, 2));
  EXPECT_EQ(last(sound, 7).left, (std::vector<float>{10, 11, 0, 0, 0, 15, 16}));
  EXPECT_EQ(sound.gaps(), 1u);
  EXPECT_EQ(sound.missing_frames(), 3u);
}

TEST(SoundHistory, AGapLongerThanTheHistoryLeavesSilenceOnly) {
  SoundHistory sound;
  sound.take(piece(10));
  sound.take(piece(500'000'000, 1));
  const auto heard = last(sound, sound.capacity());
  EXPECT_EQ(heard.left.back(), 5e8f);
  for (std::size_t i = 0; i + 1 < heard.left.size(); ++i) ASSERT_EQ(heard.left[i], 0);
  EXPECT_EQ(sound.end(), 500'000'001u - 10);
  EXPECT_EQ(sound.missing_frames(), 500'000'000u - 110);
}

TEST(SoundHistory, TheHistoryContinuesWhereFrameNumbersWrapAround) {
  SoundHistory sound;
  sound.take(piece(protocol::kFrameModulus - 2, 4));
  sound.take(piece(2, 2));
  EXPECT_EQ(sound.gaps(), 0u);
  EXPECT_EQ(sound.end(), 6u);
  EXPECT_EQ(last(sound, 4).left, (std::vector<float>{0, 1, 2, 3}));
}

TEST(SoundHistory, OvertakenAndRepeatedPiecesAreIgnored) {
  SoundHistory sound;
  sound.take(piece(100));
  sound.take(piece(300));
  sound.take(piece(200));
  sound.take(piece(300));
  EXPECT_EQ(sound.end(), 300u);
  EXPECT_EQ(last(sound, 101).left[0], 0);
}

TEST(SoundHistory, TheHistoryRestartsWhenFramesOrRateDo) {
  SoundHistory sound;
  sound.take(piece(100000));
  sound.take(piece(0));
  EXPECT_EQ(sound.end(), 100u);
  sound.take(piece(100, 50, 16000));
  EXPECT_EQ(sound.sample_rate_hz(), 16000);
  EXPECT_EQ(sound.end(), 50u);
  EXPECT_EQ(sound.capacity(), 32000u);
}

TEST(SoundHistory, PiecesWithAnImpossibleRateAreIgnored) {
  SoundHistory sound;
  for (const double rate_hz : {0.0, 999.0, SoundHistory::kMaxRate_hz + 1, 1e7}) sound.take(piece(0, 2, rate_hz));
  EXPECT_EQ(sound.sample_rate_hz(), 0);
  sound.take(piece(0, 2, SoundHistory::kMaxRate_hz));
  EXPECT_EQ(sound.sample_rate_hz(), SoundHistory::kMaxRate_hz);
}

}  // namespace
}  // namespace ringdown::viewer
