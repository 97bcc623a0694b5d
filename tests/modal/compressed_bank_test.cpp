// Compressed banks (EXT_meshopt_compression): what is kept, what is rounded, and streams that another encoder made.
#include "engine/gltf/meshopt_codec.h"
#include "tests/modal/glb_editor.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ringdown::modal::test {
namespace {

using namespace ringdown::test;  // NOLINT: the synthetic banks

constexpr const char* kMeshopt = "EXT_meshopt_compression";

std::vector<std::byte> bytes_of_hex(std::string_view hex) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
  }
  return bytes;
}

template <class T>
std::vector<T> unpacked(const MeshoptLayout& layout, std::string_view hex) {
  std::vector<T> numbers(layout.bytes() / sizeof(T));
  EXPECT_TRUE(is_allowed(layout));
  EXPECT_TRUE(unpack(layout, bytes_of_hex(hex), std::as_writable_bytes(std::span(numbers))));
  return numbers;
}

// The streams below were made by the encoder of npm's meshoptimizer 0.22.0 from the numbers that are expected.
TEST(MeshoptCodec, AttributesOfAnotherEncoderAreExact) {
  EXPECT_EQ(unpacked<float>({.count = 4, .stride = 12},
                            "a00000010f000000ff8001300000007e000000010c0000007f0000000000000000000000000000000000000000"
                            "0000000000000000000000000000803f"),
            (std::vector<float>{0, 0, 1, 0.5, 0, 1, 1, -2, 1, 1.5, -2, 1}));
}

TEST(MeshoptCodec, ExponentialsOfAnotherEncoderAreExact) {
  EXPECT_EQ(unpacked<float>({.filter = MeshoptFilter::exponential, .count = 2, .stride = 12},
                            "a001200000000130000000030001300000001001300000005f01300000001a0120000000013000000010013000"
                            "00006001300000000f01100000000130000000100000000000000000000000000000000000000000000200f700"
                            "fafff7000000f7"),
            (std::vector<float>{1, -3, 0, 0.5, 1000, -1000}));
}

TEST(MeshoptCodec, TrianglesAndIndicesOfAnotherEncoderAreExact) {
  // The codec has turned the last triangle, which was 0 6 9.
  const std::vector<std::uint32_t> triangles = {0, 1, 2, 2, 1, 3, 4, 6, 5, 6, 9, 0};
  const char* const stream = "e1f010fefef00cf706007687566778a9866589689801690000";
  EXPECT_EQ(unpacked<std::uint32_t>({.mode = MeshoptMode::triangles, .count = 12, .stride = 4}, stream), triangles);
  EXPECT_EQ(unpacked<std::uint16_t>({.mode = MeshoptMode::triangles, .count = 12, .stride = 2}, stream),
            std::vector<std::uint16_t>(triangles.begin(), triangles.end()));
  EXPECT_EQ(unpacked<std::uint32_t>({.mode = MeshoptMode::indices, .count = 7, .stride = 4},
                                    "d10004cd010407981ffd891100000000"),
            (std::vector<std::uint32_t>{0, 1, 51, 2, 49, 1000, 70000}));
  EXPECT_EQ(
      unpacked<std::uint16_t>({.mode = MeshoptMode::indices, .count = 6, .stride = 2}, "d10004cd010407981f00000000"),
      (std::vector<std::uint16_t>{0, 1, 51, 2, 49, 1000}));
}

template <class T>
void expect_units(const std::vector<T>& found, const std::vector<double>& wanted, double step) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i] / static_cast<double>(std::numeric_limits<T>::max()), wanted[i], step) << i;
  }
}

TEST(MeshoptCodec, UnitVectorsAndQuaternionsOfAnotherEncoderAreAsGoodAsTheirBits) {
  const std::vector<double> vectors = {1, 0, 0, 1, 0, -1, 0, 0, 0.6, 0, -0.8, -1};
  expect_units(
      unpacked<std::int8_t>({.filter = MeshoptFilter::octahedral, .count = 3, .stride = 4},
                            "a0013c000000fdfe013c000000fd6f00013c000000fdfd00000000000000000000000000000000000000000000"
                            "0000000000007f007f7f"),
      vectors, 1.0 / 127);
  expect_units(unpacked<std::int16_t>(
                   {.filter = MeshoptFilter::octahedral, .count = 3, .stride = 8},
                   "a00124000000013c0000000d0e012c000000dd013c0000000f1800000128000000013c000000fdff0000000000"
                   "00000000000000000000000000000000000000ff070000ff07ff7f"),
               vectors, 1.0 / 2047);
  // In twelve bits; the sign of a whole quaternion is free.
  expect_units(unpacked<std::int16_t>(
                   {.filter = MeshoptFilter::quaternion, .count = 3, .stride = 8},
                   "a0013c000000b24301340000000b013c000000b1b2013c0000000a09013c000000b1b2013c0000000a09013c00"
                   "0000050600000000000000000000000000000000000000000000000000000000000000ff07"),
               {0, 0, 0, 1, 0.5, -0.5, 0.5, 0.5, -0.6, 0, 0, 0.8}, 2.0 / 2047);
}

