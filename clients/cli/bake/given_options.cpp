#include "clients/cli/bake/given_options.h"

#include <CLI/CLI.hpp>

#include <algorithm>

namespace ringdown::cli {

std::vector<std::string> given_options(const CLI::App& app, std::initializer_list<std::string_view> except) {
  std::vector<std::string> words;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || !name.starts_with('-') ||
        std::find(except.begin(), except.end(), name) != except.end()) {
      continue;
    }
    words.push_back(name);
    const bool is_flag = option->get_items_expected_max() == 0;
    if (!is_flag) words.insert(words.end(), option->results().begin(), option->results().end());
  }
  return words;
}

}  // namespace ringdown::cli
