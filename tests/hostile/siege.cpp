#include "tests/hostile/siege.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <utility>

namespace ringdown::hostile {

constexpr std::size_t kMaxKept = std::size_t{1} << 20;  // bytes of an input that are kept

// Shared memory: the parent reads it when the process has ended.
struct Page {
  std::atomic<std::uint64_t> index{0}, size{0};
  std::atomic<bool> finishing{false};
  char bytes[kMaxKept];
};

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxFaults = 20;                 // of a kind, after which the rest of it is left out
constexpr rlim_t kMaxMemory = rlim_t{4} << 30;         // bytes of a process
constexpr int kMaxProcessor_s = 60, kMaxWait_s = 600;  // for one input

std::shared_ptr<Page> shared_page() {
  void* const memory = ::mmap(nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) std::abort();
  return {new (memory) Page, [](Page* page) { ::munmap(page, sizeof(Page)); }};
}

// The process ends by a signal when the input that comes takes too long.
void watch() {
  const itimerval limit{{0, 0}, {kMaxProcessor_s, 0}};
  ::setitimer(ITIMER_PROF, &limit, nullptr);
  ::alarm(kMaxWait_s);
}

std::uint64_t number_of(const std::string& name) {  // FNV-1a, so that a new kind changes no other's inputs
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

void feed(const Kind& kind, std::size_t begin, std::size_t end, std::uint64_t seed, Page& page) {
  const rlimit memory{kMaxMemory, kMaxMemory}, no_core{0, 0};
  ::setrlimit(RLIMIT_DATA, &memory);
  ::setrlimit(RLIMIT_CORE, &no_core);
  watch();
  const std::unique_ptr<Attack> attack = kind.begin(kind.name);
  for (std::size_t index = begin; index < end; ++index) {
    watch();
    Random random(seed, number_of(kind.name), index);
    page.index = index;
    const std::string input = attack->make(random);
    page.size = std::min(input.size(), kMaxKept);
    std::memcpy(page.bytes, input.data(), page.size);
    attack->feed(input, random);
  }
  page.index = end;
  page.finishing = true;
  watch();
  attack->finish();
}

std::string cause_of(int status) {
  if (WIFEXITED(status)) return "exit code " + std::to_string(WEXITSTATUS(status));
  switch (WTERMSIG(status)) {
    case SIGPROF:
      return "took more than " + std::to_string(kMaxProcessor_s) + " s of processor time";
    case SIGALRM:
      return "did not end within " + std::to_string(kMaxWait_s) + " s";
    default:
      return "signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + ")";
  }
}

std::vector<Kind> all_kinds() {
  std::vector<Kind> all;
  for (auto kinds : {daemon_kinds(), session_kinds(), reader_kinds()}) {
    std::move(kinds.begin(), kinds.end(), std::back_inserter(all));
  }
  return all;
}

}  // namespace

Siege::Siege(SiegeOptions options) : options_(std::move(options)), kinds_(all_kinds()) {
  if (!options_.only.empty()) {
    std::erase_if(kinds_, [&](const Kind& kind) { return std::ranges::count(options_.only, kind.name) == 0; });
  }
  tallies_.resize(kinds_.size());
}

// The kinds that take longest come first, because they are one slice each.
std::vector<Siege::Slice> Siege::slices() const {
  double shares = 0;
  for (const Kind& kind : kinds_) shares += kind.share;
  std::vector<Slice> all;
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    const double wanted = kinds_[k].share / shares * static_cast<double>(options_.inputs);
    const std::size_t count = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(wanted)));
    const std::size_t slice = kinds_[k].slice == 0 ? count : kinds_[k].slice;
    const std::size_t first = options_.first / slice * slice;
    for (std::size_t begin = first; begin < first + count; begin += slice) {
      all.push_back({k, begin, std::min(begin + slice, first + count)});
    }
  }
  std::reverse(all.begin(), all.end());
  return all;
}

void Siege::start(const Slice& slice) {
  Running running{slice, shared_page(), Clock::now()};
  std::fflush(nullptr);
  const pid_t process = ::fork();
  if (process == 0) {
    feed(kinds_[slice.kind], slice.begin, slice.end, options_.seed, *running.page);
    std::exit(0);
  }
  if (process < 0) {
    std::perror("fork");
    std::exit(1);
  }
  running_.emplace(process, std::move(running));
}

void Siege::note_fault(const Running& running, int status) {
  const Kind& kind = kinds_[running.slice.kind];
  const std::size_t index = running.page->index;
  const std::string name = kind.name + "-" + std::to_string(options_.seed) + "-" + std::to_string(index);
  const std::filesystem::path path = options_.found / name;
  std::filesystem::create_directories(options_.found);
  std::ofstream(path, std::ios::binary).write(running.page->bytes, static_cast<std::streamsize>(running.page->size));
  std::printf("FAULT: %s: %s input %zu of seed %llu; %s has it; again: --seed %llu --only %s --first %zu\n",
              cause_of(status).c_str(), running.page->finishing ? "after the last" : kind.name.c_str(), index,
              static_cast<unsigned long long>(options_.seed), path.c_str(),
              static_cast<unsigned long long>(options_.seed), kind.name.c_str(), index);
  std::fflush(stdout);
}

void Siege::wait_for_one() {
  int status = 0;
  const pid_t process = ::waitpid(-1, &status, 0);
  const auto found = running_.find(process);
  if (found == running_.end()) return;
  const Running running = std::move(found->second);
  running_.erase(found);
  const Slice& slice = running.slice;
  Tally& tally = tallies_[slice.kind];
  tally.seconds += std::chrono::duration<double>(Clock::now() - running.since).count();
  if (status == 0) {
    tally.inputs += slice.end - slice.begin;
    return;
  }
  const std::size_t fed = std::min<std::size_t>(running.page->index + 1, slice.end);
  tally.inputs += fed - std::min(slice.begin, fed);
  ++tally.faults;
  note_fault(running, status);
  if (fed < slice.end && tally.faults < kMaxFaults) waiting_.push_back({slice.kind, fed, slice.end});
}

bool Siege::run() {
  waiting_ = slices();
  while (!waiting_.empty() || !running_.empty()) {
    while (!waiting_.empty() && running_.size() < options_.jobs) {
      const Slice slice = waiting_.back();
      waiting_.pop_back();
      start(slice);
    }
    wait_for_one();
  }
  return std::ranges::all_of(tallies_, [](const Tally& tally) { return tally.faults == 0; });
}

void Siege::print_table() const {
  Tally all;
  std::printf("| kind | inputs | faults | seconds |\n|---|---|---|---|\n");
  const auto row = [](const char* name, const Tally& tally) {
    std::printf("| %s | %zu | %zu | %.1f |\n", name, tally.inputs, tally.faults, tally.seconds);
  };
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    row(kinds_[k].name.c_str(), tallies_[k]);
    all.inputs += tallies_[k].inputs, all.faults += tallies_[k].faults, all.seconds += tallies_[k].seconds;
  }
  row("all", all);
}

}  // namespace ringdown::hostile
