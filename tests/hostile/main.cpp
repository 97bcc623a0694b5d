// ringdown_hostile: hostile inputs for every reader and port (./run stress hostile). Prints a table of how many of each
// kind were tried; exits with 1 when one of them brought about a fault.
#include "tests/hostile/siege.h"

#include <CLI/CLI.hpp>

#include <thread>

int main(int argc, char** argv) {
  ringdown::hostile::SiegeOptions options;
  options.jobs = std::max(1U, std::thread::hardware_concurrency());
  CLI::App app("Hostile inputs for every reader and port.", "ringdown_hostile");
  app.add_option("--seed", options.seed, "The same seed makes the same inputs")->capture_default_str();
  app.add_option("--inputs", options.inputs, "How many, of all kinds together")->capture_default_str();
  app.add_option("--jobs", options.jobs, "Processes at a time")->capture_default_str();
  app.add_option("--only", options.only, "Kinds, as the table names them");
  app.add_option("--first", options.first, "The input to begin with, of each kind")->capture_default_str();
  app.add_option("--found", options.found, "Folder for inputs that brought about a fault")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  ringdown::hostile::Siege siege(options);
  const bool good = siege.run();
  siege.print_table();
  return good ? 0 : 1;
}
