#include "engine/bake/object_text.h"

#include "engine/bake/object_file.h"

#include <cstdio>
#include <regex>
#include <vector>

namespace ringdown::bake {
namespace {

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

class Lines {
 public:
  explicit Lines(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      lines_.emplace_back(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }

  // In the table of that name; "" is the file's own.
  void set(const std::string& table, const std::string& key, const std::string& value) {
    const std::regex line("(\\s*" + key + "\\s*=\\s*)[^#]*?(\\s*(#.*)?)");
    auto [at, end] = range(table);
    for (; at < end; ++at) {
      std::smatch found;
      if (!std::regex_match(lines_[at], found, line)) continue;
      lines_[at] = found[1].str() + value + found[2].str();
      return;
    }
    while (end > 0 && lines_[end - 1].empty()) --end;
    lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(end), key + " = " + value);
  }

  void drop(const std::string& key) {
    const auto [begin, end] = range("");
    const std::regex line("\\s*" + key + "\\s*=.*");
    for (std::size_t at = begin; at < end; ++at) {
      if (!std::regex_match(lines_[at], line)) continue;
      lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(at));
      return;
    }
  }

  [[nodiscard]] std::string text() const {
    std::string all;
    for (const std::string& line : lines_) all += line + "\n";
    return all;
  }

 private:
  // Its lines, without the header; the table is added when it is not there.
  std::pair<std::size_t, std::size_t> range(const std::string& table) {
    static const std::regex header(R"(\s*\[\s*([^\]]*?)\s*\]\s*(#.*)?)");
    std::string current;
    std::size_t begin = 0;
    for (std::size_t at = 0; at <= lines_.size(); ++at) {
      std::smatch found;
      const bool ends = at == lines_.size() || std::regex_match(lines_[at], found, header);
      if (!ends) continue;
      if (current == table) return {begin, at};
      if (at == lines_.size()) break;
      current = found[1].str();
      begin = at + 1;
    }
    lines_.emplace_back("");
    lines_.push_back("[" + table + "]");
    return {lines_.size(), lines_.size()};
  }

  std::vector<std::string> lines_;
};

}  // namespace

Result<std::string> change_object(std::string_view text, const ObjectChanges& changes) {
  const Result<ObjectRecipe> before = parse_object(text, "the object");
  if (!before) return fail(before.error());
  ObjectRecipe wanted = *before;
  Lines lines(text);
  lines.drop("name");
  if (changes.mesh_size_m > 0) lines.set("", "mesh_size_m", number_text(changes.mesh_size_m));
  if (!changes.geometry.empty()) {
    lines.set("", "geometry", "\"" + changes.geometry.generic_string() + "\"");
    wanted.geometry = changes.geometry;
  }
  for (const auto& [key, value] : changes.parameters) {
    lines.set("parameters", key, number_text(value));
    wanted.meshing.parameters[key] = std::stod(number_text(value));
  }
  const Result<ObjectRecipe> after = parse_object(lines.text(), "the object");
  if (!after || after->geometry != wanted.geometry || after->meshing.parameters != wanted.meshing.parameters) {
    return fail(
        ErrorKind::bad_input,
        "the object's file is written in a way that cannot be changed line by line; give each key a line of its "
        "own, and its parameters a table [parameters]");
  }
  return lines.text();
}

}  // namespace ringdown::bake
