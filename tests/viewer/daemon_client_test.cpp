// The client against daemons that come, go, and are not there.
#include "clients/viewer/link/bounded_queue.h"
#include "clients/viewer/link/daemon_client.h"
#include "clients/viewer/link/model.h"
#include "engine/modal/bank_file.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/viewer/lossy_relay.h"
#include "tests/viewer/preset_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace ringdown::viewer {
namespace {

using namespace ringdown::test;
using namespace std::chrono_literals;
using Kind = ConnectionState::Kind;

std::string at(std::uint16_t port) { return "osc.udp://127.0.0.1:" + std::to_string(port); }

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string object_option(const std::string& name, const std::string& bank) {
  return name + "=" + preset_bank(bank).string();
}

// A client and its model, run as the window runs them.
struct Window {
  explicit Window(const std::string& url) : client(url, 60) {}

  void frame() {
    const Batch batch = client.take();
    if (batch.connection != connection) model.restart();
    connection = batch.connection;
    for (const auto& reply : batch.replies) model.apply(reply, now_s());
    for (auto& request : model.wants(now_s())) client.send(std::move(request));
  }
  template <class Condition>
  bool reaches(Condition holds, std::chrono::milliseconds limit = kPatience) {
    const auto framed = [&] {
      frame();
      return holds();
    };
    return becomes_true(framed, limit);
  }

  DaemonClient client;
  Model model{60};
  std::uint32_t connection = 0;
};

// On a port that is known, unlike the fixture's.
Process daemon_at(std::uint16_t port, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {program("ringdownd"), "--port", std::to_string(port), "--driver", "null"});
  return Process(arguments);
}

// What one window does, another shows, and the daemon is silent for both.
TEST(DaemonClient, TwoWindowsAgreeOnMuteAndSolo) {
  Daemon daemon({"--driver", "null", "--object", object_option("bell", "bronze-bell"), "--object",
                 object_option("plate", "steel-plate")});
  ASSERT_TRUE(daemon.ready());
  Window one(at(daemon.port())), other(at(daemon.port()));
  const auto both = [&](auto holds) {
    const auto in = [&](Window& window) {
      window.frame();
      const KnownObject *bell = window.model.object("bell"), *plate = window.model.object("plate");
      return bell && plate && holds(*bell, *plate);
    };
    return becomes_true([&] { return in(one) && in(other); });
  };
  ASSERT_TRUE(both([](const auto& bell, const auto& plate) { return !bell.mute && !plate.solo; }));
  one.client.send(protocol::SetSolo{{"plate", std::nullopt}, true});
  EXPECT_TRUE(both([](const auto&, const auto& plate) { return plate.solo; }));
  other.client.send(protocol::SetMute{{"bell", std::nullopt}, true});
  EXPECT_TRUE(both([](const auto& bell, const auto& plate) { return bell.mute && plate.solo; }));
  one.client.send(protocol::SetSolo{{"plate", std::nullopt}, false});
  other.client.send(protocol::SetMute{{"bell", std::nullopt}, false});
  EXPECT_TRUE(both([](const auto& bell, const auto& plate) { return !bell.mute && !plate.solo; }));
}

TEST(DaemonClient, TheClientSaysWhatToDoWhenNoDaemonAnswers) {
  const auto silent = *wire::OscSocket::bind();
  DaemonClient client(at(silent.port()), 30);
  EXPECT_EQ(client.state().kind, Kind::connecting);
  ASSERT_TRUE(becomes_true([&] { return client.state().kind == Kind::away; }));
  const std::string sentence = client.state().sentence;
  EXPECT_NE(sentence.find(at(silent.port())), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("ringdownd"), std::string::npos) << sentence;
  EXPECT_EQ(client.state().connection, 0u);
}

