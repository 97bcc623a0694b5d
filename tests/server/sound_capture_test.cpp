// What is heard, in a file: every sample of it, and never half a file.
#include "server/session/sound_capture.h"

#include "server/session/session.h"
#include "engine/modal/bank_file.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sndfile.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace ringdown::session {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

struct Sound {
  int rate_hz = 0;
  std::vector<float> samples;  // left right left right ...
};

Sound read(const fs::path& path) {
  SF_INFO info{};
  SNDFILE* const file = sf_open(path.c_str(), SFM_READ, &info);
  if (!file) return {};
  EXPECT_EQ(info.format, SF_FORMAT_WAV | SF_FORMAT_FLOAT);
  EXPECT_EQ(info.channels, 2);
  Sound sound{info.samplerate, std::vector<float>(2 * static_cast<std::size_t>(info.frames))};
  sf_readf_float(file, sound.samples.data(), info.frames);
  sf_close(file);
  return sound;
}

class SoundCaptureTest : public testing::Test {
 protected:
  SoundCaptureTest() {
    EXPECT_TRUE(modal::write_bank(test::random_bank(1, 40, 4), folder_ / "a.glb"));
    EXPECT_TRUE(session_.perform(protocol::LoadObject{"a", (folder_ / "a.glb").string()}, 0));
    EXPECT_TRUE(session_.play(protocol::Strike{{.name = "a"}, {{0.1, 0, 0}, {0, 0, 100}, 0}}, 100));
  }

  // Renders, and lets the capture's thread keep up.
  void render(std::size_t blocks) {
    std::vector<float> left(256), right(256);
    for (std::size_t i = 0; i < blocks; ++i) {
      session_.rack().mixer().render(left, right);
      for (std::size_t n = 0; n < left.size(); ++n) heard_.insert(heard_.end(), {left[n], right[n]});
      if (i % 64 == 63) wait_until_written();
    }
    wait_until_written();
  }
  void wait_until_written() {
    while (session_.rack().mixer().capture_tap().watched() && session_.rack().mixer().capture_tap().front()) {
      std::this_thread::sleep_for(1ms);
    }
  }
  std::size_t parts() const {
    return static_cast<std::size_t>(std::count_if(fs::directory_iterator(folder_.path()), {}, [](const auto& entry) {
      return entry.path().extension() == ".part";
    }));
  }

  test::TemporaryFolder folder_;
  fs::path file_ = folder_ / "take.wav";
  Session session_{48000};
  std::vector<float> heard_;
};

TEST_F(SoundCaptureTest, TheFileIsWhatTheMixerPlayedBitForBit) {
  SoundCapture capture(session_.rack());
  render(10);
  const std::size_t before = heard_.size();
  EXPECT_FALSE(capture.progress());
  ASSERT_TRUE(capture.start({file_}));
  render(300);
  EXPECT_FALSE(fs::exists(file_)) << "it has its name when it is complete";
  EXPECT_EQ(parts(), 1u);
  const auto progress = capture.progress();
  ASSERT_TRUE(progress);
  EXPECT_EQ(progress->path, file_.string());
  const auto frames = capture.stop();
  ASSERT_TRUE(frames) << frames.error().message;
  EXPECT_EQ(*frames, 300u * 256);
  EXPECT_EQ(parts(), 0u);
  render(10);
  const Sound sound = read(file_);
  EXPECT_EQ(sound.rate_hz, 48000);
  ASSERT_EQ(sound.samples.size(), 2 * *frames);
  EXPECT_GT(*std::ranges::max_element(sound.samples), 1e-3F);
  EXPECT_TRUE(
      std::equal(sound.samples.begin(), sound.samples.end(), heard_.begin() + static_cast<std::ptrdiff_t>(before)));
}

TEST_F(SoundCaptureTest, OneFileAtATimeAndOneAfterAnother) {
  SoundCapture capture(session_.rack());
  EXPECT_FALSE(capture.stop()) << "nothing is being captured";
  ASSERT_TRUE(capture.start({file_}));
  const auto second = capture.start({folder_ / "other.wav"});
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("take.wav"), std::string::npos) << second.error().message;
  ASSERT_TRUE(capture.stop());
  ASSERT_TRUE(capture.start({folder_ / "other.wav"}));
  render(20);
  EXPECT_EQ(capture.stop().value_or(0), 20u * 256);
  EXPECT_EQ(read(file_).samples.size(), 0u);
}

TEST_F(SoundCaptureTest, AFullFileIsCompletedAndAnotherMayFollow) {
  SoundCapture capture(session_.rack(), 1000);
  ASSERT_TRUE(capture.start({file_}));
  render(8);
  while (capture.progress()) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(read(file_).samples.size(), 2000u);
  EXPECT_EQ(capture.stop().value_or(0), 1000u) << "it says how long the file became";
  ASSERT_TRUE(capture.start({folder_ / "other.wav"}));
}

TEST_F(SoundCaptureTest, AnotherSampleRateEndsTheFile) {
  SoundCapture capture(session_.rack());
  ASSERT_TRUE(capture.start({file_}));
  render(8);
  session_.change_sample_rate(44100);
  render(8);
  while (capture.progress()) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(read(file_).samples.size(), 2u * 8 * 256);
}

TEST_F(SoundCaptureTest, WhereNoFileCanBeWrittenItSaysSo) {
  SoundCapture capture(session_.rack());
  const auto started = capture.start({folder_ / "no such folder" / "take.wav"});
  ASSERT_FALSE(started);
  EXPECT_NE(started.error().message.find("take.wav"), std::string::npos) << started.error().message;
  EXPECT_FALSE(capture.progress());
}

TEST_F(SoundCaptureTest, ACaptureThatEndsWithTheDaemonCompletesItsFile) {
  {
    SoundCapture capture(session_.rack());
    ASSERT_TRUE(capture.start({file_}));
    render(8);
  }
  EXPECT_EQ(read(file_).samples.size(), 2u * 8 * 256);
}

}  // namespace
}  // namespace ringdown::session
