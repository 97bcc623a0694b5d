// Broken files: each is refused with a sentence that names the field, without a crash and without a large allocation.
#include "engine/gltf/glb.h"
#include "tests/modal/glb_editor.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

namespace ringdown::modal::test {
namespace {

using namespace ringdown::test;  // NOLINT: the synthetic banks

std::string good_file(Compression compression = Compression::none) {
  Bank bank = random_bank(9, 6, 20);
  bank.material = bar_bank(1).material;
  bank.mass = bar_bank(1).mass;
  return written(bank, compression);
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// What is done to the parts of a good file, and a word of the sentence that must come of it.
struct Damage {
  const char* name;
  std::function<void(GlbParts&)> change;
  const char* expected;
};

const std::vector<Damage>& damages() {
  static const std::vector<Damage> all = {
      {"NoExtension", [](GlbParts& p) { p.json.erase("extensions"); }, "no modal model"},
      {"NoModels", [](GlbParts& p) { p.extension()["modalModels"] = Json::array(); }, "no modal model"},
      {"ModelsNoArray", [](GlbParts& p) { p.extension()["modalModels"] = 7; }, "no modal model"},
      {"NoFrequencies", [](GlbParts& p) { p.model().erase("frequencies"); }, "frequencies"},
      {"NoDecayRates", [](GlbParts& p) { p.model().erase("decayRates"); }, "decayRates"},
      {"NoPositions", [](GlbParts& p) { p.model().erase("positions"); }, "positions"},
      {"NoShapes", [](GlbParts& p) { p.model().erase("shapes"); }, "shapes"},
      {"AccessorNumberPastTheEnd", [](GlbParts& p) { p.model()["shapes"] = 99; }, "shapes"},
      {"AccessorNumberNegative", [](GlbParts& p) { p.model()["shapes"] = -1; }, "shapes"},
      {"AccessorNumberFraction", [](GlbParts& p) { p.model()["shapes"] = 1.5; }, "shapes"},
      {"AccessorNumberHuge", [](GlbParts& p) { p.model()["shapes"] = 1e300; }, "shapes"},
      {"AccessorNumberText", [](GlbParts& p) { p.model()["shapes"] = "one"; }, "shapes"},
      {"FrequencyZero", [](GlbParts& p) { p.set("frequencies", 2, 0.0f); }, "frequencies: element 2"},
      {"FrequencyNegative", [](GlbParts& p) { p.set("frequencies", 0, -440.0f); }, "frequencies: element 0"},
      {"FrequencyNan", [](GlbParts& p) { p.set("frequencies", 5, kNan); }, "frequencies: element 5"},
      {"DecayNegative", [](GlbParts& p) { p.set("decayRates", 3, -1.0f); }, "decayRates: element 3"},
      {"DecayInfinite", [](GlbParts& p) { p.set("decayRates", 1, INFINITY); }, "decayRates: element 1"},
      {"PositionNan", [](GlbParts& p) { p.set("positions", 4, kNan); }, "positions: element 1"},
      {"ShapeInfinite", [](GlbParts& p) { p.set("shapes", 31, -INFINITY); }, "shapes: element 10"},
      {"FewerDecaysThanModes", [](GlbParts& p) { p.accessor("decayRates")["count"] = 5; }, "decayRates"},
      {"FewerShapesThanModes", [](GlbParts& p) { p.accessor("shapes")["count"] = 100; }, "shapes"},
      {"NoModes", [](GlbParts& p) { p.accessor("frequencies")["count"] = 0; }, "count"},
      {"CountHuge", [](GlbParts& p) { p.accessor("frequencies")["count"] = 1e12; }, "count"},
      {"CountPastItsView", [](GlbParts& p) { p.accessor("frequencies")["count"] = 7; }, "count"},
      {"CountMissing", [](GlbParts& p) { p.accessor("positions").erase("count"); }, "count"},
      {"ComponentTypeWrong", [](GlbParts& p) { p.accessor("frequencies")["componentType"] = 5125; }, "FLOAT"},
      {"ComponentTypeUnknown", [](GlbParts& p) { p.accessor("frequencies")["componentType"] = 1; }, "componentType"},
      {"ComponentTypeWrapped", [](GlbParts& p) { p.accessor("frequencies")["componentType"] = 5126 + 4294967296.0; },
       "componentType"},
      {"TypeWrong", [](GlbParts& p) { p.accessor("positions")["type"] = "VEC4"; }, "type"},
      {"Sparse",
       [](GlbParts& p) {
         p.accessor("shapes")["sparse"] = {{"count", 1}};
       },
       "sparse"},
      {"NoBufferView", [](GlbParts& p) { p.accessor("shapes").erase("bufferView"); }, "bufferView"},
      {"BufferViewPastTheEnd", [](GlbParts& p) { p.accessor("shapes")["bufferView"] = 99; }, "bufferView"},
      {"ByteOffsetPastItsView", [](GlbParts& p) { p.accessor("shapes")["byteOffset"] = 1 << 20; }, "count"},
      {"ViewPastTheBinary", [](GlbParts& p) { p.view("shapes")["byteLength"] = 1 << 30; }, "byteLength"},
      {"ViewOffsetPastTheBinary", [](GlbParts& p) { p.view("shapes")["byteOffset"] = 1e15; }, "byteLength"},
      {"StrideTooSmall", [](GlbParts& p) { p.view("shapes")["byteStride"] = 4; }, "byteStride"},
      {"StrideTooLarge", [](GlbParts& p) { p.view("shapes")["byteStride"] = 256; }, "byteStride"},
      {"OtherBuffer", [](GlbParts& p) { p.view("shapes")["buffer"] = 1; }, "buffer"},
      {"BufferElsewhere", [](GlbParts& p) { p.json["buffers"][0]["uri"] = "far.bin"; }, "uri"},
      {"CornerPastThePoints", [](GlbParts& p) { p.set("indices", 4, std::uint32_t{4000}); }, "indices: element 4"},
      {"CornersNoTriangles",
       [](GlbParts& p) { p.accessor("indices")["count"] = p.accessor("indices")["count"].get<int>() - 1; }, "indices"},
      {"CornersAreFloats", [](GlbParts& p) { p.accessor("indices")["componentType"] = 5126; }, "indices"},
      {"MaterialPastTheEnd", [](GlbParts& p) { p.model()["material"] = 3; }, "material"},
      {"DensityNegative", [](GlbParts& p) { p.extension()["acousticMaterials"][0]["density"] = -1; }, "density"},
      {"DensityText", [](GlbParts& p) { p.extension()["acousticMaterials"][0]["density"] = "heavy"; }, "density"},
      {"PoissonTooLarge", [](GlbParts& p) { p.extension()["acousticMaterials"][0]["poissonRatio"] = 0.6; },
       "poissonRatio"},
      {"BetaNegative", [](GlbParts& p) { p.extension()["acousticMaterials"][0]["beta"] = -1e-9; }, "beta"},
      {"MassZero", [](GlbParts& p) { p.model()["massProperties"]["mass"] = 0; }, "mass"},
      {"MassMissing", [](GlbParts& p) { p.model()["massProperties"].erase("mass"); }, "mass"},
      {"CenterOfTwoNumbers",
       [](GlbParts& p) {
         p.model()["massProperties"]["centerOfMass"] = {1, 2};
       },
       "centerOfMass"},
      {"InertiaNegative",
       [](GlbParts& p) {
         p.model()["massProperties"]["inertiaDiagonal"] = {1, -1, 1};
       },
       "inertiaDiagonal"},
      {"OrientationNoUnit",
       [](GlbParts& p) {
         p.model()["massProperties"]["inertiaOrientation"] = {0, 0, 0, 2};
       },
       "inertiaOrientation"},
      {"NodePlaysAnotherModel",
       [](GlbParts& p) { p.json["nodes"][0]["extensions"]["KHR_audio_rigid_bodies"]["modalModel"] = 5; },
       "modal model 5"},
      {"NodeScaleUneven",
       [](GlbParts& p) {
         p.json["nodes"][0]["scale"] = {1, 2, 1};
       },
       "scale"},
      {"NodeScaleZero",
       [](GlbParts& p) {
         p.json["nodes"][0]["scale"] = {0, 0, 0};
       },
       "scale"},
      {"NodeScaleTiny",
       [](GlbParts& p) {
         p.json["nodes"][0]["scale"] = {1e-300, 1e-300, 1e-300};
       },
       "scale"},
      {"NodeScaleHuge",
       [](GlbParts& p) {
         p.json["nodes"][0]["scale"] = {1e300, 1e300, 1e300};
       },
       "scale"},
  };
  return all;
}

// The same for a compressed file.
Json& packing(GlbParts& parts, const char* key = "shapes") {
  return parts.view(key)["extensions"]["EXT_meshopt_compression"];
}

void set_stream_byte(GlbParts& parts, const char* key, char value) {
  parts.binary[packing(parts, key)["byteOffset"].get<std::size_t>()] = value;
}

const std::vector<Damage>& damages_of_compressed() {
  static const std::vector<Damage> all = {
      {"ModeUnknown", [](GlbParts& p) { packing(p)["mode"] = "MESHES"; }, "mode is"},
      {"ModeMissing", [](GlbParts& p) { packing(p).erase("mode"); }, "mode is"},
      {"FilterUnknown", [](GlbParts& p) { packing(p)["filter"] = "COLOR"; }, "filter is"},
      {"FilterNumber", [](GlbParts& p) { packing(p)["filter"] = 3; }, "filter is"},
      {"FilterOfAnotherStride", [](GlbParts& p) { packing(p)["filter"] = "QUATERNION"; }, "byteStride is 12"},
      {"FilterOnIndices", [](GlbParts& p) { packing(p, "indices")["filter"] = "EXPONENTIAL"; }, "byteStride is 4"},
      {"StrideZero", [](GlbParts& p) { packing(p)["byteStride"] = 0; }, "byteStride is 0"},
      {"StrideOdd", [](GlbParts& p) { packing(p)["byteStride"] = 6; }, "byteStride is 6"},
      {"StrideLarge", [](GlbParts& p) { packing(p)["byteStride"] = 260; }, "byteStride is 260"},
      {"StrideHuge", [](GlbParts& p) { packing(p)["byteStride"] = 1e15; }, "byteStride is"},
      {"StrideOfIndices", [](GlbParts& p) { packing(p, "indices")["byteStride"] = 8; }, "byteStride is 8"},
      {"StrideMissing", [](GlbParts& p) { packing(p).erase("byteStride"); }, "byteStride is missing"},
      {"StrideNotTheViews", [](GlbParts& p) { p.view("positions")["byteStride"] = 16; }, "count"},
      {"StrideOfTheViewLarger",
       [](GlbParts& p) {
         p.view("positions")["byteStride"] = 16;
         p.accessor("positions")["count"] = 3;
       },
       "byteStride is 16"},
      {"CountMissing", [](GlbParts& p) { packing(p).erase("count"); }, "count is missing"},
      {"CountOther", [](GlbParts& p) { packing(p)["count"] = 7; }, "byteLength"},
      {"CountOverflowing", [](GlbParts& p) { packing(p)["count"] = 1e15; }, "byteLength"},
      {"CornersNoTriangles",
       [](GlbParts& p) {
         packing(p, "indices")["mode"] = "TRIANGLES";
         packing(p, "indices")["count"] = 7;
       },
       "byteStride"},
      {"UnpacksToTooMuch",
       [](GlbParts& p) {
         packing(p)["count"] = 1e9;
         p.view("shapes")["byteLength"] = 12e9;
       },
       "byteLength is 12000000000"},
      {"UnpacksToMoreThanItCanHold",
       [](GlbParts& p) {
         packing(p)["count"] = 80'000'000;
         p.view("shapes")["byteLength"] = 960'000'000;
       },
       "enough for the view's 960000000 bytes"},
      {"ViewShorter", [](GlbParts& p) { p.view("shapes")["byteLength"] = 12; }, "count"},
      {"OtherBuffer", [](GlbParts& p) { packing(p)["buffer"] = 1; }, "buffer is 1"},
      {"BufferMissing", [](GlbParts& p) { packing(p).erase("buffer"); }, "buffer is missing"},
      {"StreamPastTheBinary", [](GlbParts& p) { packing(p)["byteOffset"] = 1 << 20; }, "byteLength"},
      {"StreamLengthHuge", [](GlbParts& p) { packing(p)["byteLength"] = 1e15; }, "byteLength"},
      {"StreamEmpty", [](GlbParts& p) { packing(p)["byteLength"] = 0; }, "byteLength is 0"},
      {"StreamCut", [](GlbParts& p) { packing(p)["byteLength"] = packing(p)["byteLength"].get<std::size_t>() - 1; },
       "damaged"},
      {"StreamOfALaterCodec", [](GlbParts& p) { set_stream_byte(p, "shapes", '\xaf'); }, "later version of the codec"},
      {"StreamOfAnotherMode", [](GlbParts& p) { set_stream_byte(p, "indices", '\xe1'); }, "damaged"},
      {"ModeOfAnotherStream", [](GlbParts& p) { packing(p, "indices")["mode"] = "TRIANGLES"; }, "damaged"},
      {"PackingNoObject", [](GlbParts& p) { packing(p) = 7; }, "buffer is missing"},
      {"PlainViewInTheFallback", [](GlbParts& p) { p.view("frequencies")["buffer"] = 1; }, "buffer is 1"},
  };
  return all;
}

class BrokenBank : public testing::TestWithParam<std::size_t> {};

void expect_refused(const Damage& damage, const std::string& good) {
  GlbParts parts(good);
  damage.change(parts);
  const auto bank = parse(parts.join());
  ASSERT_FALSE(bank);
  EXPECT_EQ(bank.error().message.rfind("x.glb", 0), 0u) << bank.error().message;
  EXPECT_NE(bank.error().message.find(damage.expected), std::string::npos) << bank.error().message;
  EXPECT_LT(bank.error().message.size(), 300u) << "one sentence: " << bank.error().message;
}

TEST_P(BrokenBank, ABrokenBankIsRefusedByTheNameOfItsField) { expect_refused(damages()[GetParam()], good_file()); }

INSTANTIATE_TEST_SUITE_P(Each, BrokenBank, testing::Range(std::size_t{0}, damages().size()),
                         [](const auto& each) { return std::string(damages()[each.param].name); });

class BrokenCompressedBank : public testing::TestWithParam<std::size_t> {};

TEST_P(BrokenCompressedBank, ABrokenCompressedBankIsRefusedByTheNameOfItsField) {
  expect_refused(damages_of_compressed()[GetParam()], good_file(Compression::meshopt));
}

INSTANTIATE_TEST_SUITE_P(Each, BrokenCompressedBank, testing::Range(std::size_t{0}, damages_of_compressed().size()),
                         [](const auto& each) { return std::string(damages_of_compressed()[each.param].name); });

void expect_refused(const std::string& bytes, const char* expected) {
  const auto bank = parse(bytes);
  ASSERT_FALSE(bank) << expected;
  EXPECT_NE(bank.error().message.find(expected), std::string::npos) << bank.error().message;
}

TEST(BrokenContainer, ABrokenContainerIsRefused) {
  const std::string good = good_file();
  ASSERT_TRUE(parse(good));
  const auto with_word = [&good](std::size_t at, std::uint32_t value) {
    std::string bytes = good;
    set_word(bytes, at, value);
    return bytes;
  };
  expect_refused("", "not a binary glTF");
  expect_refused("RIFF, not glTF at all", "not a binary glTF");
  expect_refused(with_word(4, 1), "version 1");
  expect_refused(good.substr(0, good.size() - 1), "cut off");
  expect_refused(good + "x", "cut off");
  expect_refused(with_word(12, 0x7fffffff), "JSON");
  expect_refused(with_word(16, 0), "JSON");
  const std::size_t text = word(good, 12);
  expect_refused(with_word(20 + text, 0xffffffff), "second chunk");
  expect_refused(with_word(24 + text, 0), "second chunk");
  std::string torn = good;
  torn[20] = '[';
  expect_refused(torn, "malformed");
}

TEST(BrokenContainer, ABankThatIsCutAnywhereIsRefused) {
  const std::string good = good_file();
  for (std::size_t size = 0; size < good.size(); size += 1 + size / 50) {
    std::string cut = good.substr(0, size);
    EXPECT_FALSE(parse(cut));
    if (size < 12) continue;
    set_word(cut, 8, static_cast<std::uint32_t>(size));  // with a header that agrees
    EXPECT_FALSE(parse(cut)) << size;
  }
}

// A hostile text: a value nested as deep as the number of values allows where a number should stand must not exhaust
// the stack.
TEST(BrokenContainer, DeepNestingIsRefusedWithoutACrash) {
  GlbParts parts(good_file());
  parts.model()["frequencies"] = "@";
  std::string text = parts.json.dump();
  constexpr std::size_t kDepth = 250000;
  text.replace(text.find("\"@\""), 3, std::string(kDepth, '[') + std::string(kDepth, ']'));
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string file = "glTF" + std::string(16, '\0') + text;
  set_word(file, 4, 2);
  set_word(file, 8, static_cast<std::uint32_t>(file.size()));
  set_word(file, 12, static_cast<std::uint32_t>(text.size()));
  std::memcpy(file.data() + 16, "JSON", 4);
  expect_refused(file, "frequencies");
}

TEST(BrokenProvenance, ABankWithBrokenProvenanceLoadsAllTheSame) {
  for (const Json& value : {Json(1e300), Json(-1e300), Json("many"), Json(nullptr), Json(-3), Json(0.5)}) {
    GlbParts parts(good_file());
    parts.model()["extras"]["ringdown"]["unknowns"] = value;
    const auto bank = parse(parts.join());
    ASSERT_TRUE(bank) << bank.error().message;
    EXPECT_EQ(bank->provenance.unknowns, 0) << value;
  }
}

TEST(BrokenProvenance, ErrorsThatAreNotOneSoundNumberAModeAreNone) {
  GlbParts parts(good_file());
  const std::size_t modes = parse(parts.join())->mode_count();
  Json good = Json::array();
  for (std::size_t m = 0; m < modes; ++m) good.push_back(0.01);
  Json longer = good, negative = good, text = good, empty = good;
  longer.push_back(0.01);
  negative[modes - 1] = -0.01;
  text[0] = "small";
  empty[0] = nullptr;
  for (const Json& errors : {longer, negative, text, empty, Json(0.01), Json::array(), Json("none"), Json::object()}) {
    parts.model()["extras"]["ringdown"]["frequencyErrors"] = errors;
    const auto bank = parse(parts.join());
    ASSERT_TRUE(bank) << bank.error().message;
    EXPECT_TRUE(bank->frequency_error.empty()) << errors;
  }
  parts.model()["extras"]["ringdown"]["frequencyErrors"] = good;
  EXPECT_EQ(parse(parts.join())->frequency_error, std::vector<double>(modes, 0.01));
}

TEST(BrokenBank, APitchThatIsNoFrequencyCountsAsAbsent) {
  GlbParts parts(written(bar_bank(3)));
  EXPECT_FALSE(parse(parts.join())->pitch_hz);
  for (const Json& pitch : {Json(0), Json(-440), Json(1e6), Json("A4"), Json(nullptr), Json::array({440})}) {
    parts.model()["extras"]["ringdown"]["pitch"] = pitch;
    const auto bank = parse(parts.join());
    ASSERT_TRUE(bank) << bank.error().message;
    EXPECT_FALSE(bank->pitch_hz) << pitch;
  }
  parts.model()["extras"]["ringdown"]["pitch"] = 233.08;
  const auto bank = parse(parts.join());
  ASSERT_TRUE(bank) << bank.error().message;
  EXPECT_EQ(bank->pitch_hz, 233.08);
  EXPECT_EQ(parse(written(*bank))->pitch_hz, 233.08) << "written and read again";
}

// Whatever bytes a file has, reading gives a bank that keeps its promises, or a sentence.
void flip_at_random(const std::string& good) {
  const std::size_t text = word(good, 12);
  std::mt19937 random(5);
  std::size_t accepted = 0;
  for (int turn = 0; turn < 20000; ++turn) {
    std::string bytes = good;
    const std::size_t flips = 1 + random() % 4;
    for (std::size_t i = 0; i < flips; ++i) {
      const std::size_t limit = turn % 2 == 0 ? bytes.size() : 20 + text;  // every other time in header and text only
      bytes[random() % limit] = static_cast<char>(random() % (turn % 3 == 0 ? 256 : 128));
    }
    const auto bank = parse(bytes);
    if (!bank) {
      ASSERT_FALSE(bank.error().message.empty());
      continue;
    }
    ++accepted;
    ASSERT_EQ(bank->decay_per_s.size(), bank->mode_count());
    ASSERT_EQ(bank->shapes.size(), bank->mode_count() * bank->point_count());
    for (const double f : bank->frequency_hz) ASSERT_TRUE(f > 0 && std::isfinite(f));
    for (const auto& triangle : bank->triangles) {
      for (const std::uint32_t corner : triangle) ASSERT_LT(corner, bank->point_count());
    }
  }
  EXPECT_GT(accepted, 1000u);
}

TEST(BrokenBytes, TwentyThousandRandomFlipsNeverCrashOrPassABadBank) { flip_at_random(good_file()); }

TEST(BrokenBytes, TwentyThousandRandomFlipsOfACompressedBankNeverCrashOrPassABadBank) {
  flip_at_random(good_file(Compression::meshopt));
}

std::size_t count_values(const Json& json) {
  std::size_t count = 1;
  if (json.is_structured()) {
    for (const Json& value : json) count += count_values(value);
  }
  return count;
}

void expect_bank(bool fits, const GlbParts& parts, const std::string& refusal) {
  const auto bank = parse(parts.join());
  EXPECT_EQ(bank.has_value(), fits);
  if (!bank) {
    EXPECT_NE(bank.error().message.find(refusal), std::string::npos) << bank.error().message;
  }
}

TEST(BrokenContainer, TheJsonTextMayHoldSoManyValuesAndBytesAndNoMore) {
  GlbParts parts(good_file());
  const std::size_t values = kMaxJsonValues - count_values(parts.json) - 1;  // the list is a value itself
  for (const std::size_t more : {0, 1}) {
    parts.json["extras"] = Json(values + more, 0);
    expect_bank(more == 0, parts, "x.glb: its JSON text has more than 262144 values");
  }
  parts.json["extras"] = "";
  const std::size_t characters = kMaxJsonBytes - parts.json.dump().size();
  for (const std::size_t more : {0, 1}) {  // 1: the text is padded to a multiple of four
    parts.json["extras"] = std::string(characters + more, 'a');
    expect_bank(more == 0, parts, "x.glb: its JSON text has more than 16777216 bytes");
  }
}

}  // namespace
}  // namespace ringdown::modal::test
