#include "server/query_server.h"
#include "tests/fuzz/targets.h"
#include "tests/support/http_client.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::fuzz {
namespace {

// One server for all inputs, on a port of its own.
std::uint16_t server_port() {
  static const auto server = server::QueryServer::listen(
      0, {"ringdown", "127.0.0.1", 7770, [] {
            return std::make_shared<const std::vector<std::string>>(std::vector<std::string>{"bell", "glass.1"});
          }});
  expect(server.has_value(), "the server listens");
  return (*server)->port();
}

// Most mutations break the request's line, and go no further. So an input that begins with '/' is taken as the target
// up to the end of its line, and header lines after it.
std::string as_request(Bytes input) {
  std::string text(reinterpret_cast<const char*>(input.data()), input.size());
  if (!text.starts_with('/')) return text;
  const std::size_t end = std::min(text.find('\n'), text.size());
  return "GET " + text.substr(0, end) + " HTTP/1.1\r\nHost: x\r\n" +
         (end < text.size() ? text.substr(end + 1) : std::string()) + "\r\n\r\n";
}

}  // namespace

void http(Bytes input) {
  static unsigned count = 0;
  const std::uint32_t from = INADDR_LOOPBACK + ++count % 60000;  // a port of one address is free again after a minute
  test::HttpConnection connection(server_port(), from);
  expect(connection.open(), "the server takes a connection");
  connection.send(as_request(input));
  connection.end();
  const std::string text = connection.receive();
  const int status = test::parse_http(text).status;
  expect(text.empty() || (status >= 100 && status != 206), "an answer is one of HTTP, and never of a range");
  if (count % 64 == 0) {
    expect(test::http_get(server_port(), "/?HOST_INFO").status == 200, "the server still answers others");
  }
}

}  // namespace ringdown::fuzz
