#include "clients/viewer/link/daemon_client.h"

#include "clients/viewer/link/bounded_queue.h"
#include "protocol/schema.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/socket.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <future>
#include <iterator>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace ringdown::viewer {
namespace {

using namespace std::chrono_literals;
using protocol::Reply;
using protocol::Request;
using Kind = ConnectionState::Kind;

constexpr double kStatusPeriod_s = 0.25;
constexpr double kSubscribePeriod_s = 0.5;  // until the first notice arrives
constexpr double kResolvePeriod_s = 2;      // until the host name is resolved
constexpr double kForgotten_s = 1;          // without a notice, or five notice periods if that is longer
constexpr auto kTick = 20ms;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Resolves on a thread of its own: a name server may take half a minute, and even the destructor must not wait for it.
std::future<Result<wire::Endpoint>> resolve_apart(wire::OscUrl url) {
  std::packaged_task<Result<wire::Endpoint>()> task(
      [url = std::move(url)] { return wire::resolve(url.host, url.port); });
  auto answer = task.get_future();
  std::thread(std::move(task)).detach();
  return answer;
}

bool is_notice(const wire::Message& message) { return message.address.starts_with("/notify."); }

}  // namespace

struct DaemonClient::Connection {
  Connection(std::string url, double rate_hz) : rate_hz_(rate_hz), wanted_url_(std::move(url)) {
    state_.sentence = "Looking for a daemon at " + *wanted_url_ + ".";
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }

  ~Connection() {
    thread_.request_stop();
    wake();
    thread_.join();
  }

  // Any thread.
  void wake() {
    const std::scoped_lock lock(mutex_);
    woken_ = true;
    if (socket_) socket_->wake();
    changed_.notify_all();
  }

  // Only the connection's thread.
  void run(const std::stop_token& stop);
  void look_for(const std::string& url);
  void look_up();
  void bind(wire::Endpoint daemon);
  void part();
  void listen();
  void take(const wire::Datagram& datagram);
  void keep_asking();
  void judge();
  void transmit(const Request& request);
  void send_queued();
  void say(Kind kind, std::string sentence);
  void begin_connection();

  const double rate_hz_;

  mutable std::mutex mutex_;  // guards the members up to state_since_s_
  std::condition_variable changed_;
  bool woken_ = false;
  std::optional<std::string> wanted_url_;
  BoundedQueue<Request> requests_{kMaxRequests};
  BoundedQueue<Reply> replies_{kMaxReplies};
  ConnectionState state_;
  double state_since_s_ = now_s();

  std::string url_;
  std::optional<wire::OscUrl> parsed_;
  std::future<Result<wire::Endpoint>> resolving_;
  std::optional<wire::OscSocket> socket_;  // created and destroyed under the mutex
  wire::Endpoint daemon_;
  wire::Datagram datagram_;
  bool subscribed_ = false;
  double looked_up_s_ = 0, began_s_ = 0, status_asked_s_ = 0, subscription_asked_s_ = 0, heard_s_ = 0, noticed_s_ = 0;

  std::jthread thread_;
};

void DaemonClient::Connection::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::optional<std::string> url;
    {
      std::unique_lock lock(mutex_);
      if (!socket_) changed_.wait_for(lock, kTick, [this] { return woken_; });
      woken_ = false;
      url = std::exchange(wanted_url_, std::nullopt);
    }
    if (url) look_for(*url);
    look_up();
    send_queued();
    if (!socket_) continue;
    keep_asking();
    listen();
    judge();
  }
  part();
}

void DaemonClient::Connection::look_for(const std::string& url) {
  part();
  url_ = url;
  parsed_.reset();
  resolving_ = {};
  looked_up_s_ = 0;
  say(Kind::connecting, "Looking for a daemon at " + url_ + ".");
  const auto parsed = wire::parse_url(url_);
  if (parsed) {
    parsed_ = *parsed;
  } else {
    say(Kind::away, "This is not a daemon's address: " + parsed.error().message);
  }
}

void DaemonClient::Connection::look_up() {
  if (socket_ || !parsed_) return;
  if (!resolving_.valid()) {
    if (now_s() - looked_up_s_ < kResolvePeriod_s) return;
    looked_up_s_ = now_s();
    resolving_ = resolve_apart(*parsed_);
  }
  if (resolving_.wait_for(0s) != std::future_status::ready) return;
  const auto daemon = resolving_.get();
  if (daemon) return bind(*daemon);
  say(Kind::away, "No daemon is at " + url_ + ": " + daemon.error().message);
}

void DaemonClient::Connection::bind(wire::Endpoint daemon) {
  auto socket = wire::OscSocket::reach(daemon);
  if (!socket) return say(Kind::away, "Cannot talk to a daemon: " + socket.error().message);
  daemon_ = daemon;
  began_s_ = heard_s_ = now_s();
  status_asked_s_ = subscription_asked_s_ = 0;
  const std::scoped_lock lock(mutex_);
  socket_ = std::move(*socket);
}

