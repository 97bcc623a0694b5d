#include "engine/mesh/files/geo_language.h"

#include "engine/base/atomic_file.h"
#include "engine/base/file_format.h"
#include "engine/base/quote.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace ringdown::mesh {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string_view text) {
  std::string small(text);
  std::transform(small.begin(), small.end(), small.begin(), [](unsigned char c) { return std::tolower(c); });
  return small;
}

template <class List>
bool is_one_of(std::string_view word, const List& list) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Statements that print, or write what they print to a file.
constexpr std::array kPrinting = {"Printf", "Error", "Warning"};

// Passes over the text once. gmsh ends a comment that begins with // at a carriage return, too.
class Scan {
 public:
  explicit Scan(std::string_view text) : text_(text) {}

  std::vector<GeoWord> run() {
    while (at_ < text_.size()) {
      if (const std::size_t after = after_comment(); after != at_) {
        at_ = after;
      } else if (text_[at_] == '"') {
        take_quoted();
      } else if (is_letter(text_[at_])) {
        take_word();
      } else {
        take_character(text_[at_++]);
      }
    }
    return std::move(words_);
  }

 private:
  [[nodiscard]] std::size_t after_comment() const {
    if (text_.substr(at_, 2) == "//") return std::min(text_.find_first_of("\r\n", at_), text_.size());
    if (text_.substr(at_, 2) != "/*") return at_;
    const std::size_t end = text_.find("*/", at_ + 2);
    return end == std::string_view::npos ? text_.size() : end + 2;
  }

  void take_quoted() {
    note_next('"');
    const std::size_t end = std::min(text_.find('"', at_ + 1), text_.size());
    if (joined_) words_.back().quoted = text_.substr(at_ + 1, end - at_ - 1);
    joined_ = after_call_ = false;
    at_ = std::min(end + 1, text_.size());
  }

  void take_word() {
    note_next(text_[at_]);
    const std::size_t start = at_;
    while (at_ < text_.size() && is_letter(text_[at_])) ++at_;
    line_ += static_cast<int>(
        std::count(text_.begin() + counted_, text_.begin() + static_cast<std::ptrdiff_t>(start), '\n'));
    counted_ = static_cast<std::ptrdiff_t>(start);
    words_.push_back({.word = std::string(text_.substr(start, at_ - start)), .line = line_});
    joined_ = awaits_next_ = true;
    after_call_ = false;
    if (!is_one_of(words_.back().word, kPrinting)) return;
    call_ = words_.size();
    depth_ = 0;
  }

  void take_character(char c) {
    if (is_blank(c)) return;
    note_next(c);
    joined_ = joined_ && c == '(';
    if (after_call_ && c == '>') words_[call_ - 1].to_file = true;
    after_call_ = false;
    if (call_ == 0) return;
    depth_ += c == '(' || c == '[' ? 1 : c == ')' || c == ']' ? -1 : 0;
    after_call_ = depth_ == 0 && (c == ')' || c == ']');
  }

  void note_next(char c) {
    if (awaits_next_) words_.back().next = c;
    awaits_next_ = false;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::ptrdiff_t counted_ = 0;  // up to where lines are counted
  int line_ = 1;
  std::vector<GeoWord> words_;
  bool joined_ = false;  // nothing but blanks and a bracket since the last word
  bool awaits_next_ = false;
  std::size_t call_ = 0;  // one past the number of the last printing word; 0: none so far
  int depth_ = 0;         // of brackets since then
  bool after_call_ = false;
};

constexpr std::array kReading = {"include", "merge", "mergewithboundingbox", "shapefromfile"};

// By which a result depends on more than files.
constexpr std::array kAsking = {"systemcall",
                                "nonblockingsystemcall",
                                "onelabrun",
                                "onelabaction",
                                "getenv",
                                "getstring",
                                "getnumber",
                                "getforced",
                                "getforcedstr",
                                "fileexists",
                                "exists",
                                "rand",
                                "cpu",
                                "memory",
                                "totalmemory",
                                "currentdir",
                                "currentdirectory",
                                "absolutepath"};

// A command that is refused by its name, and what it would do. As the name of a variable, or of a group of options
// before a point, the name is harmless.
struct Refusal {
  const char *word, *deed;
  bool command = true;
};
constexpr std::array kRefusals = {Refusal{"SystemCall", "runs a program"},
                                  Refusal{"NonBlockingSystemCall", "runs a program"},
                                  Refusal{"System", "runs a program"},
                                  Refusal{"OnelabRun", "runs a program"},
                                  Refusal{"OnelabAction", "runs a program"},
                                  Refusal{"ExternalProcess", "runs a program", false},
                                  Refusal{"CommandLine", "runs a program", false},
                                  Refusal{"Solver", "runs a program", false},
                                  Refusal{"Plugin", "runs a plugin"},
                                  Refusal{"Save", "writes a file"},
                                  Refusal{"Print", "writes a file"},
                                  Refusal{"CreateDir", "makes a folder"},
                                  Refusal{"SaveOptions", "writes a file", false},
                                  Refusal{"SaveSession", "writes a file", false},
                                  Refusal{"Exit", "ends the program that reads it"},
                                  Refusal{"Abort", "ends the program that reads it"},
                                  Refusal{"Sleep", "stops the program that reads it"}};

// The name of an option's group, as in Print.Text, or of a variable.
bool is_name(const GeoWord& word) { return word.next == '.' || word.next == '='; }

class Inspection {
 public:
  explicit Inspection(const fs::path& geometry) : files_({geometry}) {
    std::error_code error;
    folder_ = fs::weakly_canonical(fs::absolute(geometry).parent_path(), error);
  }

