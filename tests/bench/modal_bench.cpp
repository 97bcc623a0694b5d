// Modal analysis against exact values and against other programs: how far off, how long, how much memory.
//
//   ringdown_modal_bench -o build/bench/modal.csv [--gate] [--quick] [--only PART] [--case BODY] [--limit S] [--resume]
//                        [--object FILE] [--bank FILE] [--all] [--by-mode FILE]
//
// `./run bench modal` runs it; docs/how/benchmarks.md reads it. Every measurement is a process of its own (this program
// with `single`), held to as many cores as its row says, so that times and peak memory are its alone. The CSV is
// written again after each one: a run that is cut short is taken up by --resume.
#include "engine/base/content_cache.h"
#include "engine/base/process/child_process.h"
#include "tests/bench/machine.h"
#include "tests/bench/modal/amplitude.h"
#include "tests/bench/modal/methods.h"
#include "tests/bench/modal/plan.h"

#include <CLI/CLI.hpp>
#include <cblas.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <fstream>
#include <sstream>

namespace {

using namespace ringdown;
namespace fs = std::filesystem;

struct Arguments {
  fs::path output = "modal.csv";
  std::vector<std::string> only, cases;
  bool gate = false, quick = false, resume = false;
  double limit_s = 900;
  bench::AmplitudePlan amplitude;
  // of a measuring process
  bool single = false;
  bench::Spec spec;
  fs::path frequencies, reference;

