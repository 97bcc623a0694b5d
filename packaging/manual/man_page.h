// Man pages, in roff's man macros.
#pragma once

#include "packaging/manual/command.h"

#include <string>
#include <vector>

namespace ringdown::manual {

// A section that CLI11 knows nothing of: FILES, ENVIRONMENT, EXAMPLES. Each entry is a term and its explanation.
struct Section {
  std::string heading;
  struct Entry {
    std::string term, text;
  };
  std::vector<Entry> entries;
};

// The page in section 1: name, synopsis, options, verbs, `sections`, exit codes.
std::string man_page(const Command& command, const std::vector<Section>& sections);

}  // namespace ringdown::manual