TEST(MeshoptCodec, TheExtensionsRulesForStridesHold) {
  const auto allowed = [](MeshoptMode mode, MeshoptFilter filter, std::size_t count) {
    std::vector<std::size_t> strides;
    for (std::size_t stride = 0; stride < 300; ++stride) {
      if (is_allowed({mode, filter, count, stride})) strides.push_back(stride);
    }
    return strides;
  };
  using Strides = std::vector<std::size_t>;
  std::vector<std::size_t> by_four;
  for (std::size_t stride = 4; stride <= 256; stride += 4) by_four.push_back(stride);
  EXPECT_EQ(allowed(MeshoptMode::attributes, MeshoptFilter::none, 1), by_four);
  EXPECT_EQ(allowed(MeshoptMode::attributes, MeshoptFilter::exponential, 1), by_four);
  EXPECT_EQ(allowed(MeshoptMode::attributes, MeshoptFilter::octahedral, 1), (Strides{4, 8}));
  EXPECT_EQ(allowed(MeshoptMode::attributes, MeshoptFilter::quaternion, 1), (Strides{8}));
  EXPECT_EQ(allowed(MeshoptMode::triangles, MeshoptFilter::none, 6), (Strides{2, 4}));
  EXPECT_EQ(allowed(MeshoptMode::triangles, MeshoptFilter::none, 7), Strides{});
  EXPECT_EQ(allowed(MeshoptMode::indices, MeshoptFilter::none, 7), (Strides{2, 4}));
  EXPECT_EQ(allowed(MeshoptMode::indices, MeshoptFilter::exponential, 6), Strides{});
}

Bank compressed(const Bank& bank) {
  auto read = parse(written(bank, Compression::meshopt));
  EXPECT_TRUE(read) << read.error().message;
  return read.value_or(Bank{});
}

// The rms error of a mode's numbers over their own rms.
double shape_error(const Bank& exact, const Bank& rounded, std::size_t mode) {
  double error = 0, sum = 0;
  for (std::size_t p = 0; p < exact.point_count(); ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double x = exact.shape(mode, p)[axis];
      error += std::pow(rounded.shape(mode, p)[axis] - x, 2);
      sum += x * x;
    }
  }
  return std::sqrt(error / sum);
}

TEST(CompressedBank, OnlyShapesAreRoundedAndByLessThanHalfAPercent) {
  const Bank bank = parse(written(random_bank(4, 50, 300))).value();
  const Bank packed = compressed(bank);
  ASSERT_EQ(packed.shapes.size(), bank.shapes.size());
  double min = 1;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    min = std::min(min, shape_error(bank, packed, m));
    EXPECT_LT(shape_error(bank, packed, m), 0.0047)
        << m;  // half a step in uniform distribution: 1 / (64 sqrt(12)), and 4 %
  }
  EXPECT_GT(min, 0.001) << "a finer step costs bytes that nobody hears";
  Bank rest = packed;
  rest.shapes = bank.shapes;
  EXPECT_EQ(written(rest), written(bank)) << "all but the shapes is exact";
  EXPECT_LT(written(bank, Compression::meshopt).size(), 0.4 * static_cast<double>(written(bank).size()));
}

TEST(CompressedBank, ASecondTripChangesNoByte) {
  for (const std::size_t points : {4u, 30u}) {
    Bank bank = random_bank(7, 2000, points);
    for (std::size_t m = 0; m < bank.mode_count(); ++m) {
      const auto scale = static_cast<float>(std::exp2(static_cast<double>(m) / 1000));  // all between two powers of two
      for (std::size_t p = 0; p < bank.point_count(); ++p) bank.shapes[m * bank.point_count() + p][m % 3] *= scale;
    }
    const std::string once = written(bank, Compression::meshopt);
    EXPECT_TRUE(written(parse(once).value(), Compression::meshopt) == once);
  }
}

// Shapes whose rms lies close to where the step doubles, so that rounding may move it across.
TEST(CompressedBank, ASecondTripChangesNoByteWhereTheStepDoubles) {
  constexpr std::size_t kModes = 4000;
  Bank bank = single_mode_bank(440, 2);
  bank.frequency_hz.assign(kModes, 440);
  bank.radiation.reset();
  bank.decay_per_s.assign(kModes, 2);
  bank.shapes.clear();
  for (std::size_t m = 0; m < kModes; ++m) {
    const double angle = M_PI * static_cast<double>(m) / kModes;
    const double size = std::sqrt(3.0) * (1 + 1e-5 * static_cast<double>(m % 5) - 2e-5);
    const Vec3f shape = {static_cast<float>(size * std::cos(angle)), 0, static_cast<float>(size * std::sin(angle))};
    bank.shapes.insert(bank.shapes.end(), bank.point_count(), shape);
  }
  const std::string once = written(bank, Compression::meshopt);
  EXPECT_TRUE(written(parse(once).value(), Compression::meshopt) == once);
}

