#include "packaging/manual/command.h"

#include <sstream>

namespace ringdown::manual {

std::vector<std::string> OptionRow::choices() const {
  std::vector<std::string> all;
  if (value.find('|') == value.npos) return all;
  std::istringstream words(value);
  for (std::string word; std::getline(words, word, '|');) all.push_back(word);
  return all;
}

bool OptionRow::wants_file() const { return value == "FILE" || value == "FOLDER"; }

}  // namespace ringdown::manual
