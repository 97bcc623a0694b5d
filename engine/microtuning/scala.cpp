#include "engine/microtuning/scala.h"

#include "engine/base/note.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace ringdown::microtuning {
namespace {

constexpr int kMaxDegrees = 10000;  // of a scale or a pattern
constexpr double kMaxCents = 1e6;   // far above hearing
constexpr int kCentsOfOctave = 1200;

std::string_view without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// The lines of a file that are not comments, which begin with an exclamation mark.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary) {}

  [[nodiscard]] bool is_open() const { return file_.is_open(); }

  // Returns the next line without blanks at its ends, or nothing at the end of the file.
  std::optional<std::string_view> next() {
    while (std::getline(file_, line_)) {
      ++number_;
      if (!line_.starts_with('!')) return without_blanks(line_);
    }
    ++number_;
    return std::nullopt;
  }

  [[nodiscard]] int number() const { return number_; }

  // An error about the line that next() returned last.
  [[nodiscard]] tl::unexpected<Error> refuse(const std::string& why) const {
    return fail(ErrorKind::bad_input, path_.string() + formatted(":{}: ", number_) + why);
  }
  [[nodiscard]] tl::unexpected<Error> refuse_end(const std::string& missing) const {
    return refuse("the file ends here, before " + missing);
  }

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  std::string line_;
  int number_ = 0;
};

// Reads a number from the beginning of the text, whatever follows.
template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

// Returns cents for a text that begins with a pitch: cents if its number has a period, otherwise a ratio.
std::optional<double> cents_of(std::string_view text) {
  const std::string_view number = text.substr(0, text.find_first_not_of("0123456789.-"));
  if (number.find('.') != std::string_view::npos) {
    const auto cents = number_in<double>(number);
    return cents && std::abs(*cents) <= kMaxCents ? cents : std::nullopt;
  }
  const auto above = number_in<std::uint64_t>(number);
  const std::string_view rest = text.substr(number.size());
  const auto below = rest.starts_with('/') ? number_in<std::uint64_t>(rest.substr(1)) : std::uint64_t{1};
  if (!above || !below || *above == 0 || *below == 0) return std::nullopt;
  return kCentsOfOctave * std::log2(static_cast<double>(*above) / static_cast<double>(*below));
}

template <class Number>
Result<void> read_number(Lines& lines, const std::string& what, Number low, Number high, Number& target) {
  const auto line = lines.next();
  if (!line) return lines.refuse_end(what);
  const auto number = number_in<Number>(*line);
  if (number && *number >= low && *number <= high) {
    target = *number;
    return {};
  }
  return lines.refuse(formatted("{} should be a number from {} to {}, not \"{}\"", what, low, high, *line));
}

// Reads the entries of a pattern: degrees, and "x" for unmapped keys, which may be left out at the end.
Result<void> read_pattern(Lines& lines, std::size_t size, std::vector<std::optional<int>>& pattern) {
  pattern.resize(size);
  for (std::optional<int>& degree : pattern) {
    const auto line = lines.next();
    if (!line) return {};
    if (line->starts_with('x') || line->starts_with('X')) continue;
    degree = number_in<int>(*line);
    if (!degree || std::abs(*degree) > kMaxDegrees) {
      return lines.refuse(formatted("an entry should be a degree of the scale, or x, not \"{}\"", *line));
    }
  }
  return {};
}

int floor_divided(int number, int divisor) {
  const int quotient = number / divisor;
  return number % divisor < 0 ? quotient - 1 : quotient;
}

// Returns the cents of any degree above degree 0, in any period.
double cents_of_degree(const Scale& scale, int degree) {
  const int size = static_cast<int>(scale.cents.size());
  const int period = floor_divided(degree, size);
  const int within = degree - period * size;
  return period * scale.cents.back() + (within == 0 ? 0 : scale.cents[static_cast<std::size_t>(within) - 1]);
}

// Where the entry of a key stands in the pattern, and how many patterns lie below it.
struct Place {
  std::size_t entry;
  int repeats;
};
Place place_of(const KeyboardMapping& mapping, int key) {
  const int size = static_cast<int>(mapping.pattern.size()), distance = key - mapping.middle_key;
  const int repeats = floor_divided(distance, size);
  return {static_cast<std::size_t>(distance - repeats * size), repeats};
}

bool is_mapped(const KeyboardMapping& mapping, int key) {
  return mapping.pattern.empty() || mapping.pattern[place_of(mapping, key).entry].has_value();
}