  Result<void> run() {
    for (std::size_t next = 0; next < files_.size(); ++next) {
      const fs::path file = files_[next];
      if (gmsh_knows_ending(file)) continue;
      std::error_code error;
      if (next > 0 && !fs::exists(file, error)) continue;  // gmsh says so, if it comes to that
      const Result<std::string> text = read_whole_file(file, kMaxGeoBytes);
      if (!text) return fail(text);
      if (is_of_kind(file, FileKind::gmsh_mesh) && text->starts_with("$")) continue;
      if (auto good = inspect(file, *text); !good) return good;
    }
    return {};
  }

 private:
  static tl::unexpected<Error> refused(const fs::path& file, const GeoWord& word, const std::string& why) {
    return fail(ErrorKind::bad_input, "{}, line {}: {} {}", file.string(), word.line, quote(word.word), why);
  }

  Result<void> inspect(const fs::path& file, const std::string& text) {
    // One of the two readings could hide a statement: gmsh may end a text there, or not.
    if (const std::size_t at = text.find("\\\""); at != std::string::npos) {
      const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
      return fail(ErrorKind::bad_input,
                  "{}, line {}: a backslash before a quotation mark is not understood; leave it out", file.string(),
                  line);
    }
    for (const GeoWord& word : words_of_geo(text)) {
      if (word.to_file) return refused(file, word, "writes a file; a geometry may only describe a body, so delete it");
      const auto known = std::find_if(kRefusals.begin(), kRefusals.end(),
                                      [&word](const Refusal& refusal) { return word.word == refusal.word; });
      if (known != kRefusals.end() && !(known->command && is_name(word))) {
        return refused(file, word, std::string(known->deed) + "; a geometry may only describe a body, so delete it");
      }
      if (!is_one_of(lower(word.word), kReading)) continue;
      if (auto good = follow(file, word); !good) return good;
    }
    return {};
  }

  Result<void> follow(const fs::path& file, const GeoWord& word) {
    if (is_name(word)) return {};
    if (word.quoted.empty()) return refused(file, word, "should be followed by the name of a file, in quotes");
    std::error_code error;
    const fs::path named = fs::weakly_canonical(fs::absolute(file).parent_path() / word.quoted, error);
    const auto [end, rest] = std::mismatch(folder_.begin(), folder_.end(), named.begin(), named.end());
    if (error || end != folder_.end()) {
      return refused(
          file, word,
          formatted("reads {}, which is outside of {}; a geometry may read only files in its folder and below",
                    quote(word.quoted), folder_.string()));
    }
    if (std::find(files_.begin(), files_.end(), named) == files_.end()) files_.push_back(named);
    if (files_.size() <= kMaxGeoFiles) return {};
    return refused(file, word, formatted("leads to more than {} files", kMaxGeoFiles));
  }

  std::vector<fs::path> files_;
  fs::path folder_;
};

}  // namespace

std::vector<GeoWord> words_of_geo(std::string_view text) { return Scan(text).run(); }

bool assigns(std::string_view text, std::string_view name) {
  const std::vector<GeoWord> words = words_of_geo(text);
  return std::any_of(words.begin(), words.end(),
                     [&](const GeoWord& word) { return word.next == '=' && word.word == name; });
}

std::optional<std::vector<fs::path>> files_named_by_geo(std::string_view text) {
  std::vector<fs::path> files;
  for (const GeoWord& word : words_of_geo(text)) {
    const std::string small = lower(word.word);
    if (is_one_of(small, kAsking)) return std::nullopt;
    if (!is_one_of(small, kReading)) continue;
    if (word.quoted.empty()) return std::nullopt;
    files.emplace_back(word.quoted);
  }
  return files;
}

bool gmsh_knows_ending(const std::filesystem::path& path) {
  const FileFormat* format = format_of(path);
  const std::string ending = path.extension().string();
  return format && format->known_to_gmsh &&
         (ending == format->ending || std::ranges::none_of(ending, [](unsigned char c) { return std::islower(c); }));
}

Result<void> check_geo(const fs::path& geometry) { return Inspection(geometry).run(); }

}  // namespace ringdown::mesh
