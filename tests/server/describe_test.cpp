// What the daemon tells of itself when it is asked: objects, their bank files, the scene, what there is to load.
#include "engine/base/content_hash.h"
#include "server/browse.h"
#include "server/answers.h"
#include "tests/server/osc_server_fixture.h"
#include "tests/support/breaking_bar.h"
#include "tests/support/scarcity.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

namespace ringdown::server {
namespace {

constexpr const char* kScene = R"(
[scene]
duration_s = 7
[camera]
position_m = [1, 2, 3]
target_m = [0, 0, 0.5]
field_of_view_degrees = 40
[[object]]
name = "bell"
bank = "tick.glb"
[[static]]
name = "floor"
shape = "plane"
[[static]]
name = "wall"
shape = "box"
size_m = [1, 2, 3]
position_m = [5, 0, 0]
[[body]]
name = "ball"
object = "bell"
shape = "sphere"
radius_m = 0.05
density_kg_m3 = 1000
position_m = [0, 0, 1]
)";

class DescribeTest : public OscServerTest {
 protected:
  // The replies to `message`, of which the first says that so many follow.
  template <class Head>
  std::vector<protocol::Reply> all(const Message& message, const std::function<std::int32_t(const Head&)>& more) {
    send(message);
    std::vector<protocol::Reply> replies;
    do {
      const auto some = notice(client_);
      if (some.empty() || !some.front().holds<Head>() == replies.empty()) return {};
      replies.insert(replies.end(), some.begin(), some.end());
    } while (replies.size() < 1 + static_cast<std::size_t>(more(replies.front().get<Head>())));
    return replies;
  }
  std::vector<protocol::Reply> scene() {
    return all<protocol::SceneReply>({"/scene/describe", {}},
                                     [](const auto& head) { return head.bodies + head.statics; });
  }
  std::int32_t scene_version() {
    const auto replies = scene();
    return replies.empty() ? -1 : replies.front().get<protocol::SceneReply>().version;
  }
  template <class Struct>
  std::optional<Struct> ask(const Message& message) {
    send(message);
    const auto answer = reply();
    const auto* wanted = answer ? answer->get_if<Struct>() : nullptr;
    return wanted ? std::optional(*wanted) : std::nullopt;
  }
  std::optional<protocol::ObjectReply> bell() { return ask<protocol::ObjectReply>({"/object/bell/describe", {}}); }
  void load_scene() {
    ASSERT_TRUE(ask<protocol::Done>({"/scene/load", {folder_.write("drop.toml", kScene).string()}}));
  }
};

TEST_F(DescribeTest, AnObjectIsDescribedAsItWasSet) {
  load("bell");
  serve();
  auto told = bell();
  ASSERT_TRUE(told);
  EXPECT_EQ(told->name, "bell");
  EXPECT_EQ(told->bank, (folder_ / "tick.glb").string());
  EXPECT_EQ(static_cast<std::uintmax_t>(told->bank_bytes), std::filesystem::file_size(folder_ / "tick.glb"));
  EXPECT_EQ(told->modes, 1);
  EXPECT_EQ(told->selected_modes, 1);
  EXPECT_EQ(told->scale, modal::MaterialScale{});
  EXPECT_EQ(told->gain, 1);
  EXPECT_EQ(told->pan, 0);
  EXPECT_FALSE(told->group);
  const std::int32_t version = told->version;

  send({"/object/bell/gain", {0.5f}});
  send({"/object/bell/pan", {-0.25f}});
  send({"/object/bell/material", {2, 3, 0.5f, 4}});
  send({"/object/bell/group", {"metal"}});
  sync();
  told = bell();
  ASSERT_TRUE(told);
  EXPECT_EQ(told->scale, (modal::MaterialScale{2, 3, 0.5, 4, 1}));
  EXPECT_EQ(told->gain, 0.5);
  EXPECT_EQ(told->pan, -0.25);
  EXPECT_EQ(told->group, "metal");
  EXPECT_EQ(told->version, version) << "it is still the same bank";

  send({"/load", {"bell", (folder_ / "tick.glb").string()}});
  sync();
  EXPECT_GT(bell()->version, version);
  EXPECT_EQ(bell()->bank_content, told->bank_content) << "the same file";
  EXPECT_NE(refusal({"/object/bowl/describe", {}}).find("bowl"), std::string::npos);
}

TEST_F(DescribeTest, AnObjectTellsWhatItBreaksInto) {
  ASSERT_TRUE(modal::write_bank(test::breaking_bar(6), folder_ / "bar.glb"));
  ASSERT_TRUE(session_.rack().load("bar", folder_ / "bar.glb"));
  load("bell");
  serve();
  const auto pieces = [&](std::int32_t pattern) {
    return all<protocol::PiecesReply>({"/object/bar/pieces", {pattern}},
                                      [](const auto& head) { return head.patterns + head.pieces; });
  };
  auto told = pieces(-1);
  ASSERT_EQ(told.size(), 2u) << "it is not armed";
  EXPECT_FALSE(told[0].get<protocol::PiecesReply>().broken);
  EXPECT_EQ(told[1].get<protocol::PatternReply>().pieces, 2);
  told = pieces(0);
  ASSERT_EQ(told.size(), 4u) << "while a level loads";
  EXPECT_FALSE(told[0].get<protocol::PiecesReply>().armed);
  const auto before = told[2].get<protocol::PieceReply>();
  const auto broken = all<protocol::BrokenReply>({"/object/bar/break", {0.02f, 0.f, 0.f, 0.f, 0.f, 0.5f}},
                                                 [](const auto& head) { return head.pieces; });
  ASSERT_EQ(broken.size(), 3u);
  EXPECT_EQ(broken[0].get<protocol::BrokenReply>().name, "bar");
  told = pieces(-1);
  ASSERT_EQ(told.size(), 4u);
  EXPECT_TRUE(told[0].get<protocol::PiecesReply>().broken);
  const auto &first = told[2].get<protocol::PieceReply>(), &second = told[3].get<protocol::PieceReply>();
  EXPECT_EQ(broken[1].get<protocol::PieceReply>().velocity_m_s, first.velocity_m_s);
  EXPECT_EQ(before.mass_kg, first.mass_kg);
  EXPECT_EQ(before.center_m, first.center_m);
  EXPECT_EQ(first.name, "bar.0");
  EXPECT_EQ(first.object, static_cast<std::int32_t>((*session_.rack().find({.name = "bar.0"}))->number));
  EXPECT_EQ(second.object, -1) << "it has no mode";
  EXPECT_NEAR(first.mass_kg * first.velocity_m_s.z + second.mass_kg * second.velocity_m_s.z, 0.25, 1e-6);
  EXPECT_NE(refusal({"/object/bar/strike", {0.f, 0.f, 0.f, 0.f, 0.f, 1.f}}).find("broken"), std::string::npos);
  EXPECT_NE(refusal({"/object/bell/break", {1.f, 1.f, 1.f, 0.f, 0.f, 1.f}}).find("[shatter]"), std::string::npos);
  ASSERT_TRUE(ask<protocol::Done>({"/object/bar/mend", {}}));
  EXPECT_EQ(pieces(-1).size(), 2u);
}

TEST_F(DescribeTest, ABankComesInPiecesThatMakeItsFile) {
  ASSERT_TRUE(modal::write_bank(test::random_bank(1, 40, 100), folder_ / "large.glb"));
  std::string wanted;
  {
    std::ifstream file(folder_ / "large.glb", std::ios::binary);
    wanted.assign(std::istreambuf_iterator<char>(file), {});
  }
  ASSERT_GT(wanted.size(), 2 * protocol::kMaxBankBytes);
  ASSERT_TRUE(session_.rack().load("bell", folder_ / "large.glb"));
  serve();
  std::string got;
  while (got.size() < wanted.size()) {
    const auto piece = ask<protocol::BankReply>({"/object/bell/bank", {static_cast<std::int32_t>(got.size())}});
    ASSERT_TRUE(piece);
    EXPECT_EQ(static_cast<std::size_t>(piece->total), wanted.size());
    EXPECT_EQ(static_cast<std::size_t>(piece->offset), got.size());
    EXPECT_EQ(piece->bytes.size(), std::min<std::size_t>(protocol::kMaxBankBytes, wanted.size() - got.size()));
    for (const std::byte byte : piece->bytes) got.push_back(static_cast<char>(byte));
  }
  EXPECT_EQ(got, wanted);
  EXPECT_EQ(bell()->bank_content, hash_of(got).text());
  const auto end = static_cast<std::int32_t>(wanted.size());
  EXPECT_EQ(ask<protocol::BankReply>({"/object/bell/bank", {end - 1}})->bytes.size(), 1u);
  EXPECT_NE(refusal({"/object/bell/bank", {end}}).find("past the end"), std::string::npos);
  EXPECT_NE(refusal({"/object/bowl/bank", {0}}).find("bowl"), std::string::npos);
  std::ofstream(folder_ / "large.glb", std::ios::app) << "more";
  EXPECT_NE(refusal({"/object/bell/bank", {0}}).find("/load it again"), std::string::npos);
}

TEST_F(DescribeTest, ASceneIsDescribedWithAllItsParts) {
  serve();
  auto replies = scene();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_FALSE(replies[0].get<protocol::SceneReply>().file);
  load_scene();
  replies = scene();
  ASSERT_EQ(replies.size(), 4u);
  const auto head = replies[0].get<protocol::SceneReply>();
  EXPECT_EQ(head.bodies, 1);
  EXPECT_EQ(head.statics, 2);
  EXPECT_EQ(head.duration_s, 7);
  EXPECT_EQ(head.camera_m, (Vec3{1, 2, 3}));
  EXPECT_EQ(head.target_m, (Vec3{0, 0, 0.5}));
  EXPECT_EQ(head.field_of_view_degrees, 40);
  EXPECT_EQ(head.file, (folder_ / "drop.toml").string());
  const auto body = replies[1].get<protocol::SceneBody>();
  EXPECT_EQ(body.version, head.version);
  EXPECT_EQ(body.name, "ball");
  EXPECT_EQ(body.object, "bell");
  EXPECT_EQ(body.shape, "sphere");
  EXPECT_NEAR(body.size_m.x, 0.1, 1e-7);
  const auto floor = replies[2].get<protocol::SceneStatic>(), wall = replies[3].get<protocol::SceneStatic>();
  EXPECT_EQ(floor.shape, "plane");
  EXPECT_EQ(wall.number, 1);
  EXPECT_EQ(wall.shape, "box");
  EXPECT_EQ(wall.size_m, (Vec3{1, 2, 3}));
  EXPECT_EQ(wall.position_m, (Vec3{5, 0, 0}));
}

TEST_F(DescribeTest, TheScenesVersionGrowsWithWhatChangesAndWithNothingElse) {
  serve();
  load_scene();
  std::int32_t before = scene_version();
  const auto grows = [&] {
    const std::int32_t now = scene_version();
    return now > std::exchange(before, now);
  };
  const Message changes[] = {{"/scene/spawn/box", {"bell", 0.f, 0.f, 3.f, 1.f, 1.f, 1.f, 0.f, 0.f, 0.f, 10.f}},
                             {"/load", {"bell", (folder_ / "tick.glb").string()}},
                             {"/object/bell/free", {}},
                             {"/scene/clear", {}},
                             {"/scene/load", {(folder_ / "drop.toml").string()}}};
  const Message others[] = {{"/scene/pause", {1}}, {"/scene/push", {0, 0.f, 0.f, 0.1f}}, {"/scene/pause", {0}}};
  for (const Message& message : others) {
    ASSERT_TRUE(ask<protocol::Done>(message)) << message.address;
    EXPECT_FALSE(grows()) << message.address;
  }
  for (const Message& message : changes) {
    ASSERT_TRUE(ask<protocol::Done>(message)) << message.address;
    EXPECT_TRUE(grows()) << message.address;
  }
  ASSERT_TRUE(session_.scene().load(folder_ / "drop.toml", 0));
  before = scene_version();
  ASSERT_TRUE(session_.scene().change(protocol::ScenePush{0, {-300, 0, 0}}));  // some 570 m/s: it leaves within 2 s
  session_.scene().advance_to(3 * 48000, std::nullopt);
  EXPECT_EQ(session_.scene().body_count(), 0u);
  EXPECT_TRUE(grows()) << "a body left the scene";
}

TEST_F(DescribeTest, NoticesSayWhenTheirPosesAre) {
  serve();
  ASSERT_TRUE(session_.scene().load(folder_.write("drop.toml", kScene), 0));
  send({"/notify", {1, 50.f}});
  const double fall_s = 0.3;
  session_.scene().advance_to(std::llround(fall_s * kRate), std::nullopt);
  ASSERT_TRUE(session_.scene().pause(true));
  for (int i = 0; i < 1000; ++i) {
    const auto told = notice(client_);
    const auto scene =
        std::ranges::find_if(told, [](const protocol::Reply& r) { return r.holds<protocol::NotifyScene>(); });
    if (scene == told.end() || !scene->get<protocol::NotifyScene>().paused) continue;
    const auto body =
        std::ranges::find_if(told, [](const protocol::Reply& r) { return r.holds<protocol::NotifyBody>(); });
    ASSERT_NE(body, told.end());
    const auto [version, time_s, paused] = scene->get<protocol::NotifyScene>();
    EXPECT_NEAR(time_s, fall_s, 0.01);
    EXPECT_NEAR(body->get<protocol::NotifyBody>().position_m.z, 1 - 0.5 * 9.81 * time_s * time_s, 1e-3);
    send({"/notify", {0}});
    sync();
    EXPECT_EQ(version, scene_version());
    return;
  }
  FAIL() << "no notice of a scene that is paused";
}

TEST_F(DescribeTest, APushGivesABodyTheImpulseAndOthersAreRefused) {
  serve();
  EXPECT_NE(refusal({"/scene/push", {0, 0.f, 0.f, 1.f}}).find("no scene"), std::string::npos);
  load_scene();
  const double mass = 1000 * 4 / 3.0 * std::numbers::pi * 0.05 * 0.05 * 0.05;
  const double before = session_.scene().poses().bodies[0].velocity_m_s.x;
  ASSERT_TRUE(ask<protocol::Done>({"/scene/push", {0, 0.5f, 0.f, 0.f}}));
  EXPECT_NEAR(session_.scene().poses().bodies[0].velocity_m_s.x - before, 0.5 / mass, 1e-6);
  EXPECT_NE(refusal({"/scene/push", {7, 0.f, 0.f, 1.f}}).find("no body 7"), std::string::npos);
}

TEST_F(DescribeTest, TheStatusSaysWhetherARecordingRuns) {
  serve();
  EXPECT_FALSE(ask<protocol::StatusReply>({"/status", {}})->recording);
  ASSERT_TRUE(ask<protocol::Done>({"/record/start", {(folder_ / "a.osc").string()}}));
  EXPECT_TRUE(ask<protocol::StatusReply>({"/status", {}})->recording);
  ASSERT_TRUE(ask<protocol::Done>({"/record/stop", {}}));
  EXPECT_FALSE(ask<protocol::StatusReply>({"/status", {}})->recording);
}

class BrowseTest : public testing::Test {
 protected:
  [[nodiscard]] std::set<std::string> browsed(const session::FileRoots& roots) const {
    std::set<std::string> found;
    const auto files = browse(roots);
    if (!files) ADD_FAILURE() << files.error().message;
    if (!files) return found;
    for (const auto& file : *files) found.insert(file.kind + " " + file.path);
    return found;
  }
  test::TemporaryFolder folder_;
};

TEST_F(BrowseTest, WithoutDescriptorsBrowsingIsRefusedAndDoesNotFindNothing) {
  const auto roots = session::FileRoots::only({folder_.path()});
  ASSERT_TRUE(roots);
  const auto try_it = [&roots] {
    test::run_out_of_descriptors();
    const auto files = browse(*roots);
    std::_Exit(!files && files.error().message.find("Too many open files") != std::string::npos ? 0 : 1);
  };
  EXPECT_EXIT(try_it(), testing::ExitedWithCode(0), "");
}

TEST_F(BrowseTest, AFolderThatIsGoneCountsAsEmpty) {
  std::filesystem::create_directory(folder_ / "gone");
  const auto roots = session::FileRoots::only({folder_ / "gone"});
  ASSERT_TRUE(roots);
  std::filesystem::remove(folder_ / "gone");
  const auto files = browse(*roots);
  EXPECT_TRUE(files && files->empty());
}

TEST_F(BrowseTest, EveryPresetCanBeBrowsedOnceAndNothingElse) {
  const std::filesystem::path presets = RINGDOWN_SOURCE_DIR "/presets";
  const auto roots = session::FileRoots::only({presets, presets / "banks"});
  ASSERT_TRUE(roots);
  std::set<std::filesystem::path> wanted, found;
  for (const auto& [folder, ending] : {std::pair("scenes", ".toml"), std::pair("banks", ".glb")}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(presets / folder)) {
      if (entry.path().extension() == ending) wanted.insert(entry.path());
    }
  }
  std::int32_t number = 0;
  const auto files = browse(*roots);
  ASSERT_TRUE(files);
  for (const protocol::BrowseFile& file : *files) {
    EXPECT_EQ(file.number, number++);
    EXPECT_EQ(file.kind, file.path.ends_with(".toml") ? "scene" : "bank");
    EXPECT_TRUE(roots->read(file.path, 1 << 30)) << "as /load takes it";
    EXPECT_TRUE(found.insert(std::filesystem::absolute(file.path)).second);
  }
  EXPECT_EQ(found, wanted);
}

