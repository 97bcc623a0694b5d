#include "engine/modal/bank_file.h"
#include "tests/bench/deadline/parts.h"
#include "tests/support/pauses.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

namespace ringdown::bench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int kRate = 192000, kPeriod = 128, kBudget = 70;
constexpr std::size_t kModes = 2000, kFewObjects = 20, kMaxObjects = 500;
constexpr std::uint32_t kSeeds = 8;
constexpr double kLoad = 2.5;  // in proportion to that of a few objects, which caches hold; in truth about four

std::string name(std::size_t object) { return "object" + std::to_string(object); }

class Load {
 public:
  Load(const Extent& extent, Table& table) : extent_(extent), table_(table) { need(server_, kRate, kPeriod); }

  // The mean load, or nothing when the daemon does not keep up with its messages.
  std::optional<double> measure(const std::string& what, int run, std::size_t objects, int budget);

 private:
  std::vector<std::string> arguments(std::size_t objects, int budget);

  Extent extent_;
  Table& table_;
  test::Pauses pauses_;
  test::TemporaryFolder folder_;
  test::JackServer server_{kRate, kPeriod, test::JackServer::Mode::realtime};
};

// A bank file of its own for each object, so that they do not share their states.
std::vector<std::string> Load::arguments(std::size_t objects, int budget) {
  std::vector<std::string> all{"--connect", "--budget", std::to_string(budget)};
  for (std::size_t i = 0; i < objects; ++i) {
    const auto file = folder_ / (name(i) + ".glb");
    if (!exists(file)) {
      modal::Bank bank = test::random_bank(static_cast<std::uint32_t>(i) % kSeeds, kModes, 8);
      for (double& decay_per_s : bank.decay_per_s) decay_per_s = 0.01;
      static_cast<void>(modal::write_bank(bank, file));
    }
    all.insert(all.end(), {"--object", name(i) + "=" + file.string()});
  }
  return all;
}

// Strikes all objects, and measures from when they sound while some are struck again.
std::optional<double> Load::measure(const std::string& what, int run, std::size_t objects, int budget) {
  test::Daemon daemon(arguments(objects, budget), server_.environment());
  if (!daemon.ready()) return std::nullopt;
  for (std::size_t i = 0; i < objects; ++i) {
    daemon.send(strike(name(i), 0.1 * std::pow(10.0, -static_cast<double>(i % 30) / 20)));
    if (i % 10 == 9) std::this_thread::sleep_for(5ms);
  }
  const bool all = test::becomes_true([&] {
    const auto now = status(daemon);
    return now && now->sounding_modes + now->hidden_modes >= static_cast<int>(objects * kModes * 9 / 10);
  });
  std::this_thread::sleep_for(1500ms);  // the mean load is of about a second
  const auto before = status(daemon);
  if (!all || !before) return std::nullopt;
  const std::uint64_t pauses = pauses_.count();
  auto now = before;
  std::vector<int> sounding;
  const auto begin = Clock::now();
  const auto passed_s = [begin] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  for (std::size_t i = 0; now && passed_s() < extent_.seconds; ++i) {
    daemon.send(strike(name(i % objects), 0.01));
    std::this_thread::sleep_for(20ms);
    now = status(daemon);
    if (now) sounding.push_back(now->sounding_modes);
  }
  if (!now) return std::nullopt;
  std::ranges::sort(sounding);
  const auto add = [&](const char* figure, double value, const char* unit) {
    table_.add("load", what, run, figure, value, unit);
  };
  add("objects", static_cast<double>(objects), "");
  add("callbacks", passed_s() * kRate / kPeriod, "");
  add("late callbacks", now->misses - before->misses, "");
  add("xruns", now->xruns - before->xruns, "");
  add("own xruns", now->own_xruns - before->own_xruns, "");
  add("mean load", now->load_mean, "");
  add("p99 load", now->load_p99, "");
  add("modes sounding, median", sounding[sounding.size() / 2], "");
  add("modes sounding, least", sounding.front(), "");
  add("modes left out", now->hidden_modes, "");
  add("pauses of the machine", static_cast<double>(pauses_.count() - pauses), "");
  return now->load_mean;
}

}  // namespace

void measure_load(const Extent& extent, Table& table) {
  Load load(extent, table);
  const auto few = load.measure("small scene", 0, kFewObjects, 0);
  if (!few || *few <= 0) {
    std::fprintf(stderr, "load: even a small scene is too much for this machine\n");
    return;
  }
  const auto wanted = static_cast<std::size_t>(std::ceil(kLoad / *few * kFewObjects));
  const std::size_t objects = std::min(wanted, kMaxObjects);
  for (int run = 0; run < extent.runs; ++run) {
    for (const int budget : {0, kBudget}) {
      const std::string what = budget == 0 ? "no budget" : "budget " + std::to_string(budget) + " %";
      if (!load.measure(what, run, objects, budget)) std::fprintf(stderr, "load: %s: no answer\n", what.c_str());
    }
  }
}

}  // namespace ringdown::bench
