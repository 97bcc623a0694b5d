// OSCQuery's JSON, read over HTTP by a plain socket.
#include "protocol/schema.h"
#include "server/query_server.h"
#include "tests/support/http_client.h"
#include "tests/support/scarcity.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::server {
namespace {

using nlohmann::json;

struct Page {
  int status = 0;
  json body;
};

// What a daemon with these objects tells.
template <class... Names>
std::function<ObjectNames()> objects(Names... names) {
  return [list = std::make_shared<const std::vector<std::string>>(std::vector<std::string>{names...})] { return list; };
}

class QueryTest : public testing::Test {
 protected:
  void SetUp() override {
    auto server = QueryServer::listen(0, {"ringdown", "127.0.0.1", 7770, objects("bell", "glass.1")});
    ASSERT_TRUE(server) << server.error().message;
    server_ = std::move(*server);
  }
  [[nodiscard]] Page get(const std::string& target) const {
    const test::HttpAnswer answer = test::http_get(server_->port(), target);
    return {answer.status, json::parse(answer.body, nullptr, false)};
  }
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

TEST_F(QueryTest, TheWholeNamespaceHoldsWhatItsPartsAnswer) {
  const json objects = get("/").body["CONTENTS"]["object"];
  EXPECT_EQ(get("/object").body, objects);
  EXPECT_EQ(get("/object?CONTENTS").body["CONTENTS"], objects["CONTENTS"]);
  ASSERT_EQ(objects["CONTENTS"].size(), 2u);
  for (const char* name : {"bell", "glass.1"}) {
    EXPECT_EQ(get(std::string("/object/") + name).body, objects["CONTENTS"][name]) << name;
  }
  EXPECT_EQ(get("/object/%7F").status, 404) << "the place of a name is no name";
}

TEST_F(QueryTest, WhereThereAreNoObjectsThereIsNoAddressOfThem) {
  const auto empty = QueryServer::listen(0, {"ringdown", "127.0.0.1", 7770, objects()});
  ASSERT_TRUE(empty);
  EXPECT_EQ(test::http_get((*empty)->port(), "/object").status, 404);
  EXPECT_EQ(test::http_get((*empty)->port(), "/").status, 200);
}

TEST_F(QueryTest, OnlyReadingWithoutABodyIsAllowed) {
  for (const auto& [request, status] :
       {std::pair("POST / HTTP/1.1\r\nHost: x\r\n\r\n", 405), std::pair("BREW / HTTP/1.1\r\nHost: x\r\n\r\n", 405),
        std::pair("GET / HTTP/1.1\r\nHost: x\r\nContent-Length: 3\r\n\r\nabc", 413),
        std::pair("GET / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n0\r\n\r\n", 413)}) {
    test::HttpConnection connection(server_->port());
    connection.send(request);
    connection.end();
    EXPECT_EQ(test::parse_http(connection.receive()).status, status) << request;
  }
}

TEST_F(QueryTest, ATakenQueryPortIsAnErrorThatSaysSo) {
  const auto second = QueryServer::listen(server_->port(), {"x", "127.0.0.1", 1, objects()});
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find(std::to_string(server_->port())), std::string::npos);
}

TEST_F(QueryTest, WithoutDescriptorsTheReasonIsNotAPortThatIsTaken) {
  const auto try_it = [] {
    test::run_out_of_descriptors();
    const auto refused = QueryServer::listen(0, {"x", "127.0.0.1", 1, objects()});
    if (refused) std::_Exit(1);
    std::_Exit(refused.error().message.find("Too many open files") != std::string::npos ? 0 : 2);
  };
  EXPECT_EXIT(try_it(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace ringdown::server
