// The daemon in a session manager's hands. The manager is a stand-in that speaks NSM's messages over a socket of ours.
#include "engine/modal/bank_file.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/integration/jack_fixture.h"

#include <fstream>
#include <utility>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;
using wire::Message;

class Manager {
 public:
  [[nodiscard]] Process::Environment environment(Process::Environment more) const {
    more["NSM_URL"] = "osc.udp://127.0.0.1:" + std::to_string(socket_.port()) + "/";
    return more;
  }

  // The next message of that address; it comes from the client we talk to from now on.
  std::optional<Message> wait_for(const std::string& address) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < end) {
      wire::Datagram datagram;
      if (!socket_.receive(datagram, 100ms)) continue;
      client_ = datagram.from;
      const auto messages = wire::decode_packet(datagram.bytes);
      if (messages && messages->front().message.address == address) return messages->front().message;
    }
    return std::nullopt;
  }

  void send(const Message& message) { ASSERT_TRUE(socket_.send_to(client_, wire::encode(message))); }

  // Starts the client's part of a session.
  void open(const std::filesystem::path& path, const std::string& client_id) {
    const auto announcement = wait_for("/nsm/server/announce");
    ASSERT_TRUE(announcement);
    announced_ = announcement->arguments;
    send({"/reply", {"/nsm/server/announce", "welcome", "stand-in", ":server-control:"}});
    send({"/nsm/client/open", {path.string(), "Ringdown", client_id}});
  }

  // What it answers to one of our requests: empty when well, else its sentence.
  std::string answer(const std::string& to) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < end) {
      wire::Datagram datagram;
      if (!socket_.receive(datagram, 100ms)) continue;
      const auto messages = wire::decode_packet(datagram.bytes);
      const Message& message = messages->front().message;
      if (std::get<std::string>(message.arguments.at(0)) != to) continue;
      return message.address == "/reply" ? "" : std::get<std::string>(message.arguments.at(2));
    }
    return "no answer to " + to;
  }

  [[nodiscard]] const std::vector<wire::Argument>& announced() const { return announced_; }

 private:
  wire::OscSocket socket_ = std::move(*wire::OscSocket::bind());
  wire::Endpoint client_;
  std::vector<wire::Argument> announced_;
};

class NsmTest : public JackTest {
 protected:
  // A daemon in the session; with `open` carried out while it waits.
  std::unique_ptr<Daemon> start(Manager& manager, const std::string& client_id) {
    std::jthread opening([&] { manager.open(folder_ / "Ringdown.nABCD", client_id); });
    return std::make_unique<Daemon>(std::vector<std::string>{}, manager.environment(server_.environment()));
  }
};

TEST_F(NsmTest, ASessionUnderNsmIsOpenedSavedEndedAndComesBack) {
  {
    Manager manager;
    const auto daemon = start(manager, "Ringdown.nABCD");
    ASSERT_TRUE(daemon->ready()) << daemon->process().output();
    EXPECT_EQ(manager.announced().at(0), wire::Argument("Ringdown"));
    EXPECT_EQ(manager.announced().at(2), wire::Argument("ringdownd"));
    EXPECT_EQ(manager.announced().at(3), wire::Argument(1)) << "version of the protocol";
    EXPECT_EQ(manager.announced().at(5), wire::Argument(static_cast<int>(daemon->process().id())));
    EXPECT_EQ(manager.answer("/nsm/client/open"), "");
    EXPECT_TRUE(server_.connections().contains("Ringdown.nABCD:out_left")) << "JACK knows it by its client id";

    // The session's folder is not below the daemon's roots; the bank is given by a copy in the current one.
    const auto bank = std::filesystem::current_path() / ("nsm-test-" + std::to_string(::getpid()) + ".glb");
    std::filesystem::copy_file(bank_, bank, std::filesystem::copy_options::overwrite_existing);
    const auto loaded = daemon->ask({"/load", {"tone", bank.string()}});
    ASSERT_TRUE(loaded && loaded->holds<protocol::Done>());
    daemon->send({"/object/tone/gain", {0.25f}});
    ASSERT_TRUE(daemon->ask({"/object/tone/group", {"metal"}}));
    manager.send({"/nsm/client/save", {}});
    EXPECT_EQ(manager.answer("/nsm/client/save"), "");
    EXPECT_TRUE(std::filesystem::exists(folder_ / "Ringdown.nABCD.toml"));
    daemon->process().send_signal(SIGTERM);
    EXPECT_EQ(daemon->process().wait(), 0) << daemon->process().output();
  }
  Manager manager;
  const auto daemon = start(manager, "Ringdown.nABCD");
  ASSERT_TRUE(daemon->ready()) << daemon->process().output();
  EXPECT_EQ(manager.answer("/nsm/client/open"), "");
  EXPECT_EQ(status(*daemon)->objects, 1);
  std::filesystem::remove(folder_ / "Ringdown.nABCD.toml");
  manager.send({"/nsm/client/save", {}});
  EXPECT_EQ(manager.answer("/nsm/client/save"), "");
  std::ifstream file(folder_ / "Ringdown.nABCD.toml");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const char* part : {"name = \"tone\"", "gain = 0.25", "group = \"metal\""}) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  std::filesystem::remove("nsm-test-" + std::to_string(::getpid()) + ".glb");
}

TEST_F(NsmTest, ABrokenStateIsToldToTheSessionManager) {
  std::ofstream(folder_ / "Ringdown.nABCD.toml") << "[[object]]\nname = 'a'\nbank = 'nowhere.glb'\n";
  Manager manager;
  const auto daemon = start(manager, "Ringdown.nABCD");
  EXPECT_NE(manager.answer("/nsm/client/open"), "");
  EXPECT_EQ(daemon->process().wait(), 3) << daemon->process().output();
  EXPECT_NE(daemon->process().output().find("nowhere.glb"), std::string::npos) << daemon->process().output();
}

TEST_F(NsmTest, ASessionManagerThatCannotBeIsRefused) {
  const auto started = [&](const std::string& url) {
    Process::Environment environment = server_.environment();
    environment["NSM_URL"] = url;
    return run({program("ringdownd"), "--port", "0"}, environment);
  };
  EXPECT_EQ(started("http://127.0.0.1:1").exit_code, 1);
  EXPECT_NE(started("http://127.0.0.1:1").output.find("NSM_URL"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::test