TEST(DaemonClient, AMalformedAddressIsAStateWithASentence) {
  for (const char* url : {"", "nonsense", "osc.udp://127.0.0.1", "http://127.0.0.1:7770"}) {
    DaemonClient client(url, 30);
    ASSERT_TRUE(becomes_true([&] { return client.state().kind == Kind::away; })) << url;
    EXPECT_FALSE(client.state().sentence.empty());
    client.send(protocol::Status{});
    EXPECT_TRUE(client.take().replies.empty());
  }
}

TEST(DaemonClient, TheClientConnectsReportsObjectsAndLeaves) {
  Daemon daemon({"--driver", "null", "--object", object_option("bell", "bronze-bell")});
  ASSERT_TRUE(daemon.ready());
  bool told = false;
  {
    DaemonClient client(at(daemon.port()), 60);
    ASSERT_TRUE(becomes_true([&] {
      for (const auto& reply : client.take().replies) {
        const auto* object = reply.get_if<protocol::NotifyObject>();
        told |= object && object->name == "bell" && object->loaded;
      }
      return told;
    }));
    EXPECT_EQ(client.state().kind, Kind::connected);
    EXPECT_EQ(client.state().connection, 1u);
  }
}

TEST(DaemonClient, TheClientSendsRequests) {
  Daemon daemon({"--driver", "null", "--object", object_option("bell", "bronze-bell")});
  Window window(at(daemon.port()));
  ASSERT_TRUE(window.reaches([&] { return window.connection == 1; }));
  window.client.send(protocol::StrikeVertex{{"bell", std::nullopt}, {0, {0, 0, -0.1}}});
  EXPECT_TRUE(window.reaches([&] { return !window.model.contacts().empty(); }));
  EXPECT_EQ(window.model.contacts().front().object, "bell");
  EXPECT_TRUE(window.reaches([&] { return window.model.peak().held > 0; }));
}

TEST(DaemonClient, TheClientConnectsAgainToADaemonThatReplacedAnother) {
  auto first = std::make_unique<Daemon>(
      std::vector<std::string>{"--driver", "null", "--object", object_option("bell", "bronze-bell")});
  const std::uint16_t port = first->port();
  Window window(at(port));
  ASSERT_TRUE(window.reaches([&] { return window.connection == 1; }));
  first->process().send_signal(SIGKILL);
  ASSERT_TRUE(first->process().wait());
  const Process second = daemon_at(port, {"--object", object_option("gong", "gong")});
  ASSERT_TRUE(window.reaches([&] {
    const KnownObject* gong = window.model.object("gong");
    return window.connection == 2 && gong && gong->bank;
  }));
  EXPECT_FALSE(window.model.object("bell")) << "it was the other daemon's";
}

// What the preset scene holds, counted by hand in its file.
void expect_demo(const Model& model) {
  EXPECT_EQ(model.objects().size(), 5u);
  EXPECT_EQ(model.scene().bodies().size(), 7u);
  EXPECT_EQ(model.scene().statics().size(), 1u);
  EXPECT_EQ(model.scene().statics()[0].name, "stone-floor");
  EXPECT_EQ(model.scene().description().duration_s, 12);
  for (const auto& [name, object] : model.objects()) {
    ASSERT_TRUE(object.bank) << name << ": " << object.bank_fault;
    EXPECT_EQ(object.bank->bank.mode_count(), static_cast<std::size_t>(object.modes)) << name;
  }
  EXPECT_NEAR(model.object("bell")->gain, 1.1, 1e-6);
  EXPECT_NEAR(model.object("plate")->pan, -0.6, 1e-6);
}

bool knows_everything(const Model& model) {
  return model.scene().described() &&
         std::ranges::all_of(model.objects(), [](const auto& known) { return known.second.bank != nullptr; }) &&
         !model.files().banks().empty();
}

