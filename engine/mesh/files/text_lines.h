// The lines of a text file as words, and the sentence that names a line. For readers of meshes. [any thread]
//
//   TextLines lines(text, "cup.obj");
//   while (!lines.next().empty()) {
//     double x = 0;
//     if (lines.word() == "v" && !lines.read(1, x)) return lines.wrong("a point should have three finite coordinates");
//   }
//
// Lines end with \n, \r\n or \r. A byte order mark before the first is passed over.
#pragma once

#include "engine/base/result.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace ringdown::mesh {

class TextLines {
 public:
  static constexpr std::string_view kBlanks = " \t\f\v", kBlanksAndCommas = " \t,\f\v";

  // `text` must outlive the lines.
  TextLines(std::string_view text, std::string name, std::string_view between = kBlanksAndCommas)
      : text_(text), name_(std::move(name)), between_(between) {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
  }

  // The words of the next line that has any, without its comment (#); none at the end.
  const std::vector<std::string_view>& next() {
    words_.clear();
    while (words_.empty() && at_ < text_.size()) {
      const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
      ++number_;
      split(text_.substr(at_, end - at_));
      at_ = end + (text_.substr(end, 2) == "\r\n" ? 2 : 1);
    }
    return words_;
  }

  [[nodiscard]] const std::vector<std::string_view>& words() const { return words_; }
  [[nodiscard]] std::string_view word() const { return words_.front(); }

  [[nodiscard]] std::size_t characters_left() const { return at_ < text_.size() ? text_.size() - at_ : 0; }

  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& what) const {
    return fail(ErrorKind::bad_input, "{}, line {}: {}", name_, number_, what);
  }

  // Reads word `index` of the line as a whole number or a finite one.
  template <class Number>
  bool read(std::size_t index, Number& number) const {
    return index < words_.size() && read_word(words_[index], number);
  }

  template <class Number>
  static bool read_word(std::string_view word, Number& number) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (end != word.data() + word.size()) return false;
    if constexpr (std::is_floating_point_v<Number>) {
      // Out of range is what is smaller than any number, too.
      if (error == std::errc::result_out_of_range) number = std::strtod(std::string(word).c_str(), nullptr);
      return error != std::errc::invalid_argument && std::isfinite(number);
    } else {
      return error == std::errc();
    }
  }

 private:
  void split(std::string_view line) {
    line = line.substr(0, line.find('#'));
    for (std::size_t at = 0; (at = line.find_first_not_of(between_, at)) != line.npos;) {
      const std::size_t end = std::min(line.find_first_of(between_, at), line.size());
      words_.push_back(line.substr(at, end - at));
      at = end;
    }
  }

  std::string_view text_;
  std::string name_;
  std::string_view between_;
  std::size_t at_ = 0;
  int number_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace ringdown::mesh
