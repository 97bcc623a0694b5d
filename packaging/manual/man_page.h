// Man pages, in roff's man macros.
#pragma once

#include "packaging/manual/command.h"

#include <string>
#include <vector>

namespace ringdown::manual {

// A section that no table has: FILES, ENVIRONMENT, EXAMPLES. Each entry is a term and what is to say of it.
struct Section {
  std::string heading;
  struct Entry {
    std::string term, text;
  };
  std::vector<Entry> entries;
};

// The page of section 1: name, synopsis, options, verbs, `sections`, exit codes.
std::string man_page(const Command& command, const std::vector<Section>& sections);

}  // namespace ringdown::manual
