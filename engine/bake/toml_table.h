// TOML files read strictly: a missing key, a value of the wrong kind and a key nobody asked for are all
// errors, with file and line. [worker]
//
//   Result<TomlTable> file = TomlTable::read(path);
//   if (!file) return fail(file.error());
//   thing.name = file->text("name");
//   thing.size = file->number("size", 1.0);              // optional
//   thing.inner = file->table("inner").number("value");
//   if (auto good = file->finish(); !good) return fail(good.error());
//
// After a first error the readers return empty values and finish() reports it, so reading code stays one
// straight line.
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::bake {

class TomlTable {
public:
  static Result<TomlTable> read(const std::filesystem::path& path);

  [[nodiscard]] bool has(const std::string& key) const;
  std::string text(const std::string& key);
  std::string text(const std::string& key, const std::string& otherwise);
  double number(const std::string& key);
  double number(const std::string& key, double otherwise);
  std::vector<double> numbers(const std::string& key);               // an array
  std::map<std::string, double> all_numbers(const std::string& key); // a table of any names; empty if absent
  TomlTable table(const std::string& key);

  // Notes an error of the caller's own about a key ("must be ..."), unless there is one already.
  void refuse(const std::string& key, const std::string& why);

  // The first error; else an error for the first key that was never read; else fine. Call on the whole file's
  // table.
  [[nodiscard]] Result<void> finish() const;

private:
  struct Document;
  TomlTable(std::shared_ptr<Document> document, std::vector<std::string> place);

  std::shared_ptr<Document> document_;
  std::vector<std::string> place_; // keys from the file's root to this table
};

} // namespace ringdown::bake
