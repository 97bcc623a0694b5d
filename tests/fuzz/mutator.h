// Makes hostile inputs of good ones: each is a file of a corpus after one to eight changes. A byte or a digit is set
// anew, a number becomes an extreme one, a piece is removed, doubled or taken from another file. [any thread]
#pragma once

#include <cstddef>
#include <filesystem>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::fuzz {

// The files of these folders, in the order of their paths.
std::vector<std::string> inputs_of(const std::vector<std::filesystem::path>& corpora);

class Mutator {
 public:
  // At least one input.
  explicit Mutator(std::vector<std::string> inputs) : inputs_(std::move(inputs)) {}

  // Returns the next input, of at most `max_bytes`. Equal numbers from `random` make equal inputs.
  [[nodiscard]] std::string next(std::mt19937_64& random, std::size_t max_bytes) const;

 private:
  void change(std::string& text, std::mt19937_64& random) const;

  std::vector<std::string> inputs_;
};

}  // namespace ringdown::fuzz