void DaemonClient::Connection::part() {
  if (!socket_) return;
  transmit(protocol::Notify{.on = false, .rate_hz = rate_hz_});
  subscribed_ = false;
  const std::scoped_lock lock(mutex_);
  socket_.reset();
  replies_.clear();
}

void DaemonClient::Connection::transmit(const Request& request) {
  // A request that is lost shows in the missing answer.
  static_cast<void>(socket_->send_to(daemon_, wire::encode(protocol::format(request))));
}

void DaemonClient::Connection::send_queued() {
  std::deque<Request> requests;
  {
    const std::scoped_lock lock(mutex_);
    requests = requests_.take();
  }
  // Without a daemon the requests are dropped: a strike must not sound minutes later.
  if (!socket_) return;
  for (const Request& request : requests) transmit(request);
}

void DaemonClient::Connection::keep_asking() {
  const double now = now_s();
  if (now - status_asked_s_ >= kStatusPeriod_s) {
    status_asked_s_ = now;
    transmit(protocol::Status{});
  }
  if (!subscribed_ && now - subscription_asked_s_ >= kSubscribePeriod_s) {
    subscription_asked_s_ = now;
    transmit(protocol::Notify{.on = true, .rate_hz = rate_hz_});
  }
}

void DaemonClient::Connection::listen() {
  auto patience = kTick;
  for (int i = 0; i < 256 && socket_->receive(datagram_, patience); ++i) {
    take(datagram_);
    patience = 0ms;
  }
}

void DaemonClient::Connection::take(const wire::Datagram& datagram) {
  if (datagram.from != daemon_) return;
  const auto messages = wire::decode_packet(datagram.bytes);
  if (!messages) return;
  heard_s_ = now_s();
  for (const auto& [time, message] : *messages) {
    if (is_notice(message)) {
      noticed_s_ = heard_s_;
      if (!subscribed_) begin_connection();
    }
    auto reply = protocol::parse_reply(message);
    if (!reply) continue;
    const auto* done = reply->get_if<protocol::Done>();
    if (done && done->address == "/notify") continue;
    const auto* refusal = reply->get_if<protocol::Fail>();
    if (refusal && refusal->address == "/notify")
      say(Kind::connecting, "The daemon at " + url_ + " refused: " + refusal->sentence);
    const std::scoped_lock lock(mutex_);
    replies_.push_over(std::move(*reply));
  }
}

void DaemonClient::Connection::begin_connection() {
  subscribed_ = true;
  {
    const std::scoped_lock lock(mutex_);
    ++state_.connection;
    replies_.clear();
  }
  say(Kind::connected, "Connected to the daemon at " + url_ + ".");
}

void DaemonClient::Connection::judge() {
  const double now = now_s();
  if (now - heard_s_ > kAway_s) {
    subscribed_ = false;
    say(Kind::away, "No daemon answers at " + url_ + ". Start one: ringdownd --scene demo.toml");
  } else if (subscribed_ && now - noticed_s_ > std::max(kForgotten_s, 5 / rate_hz_) &&
             heard_s_ > noticed_s_ + kForgotten_s / 2) {
    // The daemon answers but does not know of our subscription: it is a new process.
    subscribed_ = false;
    say(Kind::connecting, "Another daemon is at " + url_ + "; asking it for its objects.");
  }
}

void DaemonClient::Connection::say(Kind kind, std::string sentence) {
  const std::scoped_lock lock(mutex_);
  if (state_.kind != kind || state_.sentence != sentence) state_since_s_ = now_s();
  state_.kind = kind;
  state_.sentence = std::move(sentence);
}

DaemonClient::DaemonClient(std::string url, double notice_rate_hz)
    : connection_(std::make_unique<Connection>(std::move(url), std::clamp(notice_rate_hz, 0.1, 200.0))) {}

DaemonClient::~DaemonClient() = default;

void DaemonClient::send(protocol::Request request) {
  {
    const std::scoped_lock lock(connection_->mutex_);
    connection_->requests_.push_or_drop(std::move(request));
  }
  connection_->wake();
}

Batch DaemonClient::take() {
  const std::scoped_lock lock(connection_->mutex_);
  std::deque<Reply> replies = connection_->replies_.take();
  Batch batch{connection_->state_.connection, {}};
  batch.replies.assign(std::make_move_iterator(replies.begin()), std::make_move_iterator(replies.end()));
  return batch;
}

ConnectionState DaemonClient::state() const {
  const std::scoped_lock lock(connection_->mutex_);
  ConnectionState state = connection_->state_;
  state.seconds = now_s() - connection_->state_since_s_;
  state.lost_replies = connection_->replies_.lost();
  state.lost_requests = connection_->requests_.lost();
  return state;
}

void DaemonClient::connect_to(std::string url) {
  {
    const std::scoped_lock lock(connection_->mutex_);
    connection_->wanted_url_ = std::move(url);
  }
  connection_->wake();
}

}  // namespace ringdown::viewer
