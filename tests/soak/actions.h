// What a crowd of clients might do to a daemon, at random: the same seed does the same.
#pragma once

#include "tests/integration/daemon_fixture.h"

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace ringdown::test {

class Actions {
 public:
  // Writes banks and a scene into `folder` for the daemon to load.
  Actions(const std::filesystem::path& folder, std::uint32_t seed);

  // Sends one action: mostly strikes, some gains, pans, materials, loads, frees, scene changes, and nonsense.
  void act(Daemon& daemon);

  // Ends all that act() began.
  static void free_everything(Daemon& daemon);

  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  std::size_t below(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_); }
  std::string object() { return "o" + std::to_string(below(kObjects)); }
  void strike(Daemon& daemon);
  void bundle(Daemon& daemon);
  void touch(Daemon& daemon);
  wire::Message hold();
  void change(Daemon& daemon);
  void scene(Daemon& daemon);
  void nonsense(Daemon& daemon);

  static constexpr std::size_t kObjects = 24, kBanks = 6;
  std::filesystem::path folder_;
  std::mt19937 random_;
  std::uint64_t count_ = 0;
};

}  // namespace ringdown::test
