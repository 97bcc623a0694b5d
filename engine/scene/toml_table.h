// One TOML table read key by key, with every complaint at its line. Private to scene_file.cpp.
//
// Each reader takes the key's value if it is there and leaves the target as it was if not. The first thing that is
// wrong is kept; reading goes on without harm, and finish() gives it back, or complains about keys nobody asked for.
#pragma once

#include "engine/base/result.h"
#include "engine/scene/check.h"
#include "engine/scene/description.h"
#include "engine/scene/rotation.h"

#define TOML_HEADER_ONLY 1
#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>

#include <cstdint>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>

namespace ringdown::scene {

class TomlTable {
 public:
  // `what` begins the sentences about this table: "body 'bell'".
  TomlTable(const toml::table& table, std::string path, std::string what);

  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
  [[nodiscard]] std::uint32_t line() const { return table_.source().begin.line; }
  [[nodiscard]] std::uint32_t line_of(std::string_view key) const;

  void number(std::string_view key, double& target, const Range& range);
  void seed(std::string_view key, std::uint64_t& target);
  void boolean(std::string_view key, bool& target);
  void text(std::string_view key, std::string& target);
  void vector(std::string_view key, Vec3& target, const Range& range);
  void rotation(std::string_view key, Rotation& target);  // { axis = [x, y, z], degrees = a }
  void require(std::initializer_list<std::string_view> keys);

  // The key's place in `choices`, or -1 when it is missing or wrong.
  int choice(std::string_view key, std::initializer_list<std::string_view> choices);

  // The tables of [[key]], or the table [key]; null when there is none. The caller reads them with readers of its own.
  const toml::array* tables(std::string_view key);
  const toml::table* table(std::string_view key);

  void complain(std::uint32_t line, const std::string& why);
  [[nodiscard]] Result<void> finish();

 private:
  const toml::node* take(std::string_view key);
  void expected(std::string_view key, const std::string& what);

  const toml::table& table_;
  std::string path_, what_;
  std::set<std::string, std::less<>> taken_;
  Result<void> result_;
};

}  // namespace ringdown::scene
