// Scales and keyboard mappings of Scala against frequencies that are computed from ratios, without cents.
#include "engine/microtuning/scala.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

namespace ringdown::microtuning {
namespace {

const std::string kTwelve =
    "! 12.scl\n!\nTwelve equal steps\n 12\n!\n 100.0\n 200.0\n 300.0\n 400.0\n 500.0\n 600.0\n 700.0\n 800.0\n 900.0\n"
    " 1000.0\n 1100.0\n 2/1\n";
// meanquar.scl of Scala's archive.
const std::string kMeantone =
    "! meanquar.scl\n!\n1/4-comma meantone scale. Pietro Aaron's temperament (1523)\n 12\n!\n 76.04900\n 193.15686\n"
    " 310.26471\n 5/4\n 503.42157\n 579.47057\n 696.57843\n 25/16\n 889.73529\n 1006.84314\n 1082.89214\n 2/1\n";

std::string mapping(const std::string& head, const std::string& entries) { return "! a mapping\n" + head + entries; }

double frequency_hz(const KeyTuning& tuning, std::size_t key) {
  return 440 * std::pow(2, (static_cast<double>(key) + tuning.semitones[key] - 69) / 12);
}

class Scala : public testing::Test {
 protected:
  KeyTuning tuned(const std::string& scale, const std::string& mapping) {
    const auto tuning = read_tuning(scale.empty() ? "" : folder_.write("a.scl", scale),
                                    mapping.empty() ? "" : folder_.write("a.kbm", mapping));
    EXPECT_TRUE(tuning) << tuning.error().message;
    return tuning.value_or(KeyTuning{});
  }
  // The refusal of a scale or of a mapping, without the file's name.
  std::string refusal(const std::string& name, const std::string& text) {
    const auto path = folder_.write(name, text);
    const auto read = name == "a.scl" ? read_tuning(path, "") : read_tuning("", path);
    if (read) return "accepted";
    const std::string sentence = read.error().message;
    EXPECT_TRUE(sentence.starts_with(path.string() + ":")) << sentence;
    return sentence.substr(path.string().size() + 1);
  }

