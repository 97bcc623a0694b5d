// The limits of the table as 32-bit floats have them, which most OSC clients send: the float nearest to a limit is the
// limit, also where it was rounded outward, and the next float beyond it is refused.
#include "protocol/bulk.h"
#include "protocol/schema.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ringdown::protocol {
namespace {

constexpr float kUpwards = std::numeric_limits<float>::infinity();

bool has_limits(const ArgumentSpec& argument) {
  return argument.type == ValueType::number || argument.type == ValueType::integer;
}

// The message of the manual's example, with one argument set anew.
wire::Message example_with(const AddressSpec& spec, std::size_t position, const wire::Argument& value) {
  wire::Message message = spec.example;
  message.arguments.at(position) = value;
  return message;
}

double number_at(const wire::Message& message, std::size_t position) {
  const wire::Argument& argument = message.arguments.at(position);
  if (const auto* whole = std::get_if<std::int32_t>(&argument)) return *whole;
  return std::get<double>(argument);
}

TEST(FloatLimits, TheNearestFloatIsEveryLimitAndTheNextFloatIsRefused) {
  int checked = 0, rounded_outward = 0;
  for (const AddressSpec& spec : addresses()) {
    for (std::size_t i = spec.arguments_in_address(); i < spec.arguments.size(); ++i) {
      const ArgumentSpec& argument = spec.arguments[i];
      if (!has_limits(argument)) continue;
      const std::size_t position = i - spec.arguments_in_address();
      for (const auto& [limit, beyond] : {std::pair{argument.min, -kUpwards}, {argument.max, kUpwards}}) {
        SCOPED_TRACE(std::string(spec.address) + " " + std::string(argument.name) + " " + std::to_string(limit));
        const auto nearest = static_cast<float>(limit);
        const auto request = parse(example_with(spec, position, nearest));
        ASSERT_TRUE(request) << request.error().message;
        const double taken = number_at(format(*request), position);
        const bool outward = nearest < argument.min || nearest > argument.max;
        EXPECT_EQ(taken, outward ? limit : static_cast<double>(nearest));
        const auto refused = parse(example_with(spec, position, std::nextafter(nearest, beyond)));
        ASSERT_FALSE(refused);
        EXPECT_NE(refused.error().message.find("(" + std::string(argument.name) + ")"), std::string::npos);
        ++checked, rounded_outward += outward;
      }
    }
  }
  EXPECT_GT(checked, 200);
  EXPECT_GT(rounded_outward, 20);
}

// A float that became a double on its way here, such as a number of numpy or C#.
TEST(FloatLimits, AFloatThatWasWidenedIsTheLimitToo) {
  const auto mallet = [](double mass, double head, double bounce) {
    return parse({"/object/bell/mallet", {0., 0., 0., 0., 0., -1., mass, head, bounce}});
  };
  const auto hit = mallet(1e-5f, 1e14f, 0.01f);
  ASSERT_TRUE(hit) << hit.error().message;
  EXPECT_EQ(hit->get<HitMallet>().verb.mass_kg, 1e-5);
  EXPECT_EQ(hit->get<HitMallet>().verb.head, 1e14);
  EXPECT_EQ(hit->get<HitMallet>().verb.bounce, 0.01);
  EXPECT_FALSE(mallet(std::nextafter(1e-5, 0.0), 1e7, 0.5)) << "no float, and too small";
}

TEST(FloatLimits, RequestsMadeWithoutAMessageAreFittedToo) {
  ASSERT_GT(double{0.1f}, 0.1);
  Request request = Strike{{"", 0}, {{}, {0, 0, 1}, 0.1f}};
  ASSERT_FALSE(find_out_of_range(request));
  EXPECT_EQ(request.get<Strike>().verb.contact_time_s, 0.1);
  request = Strike{{"", 0}, {{}, {0, 0, 1}, std::nextafter(0.1f, 1.f)}};
  EXPECT_TRUE(find_out_of_range(request));
}

TEST(FloatLimits, RecordsOfManyStrikesAreFittedToo) {
  BulkStrike blow{0, std::nullopt, {}, {0, 0, 1}, 0.1, 60};
  const auto fitted = decode_strikes(encode_strikes({&blow, 1}));
  ASSERT_TRUE(fitted) << fitted.error().message;
  EXPECT_EQ(fitted->front().contact_time_s, 0.1);
  EXPECT_EQ(fitted->front().delay_s, 60);
  blow.contact_time_s = std::nextafter(0.1f, 1.f);
  EXPECT_FALSE(decode_strikes(encode_strikes({&blow, 1})));
}

// Replies carry floats, and are read by the same ranges.
TEST(FloatLimits, AReplyAtALimitIsReadAsThisLimit) {
  const auto read = parse_reply(format(Reply(NotifyContact{"bell", {}, {}, 0.1})));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->get<NotifyContact>().contact_time_s, 0.1);
}

}  // namespace
}  // namespace ringdown::protocol
