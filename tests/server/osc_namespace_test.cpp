// OSCQuery's JSON, read over HTTP by a plain socket.
#include "protocol/schema.h"
#include "server/query_server.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

namespace ringdown::server {
namespace {

using nlohmann::json;

struct Page {
  int status = 0;
  json body;
};

Page get(std::uint16_t port, const std::string& target) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  EXPECT_EQ(::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const std::string request = "GET " + target + " HTTP/1.0\r\n\r\n";
  EXPECT_EQ(::send(socket, request.data(), request.size(), 0), static_cast<ssize_t>(request.size()));
  std::string text;
  char bytes[4096];
  for (ssize_t got = 0; (got = ::recv(socket, bytes, sizeof bytes, 0)) > 0;) {
    text.append(bytes, static_cast<std::size_t>(got));
  }
  ::close(socket);
  const std::size_t blank = text.find("\r\n\r\n");
  if (text.size() < 12 || blank == text.npos) return {};
  return {std::stoi(text.substr(9, 3)), json::parse(text.substr(blank + 4), nullptr, false)};
}

class QueryTest : public testing::Test {
 protected:
  void SetUp() override {
    auto server = QueryServer::listen(0, {"ringdown", "127.0.0.1", 7770, [] {
                                            return std::vector<std::string>{"bell", "glass.1"};
                                          }});
    ASSERT_TRUE(server) << server.error().message;
    server_ = std::move(*server);
  }
  [[nodiscard]] Page get(const std::string& target) const { return server::get(server_->port(), target); }
  std::unique_ptr<QueryServer> server_;
};

TEST_F(QueryTest, EveryAddressOfTheTableCanBeQueriedWithItsArguments) {
  const Page page = get("/");
  ASSERT_EQ(page.status, 200);
  for (const protocol::AddressSpec& spec : protocol::addresses()) {
    std::string path(spec.address);
    if (spec.arguments_in_address()) path.replace(path.find('{'), 8, "glass.1");
    const json* node = &page.body;
    std::istringstream parts(path.substr(1));
    for (std::string part; std::getline(parts, part, '/');) {
      ASSERT_TRUE(node->contains("CONTENTS") && (*node)["CONTENTS"].contains(part)) << path;
      node = &(*node)["CONTENTS"][part];
    }
    EXPECT_EQ((*node)["FULL_PATH"], path);
    EXPECT_EQ((*node)["ACCESS"], 2) << path;
    const std::size_t arguments = spec.arguments.size() - spec.arguments_in_address();
    EXPECT_EQ(node->value("TYPE", "").size(), arguments) << path;
  }
}

TEST_F(QueryTest, ANodeAnAttributeAndTheHostCanBeQueried) {
  const Page gain = get("/object/bell/gain");
  ASSERT_EQ(gain.status, 200);
  EXPECT_EQ(gain.body["TYPE"], "ff");
  EXPECT_EQ(gain.body["RANGE"], json::parse(R"([{"MIN": 0.0, "MAX": 100.0}, {"MIN": 0.0, "MAX": 60.0}])"));
  EXPECT_EQ(gain.body["UNIT"], json::parse(R"(["", "s"])"));
  EXPECT_EQ(get("/object/bell/gain?TYPE").body, json::parse(R"({"TYPE": "ff"})"));
  EXPECT_EQ(get("/object/bell?TYPE").status, 204);
  EXPECT_EQ(get("/?HOST_INFO").body["OSC_PORT"], 7770);
  EXPECT_EQ(get("/object/bowl").status, 404);
  EXPECT_EQ(get("/../etc/passwd").status, 404);
}

TEST_F(QueryTest, ATakenQueryPortIsAnErrorThatSaysSo) {
  const auto second =
      QueryServer::listen(server_->port(), {"x", "127.0.0.1", 1, [] { return std::vector<std::string>(); }});
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find(std::to_string(server_->port())), std::string::npos);
}

}  // namespace
}  // namespace ringdown::server
