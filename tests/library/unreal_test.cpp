// The component of clients/unreal sounds as the library does. Unreal is not here: tests/library/unreal stands for the
// few parts of it that the component uses.
#include "clients/library/ringdown.h"
#include "clients/unreal/Source/RingdownSynth/Private/RingdownComponent.cpp"
#include "clients/unreal/Source/RingdownSynth/Private/RingdownSynth.cpp"
#include "engine/modal/bank_file.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace ringdown::test::unreal_test {
namespace {

constexpr std::size_t kFrames = 480;

// This opens the functions that the engine calls.
struct Component : URingdownComponent {
  using URingdownComponent::BeginDestroy;
  using URingdownComponent::Init;
  using URingdownComponent::OnGenerateAudio;
};

TEST(Unreal, TheComponentSoundsAsTheLibraryInMetresAndRightHanded) {
  const TemporaryFolder folder;
  const std::string file = folder / "bell.glb";
  ASSERT_TRUE(modal::write_bank(random_bank(1, 30, 12), file));
  Component component;
  int32 rate_hz = 48000;
  ASSERT_TRUE(component.Init(rate_hz));
  ASSERT_EQ(component.NumChannels, 2);
  const int32 body = component.AddBody({"bell"}, {file});
  ASSERT_GE(body, 0) << unreal_log();
  component.Strike(body, {6.25, 3.125, -12.5}, {1, 2, -4}, 0.001F);
  std::vector<float> heard(2 * kFrames);
  EXPECT_EQ(component.OnGenerateAudio(heard.data(), static_cast<int32>(heard.size())), 960);

  ringdown_bank* bank = nullptr;
  ringdown_mixer* mixer = nullptr;
  std::uint32_t bell = 0;
  ASSERT_EQ(ringdown_bank_open(file.c_str(), &bank, nullptr), RINGDOWN_OK);
  ASSERT_EQ(ringdown_mixer_create(nullptr, &mixer, nullptr), RINGDOWN_OK);
  ASSERT_EQ(ringdown_add(mixer, "bell", bank, &bell, nullptr), RINGDOWN_OK);
  ringdown_bank_release(bank);
  const double point_m[3] = {0.0625, -0.03125, -0.125}, impulse_ns[3] = {0.01, -0.02, -0.04};
  ASSERT_EQ(ringdown_strike(mixer, 0, bell, point_m, impulse_ns, 0.001F, nullptr), RINGDOWN_OK);
  std::vector<float> left(kFrames), right(kFrames);
  ringdown_render(mixer, left.data(), right.data(), kFrames);
  ringdown_mixer_destroy(mixer);
  for (std::size_t i = 0; i < kFrames; ++i) {
    ASSERT_EQ(heard[2 * i], left[i]) << i;
    ASSERT_EQ(heard[2 * i + 1], right[i]) << i;
  }
  EXPECT_GT(*std::max_element(left.begin(), left.end()), 0);

  EXPECT_EQ(component.AddBody({"none"}, {"/nonexistent.glb"}), -1);
  EXPECT_NE(unreal_log().find("/nonexistent.glb"), std::string::npos) << unreal_log();
  component.BeginDestroy();
  EXPECT_EQ(component.OnGenerateAudio(heard.data(), static_cast<int32>(heard.size())), 960);
  EXPECT_EQ(*std::max_element(heard.begin(), heard.end()), 0) << "a destroyed component is silent";
}

}  // namespace
}  // namespace ringdown::test::unreal_test