TEST(Viewing, TheModelLearnsTheSceneItsObjectsTheirBanksAndMotions) {
  Daemon daemon({"--driver", "null", "--scene", RINGDOWN_SOURCE_DIR "/presets/scenes/demo.toml"});
  ASSERT_TRUE(daemon.ready());
  Window window(at(daemon.port()));
  ASSERT_TRUE(window.reaches([&] { return window.model.objects().size() == 5 && knows_everything(window.model); }));
  expect_demo(window.model);
  EXPECT_FALSE(window.model.files().scenes().empty());
  const auto& bodies = window.model.scene().bodies();
  const auto cube = std::ranges::find_if(bodies, [](const auto& known) { return known.second.name == "first-cube"; });
  ASSERT_NE(cube, bodies.end());
  ASSERT_TRUE(window.reaches([&] { return window.model.scene().reported_time_s() > 0.5; }));
  const auto shown = window.model.scene().shown_time_at(now_s());
  ASSERT_TRUE(shown && cube->second.track.pose_at(*shown));
  EXPECT_TRUE(window.model.scene().present(cube->second));
  EXPECT_TRUE(window.reaches([&] { return !window.model.contacts().empty(); }));
}

TEST(Viewing, APausedSceneStandsInThePicture) {
  Daemon daemon({"--driver", "null", "--scene", RINGDOWN_SOURCE_DIR "/presets/scenes/demo.toml"});
  Window window(at(daemon.port()));
  ASSERT_TRUE(window.reaches([&] { return window.model.scene().reported_time_s() > 0.2; }));
  window.client.send(protocol::ScenePause{true});
  ASSERT_TRUE(window.reaches([&] { return window.model.scene().paused(); }));
  ASSERT_TRUE(window.reaches(
      [&] { return window.model.scene().shown_time_at(now_s()) == window.model.scene().reported_time_s(); }));
  const double stood_s = window.model.scene().reported_time_s();
  window.client.send(protocol::ScenePause{false});
  EXPECT_TRUE(window.reaches([&] { return window.model.scene().reported_time_s() > stood_s + 0.2; }));
}

TEST(Viewing, TheModelLearnsEverythingThoughEveryThirdDatagramIsLost) {
  Daemon daemon({"--driver", "null", "--scene", RINGDOWN_SOURCE_DIR "/presets/scenes/coin.toml"});
  ASSERT_TRUE(daemon.ready());
  const LossyRelay relay(daemon.port(), 3);
  Window window(at(relay.port()));
  const Model& model = window.model;
  ASSERT_TRUE(window.reaches([&] { return model.objects().size() == 4 && knows_everything(model); }));
  EXPECT_GT(relay.dropped(), 10u);
  EXPECT_EQ(model.scene().bodies().size(), 4u);
  for (const char* coin : {"coin", "hard-coin", "dropped-coin"}) {
    const auto direct = modal::read_bank(preset_bank("coin"));
    EXPECT_EQ(model.object(coin)->bank->bank.shapes, direct->shapes) << coin;
  }
  EXPECT_NEAR(model.object("hard-coin")->scale.stiffness, 1.5, 1e-6);
}

TEST(Viewing, TheModelLearnsOfObjectsThatComeAndGo) {
  Daemon daemon({"--driver", "null", "--object", object_option("bell", "bronze-bell")});
  Window window(at(daemon.port()));
  ASSERT_TRUE(window.reaches([&] { return window.model.object("bell") != nullptr; }));
  window.client.send(protocol::LoadObject{"glass", preset_bank("wine-glass").string()});
  window.client.send(protocol::FreeObject{{"bell", std::nullopt}});
  ASSERT_TRUE(window.reaches([&] {
    const KnownObject* glass = window.model.object("glass");
    return !window.model.object("bell") && glass && glass->bank;
  }));
  // Another client changes something of which no notice tells.
  daemon.send(protocol::format(protocol::SetGain{{"glass", std::nullopt}, {0.25}}));
  EXPECT_TRUE(window.reaches([&] { return window.model.object("glass")->gain == 0.25; }));
}

