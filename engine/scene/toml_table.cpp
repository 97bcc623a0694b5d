#include "engine/scene/toml_table.h"

#include "protocol/names.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::scene {

TomlTable::TomlTable(const toml::table& table, std::string path, std::string what)
    : table_(table), path_(std::move(path)), what_(std::move(what)) {}

void TomlTable::complain(std::uint32_t line, const std::string& why) {
  if (!result_) return;
  result_ = fail(path_ + ":" + std::to_string(line) + ": " + (what_.empty() ? "" : what_ + ": ") + why);
}

const toml::node* TomlTable::take(std::string_view key) {
  taken_.emplace(key);
  return table_.get(key);
}

std::uint32_t TomlTable::line_of(std::string_view key) const {
  const toml::node* node = table_.get(key);
  return node && node->source().begin.line ? node->source().begin.line : line();
}

void TomlTable::expected(std::string_view key, const std::string& what) {
  complain(line_of(key), std::string(key) + " must be " + what);
}

void TomlTable::number(std::string_view key, double& target, const Range& range) {
  const toml::node* node = take(key);
  if (!node) return;
  if (!node->is_number()) return expected(key, "a number");
  const double value = *node->value<double>();
  const auto ok = check_range(value, range);
  if (!ok) return complain(line_of(key), std::string(key) + " = " + ok.error().message);
  target = value;
}

void TomlTable::seed(std::string_view key, std::uint64_t& target) {
  const toml::node* node = take(key);
  if (!node) return;
  const auto* value = node->as_integer();
  if (!value || value->get() < 0) return expected(key, "a whole number >= 0");
  target = static_cast<std::uint64_t>(value->get());
}

void TomlTable::boolean(std::string_view key, bool& target) {
  const toml::node* node = take(key);
  if (!node) return;
  if (!node->is_boolean()) return expected(key, "true or false");
  target = node->as_boolean()->get();
}

void TomlTable::text(std::string_view key, std::string& target) {
  const toml::node* node = take(key);
  if (!node) return;
  if (!node->is_string() || node->as_string()->get().empty()) return expected(key, "a text in quotes, not empty");
  target = node->as_string()->get();
}

void TomlTable::vector(std::string_view key, Vec3& target, const Range& range) {
  const toml::node* node = take(key);
  if (!node) return;
  const toml::array* array = node->as_array();
  if (!array || array->size() != 3) return expected(key, "three numbers [x, y, z]");
  double values[3];
  for (std::size_t k = 0; k < 3; ++k) {
    if (!array->get(k)->is_number()) return expected(key, "three numbers [x, y, z]");
    values[k] = *array->get(k)->value<double>();
    const auto ok = check_range(values[k], range);
    if (!ok) return complain(line_of(key), std::string(key) + ": " + ok.error().message);
  }
  target = {values[0], values[1], values[2]};
}

void TomlTable::rotation(std::string_view key, Rotation& target) {
  const toml::table* inner = table(key);
  if (!inner) return;
  TomlTable reader(*inner, path_, what_.empty() ? std::string(key) : what_ + ": " + std::string(key));
  Vec3 axis;
  double degrees = 0;
  reader.require({"axis", "degrees"});
  reader.vector("axis", axis, {-1e6, 1e6});
  reader.number("degrees", degrees, {-1e6, 1e6});
  if (!(length(axis) > 1e-6)) reader.complain(reader.line_of("axis"), "axis must not be [0, 0, 0]");
  const Result<void> done = reader.finish();
  if (done) target = about(axis, degrees * std::numbers::pi / 180);
  if (result_ && !done) result_ = done;
}

void TomlTable::require(std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    if (!has(key)) complain(line(), "the key " + std::string(key) + " is missing");
  }
}

int TomlTable::choice(std::string_view key, std::initializer_list<std::string_view> choices) {
  const toml::node* node = take(key);
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

const toml::array* TomlTable::tables(std::string_view key) {
  const toml::node* node = take(key);
  if (!node) return nullptr;
  const toml::array* array = node->as_array();
  if (!array || !array->is_homogeneous(toml::node_type::table)) {
    expected(key, "written as [[" + std::string(key) + "]]");
    return nullptr;
  }
  return array;
}

const toml::table* TomlTable::table(std::string_view key) {
  const toml::node* node = take(key);
  if (node && !node->is_table()) expected(key, "a table");
  return node ? node->as_table() : nullptr;
}

Result<void> TomlTable::finish() {
  for (const auto& [key, node] : table_) {
    if (taken_.contains(key.str())) continue;
    const std::uint32_t at = key.source().begin.line;
    complain(at ? at : line(), "unknown key " + protocol::quoted(key.str()));
  }
  return result_;
}

}  // namespace ringdown::scene
