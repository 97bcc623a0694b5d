// A program's command line as plain rows: what its man page and its shell completions are written from.
#pragma once

#include <string>
#include <vector>

namespace ringdown::manual {

class App;

struct OptionRow {
  std::vector<std::string> names;  // "-o", "--output"; an argument without dashes is given by its position
  std::string value;               // what follows it: "FILE", "jack|wav|null"; empty for a switch
  std::string accepted;            // "from 8000 to 768000", or empty
  std::string fallback;            // what holds when it is left out, or empty
  std::string sentence;            // what it does, without a full stop
  bool required = false, repeats = false;

  [[nodiscard]] bool by_place() const { return names.front().front() != '-'; }
  [[nodiscard]] std::vector<std::string> choices() const;  // jack, wav, null; empty where any value will do
  [[nodiscard]] bool wants_file() const;                   // whether the value is the name of a file or a folder
};

struct Command {
  std::string name, sentence;
  std::vector<OptionRow> options;
  std::vector<Command> commands;  // verbs
  bool passes_on = false;         // everything after its name goes to another program
};

// The rows of `app` (command_line.h), hidden options left out.
Command command_of(App& app);

}  // namespace ringdown::manual
