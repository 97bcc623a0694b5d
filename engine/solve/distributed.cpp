#include "engine/solve/distributed.h"

#include "engine/base/folders.h"
#include "engine/solve/distributed_files.h"
#include "engine/solve/methods.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <unistd.h>

namespace ringdown::solve {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "ringdown-modes-slepc";
constexpr int kRigidRoom = 600;  // the program also counts rigid motions; solve_modes() counts again without them

// Views the columns of a symmetric matrix as its rows.
SparseView view_of(const fem::SparseMatrix& matrix) {
  const auto rows = static_cast<std::size_t>(matrix.rows()), entries = static_cast<std::size_t>(matrix.nonZeros());
  return {{matrix.outerIndexPtr(), rows + 1}, {matrix.innerIndexPtr(), entries}, {matrix.valuePtr(), entries}};
}

Result<void> write_system(const fs::path& path, const fem::System& system, const EigenRequest& request) {
  const fem::SparseMatrix stiffness = system.stiffness.selfadjointView<Eigen::Lower>();
  const ProblemHeader header{.nodes = system.node_mass.rows(),
                             .stiffness_entries = stiffness.nonZeros(),
                             .mass_entries = system.node_mass.nonZeros(),
                             .highest_lambda = request.highest_lambda,
                             .tolerance = request.tolerance,
                             .max_modes = request.max_modes + kRigidRoom};
  return write_problem(path, header, view_of(stiffness), view_of(system.node_mass));
}

// Without these options and variables, mpirun starts no more processes than there are cores, and nothing for root. Each
// process has one thread, because there are already many processes.
ChildRequest command_for(const fs::path& program, const DistributedRun& run) {
  ChildRequest child;
  child.environment = {{"OPENBLAS_NUM_THREADS", "1"}, {"OMP_NUM_THREADS", "1"}};
  if (run.processes > 1) {
    child.command = {"mpirun", "--oversubscribe", "-n", std::to_string(run.processes)};
    if (::geteuid() == 0) {
      child.environment.insert({{"OMPI_ALLOW_RUN_AS_ROOT", "1"}, {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"}});
    }
  }
  child.command.push_back(program.string());
  child.limit_s = run.limit_s;
  return child;
}

// Reads the program's lines, which are "STAGE FRACTION".
struct Watcher {
  const Progress& progress;
  std::string stage = "factors";
  double fraction = 0;

  void read(std::string_view line) {
    const std::size_t blank = line.find(' ');
    if (blank == std::string_view::npos) return;
    stage = line.substr(0, blank);
    fraction = std::min(0.99, std::max(0.0, std::atof(std::string(line.substr(blank + 1)).c_str())));
  }
  [[nodiscard]] bool go_on() const { return !progress || progress(stage, fraction); }
};

// The reason of a failure: the program's own error line, or else the last line of output.
std::string reason_of(const ChildOutcome& outcome) {
  const std::string mark = std::string(kProgram) + ": ";
  const std::size_t said = outcome.errors.find(mark);
  if (said == std::string::npos) {
    const std::string last = last_line(outcome.errors);
    return formatted("ended with exit code {}{}", outcome.exit_code, last.empty() ? "" : ": " + last);
  }
  const std::size_t start = said + mark.size();
  return outcome.errors.substr(start, outcome.errors.find('\n', start) - start);
}

}  // namespace

Result<DistributedModes> run_distributed(const fem::System& system, const EigenRequest& request,
                                         const DistributedRun& run, const Progress& progress) {
  const Result<fs::path> program = find_beside(kProgram);
  if (!program)
    return fail(program.error().kind,
                program.error().message + "; it is built where SLEPc is installed (libslepc-real-dev)");
  const PrivateFolder folder("ringdown-modes");
  if (folder.path().empty())
    return fail(ErrorKind::input_output, std::string("cannot make a temporary folder: ") + std::strerror(errno));
  const fs::path problem = folder.path() / "problem", answer = folder.path() / "modes";
  Watcher watcher{progress};
  if (!watcher.go_on()) throw Cancelled{};
  if (auto written = write_system(problem, system, request); !written) return fail(written);

  ChildRequest child = command_for(*program, run);
  child.command.insert(child.command.end(), {problem.string(), answer.string()});
  child.command.insert(child.command.end(), run.options.begin(), run.options.end());
  child.on_line = [&](std::string_view line) { watcher.read(line); };
  child.keep_going = [&] { return watcher.go_on(); };
  const Result<ChildOutcome> outcome = run_child(child);
  if (!outcome)
    return fail(outcome.error().kind, outcome.error().message + (run.processes > 1 ? "; install openmpi-bin" : ""));
  if (outcome->stopped) throw Cancelled{};
  if (outcome->out_of_time) return fail(ErrorKind::refused, "SLEPc took longer than its limit");
  if (outcome->exit_code != 0) return fail(ErrorKind::refused, "SLEPc: " + reason_of(*outcome));

  const Result<ModesFile> file = read_modes(answer, system.node_mass.rows());
  if (!file) return fail(file);
  const auto count = static_cast<Eigen::Index>(file->lambda.size());
  DistributedModes found{{}, *outcome};
  found.modes.lambda = Eigen::Map<const Eigen::VectorXd>(file->lambda.data(), count);
  found.modes.shapes = Eigen::Map<const Eigen::MatrixXd>(file->shapes.data(), system.unknowns(), count);
  found.modes.solves = static_cast<int>(file->header.solves);
  found.modes.factorizations = static_cast<int>(file->header.factorizations);
  found.modes.factor_seconds = file->header.factor_seconds;
  found.modes.iterate_seconds = file->header.iterate_seconds;
  return found;
}

Result<Eigenmodes> solve_slepc(const fem::System& system, const EigenRequest& request, const Progress& progress) {
  Result<DistributedModes> found =
      run_distributed(system, request, {.processes = std::max(1, request.processes)}, progress);
  if (!found) return fail(found);
  found->modes.counted = static_cast<int>(found->modes.lambda.size());  // the program checked it, by MUMPS's inertia
  return std::move(found->modes);
}

}  // namespace ringdown::solve
