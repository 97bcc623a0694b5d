// A client of a session manager that speaks NSM (New Session Manager's protocol, version 1). The client announces
// itself; the manager names the file for its part of the session, asks it to save, and ends it by SIGTERM.
//
//   if (const auto url = NsmClient::url()) {        // the session manager started us
//     auto client = NsmClient::announce(*url);      // waits until it opens the session
//     load(state_file(**client));                   // the name of the JACK client is session().client_id
//     (*client)->start(save);                       // answers, then serves on its own thread
//   }
#pragma once

#include "engine/base/result.h"
#include "protocol/wire/socket.h"
#include "server/nsm_messages.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

namespace ringdown::wire {
struct Message;
}

namespace ringdown::server {

class NsmClient {
 public:
  // Returns the value of NSM_URL in the environment; nullopt: no session manager has started us. [main]
  static std::optional<std::string> url();

  // Announces us to the manager and waits until it opens a session. An error names the peer that did not answer, or the
  // refused request. [main]
  static Result<std::unique_ptr<NsmClient>> announce(const std::string& url,
                                                     std::chrono::milliseconds patience = std::chrono::seconds(10));
  NsmClient(const NsmClient&) = delete;
  NsmClient& operator=(const NsmClient&) = delete;
  ~NsmClient();  // without start(): tells the manager that the session could not be opened

  [[nodiscard]] const NsmSession& session() const { return session_; }

  // Returns the state file of the session.
  [[nodiscard]] std::filesystem::path state_file() const { return session_.path.string() + ".toml"; }

  // Answers that the session is open. From now on the client's thread calls `save` whenever the manager wants the
  // session to be saved; `save` must arrange that `done` is called once, on any thread, while this client exists.
  // [main]
  using Done = std::function<void(const Result<void>&)>;
  void start(std::function<void(const Done& done)> save);

  // Ends the thread; `save` is not called any more. [main]
  void stop();

 private:
  NsmClient(wire::OscSocket socket, wire::Endpoint manager);
  [[nodiscard]] std::optional<NsmRequest> receive(std::chrono::milliseconds patience);
  [[nodiscard]] Result<void> wait_for_session(std::chrono::milliseconds patience);
  void run(const std::stop_token& stop);
  void send(const wire::Message& message);
  void answer(const std::string& address, const Result<void>& outcome);

  wire::OscSocket socket_;
  wire::Endpoint manager_;
  NsmSession session_;
  std::function<void(const Done&)> save_;
  std::jthread thread_;  // last member: ends before the others are destroyed
};

}  // namespace ringdown::server