TEST(DaemonClient, TheClientReportsThatADaemonHasGoneAndFindsItAgain) {
  auto first = std::make_unique<Daemon>(std::vector<std::string>{"--driver", "null"});
  const std::uint16_t port = first->port();
  DaemonClient client(at(port), 60);
  ASSERT_TRUE(becomes_true([&] { return client.state().kind == Kind::connected; }));
  first.reset();
  ASSERT_TRUE(becomes_true([&] { return client.state().kind == Kind::away; }));
  EXPECT_NE(client.state().sentence.find("ringdownd"), std::string::npos);
  const Process second = daemon_at(port, {});
  ASSERT_TRUE(becomes_true([&] { return client.state().kind == Kind::connected; }));
  EXPECT_EQ(client.state().connection, 2u);
}

TEST(DaemonClient, TheClientMovesToAnotherDaemon) {
  Daemon one({"--driver", "null"}), two({"--driver", "null", "--object", object_option("bell", "bronze-bell")});
  Window window(at(one.port()));
  ASSERT_TRUE(window.reaches([&] { return window.connection == 1; }));
  window.client.connect_to(at(two.port()));
  ASSERT_TRUE(window.reaches([&] {  // the first answer may come before the first notice, which begins the connection
    const auto& status = window.model.status();
    return window.connection == 2 && status && status->objects == 1;
  }));
  window.client.connect_to("nonsense");
  EXPECT_TRUE(becomes_true([&] { return window.client.state().kind == Kind::away; }));
}

TEST(DaemonClient, SendingAndTakingNeverWaitForAnAnswer) {
  const auto silent = *wire::OscSocket::bind();
  DaemonClient client(at(silent.port()), 30);
  for (std::size_t i = 0; i < 4 * DaemonClient::kMaxRequests; ++i) {
    client.send(protocol::Browse{});
    ASSERT_TRUE(client.take().replies.empty());
  }
}

TEST(DaemonClient, TheClientUnsubscribesAtItsEnd) {
  auto daemon = *wire::OscSocket::bind();
  wire::Datagram datagram;
  {
    DaemonClient client(at(daemon.port()), 30);
    ASSERT_TRUE(becomes_true([&] { return daemon.receive(datagram, 10ms); }));
  }
  std::optional<protocol::Notify> last;
  while (daemon.receive(datagram, 0ms)) {
    const auto messages = wire::decode_packet(datagram.bytes);
    const auto request = protocol::parse(messages.value().front().message);
    if (const auto* notify = request->get_if<protocol::Notify>()) last = *notify;
  }
  ASSERT_TRUE(last);
  EXPECT_FALSE(last->on);
}

TEST(DaemonClient, DatagramsFromOtherAddressesAreIgnored) {
  auto daemon = *wire::OscSocket::bind(), stranger = *wire::OscSocket::bind();
  DaemonClient client(at(daemon.port()), 30);
  wire::Datagram datagram;
  ASSERT_TRUE(becomes_true([&] { return daemon.receive(datagram, 10ms); }));
  const auto says = [&](wire::OscSocket& from, const char* sentence) {
    const protocol::Reply reply = protocol::Fail{"/load", sentence};
    ASSERT_TRUE(from.send_to(datagram.from, wire::encode(protocol::format(reply))));
  };
  says(stranger, "wrong");
  says(daemon, "right");
  std::vector<protocol::Reply> replies;
  ASSERT_TRUE(becomes_true([&] { return !(replies = client.take().replies).empty(); }));
  EXPECT_EQ(replies.front().get<protocol::Fail>().sentence, "right");
}

TEST(BoundedQueue, AFullQueueDropsTheNewestOrTheOldestAsAsked) {
  BoundedQueue<int> first(3), last(3);
  for (int i = 0; i < 3; ++i) first.push_or_drop(i), last.push_over(i);
  EXPECT_EQ(first.lost() + last.lost(), 0u);
  first.push_or_drop(3);
  last.push_over(3);
  EXPECT_EQ(first.lost(), 1u);
  EXPECT_EQ(last.lost(), 1u);
  EXPECT_EQ(first.take(), (std::deque<int>{0, 1, 2}));
  EXPECT_EQ(last.take(), (std::deque<int>{1, 2, 3}));
  EXPECT_TRUE(last.take().empty());
}

}  // namespace
}  // namespace ringdown::viewer
