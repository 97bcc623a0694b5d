// The peer Faust: its compiler's best code for a bank of pm.modeFilter, run in this process.
//
// White noise far below full scale drives the bank all the time, so that no mode dies away or comes near denormal
// numbers.
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::bench {

bool faust_installed();

// Faust's -vec code with one -vs, compiled by g++ -O3 -march=native -ffast-math and loaded.
class FaustCode {
 public:
  static constexpr std::size_t kModes =
      100;  // of a bank; larger counts are several banks, as g++ takes minutes for more
  // Writes into `folder`, which exists.
  static Result<FaustCode> compile(int vector_size, const std::filesystem::path& folder);

  [[nodiscard]] const std::string& name() const { return name_; }  // "faust -vec -vs 16"

 private:
  friend class FaustBanks;
  std::string name_;
  std::shared_ptr<void> library_;
  void* (*make_)(int rate) = nullptr;
  void (*remove_)(void*) = nullptr;
  void (*compute_)(void*, int frames, float* in, float* out) = nullptr;
  std::size_t (*bytes_)() = nullptr;
};

class FaustBanks {
 public:
  // `modes` is a multiple of FaustCode::kModes.
  FaustBanks(const FaustCode& code, std::size_t modes, std::size_t block);
  ~FaustBanks();
  FaustBanks(const FaustBanks&) = delete;
  FaustBanks& operator=(const FaustBanks&) = delete;

  void render();                     // one block
  [[nodiscard]] bool rings() const;  // its last block holds numbers that are neither zero nor infinite
  [[nodiscard]] double bytes_per_mode() const;

 private:
  FaustCode code_;
  std::vector<void*> banks_;
  std::vector<float> noise_, out_, sum_;
  std::size_t at_ = 0;  // in noise_
};

}  // namespace ringdown::bench
