#include "tests/fuzz/mutator.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>

namespace ringdown::fuzz {
namespace {

namespace fs = std::filesystem;

// Numbers that replace others: the ends of the types, and what is hard to divide by.
constexpr const char* kExtremes[] = {"0",      "-0",    "-1",         "1e-320",     "1e-300", "1e-39",
                                     "1e-9",   "1e9",   "1e12",       "3e38",       "4e38",   "1e300",
                                     "-1e308", "1e309", "nan",        "inf",        "-inf",   "65536",
                                     "999999", "1e-45", "2147483648", "4294967295", "1e18",   "-2147483649"};

std::size_t below(std::size_t count, std::mt19937_64& random) { return random() % count; }

// Replaces the number that stands at `at` or after it, if one does.
void make_extreme(std::string& text, std::size_t at, std::mt19937_64& random) {
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto begin = std::find_if(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), is_digit);
  const auto end = std::find_if_not(begin, text.end(), [&](char c) { return is_digit(c) || c == '.'; });
  if (begin != text.end()) text.replace(begin, end, kExtremes[below(std::size(kExtremes), random)]);
}

}  // namespace

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

std::string Mutator::next(std::mt19937_64& random, std::size_t max_bytes) const {
  std::string text = inputs_[below(inputs_.size(), random)];
  for (std::size_t changes = 1 + below(8, random); changes > 0; --changes) change(text, random);
  return text.substr(0, max_bytes);
}

// The first byte, which often says what kind of file it is, mostly stays.
void Mutator::change(std::string& text, std::mt19937_64& random) const {
  if (text.size() < 2) return text.push_back(static_cast<char>(below(256, random)));
  const std::size_t at = below(50, random) == 0 ? 0 : 1 + below(text.size() - 1, random);
  const std::size_t length = 1 + below(std::min<std::size_t>(text.size() - at, 64), random);
  const std::string& other = inputs_[below(inputs_.size(), random)];
  switch (below(6, random)) {
    case 0:
      text[at] = static_cast<char>(below(256, random));
      break;
    case 1:
      for (char& c : text)
        c = c >= '0' && c <= '9' && below(30, random) == 0 ? static_cast<char>('0' + below(10, random)) : c;
      break;
    case 2:
      text.erase(at, length);
      break;
    case 3:
      text.insert(at, text.substr(at, length));
      break;
    case 4:
      make_extreme(text, at, random);
      break;
    default:
      text.insert(at, other.substr(below(other.size() + 1, random), length));
  }
}

}  // namespace ringdown::fuzz
