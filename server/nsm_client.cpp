#include "server/nsm_client.h"

#include "protocol/wire/codec.h"
#include "server/log.h"

#include <cstdlib>
#include <utility>
#include <unistd.h>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using wire::Message;

constexpr std::int32_t kVersionMajor = 1, kVersionMinor = 0;
constexpr std::int32_t kGeneralError = -1, kSaveFailed = -9;

}  // namespace

std::optional<std::string> NsmClient::url() {
  const char* url = std::getenv("NSM_URL");
  return url && *url ? std::optional<std::string>(url) : std::nullopt;
}

Result<std::unique_ptr<NsmClient>> NsmClient::announce(const std::string& url, std::chrono::milliseconds patience) {
  const auto parsed = wire::parse_url(url);
  if (!parsed) return fail("NSM_URL", parsed);
  const auto manager = wire::resolve(parsed->host, parsed->port);
  if (!manager) return fail("NSM_URL", manager);
  // A manager may name this computer by an address that the loopback does not reach.
  auto socket = wire::OscSocket::bind({.address = manager->address, .interface = manager->interface});
  if (!socket)
    return fail(socket.error().kind,
                "NSM_URL: the session manager must run on this computer: " + socket.error().message);
  if (!manager->is_loopback()) {
    log_warning("listening on " + to_text(socket->endpoint()) +
                " for the session manager: anyone who can reach this address can send its messages");
  }
  std::unique_ptr<NsmClient> client(new NsmClient(std::move(*socket), *manager));
  client->send({"/nsm/server/announce", {"Ringdown", "", "ringdownd", kVersionMajor, kVersionMinor, ::getpid()}});
  if (const auto opened = client->wait_for_session(patience); !opened) return fail(opened);
  return client;
}

NsmClient::NsmClient(wire::OscSocket socket, wire::Endpoint manager) : socket_(std::move(socket)), manager_(manager) {}

NsmClient::~NsmClient() {
  if (!save_ && !session_.client_id.empty()) {
    answer("/nsm/client/open", fail(ErrorKind::refused, "ringdownd could not start; its own messages say why"));
  }
  stop();
}

void NsmClient::stop() {
  thread_.request_stop();
  socket_.wake();
  if (thread_.joinable()) thread_.join();
}

Result<void> NsmClient::wait_for_session(std::chrono::milliseconds patience) {
  const auto end = Clock::now() + patience;
  while (Clock::now() < end) {
    const auto request = receive(100ms);
    if (!request || request->kind == NsmRequest::Kind::save) continue;
    if (!request->session) return fail(request->session);
    session_ = *request->session;
    return {};
  }
  return fail(ErrorKind::refused, "the session manager at " + to_text(manager_) + " (NSM_URL) opened no session");
}

std::optional<NsmRequest> NsmClient::receive(std::chrono::milliseconds patience) {
  wire::Datagram datagram;
  if (!socket_.receive(datagram, patience) || datagram.from.port != manager_.port) return std::nullopt;
  return parse_nsm(datagram.bytes);
}

void NsmClient::start(std::function<void(const Done&)> save) {
  save_ = std::move(save);
  answer("/nsm/client/open", {});
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void NsmClient::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const auto request = receive(1s);
    if (!request) continue;
    if (request->kind == NsmRequest::Kind::save) {
      save_([this](const Result<void>& outcome) { answer("/nsm/client/save", outcome); });
    } else if (request->kind == NsmRequest::Kind::open) {
      answer("/nsm/client/open",
             fail(ErrorKind::refused, "ringdownd changes no session while it runs; start another one"));
    }
  }
}

void NsmClient::answer(const std::string& address, const Result<void>& outcome) {
  if (outcome) return send({"/reply", {address, "OK"}});
  log_warning(address + ": " + outcome.error().message);
  send({"/error", {address, address == "/nsm/client/save" ? kSaveFailed : kGeneralError, outcome.error().message}});
}

void NsmClient::send(const Message& message) { static_cast<void>(socket_.send_to(manager_, wire::encode(message))); }

}  // namespace ringdown::server