  test::TemporaryFolder folder_;
};

TEST_F(Scala, TwelveEqualStepsDeviateByExactlyNothing) {
  EXPECT_EQ(tuned(kTwelve, ""), KeyTuning{});
  EXPECT_EQ(tuned(kTwelve, "0\n0\n127\n60\n69\n440.0\n12\n"), KeyTuning{}) << "a linear mapping";
  EXPECT_EQ(tuned(kTwelve, "12\n0\n127\n60\n69\n440.0\n12\n0\n1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n11\n"), KeyTuning{});
  EXPECT_EQ(tuned("", "0\n0\n127\n60\n69\n440\n0\n"), KeyTuning{}) << "without a scale";
}

// In the temperament of Aaron, every fifth is the fourth root of 5.
TEST_F(Scala, MeantoneIsAChainOfFifths) {
  const KeyTuning tuning = tuned(kMeantone, "");
  const int fifths[12] = {0, 7, 2, -3, 4, -1, 6, 1, 8, 3, -2, 5};  // from C to each key of an octave
  const double middle_c_hz = 440 * std::pow(2, -9.0 / 12);
  for (int key = 0; key < 128; ++key) {
    double ratio = std::pow(5, fifths[key % 12] / 4.0);
    while (ratio >= 2) ratio /= 2;
    while (ratio < 1) ratio *= 2;
    const double expected_hz = middle_c_hz * ratio * std::pow(2, key / 12 - 5);
    EXPECT_NEAR(frequency_hz(tuning, static_cast<std::size_t>(key)) / expected_hz, 1, 1e-8) << key;
  }
}

TEST_F(Scala, AMappingChoosesKeysDegreesAndPitch) {
  const std::string just = "just\n7\n9/8\n5/4\n4/3\n3/2\n5/3\n15/8\n2/1\n";
  // White keys only, from 36 to 96, A4 = 432 Hz.
  const std::string white = "12\n36\n96\n60\n69\n432.0\n7\n0\nx\n1\nx\n2\n3\nx\n4\nx\n5\nx\n6\n";
  const KeyTuning tuning = tuned(just, white);
  const std::pair<std::size_t, double> expected[] = {{69, 432.0},
                                                     {60, 432.0 * 3 / 5},
                                                     {62, 432.0 * 3 / 5 * 9 / 8},
                                                     {64, 432.0 * 3 / 5 * 5 / 4},
                                                     {72, 432.0 * 3 / 5 * 2},
                                                     {48, 432.0 * 3 / 10},
                                                     {57, 216.0},
                                                     {95, 432.0 * 3 / 5 * 15 / 8 * 4}};
  for (const auto& [key, hz] : expected) EXPECT_NEAR(frequency_hz(tuning, key) / hz, 1, 1e-12) << key;
  for (const std::size_t black : {37, 61, 63, 66, 68, 70, 94}) EXPECT_TRUE(tuning.unmapped[black]) << black;
  EXPECT_EQ(tuning.unmapped.count(), 25u);
  for (const std::size_t outside : {0, 1, 35, 97, 127}) {
    EXPECT_EQ(tuning.semitones[outside], 0) << outside;
    EXPECT_FALSE(tuning.unmapped[outside]) << outside;
  }
}

// Bohlen and Pierce: 13 steps of a twelfth, 3/1.
TEST_F(Scala, TheFormalOctaveIsAnyDegree) {
  std::string scale = "BP\n13\n";
  for (int step = 1; step < 13; ++step) scale += std::to_string(step * 1200 * std::log2(3.0) / 13) + "\n";
  scale += "3\n";
  const KeyTuning whole = tuned(scale, "0\n0\n127\n60\n60\n200\n13\n");
  EXPECT_NEAR(frequency_hz(whole, 73) / 600, 1, 1e-9);
  EXPECT_NEAR(frequency_hz(whole, 47) / (200 / 3.0), 1, 1e-9);
  EXPECT_NEAR(frequency_hz(whole, 61) / (200 * std::pow(3, 1 / 13.0)), 1, 1e-9);
  // Two keys, a step apart, and the next two a third of a twelfth above.
  const KeyTuning pairs = tuned(scale, "2\n0\n127\n60\n60\n200\n4\n0\n1\n");
  EXPECT_NEAR(frequency_hz(pairs, 61) / (200 * std::pow(3, 1 / 13.0)), 1, 1e-9);
  EXPECT_NEAR(frequency_hz(pairs, 62) / (200 * std::pow(3, 4 / 13.0)), 1, 1e-9);
  EXPECT_NEAR(frequency_hz(pairs, 59) / (200 * std::pow(3, -3 / 13.0)), 1, 1e-9);
  const KeyTuning period = tuned(scale, "2\n0\n127\n60\n60\n200\n0\n0\n1\n");
  EXPECT_NEAR(frequency_hz(period, 62) / 600, 1, 1e-9) << "0: the scale's period";
  const KeyTuning far = tuned(scale, "2\n0\n127\n60\n60\n200\n13\n0\n-27\n");
  EXPECT_NEAR(frequency_hz(far, 61) / (200 * std::pow(3, -27 / 13.0)), 1, 1e-9) << "below degree 0";
}

// https://www.huygens-fokker.org/scala/scl_format.html
TEST_F(Scala, AllThatTheFormatAllowsIsRead) {
  const auto cents = [&](const std::string& pitch) {
    const auto scale =
        read_scale(folder_.write("a.scl", "! a comment\r\n\r\n  1 note\r\n! another\r\n" + pitch + "\r\n"));
    EXPECT_TRUE(scale) << scale.error().message;
    return scale ? scale->cents.at(0) : 0;
  };
  EXPECT_NEAR(cents("81/64"), 407.82000346, 1e-8);
  EXPECT_EQ(cents("408.0"), 408);
  EXPECT_EQ(cents("408."), 408);
  EXPECT_NEAR(cents("5"), 2786.31371386, 1e-8);
  EXPECT_EQ(cents("-5.0"), -5);
  EXPECT_NEAR(cents("10/20"), -1200, 1e-9);
  EXPECT_EQ(cents("100.0 cents"), 100);
  EXPECT_EQ(cents("\t100.0 C#"), 100);
  EXPECT_NEAR(cents("5/4   E\\"), 386.31371386, 1e-8);
  EXPECT_NEAR(cents("2147483647/2147483646"), 8.0617e-7, 1e-10);
  EXPECT_NEAR(cents("3/2.5"), 701.9550009, 1e-6) << "what follows a ratio is ignored";
  const KeyTuning short_pattern = tuned("", mapping("4\n0\n127\n60\n60\n261.6255653\n4\n", "0\n! none\n1\n"));
  EXPECT_TRUE(short_pattern.unmapped[62] && short_pattern.unmapped[63]) << "entries at the end may be left out";
  EXPECT_FALSE(short_pattern.unmapped[64] || short_pattern.unmapped[65]);
}

TEST_F(Scala, EveryFaultIsASentenceWithItsLine) {
  const std::pair<const char*, const char*> scales[] = {
      {"", "1: the file ends here, before the scale's description"},
      {"a\n", "2: the file ends here, before the number of notes"},
      {"a\nx\n", "2: the number of notes should be a number from 1 to 10000, not \"x\""},
      {"a\n0\n", "2: the number of notes should be a number from 1 to 10000, not \"0\""},
      {"a\n! b\n2\n1.0\n", "5: the file ends here, before note 2 of 2"},
      {"a\n2\n1.0\n-3/2\n", "4: a pitch should be a ratio above 0"},
      {"a\n1\n3/0\n", "3: a pitch"},
      {"a\n1\n0/3\n", "3: a pitch"},
      {"a\n1\n3/\n", "3: a pitch"},
      {"a\n1\n3/-2\n", "3: a pitch"},
      {"a\n1\ntwo\n", "3: a pitch"},
      {"a\n1\n\n", "3: a pitch"},
      {"a\n1\n.\n", "3: a pitch"},
      {"a\n1\n1e9.0\n", "accepted"},  // the ratio 1
      {"a\n1\n99999999999999999999\n", "3: a pitch"},
      {"a\n1\n9999999.0\n", "3: a pitch"},
  };
  for (const auto& [text, begin] : scales)
    EXPECT_TRUE(refusal("a.scl", text).starts_with(begin)) << refusal("a.scl", text);
  const std::string head = "2\n0\n127\n60\n69\n440.0\n12\n";
  const std::pair<std::string, const char*> mappings[] = {
      {"", "1: the file ends here, before the size of the map"},
      {"-1\n", "1: the size of the map should be a number from 0 to 10000, not \"-1\""},
      {"0\n128\n", "2: the first key should be a number from 0 to 127, not \"128\""},
      {"0\n0\n-1\n", "3: the last key"},
      {"0\n0\n127\n60.5\n69\n", "6: the file ends here, before the reference frequency"},
      {"0\n0\n127\nsixty\n", "4: the middle key"},
      {"0\n0\n127\n60\n!\n200\n", "6: the reference key"},
      {"0\n0\n127\n60\n69\n0\n", "6: the reference frequency"},
      {"0\n0\n127\n60\n69\nnan\n", "6: the reference frequency"},
      {"0\n0\n127\n60\n69\n440.0\n-12\n", "7: the formal octave"},
      {head + "0\ny\n", "9: an entry should be a degree of the scale, or x, not \"y\""},
      {head + "0\n99999999999\n", "9: an entry"},
      {head + "0\nx\n", "5: the reference key 69 is unmapped"},
  };
  for (const auto& [text, begin] : mappings)
    EXPECT_TRUE(refusal("a.kbm", text).starts_with(begin)) << refusal("a.kbm", text);
  const auto missing = read_tuning(folder_ / "missing.scl", "");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().message,
            (folder_ / "missing.scl").string() + " cannot be read; it should be a scale (.scl)");
}

}  // namespace
}  // namespace ringdown::microtuning