// Returns the cents of a mapped key above degree 0 of the scale.
double cents_of_key(const Scale& scale, const KeyboardMapping& mapping, int key) {
  if (mapping.pattern.empty()) return cents_of_degree(scale, key - mapping.middle_key);
  const Place place = place_of(mapping, key);
  const int octave = mapping.octave_degree == 0 ? static_cast<int>(scale.cents.size()) : mapping.octave_degree;
  return place.repeats * cents_of_degree(scale, octave) + cents_of_degree(scale, *mapping.pattern[place.entry]);
}

Scale equal_temperament() {
  Scale scale;
  for (int degree = 1; degree <= 12; ++degree) scale.cents.push_back(100 * degree);
  return scale;
}

}  // namespace

Result<Scale> read_scale(const std::filesystem::path& path) {
  Lines lines(path);
  if (!lines.is_open())
    return fail(ErrorKind::bad_input, path.string() + " cannot be read; it should be a scale (.scl)");
  if (!lines.next()) return lines.refuse_end("the scale's description");
  int size = 0;
  if (const auto good = read_number(lines, "the number of notes", 1, kMaxDegrees, size); !good) return fail(good);
  Scale scale;
  for (int degree = 1; degree <= size; ++degree) {
    const auto line = lines.next();
    if (!line) return lines.refuse_end(formatted("note {} of {}", degree, size));
    const auto cents = cents_of(*line);
    if (!cents) {
      return lines.refuse(formatted(
          "a pitch should be a ratio above 0, such as 3/2, or cents with a period, such as 701.955, not \"{}\"",
          *line));
    }
    scale.cents.push_back(*cents);
  }
  return scale;
}

Result<KeyboardMapping> read_mapping(const std::filesystem::path& path) {
  constexpr int kLast = kKeys - 1;
  Lines lines(path);
  if (!lines.is_open()) {
    return fail(ErrorKind::bad_input, path.string() + " cannot be read; it should be a keyboard mapping (.kbm)");
  }
  KeyboardMapping mapping;
  int size = 0;
  double frequency_hz = 0;
  if (auto good = read_number(lines, "the size of the map", 0, kMaxDegrees, size); !good) return fail(good);
  if (auto good = read_number(lines, "the first key", 0, kLast, mapping.first_key); !good) return fail(good);
  if (auto good = read_number(lines, "the last key", 0, kLast, mapping.last_key); !good) return fail(good);
  if (auto good = read_number(lines, "the middle key", 0, kLast, mapping.middle_key); !good) return fail(good);
  if (auto good = read_number(lines, "the reference key", 0, kLast, mapping.reference_key); !good) return fail(good);
  const int line_of_reference = lines.number();
  if (auto good = read_number(lines, "the reference frequency", 0.001, 1e6, frequency_hz); !good) return fail(good);
  if (auto good = read_number(lines, "the formal octave", 0, kMaxDegrees, mapping.octave_degree); !good) {
    return fail(good);
  }
  mapping.reference_note = note_of(frequency_hz);
  if (auto good = read_pattern(lines, static_cast<std::size_t>(size), mapping.pattern); !good) return fail(good);
  if (is_mapped(mapping, mapping.reference_key)) return mapping;
  return fail(ErrorKind::bad_input,
              "{}:{}: the reference key {} is unmapped; give its entry a degree, or name another key", path.string(),
              line_of_reference, mapping.reference_key);
}

KeyTuning tuning_of(const Scale& scale, const KeyboardMapping& mapping) {
  const double reference_cents = cents_of_key(scale, mapping, mapping.reference_key);
  KeyTuning tuning;
  for (int key = mapping.first_key; key <= mapping.last_key; ++key) {
    const auto position = static_cast<std::size_t>(key);
    if (is_mapped(mapping, key)) {
      const double semitones = (cents_of_key(scale, mapping, key) - reference_cents) / 100;
      tuning.semitones[position] = semitones + mapping.reference_note - key;
    } else {
      tuning.unmapped.set(position);
    }
  }
  return tuning;
}

Result<KeyTuning> read_tuning(const std::filesystem::path& scale, const std::filesystem::path& mapping) {
  const auto read = scale.empty() ? Result<Scale>(equal_temperament()) : read_scale(scale);
  if (!read) return fail(read);
  const auto mapped = mapping.empty() ? Result<KeyboardMapping>(KeyboardMapping{}) : read_mapping(mapping);
  if (!mapped) return fail(mapped);
  return tuning_of(*read, *mapped);
}

}  // namespace ringdown::microtuning
