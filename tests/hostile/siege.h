// Feeds kinds of hostile inputs, each slice of them in a process of its own, and keeps what ends a process: a crash, a
// promise that was broken (fuzz::expect()), a minute of processor time for one input, or ten minutes in which nothing
// came of it. The process that follows goes on with the next input.
#pragma once

#include "tests/hostile/attack.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::hostile {

struct SiegeOptions {
  std::uint64_t seed = 1;
  std::size_t inputs = 300'000;
  std::size_t jobs = 2;               // processes at a time
  std::vector<std::string> only;      // kinds; empty: all
  std::size_t first = 0;              // of each kind, the input to begin with, rounded down to a slice
  std::filesystem::path found = ".";  // where inputs are kept that have brought about a fault
};

struct Page;  // what a process says of the input that it is feeding

struct Tally {
  std::size_t inputs = 0, faults = 0;
  double seconds = 0;  // that its processes took, by the clock
};

class Siege {
 public:
  explicit Siege(SiegeOptions options);

  // Prints each fault when it is found. False when there was one.
  bool run();
  void print_table() const;

 private:
  struct Slice {
    std::size_t kind = 0, begin = 0, end = 0;
  };
  struct Running {
    Slice slice;
    std::shared_ptr<Page> page;
    std::chrono::steady_clock::time_point since;
  };
  [[nodiscard]] std::vector<Slice> slices() const;
  void start(const Slice& slice);
  void wait_for_one();
  void note_fault(const Running& running, int status);

  SiegeOptions options_;
  std::vector<Kind> kinds_;
  std::vector<Tally> tallies_;
  std::vector<Slice> waiting_;  // the last first
  std::map<int, Running> running_;
};

}  // namespace ringdown::hostile
