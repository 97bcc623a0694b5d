#include "clients/viewer/local_daemon.h"

#include "engine/base/child_process.h"

#include <atomic>
#include <future>
#include <thread>

namespace ringdown::viewer {
namespace {

constexpr std::string_view kReady = "ready: OSC on ";

}  // namespace

struct LocalDaemon::State {
  std::string url;
  std::atomic<bool> stop = false;
  std::promise<Result<std::string>> ready;
  bool told = false;  // thread
  std::string last_line;
  std::jthread thread;

  ~State() {
    stop = true;
    if (thread.joinable()) thread.join();
  }

  void tell(Result<std::string> outcome) {
    if (!std::exchange(told, true)) ready.set_value(std::move(outcome));
  }

  void take_line(std::string_view line) {
    last_line = line;
    const auto at = line.find(kReady);
    if (at == line.npos) return;
    const std::string_view rest = line.substr(at + kReady.size());
    tell("osc.udp://" + std::string(rest.substr(0, rest.find(','))));
  }

  void run(const std::filesystem::path& program, const std::filesystem::path& scene) {
    // Its log is on the standard error, and run_child() hands out lines of the standard output.
    const auto done = run_child({.command = {"/bin/sh", "-c", "exec \"$0\" \"$@\" 2>&1", program.string(), "--driver",
                                             "null", "--port", "0", "--scene", scene.string()},
                                 .on_line = [this](std::string_view line) { take_line(line); },
                                 .keep_going = [this] { return !stop; }});
    tell(done ? fail(ErrorKind::refused, last_line) : fail(done.error()));
  }
};

LocalDaemon::LocalDaemon(std::unique_ptr<State> state) : state_(std::move(state)) {}
LocalDaemon::LocalDaemon(LocalDaemon&&) noexcept = default;
LocalDaemon& LocalDaemon::operator=(LocalDaemon&&) noexcept = default;
LocalDaemon::~LocalDaemon() = default;

const std::string& LocalDaemon::url() const { return state_->url; }

Result<LocalDaemon> LocalDaemon::start(const std::filesystem::path& scene) {
  const auto program = find_beside("ringdownd");
  if (!program) return fail(program.error());
  auto state = std::make_unique<State>();
  auto ready = state->ready.get_future();
  state->thread = std::jthread([&own = *state, program = *program, scene] { own.run(program, scene); });
  auto url = ready.get();
  if (!url) return fail(url.error());
  state->url = *url;
  return LocalDaemon(std::move(state));
}

}  // namespace ringdown::viewer
