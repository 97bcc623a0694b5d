// The fuzzer of what libFuzzer cannot watch, because another process does the work: changes inputs of its corpora at
// random, and takes libFuzzer's options that ./run fuzz gives. RINGDOWN_FUZZ_TARGET names the function that it feeds.
//
//   fuzz_reader -max_total_time=60 -max_len=16384 CORPUS...
//
// Each input is a file of a corpus after one to eight changes: a byte or a digit set anew, a piece removed, doubled or
// moved over from another file. The same inputs come in the same order each time; only their number depends on time.
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

std::vector<std::string> inputs_of(const std::vector<fs::path>& corpora) {
  std::vector<fs::path> files;
  for (const fs::path& corpus : corpora) {
    std::copy(fs::directory_iterator(corpus), {}, std::back_inserter(files));
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> inputs;
  for (const fs::path& path : files) {
    std::ifstream file(path, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return inputs;
}

class Mutator {
 public:
  explicit Mutator(std::vector<std::string> inputs) : inputs_(std::move(inputs)) {}

  std::string next(std::size_t most_bytes) {
    std::string text = inputs_[below(inputs_.size())];
    for (std::size_t changes = 1 + below(8); changes > 0; --changes) change(text);
    return text.substr(0, most_bytes);
  }

 private:
  std::size_t below(std::size_t count) { return random_() % count; }

  // The first byte, which says what kind of file it is, mostly stays.
  void change(std::string& text) {
    if (text.size() < 2) return text.push_back(static_cast<char>(below(256)));
    const std::size_t at = below(50) == 0 ? 0 : 1 + below(text.size() - 1);
    const std::size_t length = 1 + below(std::min<std::size_t>(text.size() - at, 64));
    const std::string& other = inputs_[below(inputs_.size())];
    switch (below(5)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        break;
      case 1:
        for (char& c : text) c = c >= '0' && c <= '9' && below(30) == 0 ? static_cast<char>('0' + below(10)) : c;
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(at, text.substr(at, length));
        break;
      default:
        text.insert(at, other.substr(below(other.size() + 1), length));
    }
  }

  std::vector<std::string> inputs_;
  std::mt19937_64 random_{1};
};

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
  Mutator mutator(inputs_of(corpora));
  const auto end = Clock::now() + std::chrono::duration<double>(std::stod(option(words, "max_total_time", "60")));
  const auto most_bytes = std::stoul(option(words, "max_len", "16384"));
  const fs::path kept = option(words, "artifact_prefix", "") + "crash";  // the last input, while it is tried
  std::size_t count = 0;
  for (; Clock::now() < end; ++count) {
    const std::string input = mutator.next(most_bytes);
    std::ofstream(kept, std::ios::binary) << input;
    ringdown::fuzz::RINGDOWN_FUZZ_TARGET(std::as_bytes(std::span(input)));
  }
  fs::remove(kept);
  std::fprintf(stderr, "stat::number_of_executed_units: %zu\n", count);
  return 0;
}
