// One kind of hostile input: how it is made, and what it is fed to.
//
// make() depends on nothing but the random numbers, so that an input is the same whatever came before. feed() accepts
// or refuses it; fuzz::expect() ends the process when something is wrong, as a crash does.
#pragma once

#include "tests/hostile/random.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::hostile {

class Attack {
 public:
  virtual ~Attack() = default;
  Attack() = default;
  Attack(const Attack&) = delete;
  Attack& operator=(const Attack&) = delete;

  [[nodiscard]] virtual std::string make(Random& random) = 0;
  // `random` goes on from where make() left it.
  virtual void feed(const std::string& input, Random& random) = 0;
  // Looks at what all inputs together have left behind.
  virtual void finish() {}
};

struct Kind {
  std::string name;
  double share = 1;       // of all inputs, before they are made to add up
  std::size_t slice = 0;  // inputs that one process is fed, which begins anew; 0: all
  std::unique_ptr<Attack> (*begin)(const std::string& name) = nullptr;
};

std::vector<Kind> reader_kinds();   // readers, each input by itself (reader_attacks.cpp)
std::vector<Kind> session_kinds();  // a session that plays meanwhile, by its interface (session_attacks.cpp)
std::vector<Kind> daemon_kinds();   // a daemon that plays meanwhile, by its ports (daemon_attacks.cpp)

}  // namespace ringdown::hostile
