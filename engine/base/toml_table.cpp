#include "engine/base/toml_table.h"

#include "engine/base/atomic_file.h"
#include "engine/base/quote.h"
#include "engine/base/range.h"

// toml++ 3.3.0 asserts that "[" is followed by the beginning of a key before it has looked; where NDEBUG is set, the
// compiler may even rely on that. Without its assertions the parser refuses such text with an error.
#undef NDEBUG
#define TOML_ASSERT(expression) static_cast<void>(0)
#define TOML_HEADER_ONLY 1
#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <set>
#include <unordered_map>
#include <utility>

namespace ringdown {

namespace {

// A text, number, true or false as a word.
std::optional<std::string> word_of(const toml::node& node) {
  if (node.is_string()) return node.as_string()->get();
  if (node.is_boolean()) return node.as_boolean()->get() ? "true" : "false";
  if (node.is_integer()) return std::to_string(node.as_integer()->get());
  if (!node.is_floating_point()) return std::nullopt;
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", node.as_floating_point()->get());
  return text;
}

// Where toml++ 3.3.0 looks for white space, its behaviour is undefined for some characters beyond ASCII. It looks for
// white space outside strings and comments, where TOML allows no such character, and in a string of several lines after
// a backslash that ends a line. Returns the line of the first character of this kind, or 0 when there is none.
//
// The loop follows quotes, backslashes and comments, nothing else. It may lose track in a text that is not TOML, but
// then the parser stops at the fault and does not see what follows.
std::uint32_t line_of_stray_character(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF", kWhite = " \t\r\n";
  const auto beyond_ascii = [text](std::size_t i) {
    return i < text.size() && static_cast<unsigned char>(text[i]) > 127;
  };
  std::uint32_t line = 1;
  bool comment = false;
  std::string_view closing;  // the quotes that end the string, one or three; empty outside strings
  for (std::size_t i = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line, comment = false;
    if (comment) continue;
    if (closing.empty()) {
      if (beyond_ascii(i)) return line;
      comment = c == '#';
      if (c != '"' && c != '\'') continue;
      closing = text.substr(i, text.substr(i).starts_with(std::string(3, c)) ? 3 : 1);
      i += closing.size() - 1;
    } else if (c == '\\' && closing[0] == '"') {
      const std::size_t next = text.find_first_not_of(kWhite, i + 1);
      if (closing.size() == 3 && beyond_ascii(next)) return line;
      if (next == i + 1) ++i;  // an escaped quote ends nothing
    } else if (text.substr(i).starts_with(closing)) {
      // Up to five quotes end a string of several lines: the first two of them belong to it.
      const std::size_t quotes = std::min(text.find_first_not_of(c, i), text.size()) - i;
      i += (closing.size() == 3 ? std::min<std::size_t>(quotes, 5) : 1) - 1;
      closing = {};
    }
  }
  return 0;
}

}  // namespace

// A table of the file that is being read, and the keys that were asked for.
struct TomlTable::OpenTable {
  const toml::table* table;
  std::string what;
  std::set<std::string, std::less<>> taken = {};

  const toml::node* take(std::string_view key) {
    taken.emplace(key);
    return table->get(key);
  }
};

struct TomlTable::Document {
  std::string path;
  toml::table root;
  std::deque<OpenTable> open_tables = {};  // in the order of reading; a deque does not move them
  std::unordered_map<const toml::table*, OpenTable*> known = {};
  std::optional<Error> error = {};

  // A table that is asked for twice is opened once, so that keys read through either handle count as known.
  OpenTable& open(const toml::table& table, std::string what) {
    OpenTable*& opened = known[&table];
    if (!opened) opened = &open_tables.emplace_back(OpenTable{&table, std::move(what)});
    return *opened;
  }

