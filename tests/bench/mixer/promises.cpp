#include "tests/bench/mixer/promises.h"

#include <algorithm>
#include <array>

namespace ringdown::bench {
namespace {

using Wanted = std::function<bool(const Row&)>;

const Row* find(const Rows& rows, const std::string& part, const Wanted& wanted) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.part == part && wanted(r); });
  return found == rows.end() ? nullptr : &*found;
}

Wanted is(const std::string& who) {
  return [who](const Row& row) { return row.who == who; };
}

// The fastest of a peer's ways at one count and block; a row that says why there is none; or nothing.
const Row* best_of(const Rows& rows, const std::string& peer, std::size_t modes, std::size_t block) {
  const Row* best = nullptr;
  for (const Row& row : rows) {
    const bool applies = row.modes == 0 || (row.modes == modes && row.block == block);
    if (row.part != "throughput" || !row.who.starts_with(peer) || !applies) continue;
    if (best == nullptr || !best->ok() || (row.ok() && row.modes_per_core > best->modes_per_core)) best = &row;
  }
  return best;
}

// What was not asked for or is not installed counts neither way; what failed is a promise missed.
Promise without_value(const std::string& what, const Row* row) {
  if (row == nullptr) return {what + ": not measured", Promise::kNotMeasured};
  return {what + ": " + row->status, row->status == "not installed" ? Promise::kNotMeasured : Promise::kMissed};
}

Promise ratio(const Rows& rows, const std::string& peer, std::size_t modes, std::size_t block, double least) {
  const Row* other = best_of(rows, peer, modes, block);
  const Row* ours = find(rows, "throughput", [&](const Row& row) {
    return row.who == "ours" && row.modes == modes && row.objects == 1 && row.block == block;
  });
  const std::string what = std::to_string(modes) + " modes, block " + std::to_string(block) +
                           ": times the modes per core of " + (other ? other->who : peer);
  for (const Row* row : {ours, other}) {
    if (row == nullptr || !row->ok()) return without_value(what, row);
  }
  return at_least(what, other->ratio, least);
}

void add_ratios(std::vector<Promise>& list, const Rows& rows) {
  struct Least {
    std::size_t modes, block;
    double faust, klank;
  };
  for (const Least& least : {Least{10000, 128, 20, 40}, Least{10000, 64, 15, 30}, Least{1000, 128, 10, 10},
                             Least{1000, 64, 10, 10}, Least{100, 128, 10, 10}, Least{100, 64, 10, 10}}) {
    list.push_back(ratio(rows, "faust", least.modes, least.block, least.faust));
    list.push_back(ratio(rows, "klank", least.modes, least.block, least.klank));
  }
}

Promise most(const std::string& what, const Row* row, double Row::*value, double limit, const char* unit) {
  return row != nullptr && row->ok() ? at_most(what, row->*value, limit, unit) : without_value(what, row);
}

Promise least(const std::string& what, const Row* row, double limit) {
  return row != nullptr && row->ok() ? at_least(what, row->ratio, limit) : without_value(what, row);
}

Promise error(const Rows& rows, const std::string& who, double time_s, const char* time) {
  const Row* row = find(rows, "accuracy", [&](const Row& r) { return r.who == who && r.time_s == time_s; });
  return most(who + ": error of the sum of 2000 modes after " + time, row, &Row::error_db, -110, " dB");
}

Promise load(const Rows& rows) {
  const Row* row = find(rows, "storm", is("ours"));
  const std::string what = "10000 strikes a second on 1000 objects: load";
  if (row == nullptr || !row->ok()) return without_value(what, row);
  return at_most(what, row->mean_us * 1e-6 * kRate / static_cast<double>(row->block), 1, "");
}

// The share of a core that a head takes, beside the ambisonic channels that it hears.
Promise binaural(const Rows& rows) {
  const Row *ears = find(rows, "fields", is("binaural")), *field = find(rows, "fields", is("ambisonics 3"));
  const std::string what = "binaural beside ambisonics of order 3: percent of a core";
  for (const Row* row : {ears, field}) {
    if (row == nullptr || !row->ok()) return without_value(what, row);
  }
  const double block_us = static_cast<double>(ears->block) / kRate * 1e6;
  return at_most(what, 100 * (ears->mean_us - field->mean_us) / block_us, 2, "");
}

// What contacts that touch cost above the same modes ringing freely.
Promise above_free(const Rows& rows) {
  const Row *touching = find(rows, "two-way", is("touching")), *free = find(rows, "two-way", is("free"));
  const std::string what = "16 two-way contacts of 200 + 200 modes with friction: share of a core above ringing freely";
  for (const Row* row : {touching, free}) {
    if (row == nullptr || !row->ok()) return without_value(what, row);
  }
  return at_most(what, touching->ratio - free->ratio, 0.15, "");
}

}  // namespace

std::vector<Promise> promises(const Rows& rows) {
  std::vector<Promise> list;
  add_ratios(list, rows);
  list.push_back(error(rows, "ours: mixer", 1, "1 s"));
  list.push_back(error(rows, "ours: mixer", 600, "10 min"));
  list.push_back(most("1000 silent objects: block", find(rows, "silence", is("ours")), &Row::mean_us, 1, " us"));
  list.push_back(load(rows));
  for (const char* range : {"denormal float", "denormal double"}) {
    list.push_back(most("1000 modes, " + std::string(range) + ": block time over loud", find(rows, "tail", is(range)),
                        &Row::ratio, 1.1, ""));
  }
  list.push_back(least("two banks: block time over that of 1000 instances that share their states",
                       find(rows, "instances", is("two banks")), 0.9));
  list.push_back(least("10000 modes in 100 objects that turn: modes per core over those of objects that stand",
                       find(rows, "directions", is("turning")), 0.8));
  list.push_back(most("10000 modes in 100 objects in ambisonics of order 3: block time over stereo",
                      find(rows, "fields", is("ambisonics 3")), &Row::ratio, 1.25, ""));
  list.push_back(binaural(rows));
  list.push_back(most("16 two-way contacts of 200 + 200 modes with friction: share of a core",
                      find(rows, "two-way", is("touching")), &Row::ratio, 0.3, ""));
  list.push_back(above_free(rows));
  list.push_back(most("10000 modes in 100 objects that glide: block time over linear",
                      find(rows, "nonlinear", is("gliding")), &Row::ratio, 1.03, ""));
  list.push_back(most("10000 modes in 100 objects with nonlinear terms, calm: block time over linear",
                      find(rows, "nonlinear", is("calm")), &Row::ratio, 1.03, ""));
  list.push_back(most("50 modes that exchange energy by 30 functions: share of a core",
                      find(rows, "nonlinear", is("M 50, K 30")), &Row::ratio, 0.3, ""));
  list.push_back(most("64 modes that exchange energy by 50 functions: share of a core",
                      find(rows, "nonlinear", is("M 64, K 50")), &Row::ratio, 0.5, ""));
  list.push_back(most("10000 modes in 100 objects behind libringdown: block time over the mixer's",
                      find(rows, "library", is("libringdown")), &Row::ratio, 1.05, ""));
  const auto two_threads = [](const Row& row) { return row.who == "2 threads" && row.objects == 100; };
  list.push_back(least("30000 modes in 100 objects: block time of 1 thread over that of 2",
                       find(rows, "threads", two_threads), 1.7));
  return list;
}

}  // namespace ringdown::bench
