// The options of ringdownd: the one table that its command line and --help are made from. [main]
//
//   DaemonOptions options;
//   CLI::App app;
//   add_options(app, options);  // app fills options when it parses; options must outlive it
//
// A new option is a member of DaemonOptions and a row in options.cpp.
#pragma once

namespace CLI {
class App;
}

namespace ringdown::server {

struct DaemonOptions;

// Values that are wrong in themselves (a number out of range, an object without a name) end the parsing with a
// CLI::ParseError that names the option.
void add_options(CLI::App& app, DaemonOptions& options);

}  // namespace ringdown::server