TEST_F(BrowseTest, FilesOutsideHiddenOrDeepCannotBeBrowsed) {
  std::filesystem::create_directories(folder_ / "in/a/b/c/d/e");
  std::filesystem::create_directories(folder_ / "in/.hidden");
  std::filesystem::create_directories(folder_ / "in/scenes");
  for (const char* name : {"out.glb", "in/a.glb", "in/.hidden/b.glb", "in/a/b/c/d/deep.glb", "in/a/b/c/d/e/deeper.glb",
                           "in/scenes/s.toml", "in/a/no.toml"}) {
    static_cast<void>(folder_.write(name, ""));
  }
  std::filesystem::create_symlink(folder_ / "out.glb", folder_ / "in/link.glb");
  std::filesystem::create_directory_symlink(folder_.path(), folder_ / "in/up");
  const std::string in = "bank " + (folder_ / "in").string();
  EXPECT_EQ(browsed(*session::FileRoots::only({folder_ / "in"})),
            (std::set<std::string>{in + "/a.glb", in + "/a/b/c/d/deep.glb",
                                   "scene " + (folder_ / "in").string() + "/scenes/s.toml"}));
  EXPECT_TRUE(browsed({}).empty()) << "a program that may open all has no folders to look in";
}

TEST_F(BrowseTest, FilesAreBrowsedUpToTheLimitAndNotOneMore) {
  for (std::size_t i = 0; i < kMaxBrowsed; ++i) static_cast<void>(folder_.write(std::to_string(i) + ".glb", ""));
  EXPECT_EQ(browse(*session::FileRoots::only({folder_.path()}))->size(), kMaxBrowsed);
  static_cast<void>(folder_.write("more.glb", ""));
  EXPECT_EQ(browse(*session::FileRoots::only({folder_.path()}))->size(), kMaxBrowsed);
}

TEST(Bundles, BundlesHoldSixteenMessagesOrTheirLimitOfBytesAndKeepTheOrder) {
  std::vector<protocol::Reply> replies;
  for (std::int32_t i = 0; i < 40; ++i) replies.emplace_back(protocol::Synced{i});
  for (std::int32_t i = 40; i < 45; ++i) replies.emplace_back(protocol::BankReply{"a", 1, i, 9, wire::Blob(8192)});
  std::vector<std::size_t> sizes;
  std::vector<protocol::Reply> got;
  send_in_bundles(replies, [&](std::span<const std::byte> packet) {
    EXPECT_LE(packet.size(), wire::kMaxPacketBytes);
    const auto messages = wire::decode_packet(packet);
    ASSERT_TRUE(messages);
    sizes.push_back(messages->size());
    for (const auto& timed : *messages) got.push_back(*protocol::parse_reply(timed.message));
  });
  ASSERT_EQ(got.size(), replies.size());
  for (std::size_t i = 0; i < got.size(); ++i) EXPECT_EQ(got[i].index(), replies[i].index());
  EXPECT_EQ(sizes, (std::vector<std::size_t>{16, 16, 11, 2}));
}

}  // namespace
}  // namespace ringdown::server