  [[nodiscard]] Error sentence(const OpenTable& table, std::uint32_t line, const std::string& why) const {
    return {ErrorKind::bad_input,
            path + ":" + std::to_string(line) + ": " + (table.what.empty() ? "" : table.what + ": ") + why};
  }
};

namespace {

std::uint32_t line_of_table(const toml::table& table) { return std::max(table.source().begin.line, 1u); }

std::string name_of(const toml::table& table, std::string_view kind) {
  const std::string name = table["name"].value_or(std::string());
  return name.empty() ? "[[" + std::string(kind) + "]]" : std::string(kind) + " " + quote(name);
}

}  // namespace

TomlTable::TomlTable(std::shared_ptr<Document> document, OpenTable& open)
    : document_(std::move(document)), open_(&open) {}

Result<TomlTable> TomlTable::read(const std::filesystem::path& path) {
  const Result<std::string> text = read_whole_file(path, kMaxTomlFileBytes);
  if (!text) return fail(text.error());
  return parse(*text, path);
}

Result<TomlTable> TomlTable::parse(std::string_view text, const std::filesystem::path& path) {
  if (const std::uint32_t line = line_of_stray_character(text)) {
    return fail(ErrorKind::bad_input, path.string() + ":" + std::to_string(line) +
                                          ": not TOML: a character beyond ASCII stands outside quotes and comments, or "
                                          "after a backslash that ends a line");
  }
  toml::parse_result file = toml::parse(text);
  if (!file) {
    const toml::parse_error& error = file.error();
    return fail(ErrorKind::bad_input, path.string() + ":" + std::to_string(error.source().begin.line) +
                                          ": not TOML: " + std::string(error.description()));
  }
  auto document = std::make_shared<Document>(Document{path.string(), std::move(file).table()});
  OpenTable& root = document->open(document->root, "");
  return TomlTable(std::move(document), root);
}

bool TomlTable::has(std::string_view key) const { return open_->table->contains(key); }

std::uint32_t TomlTable::line_of(std::string_view key) const {
  const toml::node* node = open_->table->get(key);
  return node && node->source().begin.line ? node->source().begin.line : line_of_table(*open_->table);
}

const std::string& TomlTable::what() const { return open_->what; }

void TomlTable::complain(std::string_view key, const std::string& why) {
  if (!document_->error) document_->error = document_->sentence(*open_, line_of(key), why);
}

void TomlTable::expected(std::string_view key, const std::string& what) {
  complain(key, std::string(key) + " must be " + what);
}

void TomlTable::require(std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    if (!has(key)) complain(key, "the key " + std::string(key) + " is missing");
  }
}

void TomlTable::text(std::string_view key, std::string& target) {
  const toml::node* node = open_->take(key);
  if (!node) return;
  if (!node->is_string() || node->as_string()->get().empty()) return expected(key, "a text in quotes, not empty");
  target = node->as_string()->get();
}

void TomlTable::boolean(std::string_view key, bool& target) {
  const toml::node* node = open_->take(key);
  if (!node) return;
  if (!node->is_boolean()) return expected(key, "true or false");
  target = node->as_boolean()->get();
}

void TomlTable::number(std::string_view key, double& target, const Range& range) {
  const toml::node* node = open_->take(key);
  if (!node) return;
  if (!node->is_number()) return expected(key, "a number");
  const double value = *node->value<double>();
  const auto inside = check_range(value, range);
  if (!inside) return complain(key, std::string(key) + " = " + inside.error().message);
  target = value;
}

void TomlTable::number(std::string_view key, double& target) {
  const toml::node* node = open_->take(key);
  if (!node) return;
  if (!node->is_number() || !std::isfinite(*node->value<double>())) return expected(key, "a finite number");
  target = *node->value<double>();
}

void TomlTable::fraction(std::string_view key, double& target, const Range& range) {
  const toml::node* node = open_->take(key);
  if (!node) return;
  const Result<double> value = node->is_string()   ? parse_fraction(node->as_string()->get())
                               : node->is_number() ? Result<double>(*node->value<double>())
                                                   : fail(ErrorKind::bad_input, "");
  if (!value) return expected(key, "a number or a percentage in quotes, such as \"0.1%\"");
  const auto inside = check_range(*value, range);
  if (!inside) return complain(key, std::string(key) + " = " + inside.error().message);
  target = *value;
}

void TomlTable::whole(std::string_view key, std::uint64_t& target, std::uint64_t low, std::uint64_t high) {
  const toml::node* node = open_->take(key);
  if (!node) return;
  const auto* integer = node->as_integer();
  const std::uint64_t value = integer && integer->get() >= 0 ? static_cast<std::uint64_t>(integer->get()) : 0;
  if (!integer || integer->get() < 0 || value < low || value > high) {
    const std::string most = high == kAnyWhole ? "" : " and <= " + std::to_string(high);
    return expected(key, "a whole number >= " + std::to_string(low) + most);
  }
  target = value;
}

