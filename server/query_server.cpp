#include "server/query_server.h"

#include "protocol/wire/endpoint.h"

#include <microhttpd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>
#include <poll.h>
#include <string_view>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <thread>
#include <utility>
#include <vector>

namespace ringdown::server {
namespace {

using SteadyTime = std::chrono::steady_clock::time_point;

constexpr std::size_t kAnswerBlock = 8192;  // bytes of an answer that are made at once
constexpr unsigned kLeaving = 16;           // connections that may be open beyond the maximum, until they are closed

// An open connection, and since when it has been receiving a request, or sending an answer, or waiting.
struct QueryClient {
  MHD_Connection* connection;
  int socket;
  SteadyTime since = std::chrono::steady_clock::now();
  bool cut = false;  // closed by us; the library has not noticed yet

  void cut_off() {
    ::shutdown(socket, SHUT_RDWR);
    cut = true;
  }
};

MHD_Result send_answer(MHD_Connection* connection, unsigned status, MHD_Response* answer) {
  const MHD_Result queued = MHD_queue_response(connection, status, answer);
  MHD_destroy_response(answer);  // the connection holds it as long as it is sent
  return queued;
}

MHD_Result send_empty(MHD_Connection* connection, unsigned status) {
  MHD_Response* const answer = MHD_create_response_from_buffer(0, nullptr, MHD_RESPMEM_PERSISTENT);
  if (!answer) return MHD_NO;
  if (status == MHD_HTTP_METHOD_NOT_ALLOWED) MHD_add_response_header(answer, MHD_HTTP_HEADER_ALLOW, "GET, HEAD");
  return send_answer(connection, status, answer);
}

ssize_t read_description(void* description, std::uint64_t, char* target, std::size_t max) noexcept {
  try {
    const std::size_t count = static_cast<Description*>(description)->read({target, max});
    return count > 0 ? static_cast<ssize_t>(count) : MHD_CONTENT_READER_END_OF_STREAM;
  } catch (const std::exception&) {
    return MHD_CONTENT_READER_END_WITH_ERROR;
  }
}

void free_description(void* description) { delete static_cast<Description*>(description); }

MHD_Result send_description(MHD_Connection* connection, Description description) {
  const std::size_t size = description.size();
  if (size == 0) return send_empty(connection, MHD_HTTP_NO_CONTENT);
  auto kept = std::make_unique<Description>(std::move(description));
  MHD_Response* const answer =
      MHD_create_response_from_callback(size, kAnswerBlock, read_description, kept.get(), free_description);
  if (!answer) return MHD_NO;
  static_cast<void>(kept.release());  // free_description() frees it
  MHD_add_response_header(answer, MHD_HTTP_HEADER_CONTENT_TYPE, "application/json");
  return send_answer(connection, MHD_HTTP_OK, answer);
}

bool has_body(MHD_Connection* connection) {
  const char* const length = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_CONTENT_LENGTH);
  return (length && std::string_view(length) != "0") ||
         MHD_lookup_connection_value(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_TRANSFER_ENCODING);
}

// The name of the first parameter after the '?', which OSCQuery takes for an attribute.
std::string first_parameter(MHD_Connection* connection) {
  std::string name;
  const auto take = [](void* target, MHD_ValueKind, const char* key, const char*) noexcept {
    if (key) *static_cast<std::string*>(target) = std::string(key, std::min<std::size_t>(std::strlen(key), 64));
    return MHD_NO;  // no more of them
  };
  MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, take, &name);
  return name;
}

// Neither the kernel's listen() nor the library's start says more than errno does; the library may leave it at 0.
Error no_service(const wire::Endpoint& endpoint, int reason) {
  return {ErrorKind::input_output, formatted("cannot serve OSCQuery on {}: {}", to_text(endpoint),
                                             reason == 0 ? "the HTTP library does not start" : std::strerror(reason))};
}

}  // namespace

