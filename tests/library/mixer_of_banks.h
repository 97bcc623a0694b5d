// A mixer of the C library with objects of synthetic banks, for tests.
#pragma once

#include "clients/library/ringdown.h"
#include "engine/modal/bank_file.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace ringdown::test {

class MixerOfBanks {
 public:
  // Objects 0 ... count - 1, each of a bank of its own with 30 modes and at least 12 points.
  explicit MixerOfBanks(std::uint32_t count, const ringdown_settings* settings = nullptr) {
    ringdown_error error;
    EXPECT_EQ(ringdown_mixer_create(settings, &mixer_, &error), RINGDOWN_OK) << error.sentence;
    for (std::uint32_t n = 0; n < count; ++n) {
      const auto path = folder_ / (std::to_string(n) + ".glb");
      EXPECT_TRUE(modal::write_bank(random_bank(n + 1, 30, 12), path));
      ringdown_bank* bank = nullptr;
      std::uint32_t object = 0;
      EXPECT_EQ(ringdown_bank_open(path.c_str(), &bank, &error), RINGDOWN_OK) << error.sentence;
      EXPECT_EQ(ringdown_add(mixer_, nullptr, bank, &object, &error), RINGDOWN_OK) << error.sentence;
      EXPECT_EQ(object, n);
      ringdown_bank_release(bank);
    }
  }
  ~MixerOfBanks() { ringdown_mixer_destroy(mixer_); }
  MixerOfBanks(const MixerOfBanks&) = delete;
  MixerOfBanks& operator=(const MixerOfBanks&) = delete;

  [[nodiscard]] ringdown_mixer* get() const { return mixer_; }
  [[nodiscard]] std::filesystem::path bank(std::uint32_t n) const { return folder_ / (std::to_string(n) + ".glb"); }

 private:
  TemporaryFolder folder_;
  ringdown_mixer* mixer_ = nullptr;
};

}  // namespace ringdown::test
