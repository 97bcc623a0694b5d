#include "engine/bake/toml_table.h"

#include "engine/base/atomic_file.h"

#include <toml++/toml.h>

#include <optional>
#include <set>

namespace ringdown::bake {
namespace {

constexpr std::size_t kLargestFile = 1 << 20;  // bytes

std::string line_of(const toml::node& node) { return ", line " + std::to_string(node.source().begin.line); }

}  // namespace

struct TomlTable::Document {
  std::string path;
  toml::table root;
  std::set<const toml::node*> read;
  std::optional<Error> error;

  const toml::table* table_at(const std::vector<std::string>& place) const {
    const toml::table* table = &root;
    for (const std::string& key : place) {
      table = table ? table->get_as<toml::table>(key) : nullptr;
    }
    return table;
  }

  const toml::node* find(const std::vector<std::string>& place, const std::string& key) {
    const toml::table* table = table_at(place);
    const toml::node* node = table ? table->get(key) : nullptr;
    if (node) read.insert(node);
    return node;
  }

  void note(const toml::node* where, const std::string& what) {
    if (!error) error = Error{path + (where ? line_of(*where) : "") + ": " + what};
  }

  // The first leaf or table that nobody read.
  const toml::node* unread(const toml::table& table, std::string& name) const {
    const toml::node* first = nullptr;
    for (const auto& [key, node] : table) {
      const toml::node* found = nullptr;
      std::string found_name(key.str());
      if (!read.contains(&node)) {
        found = &node;
      } else if (const toml::table* inner = node.as_table()) {
        found = unread(*inner, found_name);
      }
      if (found && (!first || found->source().begin.line < first->source().begin.line)) {
        first = found;
        name = found_name;
      }
    }
    return first;
  }
};

TomlTable::TomlTable(std::shared_ptr<Document> document, std::vector<std::string> place)
    : document_(std::move(document)), place_(std::move(place)) {}

Result<TomlTable> TomlTable::read(const std::filesystem::path& path) {
  const Result<std::string> text = read_whole_file(path, kLargestFile);
  if (!text) return fail(text.error());
  try {
    auto document = std::make_shared<Document>();
    document->path = path.string();
    document->root = toml::parse(*text);
    return TomlTable(std::move(document), {});
  } catch (const toml::parse_error& error) {
    return fail(path.string() + ", line " + std::to_string(error.source().begin.line) +
                ": not TOML: " + std::string(error.description()));
  }
}

bool TomlTable::has(const std::string& key) const {
  const toml::table* table = document_->table_at(place_);
  return table && table->contains(key);
}

std::string TomlTable::text(const std::string& key) {
  const toml::node* node = document_->find(place_, key);
  if (!node) {
    refuse(key, "is missing");
    return {};
  }
  const auto value = node->value_exact<std::string>();
  if (!value) document_->note(node, "'" + key + "' must be text in quotes");
  return value.value_or("");
}

std::string TomlTable::text(const std::string& key, const std::string& otherwise) {
  return has(key) ? text(key) : otherwise;
}

double TomlTable::number(const std::string& key) {
  const toml::node* node = document_->find(place_, key);
  if (!node) {
    refuse(key, "is missing");
    return 0;
  }
  if (!node->is_number()) {
    document_->note(node, "'" + key + "' must be a number");
    return 0;
  }
  return node->value<double>().value_or(0);
}

double TomlTable::number(const std::string& key, double otherwise) { return has(key) ? number(key) : otherwise; }

std::vector<double> TomlTable::numbers(const std::string& key) {
  const toml::node* node = document_->find(place_, key);
  const toml::array* array = node ? node->as_array() : nullptr;
  if (!array) {
    refuse(key, "must be a list of numbers");
    return {};
  }
  std::vector<double> values;
  for (const toml::node& element : *array) {
    if (!element.is_number()) document_->note(&element, "'" + key + "' must be a list of numbers");
    values.push_back(element.value<double>().value_or(0));
  }
  return values;
}

std::map<std::string, double> TomlTable::all_numbers(const std::string& key) {
  std::map<std::string, double> values;
  if (!has(key)) return values;
  TomlTable inner = table(key);
  const toml::table* names = document_->table_at(inner.place_);
  if (!names) return values;
  for (const auto& [name, node] : *names) values[std::string(name.str())] = inner.number(std::string(name.str()));
  return values;
}

TomlTable TomlTable::table(const std::string& key) {
  const toml::node* node = document_->find(place_, key);
  if (!node || !node->is_table()) refuse(key, node ? "must be a table" : "is missing");
  std::vector<std::string> place = place_;
  place.push_back(key);
  return {document_, std::move(place)};
}

void TomlTable::refuse(const std::string& key, const std::string& why) {
  const toml::table* here = document_->table_at(place_);
  const toml::node* node = here ? here->get(key) : nullptr;
  std::string name;
  for (const std::string& outer : place_) name += outer + ".";
  document_->note(node ? node : place_.empty() ? nullptr : here, "'" + name + key + "' " + why);
}

Result<void> TomlTable::finish() const {
  if (document_->error) return fail(*document_->error);
  std::string name;
  if (const toml::node* node = document_->unread(document_->root, name)) {
    return fail(document_->path + line_of(*node) + ": unknown key '" + name + "'; remove it or correct its spelling");
  }
  return {};
}

}  // namespace ringdown::bake
