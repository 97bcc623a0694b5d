#include "tests/bench/modal/machine.h"

#include <cblas.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <thread>

namespace ringdown::bench {
namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown processor";
}

// "OpenBLAS 0.3.21 ..." -> its first two words.
std::string blas() {
  std::istringstream config(openblas_get_config());
  std::string name, version;
  config >> name >> version;
  return name + " " + version + " (" + openblas_get_corename() + ")";
}

}  // namespace

std::string this_machine() {
  const unsigned cores = std::thread::hardware_concurrency();
  std::string text = processor() + "; " + std::to_string(cores) + (cores == 1 ? " core; " : " cores; ") + blas();
  std::replace(text.begin(), text.end(), ',', ' ');
  return text;
}

}  // namespace ringdown::bench
