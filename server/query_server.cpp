#include "server/query_server.h"

#include "server/osc_namespace.h"

#include <httplib.h>

#include <chrono>
#include <semaphore>
#include <thread>

namespace ringdown::server {
namespace {

constexpr std::size_t kThreads = 2;
constexpr int kMaxWaiting = 32;  // accepted connections; further ones wait in the kernel's queue
constexpr int kTimeout_s = 2;    // how long a client may be silent in the middle of a request
constexpr std::size_t kMaxRequestBytes = 1024;

// Replaces httplib's own queue, whose length is not limited.
class BoundedQueue final : public httplib::TaskQueue {
 public:
  using Outcome = decltype(std::declval<httplib::TaskQueue&>().enqueue({}));  // void; bool in later versions
  Outcome enqueue(std::function<void()> task) override {
    room_.acquire();
    return pool_.enqueue([this, task = std::move(task)] {
      task();
      room_.release();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  std::counting_semaphore<kMaxWaiting> room_{kMaxWaiting};
  httplib::ThreadPool pool_{kThreads};
};

}  // namespace

struct QueryServer::Impl {
  About about;
  httplib::Server http;
  int port = 0;
  std::jthread thread;

  void answer(const httplib::Request& request, httplib::Response& response) const;
};

QueryServer::QueryServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

QueryServer::~QueryServer() {
  impl_->http.stop();
  if (impl_->thread.joinable()) impl_->thread.join();
}

std::uint16_t QueryServer::port() const { return static_cast<std::uint16_t>(impl_->port); }

Result<std::unique_ptr<QueryServer>> QueryServer::listen(std::uint16_t port, About about) {
  auto impl = std::make_unique<Impl>();
  impl->about = std::move(about);
  httplib::Server& http = impl->http;
  http.new_task_queue = [] { return new BoundedQueue; };
  http.set_payload_max_length(kMaxRequestBytes);
  http.set_read_timeout(kTimeout_s);
  http.set_write_timeout(kTimeout_s);
  http.set_keep_alive_max_count(100);
  http.set_keep_alive_timeout(kTimeout_s);
  http.set_socket_options([](int socket) {
    const int on = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  });
  http.Get(".*", [impl = impl.get()](const httplib::Request& request, httplib::Response& response) {
    impl->answer(request, response);
  });
  const std::string& address = impl->about.address;
  impl->port = port == 0 ? http.bind_to_any_port(address) : http.bind_to_port(address, port) ? port : -1;
  if (impl->port < 0) {
    return fail(ErrorKind::port_busy, "cannot serve OSCQuery on " + address + ":" + std::to_string(port) +
                                          ": the port is taken or not ours; choose another (0 takes any free one)");
  }
  impl->thread = std::jthread([&http] { http.listen_after_bind(); });
  // httplib::Server::stop() has no effect before the thread listens, so the destructor must not come earlier.
  for (int i = 0; i < 1000 && !http.is_running(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return std::unique_ptr<QueryServer>(new QueryServer(std::move(impl)));
}

void QueryServer::Impl::answer(const httplib::Request& request, httplib::Response& response) const {
  const char* const kJson = "application/json";
  const std::string attribute = request.params.empty() ? "" : request.params.begin()->first;
  if (attribute == "HOST_INFO") {
    return response.set_content(describe_host(about.name, about.address, about.osc_port), kJson);
  }
  const auto objects = about.objects();
  const auto text = attribute.empty() ? describe_namespace(request.path, objects)
                                      : describe_attribute(request.path, attribute, objects);
  if (!text) {
    response.status = 404;
  } else if (text->empty()) {
    response.status = 204;
  } else {
    response.set_content(*text, kJson);
  }
}

}  // namespace ringdown::server
