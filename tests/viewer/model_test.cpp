// What the model learns from replies and notices, and which questions it asks.
#include "clients/viewer/link/model.h"
#include "protocol/schema.h"
#include "protocol/wire/message.h"
#include "tests/viewer/preset_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <thread>

namespace ringdown::viewer {
namespace {

using namespace ringdown::test;

// With a bank of its own.
protocol::ObjectReply described(const std::string& name, std::int32_t version = 1, std::int32_t bytes = 1000) {
  protocol::ObjectReply reply;
  reply.number = 0;
  reply.name = name;
  reply.version = version;
  reply.bank_bytes = bytes;
  reply.bank_content = name + std::to_string(version);
  reply.bank = name + ".glb";
  reply.modes = 30;
  reply.selected_modes = 30;
  return reply;
}

class ModelTest : public testing::Test {
 protected:
  Model model{30};

  template <class Struct>
  std::vector<Struct> asked(double now_s) {
    std::vector<Struct> found;
    for (const auto& request : model.wants(now_s)) {
      if (const auto* wanted = request.get_if<Struct>()) found.push_back(*wanted);
    }
    return found;
  }
  std::set<std::string> asked_to_describe(double now_s) {
    std::set<std::string> names;
    for (const auto& request : asked<protocol::DescribeObject>(now_s)) names.insert(request.object.name);
    return names;
  }
};

TEST_F(ModelTest, WithoutADaemonTheModelAsksNothing) { EXPECT_TRUE(model.wants(1).empty()); }

TEST_F(ModelTest, EveryRequestOfTheModelIsValidInTheProtocol) {
  model.choose("bell");
  model.watch_sound(true);
  model.apply(protocol::NotifyScene{1, 0, false}, 0);
  model.apply(protocol::NotifyObject{0, "gong", true}, 0);
  model.apply(described("bell"), 0);
  const auto requests = model.wants(0);
  EXPECT_GE(requests.size(), 6u);
  for (const auto& request : requests) {
    const auto back = protocol::parse(protocol::format(request));
    EXPECT_TRUE(back) << back.error().message;
  }
}

TEST_F(ModelTest, AnObjectNamedInANoticeIsAskedForUntilItIsDescribed) {
  model.apply(protocol::NotifyObject{3, "bell", true}, 0);
  EXPECT_TRUE(model.objects().empty());
  EXPECT_TRUE(asked_to_describe(0).contains("bell"));
  EXPECT_FALSE(asked_to_describe(0.3).contains("bell"));
  EXPECT_TRUE(asked_to_describe(0.6).contains("bell"));
  protocol::ObjectReply reply = described("bell");
  reply.gain = 0.5;
  reply.group = "metal";
  reply.first_mode = 2;
  reply.selected_modes = 5;
  model.apply(reply, 0.7);
  const KnownObject* bell = model.object("bell");
  ASSERT_TRUE(bell);
  EXPECT_EQ(bell->gain, 0.5);
  EXPECT_EQ(bell->group, "metal");
  EXPECT_EQ(bell->selected, (modal::ModeRange{2, 5}));
}

TEST_F(ModelTest, KnownObjectsAreAskedForInTurn) {
  for (const char* name : {"a", "b", "c"}) model.apply(described(name), 0);
  std::vector<std::string> turns;
  for (double now = 0; now < 13; now += 0.1) {
    for (const std::string& name : asked_to_describe(now)) turns.push_back(name);
  }
  EXPECT_EQ(turns, (std::vector<std::string>{"a", "b", "c", "a", "b", "c", "a"}));
}

TEST_F(ModelTest, ObjectsWhoseNoticeWasLostAreAskedForAllTheSame) {
  model.apply(protocol::NotifyObjectPeak{"bell", 0.1}, 0);
  model.apply(protocol::NotifyContact{"gong", {}, {}, 0}, 0);
  const auto names = asked_to_describe(0);
  EXPECT_TRUE(names.contains("bell") && names.contains("gong"));

  Model silent(30);
  silent.apply(protocol::StatusReply{.objects = 2}, 0);
  silent.apply(described("bell"), 0);
  const auto requests = silent.wants(0);
  EXPECT_TRUE(std::ranges::any_of(requests, [](const protocol::Request& request) {
    const auto* describe = request.get_if<protocol::DescribeObject>();
    return describe && describe->object.name == "*";
  }));
}

TEST_F(ModelTest, AnObjectThatIsFreedOrNotThereIsForgotten) {
  model.apply(described("bell"), 0);
  model.apply(protocol::NotifyObject{0, "bell", false}, 1);
  EXPECT_TRUE(model.objects().empty());
  model.apply(described("bell"), 2);
  model.apply(protocol::NotifyObject{1, "gong", true}, 2);
  model.apply(protocol::Fail{"/object/bell/describe", "no object bell"}, 3);
  model.apply(protocol::Fail{"/object/gong/describe", "no object gong"}, 3);
  EXPECT_TRUE(model.objects().empty());
  EXPECT_TRUE(asked_to_describe(9).empty());
  EXPECT_TRUE(model.messages().empty()) << "nobody asked for that";
}

TEST_F(ModelTest, TheModelKeepsNoMoreObjectsThanItsBound) {
  for (std::size_t i = 0; i <= KnownObjects::kMaxKnownObjects; ++i) model.apply(described("o" + std::to_string(i)), 0);
  EXPECT_EQ(model.objects().size(), KnownObjects::kMaxKnownObjects);
  EXPECT_TRUE(model.object("o" + std::to_string(KnownObjects::kMaxKnownObjects - 1)));
  EXPECT_FALSE(model.object("o" + std::to_string(KnownObjects::kMaxKnownObjects)));
}

class ModelWithFile : public ModelTest {
 protected:
  // Answers as a daemon with this file would, until the bank of the object is there or faulty.
  void serve(const std::string& name, std::int32_t version, const wire::Blob& file, double from_s) {
    double now = from_s;
    const std::string fault = model.object(name)->bank_fault;
    const auto settled = [&] { return model.object(name)->bank || model.object(name)->bank_fault != fault; };
    for (int i = 0; i < 6000 && !settled(); ++i, now += 0.016) {
      for (const auto& question : asked<protocol::ReadBank>(now)) {
        if (question.object.name != name) continue;
        model.apply(piece_of(file, name, version, question.offset, question.bytes), now);
      }
      if (model.object(name)->bank_progress == 1) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  static protocol::ObjectReply playing(const wire::Blob& file, const std::string& name, std::int32_t version = 1) {
    protocol::ObjectReply reply = described(name, version, static_cast<std::int32_t>(file.size()));
    reply.bank_content = content_of(file);
    return reply;
  }
};

TEST_F(ModelWithFile, TheBankOfTheChosenObjectIsFetchedFirst) {
  const auto file = bytes_of(preset_bank("wine-glass"));
  for (const char* name : {"a", "b"}) model.apply(described(name), 0);
  model.apply(playing(file, "z"), 0);
  model.choose("z");
  for (const auto& question : asked<protocol::ReadBank>(0)) EXPECT_EQ(question.object.name, "z");
  serve("z", 1, file, 0.1);
  ASSERT_TRUE(model.object("z")->bank);
  EXPECT_GT(model.object("z")->bank->bank.mode_count(), 0u);
  for (const auto& question : asked<protocol::ReadBank>(1)) EXPECT_EQ(question.object.name, "a");
}

// A body and its pieces are models of one file.
TEST_F(ModelWithFile, AFileIsFetchedOnceForAllOfItsModels) {
  const auto file = bytes_of(preset_bank("tumbler"));
  for (const auto& [name, path] : {std::pair{"a", "tumbler.glb"}, {"a.0", "tumbler.glb#1"}, {"a.1", "tumbler.glb#2"}}) {
    protocol::ObjectReply reply = playing(file, name);
    reply.bank = path;
    model.apply(reply, 0);
  }
  serve("a", 1, file, 0.1);
  std::set<std::size_t> points;
  for (const char* name : {"a", "a.0", "a.1"}) {
    for (int i = 0; i < 500 && !model.object(name)->bank; ++i) {
      EXPECT_TRUE(asked<protocol::ReadBank>(200 + 0.016 * i).empty());
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ASSERT_TRUE(model.object(name)->bank) << name;
    points.insert(model.object(name)->bank->bank.point_count());
  }
  EXPECT_EQ(points.size(), 3u) << "three different surfaces";
}

TEST_F(ModelWithFile, ANewBankReplacesTheOldAndTheirPiecesDoNotMix) {
  const auto glass = bytes_of(preset_bank("wine-glass")), bell = bytes_of(preset_bank("bronze-bell"));
  model.apply(playing(glass, "x", 1), 0);
  const auto questions = asked<protocol::ReadBank>(0);
  model.apply(playing(bell, "x", 2), 0.1);
  for (const auto& question : questions) model.apply(piece_of(glass, "x", 1, question.offset, question.bytes), 0.2);
  serve("x", 2, bell, 0.3);
  ASSERT_TRUE(model.object("x")->bank);
  EXPECT_NE(model.object("x")->bank->bank.name.find("bell"), std::string::npos) << model.object("x")->bank->bank.name;
  model.apply(playing(bell, "x", 2), 2);
  EXPECT_TRUE(model.object("x")->bank) << "told again, but not changed";
  model.apply(playing(glass, "x", 3), 3);
  EXPECT_FALSE(model.object("x")->bank);
}

TEST_F(ModelWithFile, AnImpossibleBankSizeEndsInASentence) {
  model.apply(described("x", 1, std::numeric_limits<std::int32_t>::max()), 0);
  EXPECT_TRUE(asked<protocol::ReadBank>(0).empty());
  EXPECT_TRUE(asked<protocol::ReadBank>(1).empty());
  EXPECT_NE(model.object("x")->bank_fault.find("x"), std::string::npos);
  EXPECT_TRUE(asked<protocol::ReadBank>(100).empty()) << "it will not shrink";
}

TEST_F(ModelWithFile, ARefusedBankIsAskedForAgainLater) {
  const auto file = bytes_of(preset_bank("wine-glass"));
  model.apply(playing(file, "x", 1), 0);
  EXPECT_FALSE(asked<protocol::ReadBank>(0).empty());
  model.apply(protocol::Fail{"/object/x/bank", "the file has changed"}, 0.1);
  EXPECT_TRUE(asked<protocol::ReadBank>(0.2).empty());
  EXPECT_EQ(model.object("x")->bank_fault, "the file has changed");
  EXPECT_TRUE(asked<protocol::ReadBank>(3).empty());
  EXPECT_FALSE(asked<protocol::ReadBank>(6).empty());
}

TEST_F(ModelWithFile, ObjectsThatPlayTheSameFileShareItsBank) {
  const auto coin = bytes_of(preset_bank("coin")), glass = bytes_of(preset_bank("wine-glass"));
  for (const char* name : {"a", "b"}) model.apply(playing(coin, name), 0);
  model.apply(playing(glass, "c"), 0);
  serve("a", 1, coin, 0);
  const auto questions = asked<protocol::ReadBank>(50);
  ASSERT_TRUE(model.object("a")->bank);
  EXPECT_EQ(model.object("b")->bank, model.object("a")->bank);
  EXPECT_FALSE(model.object("c")->bank);
  ASSERT_FALSE(questions.empty());
  for (const auto& question : questions) EXPECT_EQ(question.object.name, "c");
  model.apply(playing(coin, "d"), 51);
  model.wants(51);
  EXPECT_EQ(model.object("d")->bank, model.object("a")->bank) << "one that comes later";
  model.apply(playing(glass, "b", 2), 52);
  model.wants(52);
  EXPECT_FALSE(model.object("b")->bank);
  EXPECT_TRUE(model.object("d")->bank);
}

TEST_F(ModelWithFile, BanksAreFetchedUpToABoundOnAllTogether) {
  const auto coin = bytes_of(preset_bank("coin")), glass = bytes_of(preset_bank("wine-glass"));
  const std::size_t bytes = coin.size() + glass.size();
  for (const std::size_t short_by : {0, 1}) {
    model = Model(30, bytes - short_by);
    for (const char* name : {"a", "b"}) model.apply(playing(coin, name), 0);
    serve("a", 1, coin, 0);
    model.apply(playing(glass, "c"), 1);
    serve("c", 1, glass, 1);
    EXPECT_TRUE(model.object("a")->bank && model.object("b")->bank) << "which counts once";
    EXPECT_EQ(model.object("c")->bank != nullptr, short_by == 0);
  }
  EXPECT_NE(model.object("c")->bank_fault.find(std::to_string(bytes - 1)), std::string::npos);
  for (const char* name : {"a", "b"}) model.apply(protocol::NotifyObject{0, name, false}, 100);
  serve("c", 1, glass, 101);
  EXPECT_TRUE(model.object("c")->bank) << "there is room now";
}

TEST_F(ModelTest, ANewDaemonIsLearntFromTheBeginning) {
  model.choose("bell");
  model.apply(described("bell"), 0);
  model.apply(protocol::NotifyScene{9, 5, false}, 0);
  model.apply(protocol::Fail{"/load", "cannot"}, 0);
  model.restart();
  EXPECT_TRUE(model.objects().empty());
  EXPECT_TRUE(model.messages().empty());
  EXPECT_EQ(model.chosen(), "bell");
  EXPECT_TRUE(model.wants(1).empty());
  model.apply(protocol::NotifyScene{1, 0, false}, 1);  // a lower version is no late one now
  EXPECT_EQ(asked<protocol::SceneDescribe>(1).size(), 1u);
}

TEST_F(ModelTest, TheChosenObjectIsWatchedThenTheLoudest) {
  for (int i = 0; i < 20; ++i) {
    const std::string name = "o" + std::to_string(i);
    model.apply(described(name), 0);
    model.apply(protocol::NotifyObjectPeak{name, 0.01 * (i + 1)}, 0);
  }
  model.choose("o0");
  std::set<std::string> watched;
  for (const auto& request : asked<protocol::WatchObject>(0)) watched.insert(request.object.name);
  EXPECT_EQ(watched.size(), ObjectWatches::kMaxWatched);
  EXPECT_TRUE(watched.contains("o0"));
  for (int i = 5; i < 20; ++i) EXPECT_TRUE(watched.contains("o" + std::to_string(i)));

  model.apply(protocol::NotifyObjectPeak{"o2", 0.9}, 1);
  bool ends_one = false, begins = false;
  for (const auto& request : asked<protocol::WatchObject>(1)) {
    if (!request.on) ends_one = request.object.name == "o5";
    if (request.on && request.object.name == "o2") begins = ends_one;  // there are no more places than that
  }
  EXPECT_TRUE(ends_one && begins);
}

TEST_F(ModelTest, AWatchedObjectIsKeptUntilAnotherIsMuchLouder) {
  for (int i = 0; i < 17; ++i) {
    const std::string name = "o" + std::to_string(i);
    model.apply(described(name), 0);
    model.apply(protocol::NotifyObjectPeak{name, i < 16 ? 0.1 : 0.05}, 0);
  }
  model.wants(0);
  model.apply(protocol::NotifyObjectPeak{"o16", 0.2}, 1);
  for (const auto& request : asked<protocol::WatchObject>(1)) EXPECT_TRUE(request.on);
}

TEST_F(ModelTest, AmplitudesAreStoredByRank) {
  model.apply(described("bell"), 0);
  model.apply(protocol::NotifyModes{"bell", 28, wire::encode_floats(std::vector<float>{0.5f, 0.25f})}, 1);
  const auto& amplitudes = model.object("bell")->amplitudes;
  ASSERT_EQ(amplitudes.size(), 30u);
  EXPECT_EQ(amplitudes[28], 0.5f);
  EXPECT_EQ(amplitudes[29], 0.25f);
  EXPECT_EQ(amplitudes[0], 0);
}

TEST_F(ModelTest, AmplitudesOfModesThatDoNotExistAreIgnored) {
  model.apply(described("bell"), 0);
  const auto one = wire::encode_floats(std::vector<float>{0.5f});
  for (const std::int32_t first : {30, -1, std::numeric_limits<std::int32_t>::max()}) {
    model.apply(protocol::NotifyModes{"bell", first, one}, 1);
  }
  model.apply(protocol::NotifyModes{"nobody", 0, one}, 1);
  EXPECT_TRUE(model.object("bell")->amplitudes.empty());
  EXPECT_EQ(model.objects().size(), 1u);
  protocol::ObjectReply huge = described("huge");
  huge.modes = std::numeric_limits<std::int32_t>::max();
  model.apply(huge, 1);
  model.apply(protocol::NotifyModes{"huge", 0, one}, 1);
  EXPECT_EQ(model.object("huge")->amplitudes.size(), KnownObjects::kMaxModes);
}

TEST_F(ModelTest, ContactsAreKeptForTwoSecondsAndNoMoreThanTheBound) {
  for (std::size_t i = 0; i <= Model::kMaxContacts; ++i) {
    model.apply(protocol::NotifyContact{"bell", {1.0 * i, 0, 0}, {0, 0, -1}, 0.001}, 10);
  }
  ASSERT_EQ(model.contacts().size(), Model::kMaxContacts);
  EXPECT_EQ(model.contacts().front().point_m.x, 1);
  model.wants(11.9);
  EXPECT_EQ(model.contacts().size(), Model::kMaxContacts);
  model.wants(12.1);
  EXPECT_TRUE(model.contacts().empty());
}

TEST_F(ModelTest, ThePeakLevelIsHeldForASecond) {
  for (const auto& [now, peak] : {std::pair{0.0, 0.9}, {0.5, 0.2}, {1.0, 0.3}}) {
    model.apply(protocol::NotifyPeak{peak}, now);
    EXPECT_EQ(model.peak().held, 0.9);
    EXPECT_EQ(model.peak().now, peak);
  }
  model.apply(protocol::NotifyPeak{0.1}, 1.1);
  EXPECT_EQ(model.peak().held, 0.1);
}

TEST_F(ModelTest, SoundIsSubscribedUntilItComesAndUnsubscribedUntilItEnds) {
  const protocol::NotifySound piece{0, 48000, wire::Blob(8)};
  model.apply(protocol::NotifyPeak{}, 0);
  EXPECT_TRUE(asked<protocol::WatchSound>(0).empty());
  model.watch_sound(true);
  ASSERT_EQ(asked<protocol::WatchSound>(0).size(), 1u);
  EXPECT_TRUE(asked<protocol::WatchSound>(0.5).empty());
  EXPECT_EQ(asked<protocol::WatchSound>(1.1).size(), 1u);
  model.apply(piece, 1.2);
  EXPECT_TRUE(asked<protocol::WatchSound>(2.15).empty());
  EXPECT_EQ(asked<protocol::WatchSound>(3).size(), 1u) << "it stopped coming";
  model.apply(piece, 4);
  model.watch_sound(false);
  const auto end = asked<protocol::WatchSound>(4.1);
  ASSERT_EQ(end.size(), 1u);
  EXPECT_FALSE(end[0].on);
  EXPECT_TRUE(asked<protocol::WatchSound>(9).empty());
}

TEST_F(ModelTest, FilesAreListedOncePerDaemonThoughPartsAreLost) {
  model.apply(protocol::NotifyPeak{}, 0);
  EXPECT_EQ(asked<protocol::Browse>(0).size(), 1u);
  EXPECT_TRUE(asked<protocol::Browse>(0.3).empty());
  model.apply(protocol::BrowseFile{1, "bank", "b.glb"}, 0.4);
  model.apply(protocol::BrowseReply{2}, 0.4);
  EXPECT_EQ(asked<protocol::Browse>(0.6).size(), 1u);
  model.apply(protocol::BrowseReply{2}, 0.7);
  model.apply(protocol::BrowseFile{0, "scene", "a.toml"}, 0.7);
  EXPECT_EQ(model.files().scenes(), std::vector<std::string>{"a.toml"});
  EXPECT_EQ(model.files().banks(), std::vector<std::string>{"b.glb"});
  EXPECT_TRUE(asked<protocol::Browse>(99).empty());
  model.files().browse_again();
  EXPECT_EQ(asked<protocol::Browse>(100).size(), 1u);
  EXPECT_EQ(model.files().scenes().size(), 1u) << "the old list stands until the new one is there";
}

TEST_F(ModelTest, TheModelKeepsNoMoreFilesThanItsBound) {
  model.apply(protocol::BrowseReply{std::numeric_limits<std::int32_t>::max()}, 0);
  const auto max = static_cast<std::int32_t>(FileBrowser::kMaxFiles);
  for (std::int32_t i = 0; i < max - 1; ++i) model.apply(protocol::BrowseFile{i, "bank", "x.glb"}, 0);
  EXPECT_TRUE(model.files().banks().empty());
  model.apply(protocol::BrowseFile{max - 1, "bank", "x.glb"}, 0);
  EXPECT_EQ(model.files().banks().size(), FileBrowser::kMaxFiles);
  model.apply(protocol::BrowseFile{max, "bank", "x.glb"}, 0);
  EXPECT_EQ(model.files().banks().size(), FileBrowser::kMaxFiles);
}

TEST_F(ModelTest, MessagesAreKeptUpToTheBound) {
  for (std::size_t i = 0; i <= Model::kMaxMessages; ++i) {
    model.apply(protocol::Fail{"/load", "sentence " + std::to_string(i)}, 1.0 * i);
  }
  EXPECT_EQ(model.messages().size(), Model::kMaxMessages);
  EXPECT_EQ(model.messages().front().sentence, "sentence 1");
  model.apply(protocol::Done{"/load", 4}, 99);
  EXPECT_FALSE(model.messages().back().failed);
  EXPECT_EQ(model.messages().back().number, 4);
}

TEST_F(ModelTest, RecordingFollowsTheStatus) {
  EXPECT_FALSE(model.recording());
  model.apply(protocol::StatusReply{.recording = true}, 0);
  EXPECT_TRUE(model.recording());
}

}  // namespace
}  // namespace ringdown::viewer
