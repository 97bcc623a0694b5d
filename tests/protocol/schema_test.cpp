// The table of addresses: what it accepts, refuses, and says about it. A new address without cases, or an argument that
// no case refuses, fails.
#include "protocol/schema.h"

#include "tests/protocol/schema_cases.h"

#include <gtest/gtest.h>

#include <set>

namespace ringdown::protocol {
namespace {

TEST(Schema, EveryAddressHasCasesAndEveryArgumentIsRefusedByOne) {
  ASSERT_EQ(addresses().size(), all_cases().size());
  for (const AddressSpec& spec : addresses()) {
    const auto cases = all_cases().find(std::string(spec.address));
    ASSERT_NE(cases, all_cases().end()) << spec.address << " has no cases";
    EXPECT_FALSE(cases->second.good.empty()) << spec.address;
    std::set<std::string> refused;
    for (const Bad& bad : cases->second.bad) refused.insert(bad.argument);
    for (const ArgumentSpec& argument : spec.arguments) {
      EXPECT_TRUE(refused.contains(std::string(argument.name))) << spec.address << " " << argument.name;
    }
  }
}

TEST(Schema, TheTableStandsInTheOrderOfTheAlternatives) {
  ASSERT_EQ(addresses().size(), Requests::kCount);
  ASSERT_EQ(reply_addresses().size(), Replies::kCount);
  for (std::size_t i = 0; i < addresses().size(); ++i) {
    const Result<Request> request = parse(addresses()[i].example);
    ASSERT_TRUE(request) << request.error().message;
    EXPECT_EQ(request->index(), i) << addresses()[i].address;
  }
}

TEST(Schema, GoodArgumentsFillTheStruct) {
  for (const auto& [pattern, cases] : all_cases()) {
    for (const Good& good : cases.good) {
      const Result<Request> request = parse({good.address, good.arguments});
      ASSERT_TRUE(request) << request.error().message;
      EXPECT_TRUE(good.claim(*request)) << good.address << " with " << good.arguments.size() << " arguments";
    }
  }
}

TEST(Schema, EveryRefusalNamesTheAddressAndTheArgument) {
  for (const auto& [pattern, cases] : all_cases()) {
    for (const Bad& bad : cases.bad) {
      const Result<Request> request = parse({bad.address, bad.arguments});
      ASSERT_FALSE(request) << bad.address << " took a bad " << bad.argument;
      const std::string& sentence = request.error().message;
      EXPECT_TRUE(sentence.starts_with(bad.address)) << sentence;
      const bool is_name = !bad.argument.starts_with("argument");
      EXPECT_NE(sentence.find(is_name ? "(" + bad.argument + ")" : bad.argument), sentence.npos) << sentence;
    }
  }
}

TEST(Schema, AnArgumentTooManyIsRefused) {
  for (const AddressSpec& spec : addresses()) {
    wire::Message message = spec.example;
    message.arguments.resize(spec.arguments.size() - spec.arguments_in_address(), 0);
    message.arguments.emplace_back(0);
    const Result<Request> request = parse(message);
    ASSERT_FALSE(request) << spec.address;
    EXPECT_NE(request.error().message.find("one too many"), std::string::npos) << request.error().message;
  }
}

TEST(Schema, FormatIsTheInverseOfParse) {
  for (const auto& [pattern, cases] : all_cases()) {
    for (const Good& good : cases.good) {
      const Result<Request> request = parse({good.address, good.arguments});
      ASSERT_TRUE(request) << request.error().message;
      const wire::Message message = format(*request);
      const Result<Request> again = parse(message);
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_TRUE(good.claim(*again)) << good.address;
      EXPECT_EQ(format(*again), message);
    }
  }
}

TEST(Schema, FormatWritesWhatAClientWouldSend) {
  const Strike strike{named("bell"), {{1, 2, 3}, {4, 5, 6}, 0.001}};
  EXPECT_EQ(format(Request(strike)), (wire::Message{"/object/bell/strike", {1., 2., 3., 4., 5., 6., 0.001}}));
  const SpawnSphere ball{std::nullopt, {0, 0, 1}, {0, 0, 0}, 0.5, 7800};
  EXPECT_EQ(format(Request(ball)), (wire::Message{"/scene/spawn/sphere", {"-", 0., 0., 1., 0.5, 0., 0., 0., 7800.}}));
  EXPECT_EQ(format(Request(FreeObject{numbered(4)})), (wire::Message{"/object/4/free", {}}));
}

TEST(Schema, SwitchesTakeTrueAndFalseAndNothingElseDoes) {
  int switches = 0, others = 0;
  for (const AddressSpec& spec : addresses()) {
    for (std::size_t i = spec.arguments_in_address(); i < spec.arguments.size(); ++i) {
      const std::size_t position = i - spec.arguments_in_address();
      wire::Message message = spec.example;
      message.arguments.resize(std::max(message.arguments.size(), position + 1), 0);
      for (const bool on : {true, false}) {
        message.arguments[position] = on;
        const Result<Request> request = parse(message);
        if (spec.arguments[i].type == ValueType::flag) {
          ASSERT_TRUE(request) << request.error().message;
          EXPECT_EQ(format(*request).arguments[position], wire::Argument(on ? 1 : 0)) << spec.address;
          ++switches;
        } else {
          ASSERT_FALSE(request) << spec.address << " " << spec.arguments[i].name;
          EXPECT_NE(request.error().message.find(on ? "is true;" : "is false;"), std::string::npos)
              << request.error().message;
          ++others;
        }
      }
    }
  }
  EXPECT_GE(switches, 12);
  EXPECT_GE(others, 200);
}

TEST(Schema, NilLeavesAnOptionalArgumentOut) {
  const wire::Argument nil = wire::Tag{'N'};
  const Result<Request> request = parse({"/scene/spawn/box", {nil, 0., 0., 1., nil, nil, nil, 3., nil, nil, 2000.}});
  ASSERT_TRUE(request) << request.error().message;
  EXPECT_EQ(format(*request), (wire::Message{"/scene/spawn/box", {"-", 0., 0., 1., 0., 0., 0., 3., 0., 0., 2000.}}));
  const Result<Request> missing = parse({"/object/bell/gain", {nil}});
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("(gain) is nil (type N)"), std::string::npos) << missing.error().message;
}

TEST(Schema, AnImpulseAloneIsAMessageWithoutArguments) {
  const wire::Argument impulse = wire::Tag{'I'};
  EXPECT_TRUE(parse({"/clear", {impulse}}));
  EXPECT_TRUE(parse({"/notify", {impulse}}));
  EXPECT_FALSE(parse({"/object/bell/gain", {impulse}})) << "the gain is missing";
  EXPECT_FALSE(parse({"/object/bell/gain", {0.5, impulse}}));
  EXPECT_FALSE(parse({"/clear", {impulse, impulse}}));
}

TEST(Schema, ValuesThatNoRequestTakesAreRefusedByTheirNames) {
  for (const auto& [type, name] : {std::pair{'c', "a character (type c)"},
                                   {'m', "a MIDI message (type m)"},
                                   {'r', "a colour (type r)"},
                                   {'t', "a time tag (type t)"}}) {
    for (const char* address : {"/object/bell/gain", "/object/bell/mute", "/load", "/strikes", "/scene/push"}) {
      const Result<Request> request = parse({address, {wire::Tag{type}}});
      ASSERT_FALSE(request) << address;
      EXPECT_NE(request.error().message.find(name), std::string::npos) << request.error().message;
    }
  }
}

TEST(Schema, AnUnknownAddressSuggestsTheNearestOne) {
  const auto sentence = [](const std::string& address) { return parse({address, {}}).error().message; };
  EXPECT_NE(sentence("/object/bell/strik").find("/object/{object}/strike"), std::string::npos);
  EXPECT_NE(sentence("/object/my-long-bell-name/gian").find("/object/{object}/gain"), std::string::npos);
  EXPECT_NE(sentence("/scene/spwan/box").find("/scene/spawn/box"), std::string::npos);
  EXPECT_NE(sentence("/stauts").find("/status"), std::string::npos);
  EXPECT_NE(sentence("/stauts").find("'/stauts'"), std::string::npos);
  for (const char* odd :
       {"", "/", "//", "/object", "/object/", "/object/bell", "/object/bell/", "strike", "/status/"}) {
    EXPECT_FALSE(parse({odd, {}})) << odd;
  }
  EXPECT_FALSE(parse({"/" + std::string(100000, 'a'), {}}));
}

TEST(Schema, RepliesRoundTripInTypesPureDataKnows) {
  const StatusReply status{4,  1,  220, 6,  48000, 256, 0.25, 0.5, 7,  8, 9, 10,  0.375,
                           11, 12, 13,  14, 0.5,   2.5, true, 1.5, 20, 3, 1, 0.5, "take.wav"};
  const wire::Message message = format(Reply(status));
  EXPECT_EQ(message, (wire::Message{"/status.reply",
                                    {4,  1,  220, 6,  48000.f, 256,  0.25f, 0.5f, 7,    8, 9, 10,   0.375f,
                                     11, 12, 13,  14, 0.5f,    2.5f, 1,     1.5f, 20.f, 3, 1, 0.5f, "take.wav"}}));
  for (const Reply& reply :
       {Reply(Done{"/load", 3}),
        Reply(Done{"/quit", std::nullopt}),
        Reply(Fail{"/load", "why"}),
        Reply(status),
        Reply(StatusReply{.full_scale_pa = 20, .psi = -0.25}),
        Reply(VersionReply{"ringdownd", "0.1.0", 1}),
        Reply(Synced{-5}),
        Reply(Fail{"", "two\nlines"}),
        Reply(NotifyObject{3, "bell", false}),
        Reply(NotifyContact{"bell", {1, 2, 3}, {4, 5, 6}, 0.001}),
        Reply(NotifyGroup{3, "bell", "metal"}),
        Reply(NotifyGroup{3, "bell", std::nullopt}),
        Reply(NotifyPeak{2}),
        Reply(NotifyObjectPeak{"bell", 0.5}),
        Reply(NotifyLoad{0.5, 0.75, 1, 2, 3}),
        Reply(ObjectReply{
            3, "bell", 2, 100, "00ff", "a.glb", 9, 1, 4, {1, 2, 3, 4, 5}, 0.5, -0.25, false, false, 0.08, "metal"}),
        Reply(ObjectReply{}),
        Reply(BankReply{"bell", 1, 2, 3, wire::Blob(5)}),
        Reply(SceneReply{1, 2, 3, 4, {5, 6, 7}, {8, 9, 10}, 50, "s.toml"}),
        Reply(SceneReply{}),
        Reply(SceneBody{1, 2, "a", "-", "box", {1, 2, 3}, true}),
        Reply(SceneStatic{1, 2, "a", "box", {1, 2, 3}, {4, 5, 6}, 0, 0.6, 0, 0.8}),
        Reply(BrowseReply{2}),
        Reply(BrowseFile{1, "bank", "a b.glb"}),
        Reply(NotifyScene{1, 2.5, true}),
        Reply(NotifySound{7, 48000, wire::Blob(16)}),
        Reply(NotifyModes{"bell", 512, wire::Blob(8)}),
        Reply(NotifyBody{7, "ball", "-", {1, 2, 3}, 0, 0.6, 0, 0.8})}) {
    const Result<Reply> again = parse_reply(format(reply));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(format(*again), format(reply));
  }
  EXPECT_EQ(format(Reply(Done{"/load", 3})), (wire::Message{"/done", {"/load", 3}}));
  EXPECT_EQ(format(Reply(Done{"/quit", std::nullopt})), (wire::Message{"/done", {"/quit"}}));
}

TEST(Schema, EveryAnswerNamedByARequestIsAReply) {
  std::set<std::string_view> replies = {""};
  for (const AddressSpec& spec : reply_addresses()) replies.insert(spec.address);
  for (const AddressSpec& spec : addresses()) EXPECT_TRUE(replies.contains(spec.reply)) << spec.address;
}

TEST(Schema, WordsOfACommandLineBecomeTypedArguments) {
  const std::vector<std::string> words = {"bell", "1", "-2.5", "3e-1"};
  const Result<wire::Message> message = compose("/scene/spawn/box", words);
  ASSERT_TRUE(message) << message.error().message;
  EXPECT_EQ(*message, (wire::Message{"/scene/spawn/box", {"bell", 1., -2.5, 0.3}}));
  const std::vector<std::string> digits = {"bell", "007"};
  EXPECT_EQ(compose("/load", digits), (wire::Message{"/load", {"bell", "007"}}))
      << "text that looks like a number is text";
  for (const char* word : {"", "1x", "nan", "inf", "0x10", " 1", "1 ", "--1"}) {
    const std::vector<std::string> bad = {word};
    const Result<wire::Message> refused = compose("/object/bell/gain", bad);
    ASSERT_FALSE(refused) << word;
    EXPECT_NE(refused.error().message.find("(gain)"), std::string::npos) << refused.error().message;
  }
}

}  // namespace
}  // namespace ringdown::protocol
