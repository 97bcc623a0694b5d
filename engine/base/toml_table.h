// Reads TOML files strictly: a wrong type, a number out of range, a missing key and an unknown key are all errors. Each
// error is one sentence that begins with path:line. [worker]
//
//   Result<TomlTable> file = TomlTable::read(path);
//   if (!file) return fail(file);
//   file->require({"name"});
//   file->text("name", thing.name);
//   file->number("size_m", thing.size_m, {0, 10});               // optional: keeps its value when absent
//   if (auto inner = file->table("inner")) inner->boolean("on", thing.on);
//   for (TomlTable& part : file->tables("part")) read_part(part);
//   if (auto good = file->finish(); !good) return fail(good);
//
// Every reading function stores the key's value in its target, and leaves the target unchanged if the key is absent or
// the value is wrong. Reading continues after an error; finish() returns the first one. So reading code needs no
// branches. The key `version` of a file is checked here (version.h). Tables are handles on one shared file; copies are
// cheap. One thread per file.
#pragma once

#include "engine/base/range.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown {

inline constexpr std::size_t kMaxTomlFileBytes = std::size_t{4} << 20;  // bytes

class TomlTable {
 public:
  static Result<TomlTable> read(const std::filesystem::path& path);

  // Reads a text in memory; `path` appears in the errors.
  static Result<TomlTable> parse(std::string_view text, const std::filesystem::path& path);

  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] bool has_table(std::string_view key) const;
  [[nodiscard]] std::uint32_t line_of(std::string_view key) const;  // the table's own line if there is no such key

  // The beginning of errors about this table: "" for the file's table, "[inner]", "body 'bell'" for the [[body]] of
  // that name, "body 'bell': inner" for a table inside that body.
  [[nodiscard]] const std::string& what() const;

  void require(std::initializer_list<std::string_view> keys);
  void text(std::string_view key, std::string& target);  // never empty
  void boolean(std::string_view key, bool& target);
  void number(std::string_view key, double& target, const Range& range);
  void number(std::string_view key, double& target);                        // any finite number
  void fraction(std::string_view key, double& target, const Range& range);  // a number, or a text such as "0.1%"
  void whole(std::string_view key, std::uint64_t& target, std::uint64_t low = 0, std::uint64_t high = kAnyWhole);
  void vector(std::string_view key, Vec3& target, const Range& range);              // [x, y, z], each in the range
  void numbers(std::string_view key, std::vector<double>& target);                  // a list of finite numbers
  void named_numbers(std::string_view key, std::map<std::string, double>& target);  // a table of any names

  // Reads a text, a number, true or false as the word that a command line would have. If `list` is true, the value may
  // also be a list of such values.
  void words(std::string_view key, std::vector<std::string>& target, bool list);

  // Returns the value's position in `choices`, or -1 if the key is missing or its value wrong.
  int choice(std::string_view key, std::initializer_list<std::string_view> choices);

  std::optional<TomlTable> table(std::string_view key);  // [key]; nothing if there is none
  std::vector<TomlTable> tables(std::string_view key);   // every [[key]]

  // Records an error that the caller found, at the key's line, or at the table's line if there is no such key.
  void complain(std::string_view key, const std::string& why);

  // Fails with the first error, or with the first key that no reading function asked for, in any table that was read.
  [[nodiscard]] Result<void> finish() const;

 private:
  static constexpr std::uint64_t kAnyWhole = INT64_MAX;  // the largest integer of TOML
  struct Document;
  struct OpenTable;
  TomlTable(std::shared_ptr<Document> document, OpenTable& open);
  void expected(std::string_view key, const std::string& what);

  std::shared_ptr<Document> document_;
  OpenTable* open_;
};

}  // namespace ringdown
