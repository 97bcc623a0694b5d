// HTTP by a plain socket, so that a test may send what no HTTP library would. [any thread]
#pragma once

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

namespace ringdown::test {

struct HttpAnswer {
  int status = 0;  // 0: what came is no answer
  std::string body;
};

inline HttpAnswer parse_http(const std::string& text) {
  const std::size_t blank = text.find("\r\n\r\n");
  if (!text.starts_with("HTTP/1.") || blank == text.npos) return {};
  return {std::atoi(text.c_str() + 9), text.substr(blank + 4)};
}

class HttpConnection {
 public:
  // Connects to this computer. `from` is the address to come from, such as 0x7f000002.
  explicit HttpConnection(std::uint16_t port, std::uint32_t from = INADDR_LOOPBACK)
      : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval patience{.tv_sec = 120, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    const sockaddr_in own = address(from, 0), server = address(INADDR_LOOPBACK, port);
    open_ = ::bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0 &&
            (::connect(socket_, reinterpret_cast<const sockaddr*>(&server), sizeof server) == 0 ||
             (errno == EINTR && connects_on()));
  }
  ~HttpConnection() { ::close(socket_); }
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  [[nodiscard]] bool open() const { return open_; }

  // Returns false when the server has closed the connection.
  bool send(std::string_view text) {
    while (open_ && !text.empty()) {
      const ssize_t sent = again([&] { return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL); });
      open_ = sent > 0;
      if (open_) text.remove_prefix(static_cast<std::size_t>(sent));
    }
    return open_;
  }
  // No more will be sent. Waits a moment for an answer first: libmicrohttpd notices an end that comes together with the
  // last bytes only when the silence has lasted too long.
  void end() {
    pollfd answer{socket_, POLLIN, 0};
    ::poll(&answer, 1, 2);
    ::shutdown(socket_, SHUT_WR);
  }

  // Everything until the server closes the connection.
  [[nodiscard]] std::string receive() {
    std::string text;
    char bytes[65536];
    for (ssize_t got = 0; (got = again([&] { return ::recv(socket_, bytes, sizeof bytes, 0); })) > 0;) {
      text.append(bytes, static_cast<std::size_t>(got));
    }
    return text;
  }

 private:
  // A socket with a time-out gives up at any signal, even where SA_RESTART is set, such as for the fuzzer's alarm.
  template <typename Call>
  static ssize_t again(Call call) {
    ssize_t result = 0;
    while ((result = call()) < 0 && errno == EINTR) {
    }
    return result;
  }

  // Waits for a connection that a signal interrupted: it goes on by itself, and cannot be asked for twice.
  bool connects_on() {
    pollfd made{socket_, POLLOUT, 0};
    again([&] { return ::poll(&made, 1, 120'000); });
    int fault = ETIMEDOUT;
    socklen_t size = sizeof fault;
    return made.revents != 0 && ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &fault, &size) == 0 && fault == 0;
  }

  static sockaddr_in address(std::uint32_t host, std::uint16_t port) {
    sockaddr_in result{};
    result.sin_family = AF_INET;
    result.sin_addr.s_addr = htonl(host);
    result.sin_port = htons(port);
    return result;
  }

  int socket_;
  bool open_ = false;
};

// `headers` are whole lines.
inline HttpAnswer http_get(std::uint16_t port, const std::string& target, const std::string& headers = "") {
  HttpConnection connection(port);
  connection.send("GET " + target + " HTTP/1.0\r\n" + headers + "\r\n");
  return parse_http(connection.receive());
}

}  // namespace ringdown::test
