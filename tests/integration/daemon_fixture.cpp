#include "tests/integration/daemon_fixture.h"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <sys/file.h>
#include <unistd.h>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;

// Without a time budget unless it is what is tested: on a busy machine, what is recorded would lack what there was no
// time for.
std::vector<std::string> daemon_command(std::vector<std::string> arguments) {
  if (std::ranges::find(arguments, "--budget") == arguments.end()) {
    arguments.insert(arguments.begin(), {"--budget", "0"});
  }
  arguments.insert(arguments.begin(), {program("ringdownd"), "--port", "0"});
  return arguments;
}

// Waits for the lock on this file. Programs that a test starts later hold it too: it is free when the last of them has
// ended.
int lock(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT, 0600);
  if (descriptor < 0) throw std::runtime_error("cannot open " + file.string());
  while (::flock(descriptor, LOCK_EX) != 0) {
    if (errno != EINTR) throw std::runtime_error("cannot lock " + file.string());
  }
  return descriptor;
}

}  // namespace

JackServer::JackServer(int sample_rate_hz, int period_frames, Mode mode)
    : lock_(lock(std::filesystem::temp_directory_path() / (name() + "-of-" + std::to_string(::getuid()) + ".lock"))),
      mode_(mode) {
  start(sample_rate_hz, period_frames);
}

JackServer::~JackServer() {
  server_.reset();
  ::close(lock_);
}

// Port limit: jackd's default wants 107 MB of shared memory, more than many containers have.
void JackServer::start(int sample_rate_hz, int period_frames) {
  std::vector<std::string> command{"jackd", "--name", name(), "--port-max", "128"};
  if (mode_ == Mode::realtime) {
    command.emplace_back("--realtime");
  } else {
    command.insert(command.end(), {"--no-realtime", "--sync", "--timeout", "10000"});
  }
  command.insert(command.end(),
                 {"-d", "dummy", "-r", std::to_string(sample_rate_hz), "-p", std::to_string(period_frames)});
  server_ = std::make_unique<Process>(command, Process::Environment{{"JACK_NO_AUDIO_RESERVATION", "1"}});
}

void JackServer::stop(int signal) {
  server_->send_signal(signal);
  server_->wait();
}

Process::Environment JackServer::environment() const {
  return {{"JACK_DEFAULT_SERVER", name()}, {"JACK_NO_START_SERVER", "1"}};
}

testing::AssertionResult JackServer::runs() {
  if (run({"jack_wait", "--server", name(), "--wait", "--timeout", std::to_string(kPatience.count())}).exit_code == 0) {
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << "no JACK server " << name() << ":\n" << server_->output();
}

std::map<std::string, std::set<std::string>> JackServer::connections() const {
  std::map<std::string, std::set<std::string>> found;
  std::istringstream lines(run({"jack_lsp", "-c"}, environment()).output);
  std::string line, port;
  while (std::getline(lines, line)) {
    if (line.starts_with("   ")) {
      found[port].insert(line.substr(3));
    } else {
      found[port = line];
    }
  }
  return found;
}

Daemon::Daemon(std::vector<std::string> arguments, const Process::Environment& environment)
    : process_(daemon_command(std::move(arguments)), environment), socket_(*wire::OscSocket::bind()) {
  const std::string announcement = "ready: OSC on ";
  if (!process_.wait_for_output(announcement)) return;
  const std::string output = process_.output();
  port_ = static_cast<std::uint16_t>(
      std::stoi(output.substr(output.find(':', output.find(announcement) + announcement.size()) + 1)));
}

void Daemon::send(const wire::Message& message) {
  static_cast<void>(socket_.send_to({.port = port_}, wire::encode(message)));
}

void Daemon::send_bundle(double unix_s, const std::vector<wire::Message>& messages) {
  static_cast<void>(socket_.send_to({.port = port_}, wire::encode_bundle(wire::time_tag(unix_s), messages)));
}

std::vector<protocol::Reply> Daemon::packet(std::chrono::milliseconds limit) {
  wire::Datagram datagram;
  if (!socket_.receive(datagram, limit)) return {};
  const auto messages = wire::decode_packet(datagram.bytes);
  std::vector<protocol::Reply> replies;
  if (!messages) return replies;
  for (const auto& timed : *messages) {
    if (const auto reply = protocol::parse_reply(timed.message)) replies.push_back(*reply);
  }
  return replies;
}

std::optional<protocol::Reply> Daemon::reply(std::chrono::milliseconds limit) {
  const auto replies = packet(limit);
  return replies.empty() ? std::nullopt : std::optional(replies.front());
}

std::optional<protocol::Reply> Daemon::ask(const wire::Message& message) {
  send(message);
  return reply();
}

}  // namespace ringdown::test