void TomlTable::vector(std::string_view key, Vec3& target, const Range& range) {
  const toml::node* node = open_->take(key);
  if (!node) return;
  const toml::array* array = node->as_array();
  if (!array || array->size() != 3) return expected(key, "three numbers [x, y, z]");
  double values[3];
  for (std::size_t k = 0; k < 3; ++k) {
    if (!array->get(k)->is_number()) return expected(key, "three numbers [x, y, z]");
    values[k] = *array->get(k)->value<double>();
    const auto inside = check_range(values[k], range);
    if (!inside) return complain(key, std::string(key) + ": " + inside.error().message);
  }
  target = {values[0], values[1], values[2]};
}

void TomlTable::numbers(std::string_view key, std::vector<double>& target) {
  const toml::node* node = open_->take(key);
  if (!node) return;
  std::vector<double> values;
  bool good = node->is_array();
  for (std::size_t k = 0; good && k < node->as_array()->size(); ++k) {
    const toml::node& element = *node->as_array()->get(k);
    good = element.is_number() && std::isfinite(*element.value<double>());
    if (good) values.push_back(*element.value<double>());
  }
  if (!good) return expected(key, "a list of finite numbers");
  target = std::move(values);
}

void TomlTable::named_numbers(std::string_view key, std::map<std::string, double>& target) {
  std::optional<TomlTable> names = table(key);
  if (!names) return;
  for (const auto& [name, node] : *names->open_->table) {
    double value = 0;
    names->number(name.str(), value);
    target[std::string(name.str())] = value;
  }
}

void TomlTable::words(std::string_view key, std::vector<std::string>& target, bool list) {
  const toml::node* node = open_->take(key);
  if (!node) return;
  std::vector<std::string> words;
  const toml::array* const array = list ? node->as_array() : nullptr;
  for (std::size_t k = 0; k < (array ? array->size() : 1); ++k) {
    const std::optional<std::string> word = word_of(array ? *array->get(k) : *node);
    if (!word) return expected(key, list ? "a text, or a list of them" : "a text, a number, true or false");
    words.push_back(*word);
  }
  target = std::move(words);
}

int TomlTable::choice(std::string_view key, std::initializer_list<std::string_view> choices) {
  const toml::node* node = open_->take(key);
  if (!node) return -1;
  std::string allowed;
  int place = 0;
  for (const std::string_view option : choices) {
    if (node->is_string() && node->as_string()->get() == option) return place;
    allowed += (place ? ", \"" : "\"") + std::string(option) + "\"";
    ++place;
  }
  expected(key, "one of " + allowed);
  return -1;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) {
  const toml::node* node = open_->take(key);
  if (!node) return {};
  if (!node->is_table()) {
    expected(key, "a table");
    return {};
  }
  const std::string name(key);
  const std::string what = open_->what.empty() ? "[" + name + "]" : open_->what + ": " + name;
  return TomlTable(document_, document_->open(*node->as_table(), what));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  const toml::node* node = open_->take(key);
  if (!node) return {};
  const toml::array* array = node->as_array();
  if (!array || !array->is_homogeneous(toml::node_type::table)) {
    expected(key, "written as [[" + std::string(key) + "]]");
    return {};
  }
  const std::string outer = open_->what.empty() ? "" : open_->what + ": ";
  std::vector<TomlTable> all;
  for (const toml::node& element : *array) {
    const toml::table& table = *element.as_table();
    all.push_back(TomlTable(document_, document_->open(table, outer + name_of(table, key))));
  }
  return all;
}

Result<void> TomlTable::finish() const {
  if (document_->error) return fail(*document_->error);
  for (const OpenTable& opened : document_->open_tables) {
    for (const auto& [key, node] : *opened.table) {
      if (opened.taken.contains(key.str())) continue;
      const std::uint32_t line = key.source().begin.line ? key.source().begin.line : line_of_table(*opened.table);
      return fail(document_->sentence(opened, line,
                                      "unknown key " + quote(key.str()) + "; remove it or correct it"));
    }
  }
  return {};
}

}  // namespace ringdown