struct QueryServer::Impl {
  About about;
  MHD_Daemon* http = nullptr;
  int epoll = -1;                    // the library's
  wire::Descriptor second_listener;  // of the other version of IP; the library has the first
  wire::Descriptor waker{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  std::uint16_t port = 0;
  std::vector<QueryClient> clients;  // in the order of coming
  std::jthread thread;

  MHD_Result answer(MHD_Connection* connection, const char* path, std::string_view method, bool first_call);
  void note_change(MHD_Connection* connection, MHD_ConnectionNotificationCode change);
  void note_step(MHD_Connection* connection);
  void accept_second();
  void cut_off_slow();
  void run(const std::stop_token& stop);
};

QueryServer::QueryServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

QueryServer::~QueryServer() {
  impl_->thread.request_stop();
  ::eventfd_write(impl_->waker.get(), 1);
  if (impl_->thread.joinable()) impl_->thread.join();
  MHD_stop_daemon(impl_->http);
}

std::uint16_t QueryServer::port() const { return impl_->port; }

Result<std::unique_ptr<QueryServer>> QueryServer::listen(std::uint16_t port, About about) {
  const auto endpoint = wire::resolve(about.address, port);
  if (!endpoint) return fail(endpoint);
  auto listeners = wire::bind_for_server(*endpoint, SOCK_STREAM | SOCK_NONBLOCK, "OSCQuery");
  if (!listeners) return fail(listeners);
  auto impl = std::make_unique<Impl>();
  if (!impl->waker.is_open()) return fail(no_service(listeners->endpoint, errno));
  impl->about = std::move(about);
  impl->port = listeners->endpoint.port;
  wire::Descriptor first = std::move(listeners->ipv4);
  impl->second_listener = std::move(listeners->ipv6);
  if (!first.is_open()) std::swap(first, impl->second_listener);
  for (const int listener : {first.get(), impl->second_listener.get()}) {
    if (listener >= 0 && ::listen(listener, SOMAXCONN) != 0) return fail(no_service(listeners->endpoint, errno));
  }

  // The library calls these on the thread that runs it, which is ours, and they throw nothing into it.
  const auto answer = [](void* self, MHD_Connection* connection, const char* path, const char* method, const char*,
                         const char*, std::size_t*, void** state) noexcept {
    try {
      return static_cast<Impl*>(self)->answer(connection, path, method, std::exchange(*state, self) == nullptr);
    } catch (const std::exception&) {
      return MHD_NO;  // the connection is closed
    }
  };
  const auto changed = [](void* self, MHD_Connection* connection, void**, MHD_ConnectionNotificationCode change) {
    static_cast<Impl*>(self)->note_change(connection, change);
  };
  const auto completed = [](void* self, MHD_Connection* connection, void**, MHD_RequestTerminationCode) {
    static_cast<Impl*>(self)->note_step(connection);
  };
  impl->clients.reserve(kMaxQueryConnections + kLeaving);
  errno = 0;
  impl->http = MHD_start_daemon(
      MHD_USE_EPOLL, port, nullptr, nullptr, +answer, impl.get(),                                    //
      MHD_OPTION_LISTEN_SOCKET, first.get(),                                                         //
      MHD_OPTION_CONNECTION_LIMIT, static_cast<unsigned>(kMaxQueryConnections) + kLeaving,           //
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, kMaxRequestBytes,                                          //
      MHD_OPTION_CONNECTION_TIMEOUT, kMaxQuerySilence_s,                                             //
      MHD_OPTION_NOTIFY_CONNECTION, static_cast<MHD_NotifyConnectionCallback>(changed), impl.get(),  //
      MHD_OPTION_NOTIFY_COMPLETED, static_cast<MHD_RequestCompletedCallback>(completed), impl.get(), MHD_OPTION_END);
  if (!impl->http) return fail(no_service(listeners->endpoint, errno));
  static_cast<void>(first.release());  // MHD_stop_daemon() closes it
  impl->epoll = MHD_get_daemon_info(impl->http, MHD_DAEMON_INFO_EPOLL_FD)->epoll_fd;
  impl->thread = std::jthread([impl = impl.get()](const std::stop_token& stop) { impl->run(stop); });
  return std::unique_ptr<QueryServer>(new QueryServer(std::move(impl)));
}

void QueryServer::Impl::run(const std::stop_token& stop) {
  constexpr int kLongest_ms = 500;  // between two looks for slow clients
  while (!stop.stop_requested()) {
    MHD_UNSIGNED_LONG_LONG soon_ms = kLongest_ms;
    if (MHD_get_timeout(http, &soon_ms) != MHD_YES) soon_ms = kLongest_ms;
    pollfd watched[] = {{waker.get(), POLLIN, 0}, {epoll, POLLIN, 0}, {second_listener.get(), POLLIN, 0}};
    ::poll(watched, std::size(watched), static_cast<int>(std::min<MHD_UNSIGNED_LONG_LONG>(soon_ms, kLongest_ms)));
    if (watched[2].revents != 0) accept_second();
    MHD_run(http);
    cut_off_slow();
  }
}

void QueryServer::Impl::accept_second() {
  wire::Accepted accepted = wire::accept_one(second_listener.get());
  if (accepted.out_of_descriptors) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  if (!accepted.socket.is_open()) return;
  const wire::SocketAddress from(accepted.from);
  // The library closes the socket, also when it refuses the connection.
  static_cast<void>(MHD_add_connection(http, accepted.socket.release(), from.generic(), from.size));
}

void QueryServer::Impl::note_change(MHD_Connection* connection, MHD_ConnectionNotificationCode change) {
  if (change == MHD_CONNECTION_NOTIFY_CLOSED) {
    std::erase_if(clients, [connection](const QueryClient& client) { return client.connection == connection; });
    return;
  }
  clients.push_back({connection, MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd});
  if (std::ranges::count(clients, false, &QueryClient::cut) <= static_cast<std::ptrdiff_t>(kMaxQueryConnections))
    return;
  std::ranges::min_element(clients, {}, [](const QueryClient& client) {
    return client.cut ? SteadyTime::max() : client.since;
  })->cut_off();
}

void QueryServer::Impl::note_step(MHD_Connection* connection) {
  const auto client = std::ranges::find(clients, connection, &QueryClient::connection);
  if (client != clients.end()) client->since = std::chrono::steady_clock::now();
}

// A client that sends or takes a byte now and then would keep its connection for ever.
void QueryServer::Impl::cut_off_slow() {
  const SteadyTime oldest = std::chrono::steady_clock::now() - std::chrono::seconds(kMaxQueryTime_s);
  for (QueryClient& client : clients) {
    if (!client.cut && client.since < oldest) client.cut_off();
  }
}

// Called once when the headers have come, when nothing but a refusal may be answered, and once after the whole request.
MHD_Result QueryServer::Impl::answer(MHD_Connection* connection, const char* path, std::string_view method,
                                     bool first_call) {
  if (method != MHD_HTTP_METHOD_GET && method != MHD_HTTP_METHOD_HEAD) {
    return send_empty(connection, MHD_HTTP_METHOD_NOT_ALLOWED);
  }
  if (has_body(connection)) return send_empty(connection, MHD_HTTP_CONTENT_TOO_LARGE);
  if (first_call) return MHD_YES;
  note_step(connection);
  const std::string attribute = first_parameter(connection);
  if (attribute == "HOST_INFO") {
    return send_description(connection, Description(describe_host(about.name, about.address, about.osc_port)));
  }
  auto description = describe(path, attribute, about.objects());
  return description ? send_description(connection, *std::move(description))
                     : send_empty(connection, MHD_HTTP_NOT_FOUND);
}

}  // namespace ringdown::server