  [[nodiscard]] fs::path folder() const { return output.parent_path() / (output.stem().string() + "-runs"); }
  [[nodiscard]] fs::path file_of(const bench::Spec& of, const char* extension) const {
    return folder() / (of.key() + extension);
  }
};

void add_options(CLI::App& app, Arguments& a) {
  app.add_option("-o,--output", a.output, "the CSV to write; files of single measurements lie beside it");
  app.add_flag("--gate", a.gate, "exit with 1 when a promise is missed");
  app.add_flag("--quick", a.quick, "small meshes: shows that everything runs, promises nothing");
  app.add_option("--only", a.only, "parts: default agreement peers threads many memory choice series growth amplitude");
  app.add_option("--case", a.cases, "bodies: block plate sphere bell soft-block bar");
  app.add_option("--limit", a.limit_s, "seconds each measurement may take (default 900)");
  app.add_flag("--resume", a.resume, "keep what an earlier run measured");
  app.add_option("--object", a.amplitude.objects, "amplitude: object files instead of six presets");
  app.add_flag("--all", a.amplitude.all, "amplitude: all presets");
  app.add_option("--bank", a.amplitude.bank, "amplitude: a bank of the object to measure beside the one that is baked");
  app.add_option("--points", a.amplitude.max_points, "amplitude: surface points of baked banks; several make a series");
  app.add_flag("--compress", a.amplitude.compress, "amplitude: baked banks are compressed, as the presets are");
  app.add_option("--by-mode", a.amplitude.by_mode, "amplitude: a .tsv to write with a line for each mode");
  app.add_option("--cache", a.amplitude.cache, "amplitude: folder of solutions (default: that of ringdown-bake)");
  CLI::App* single = app.add_subcommand("single", "one measurement, in this process")->group("");
  single->add_option("--body", a.spec.body);
  single->add_option("--mesh", a.spec.mesh);
  single->add_option("--element", a.spec.element);
  single->add_option("--method", a.spec.method);
  single->add_option("--threads", a.spec.threads);
  single->add_option("--top", a.spec.top_hz);
  single->add_option("--expected", a.spec.expected);
  single->add_option("--limit", a.limit_s);
  single->add_option("--frequencies", a.frequencies);
  single->add_option("--reference", a.reference);
}

// "OpenBLAS 0.3.21 (SkylakeX)": of OpenBLAS's long description the first two words, and the kernels it chose.
std::string blas() {
  std::istringstream config(openblas_get_config());
  std::string name, version;
  config >> name >> version;
  return name + " " + version + " (" + openblas_get_corename() + ")";
}

int measure_here(const Arguments& a) {
  bench::hold_to_cores(a.spec.threads);
  const auto reference = a.reference.empty() ? std::vector<double>{} : bench::read_frequencies(a.reference);
  std::fputs(to_lines(bench::measure(a.spec, a.limit_s, a.frequencies, reference)).c_str(), stdout);
  return 0;
}

bench::Measurement measure_in_a_child(const Arguments& a, const bench::Spec& spec) {
  bench::Measurement failed{.spec = spec};
  if (!bench::installed(spec.method)) return failed.status = bench::Status::kNotInstalled, failed;
  std::string said;
  const fs::path reference = spec.body == "bell" ? a.file_of(bench::bell_reference(a.quick), ".hz") : fs::path();
  const std::string threads = std::to_string(spec.threads);
  ChildRequest child{.command = {fs::read_symlink("/proc/self/exe").string(),
                                 "single",
                                 "--body",
                                 spec.body,
                                 "--mesh",
                                 spec.mesh,
                                 "--element",
                                 spec.element,
                                 "--method",
                                 spec.method,
                                 "--threads",
                                 threads,
                                 "--top",
                                 std::to_string(spec.top_hz),
                                 "--expected",
                                 std::to_string(spec.expected),
                                 "--limit",
                                 std::to_string(a.limit_s),
                                 "--frequencies",
                                 a.file_of(spec, ".hz").string()},
                     .environment = {{"OPENBLAS_NUM_THREADS", threads}, {"OMP_NUM_THREADS", threads}},
                     .limit_s = 1.2 * a.limit_s + 60,  // a peer's own limit ends it first; meshing is not its time
                     .on_line = [&](std::string_view line) { said.append(line).append("\n"); }};
  if (!reference.empty()) child.command.insert(child.command.end(), {"--reference", reference.string()});
  const auto run = run_child(child);
  if (!run) return failed.complaint = run.error().message, failed;
  if (run->out_of_time) {
    failed.status = bench::Status::kOverLimit;
    failed.seconds = a.limit_s;
    return failed;
  }
  const auto measured = bench::from_lines(said, spec);
  if (measured) return *measured;
  failed.complaint = run->exit_code == 0
                         ? measured.error().message
                         : "exit code " + std::to_string(run->exit_code) + ", " + last_line(run->errors);
  return failed;
}

void show(const bench::Measurement& m) {
  const bench::Spec& s = m.spec;
  std::printf("%-10s %-9s %-7s %-13s %d thread%s ", s.body.c_str(), s.mesh.c_str(), s.element.c_str(), s.method.c_str(),
              s.threads, s.threads == 1 ? " " : "s");
  switch (m.status) {
    case bench::Status::kNotInstalled:
      std::printf("not installed\n");
      break;
    case bench::Status::kFailed:
      std::printf("failed: %s\n", m.complaint.c_str());
      break;
    case bench::Status::kOverLimit:
      std::printf("> %.0f s\n", m.seconds);
      break;
    case bench::Status::kDone:
      std::printf("%7ld unknowns %5ld modes %8.2f s %7.0f MiB", m.unknowns, m.modes, m.seconds, m.peak_mib);
      if (m.error_10 >= 0) std::printf("  errors %.4f %%", m.error_10);
      if (m.error_50 >= 0) std::printf(" %.4f %%", m.error_50);
      std::printf("\n");
  }
  std::fflush(stdout);
}

bool chosen(const std::vector<std::string>& names, const std::string& name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

bool wanted(const Arguments& a, const bench::Spec& planned) {
  return chosen(a.only, planned.part) && chosen(a.cases, planned.body);
}

std::string whole_file(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// What an earlier run wrote; a failure is tried again.
const bench::Measurement* take_earlier(const Arguments& a, const bench::Spec& spec, bench::Measurements& all) {
  const auto earlier = bench::from_lines(whole_file(a.file_of(spec, ".txt")), spec);
  if (!earlier || earlier->status == bench::Status::kFailed || earlier->status == bench::Status::kNotInstalled) {
    return nullptr;
  }
  return &(all[spec.key()] = *earlier);
}

// Peers are asked for as many modes as ours found, and one for each rigid motion.
int expected_modes(const bench::Measurements& all, const bench::Spec& spec) {
  const bench::Measurement* ours = find(all, spec.by("ours"));
  return ours == nullptr ? 0 : static_cast<int>(ours->modes) + 6;
}

bool needs_ours(const bench::Spec& spec) { return spec.method != "ours" && spec.method != "bake"; }

// False when the CSV could not be written.
bool save(const Arguments& a, const std::vector<bench::Spec>& plan, bench::Measurements& all) {
  compare(all, a.folder());
  const auto written = write_csv(a.output, plan, all, bench::this_machine(blas()));
  if (!written) std::fprintf(stderr, "%s\n", written.error().message.c_str());
  return written.has_value();
}

// What is not chosen is taken from an earlier run, so that a table can be made in parts.
bool measure_all(const Arguments& a, const std::vector<bench::Spec>& plan, bench::Measurements& all) {
  for (const bench::Spec& planned : plan) {
    bench::Spec spec = planned;
    const bool due = wanted(a, planned);
    const bool kept = (a.resume || !due) && take_earlier(a, spec, all) != nullptr;
    if (kept || !due || find(all, spec) != nullptr) continue;
    spec.expected = needs_ours(spec) ? expected_modes(all, spec) : 0;
    bench::Measurement measured{.spec = spec, .complaint = "ours, which tells the number of modes, was not measured"};
    if (!needs_ours(spec) || spec.expected > 6) measured = measure_in_a_child(a, spec);
    show(all[spec.key()] = measured);
    std::ofstream(a.file_of(spec, ".txt")) << to_lines(measured);
    if (!save(a, plan, all)) return false;
  }
  return save(a, plan, all);
}

// False when there is something that could not be measured.
bool measure_strikes(const Arguments& a, std::vector<bench::Promise>& promises) {
  bench::AmplitudePlan plan = a.amplitude;
  plan.quick = a.quick;
  plan.folder = a.folder();
  plan.csv = a.output.parent_path() / (a.output.stem().string() + "-amplitude.csv");
  if (plan.cache.empty()) plan.cache = cache_folder().value_or(a.folder() / "cache");
  const auto measured = bench::measure_amplitudes(plan);
  if (measured) {
    promises.insert(promises.end(), measured->begin(), measured->end());
  } else {
    std::fprintf(stderr, "%s\n", measured.error().message.c_str());
  }
  return measured.has_value();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures modal analysis against exact values and other programs.", "ringdown_modal_bench");
  Arguments arguments;
  add_options(app, arguments);
  CLI11_PARSE(app, argc, argv);
  if (app.got_subcommand("single")) return measure_here(arguments);
  std::error_code error;
  fs::create_directories(arguments.folder(), error);
  std::vector<bench::Spec> plan = bench::plan(arguments.quick);
  bench::Measurements all;
  if (!measure_all(arguments, plan, all)) return 1;
  std::erase_if(plan, [&](const bench::Spec& planned) { return !wanted(arguments, planned); });
  std::vector<bench::Promise> list = promises(plan, all, arguments.quick);
  if (chosen(arguments.only, "amplitude") && !measure_strikes(arguments, list)) return 1;
  const bool kept = bench::report(list);
  std::printf("\n%s\n", arguments.output.c_str());
  return arguments.gate && !kept ? 1 : 0;
}
