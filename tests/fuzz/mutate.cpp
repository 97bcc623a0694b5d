// The fuzzer of what libFuzzer cannot watch, because another process does the work: changes inputs of its corpora at
// random, and takes libFuzzer's options that ./run fuzz gives. RINGDOWN_FUZZ_TARGET names the function that it feeds.
//
//   fuzz_reader -max_total_time=60 -max_len=16384 CORPUS...
//
// Inputs and their order repeat in every run; only their number depends on time.
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/targets.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

// The value of an option "-NAME=VALUE".
std::string option(const std::vector<std::string>& words, const std::string& name, const std::string& usual) {
  for (const std::string& word : words) {
    if (word.starts_with("-" + name + "=")) return word.substr(name.size() + 2);
  }
  return usual;
}

}  // namespace

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  const std::vector<std::string> words(argv + 1, argv + argc);
  std::vector<fs::path> corpora;
  std::copy_if(words.begin(), words.end(), std::back_inserter(corpora),
               [](const std::string& word) { return !word.starts_with("-"); });
  const ringdown::fuzz::Mutator mutator(ringdown::fuzz::inputs_of(corpora));
  std::mt19937_64 random(1);
  const auto end = Clock::now() + std::chrono::duration<double>(std::stod(option(words, "max_total_time", "60")));
  const auto max_bytes = std::stoul(option(words, "max_len", "16384"));
  const fs::path kept = option(words, "artifact_prefix", "") + "crash";  // the last input, while it is tried
  std::size_t count = 0;
  for (; Clock::now() < end; ++count) {
    const std::string input = mutator.next(random, max_bytes);
    std::ofstream(kept, std::ios::binary) << input;
    ringdown::fuzz::RINGDOWN_FUZZ_TARGET(std::as_bytes(std::span(input)));
  }
  fs::remove(kept);
  std::fprintf(stderr, "stat::number_of_executed_units: %zu\n", count);
  return 0;
}