TEST(CompressedBank, ShapesOfAnySizeAreKept) {
  Bank bank = parse(written(random_bank(5, 4, 30))).value();
  const std::size_t points = bank.point_count();
  std::fill_n(bank.shapes.begin(), points, Vec3f{});  // a mode that moves no point
  std::fill_n(bank.shapes.begin() + static_cast<std::ptrdiff_t>(points), 1, Vec3f{0, 0, 1e6F});  // one that moves one
  for (std::size_t p = 0; p < points; ++p) bank.shapes[2 * points + p][0] *= 1e-12F;
  for (std::size_t p = 0; p < points; ++p) bank.shapes[3 * points + p][1] *= 1e20F;
  const Bank packed = compressed(bank);
  for (std::size_t p = 0; p < points; ++p) EXPECT_EQ(packed.shape(0, p), Vec3f{}) << p;
  for (const std::size_t m : {1u, 2u, 3u}) EXPECT_LT(shape_error(bank, packed, m), 0.0047) << m;
  bank.shapes[7][0] = 1e30F;
  EXPECT_EQ(compressed(bank).shapes, bank.shapes) << "beyond what the filter holds they stay exact";
}

TEST(CompressedBank, ACompressedBankIsAValidGltfDocument) {
  GlbParts parts(written(random_bank(3, 5, 30), Compression::meshopt));
  const Json& json = parts.json;
  EXPECT_EQ(json["extensionsUsed"], Json::array({"KHR_audio_rigid_bodies", kMeshopt}));
  EXPECT_EQ(json["extensionsRequired"], Json::array({kMeshopt}));
  ASSERT_EQ(json["buffers"].size(), 2u);
  EXPECT_TRUE(json["buffers"][1]["extensions"][kMeshopt]["fallback"]);
  EXPECT_FALSE(json["buffers"][1].contains("uri"));
  for (const char* key : {"frequencies", "decayRates"}) EXPECT_EQ(parts.view(key)["buffer"], 0) << key;
  const std::pair<const char*, const char*> views[] = {
      {"positions", "NONE"}, {"shapes", "EXPONENTIAL"}, {"indices", "NONE"}};
  for (const auto& [key, filter] : views) {
    const Json view = parts.view(key), packing = view["extensions"][kMeshopt];
    EXPECT_EQ(packing.value("filter", "NONE"), filter) << key;
    EXPECT_EQ(view["buffer"], 1) << key;
    EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u) << key;
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(),
              json["buffers"][1]["byteLength"]);
    EXPECT_EQ(view["byteLength"], packing["count"].get<std::size_t>() * packing["byteStride"].get<std::size_t>());
    EXPECT_LE(packing["byteOffset"].get<std::size_t>() + packing["byteLength"].get<std::size_t>(),
              json["buffers"][0]["byteLength"]);
  }
}

// As another tool may write it: two arrays in one compressed view, and data of a fallback that nobody needs.
TEST(CompressedBank, AForeignViewMayHoldTwoArraysAndAFallback) {
  const Bank source = parse(written(random_bank(6, 9, 30))).value();
  std::vector<float> both(source.frequency_hz.begin(), source.frequency_hz.end());
  both.insert(both.end(), source.decay_per_s.begin(), source.decay_per_s.end());
  const std::vector<std::byte> stream = pack_attributes(std::as_bytes(std::span(both)), 4);
  GlbParts parts(written(source));
  parts.replace_data("frequencies", std::string(reinterpret_cast<const char*>(stream.data()), stream.size()));
  Json& view = parts.view("frequencies");
  Json packing = view;
  packing.update({{"mode", "ATTRIBUTES"}, {"filter", "NONE"}, {"count", both.size()}, {"byteStride", 4}});
  view = {{"buffer", 0}, {"byteLength", 4 * both.size()}, {"byteStride", 4}, {"extensions", {{kMeshopt, packing}}}};
  parts.accessor("decayRates")["bufferView"] = parts.accessor("frequencies")["bufferView"];
  parts.accessor("decayRates")["byteOffset"] = 4 * source.mode_count();
  const auto bank = parse(parts.join());
  ASSERT_TRUE(bank) << bank.error().message;
  EXPECT_EQ(bank->frequency_hz, source.frequency_hz);
  EXPECT_EQ(bank->decay_per_s, source.decay_per_s);
}

}  // namespace
}  // namespace ringdown::modal::test
