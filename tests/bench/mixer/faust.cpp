#include "tests/bench/mixer/faust.h"

#include "engine/base/process/child_process.h"
#include "tests/bench/mixer/row.h"

#include <algorithm>
#include <cmath>
#include <dlfcn.h>
#include <random>

namespace ringdown::bench {
namespace {

namespace fs = std::filesystem;

constexpr float kNoiseLevel = 1e-6f;
constexpr double kLimit_s = 300;

Result<void> run(const std::vector<std::string>& command) {
  const auto done = run_child({.command = command, .limit_s = kLimit_s});
  if (!done) return fail(done.error());
  if (done->out_of_time) return fail(ErrorKind::refused, command[0] + " took too long");
  if (done->exit_code != 0) return fail(ErrorKind::refused, command[0] + ": " + last_line(done->errors));
  return {};
}

Result<fs::path> compiled(int vector_size, const fs::path& folder) {
  const fs::path sources = fs::path(RINGDOWN_SOURCE_DIR) / "tests/bench/mixer";
  const fs::path stem = folder / ("faust_bank_" + std::to_string(vector_size));
  const std::string code = stem.string() + ".h", object = stem.string() + ".o", library = stem.string() + ".so";
  auto done = run(
      {"faust", "-vec", "-vs", std::to_string(vector_size), "-lang", "cpp", sources / "faust_bank.dsp", "-o", code});
  if (done) {
    done = run({"g++", "-O3", "-march=native", "-ffast-math", "-fPIC", "-fvisibility=hidden",
                "-DRINGDOWN_FAUST_BANK=\"" + code + "\"", "-c", sources / "faust_bank.cpp", "-o", object});
  }
  // Linked without -ffast-math, which would switch denormals off for the whole process.
  if (done) done = run({"g++", "-shared", object, "-o", library});
  if (!done) return fail(done.error());
  return fs::absolute(library);
}

template <class Function>
void look_up(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
}

}  // namespace

bool faust_installed() {
  return run_child({.command = {"faust", "--version"}}) && run_child({.command = {"g++", "--version"}});
}

Result<FaustCode> FaustCode::compile(int vector_size, const fs::path& folder) {
  const auto path = compiled(vector_size, folder);
  if (!path) return fail(path.error());
  void* library = ::dlopen(path->c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    return fail(ErrorKind::refused, "cannot load what g++ made of Faust's code: " + std::string(::dlerror()));
  FaustCode code;
  code.name_ = "faust -vec -vs " + std::to_string(vector_size);
  code.library_ = {library, [](void* loaded) { ::dlclose(loaded); }};
  look_up(library, "bank_new", code.make_);
  look_up(library, "bank_delete", code.remove_);
  look_up(library, "bank_compute", code.compute_);
  look_up(library, "bank_bytes", code.bytes_);
  return code;
}

FaustBanks::FaustBanks(const FaustCode& code, std::size_t modes, std::size_t block)
    : code_(code), noise_(256 * block), out_(block), sum_(block) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> level(-kNoiseLevel, kNoiseLevel);
  std::generate(noise_.begin(), noise_.end(), [&] { return level(random); });
  for (std::size_t m = 0; m < modes; m += FaustCode::kModes) banks_.push_back(code_.make_(static_cast<int>(kRate)));
}

FaustBanks::~FaustBanks() {
  for (void* bank : banks_) code_.remove_(bank);
}

void FaustBanks::render() {
  const std::size_t block = out_.size();
  std::fill(sum_.begin(), sum_.end(), 0.0f);
  for (void* bank : banks_) {
    code_.compute_(bank, static_cast<int>(block), noise_.data() + at_, out_.data());
    for (std::size_t n = 0; n < block; ++n) sum_[n] += out_[n];
  }
  at_ = (at_ + block) % noise_.size();
}

bool FaustBanks::rings() const {
  return std::all_of(sum_.begin(), sum_.end(), [](float x) { return std::isnormal(x); });
}

double FaustBanks::bytes_per_mode() const {
  return static_cast<double>(code_.bytes_()) / static_cast<double>(FaustCode::kModes);
}

}  // namespace ringdown::bench
