// The pieces of a body in its bank's file: written, read, scaled; and broken files, each refused by the name of a
// field.
#include "engine/modal/mode_choice.h"
#include "engine/modal/scaled_bank.h"
#include "tests/modal/fracture/breakable_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace ringdown::modal::fracture_file_test {
namespace {

using test::file_content;
using test::parse;
using test::written;

TEST(FractureFile, PiecesComeBackAsTheyWentIn) {
  const Bank bank = breakable_bank();
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    const auto back = parse(written(bank, compression));
    ASSERT_TRUE(back) << back.error().message;
    ASSERT_TRUE(back->fracture);
    ASSERT_EQ(back->fracture->patterns.size(), 2u);
    for (std::size_t p = 0; p < 2; ++p) {
      const BreakPattern &a = bank.fracture->patterns[p], &b = back->fracture->patterns[p];
      EXPECT_EQ(a.at_m, b.at_m);
      EXPECT_EQ(a.crack_area_m2, b.crack_area_m2);
      ASSERT_EQ(a.pieces.size(), b.pieces.size());
      for (std::size_t i = 0; i < a.pieces.size(); ++i)
        expect_same_piece(a.pieces[i], b.pieces[i], compression == Compression::none);
      EXPECT_EQ(b.pieces[kSilent].bank.mode_count(), 0u);
      EXPECT_FALSE(b.pieces[kSilent].bank.triangles.empty());
    }
  }
}

TEST(FractureFile, AFileIsTheSameByteForByteAfterOneTrip) {
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    const std::string once = written(breakable_bank(), compression);
    EXPECT_EQ(written(parse(once).value(), compression), once);
  }
}

// The document without what the pieces added to it is that of the same body without pieces.
TEST(FractureFile, ABankWithoutPiecesIsWrittenAsIfThereWereNoFracture) {
  Bank whole = breakable_bank();
  const GlbParts with(written(whole));
  whole.fracture.reset();
  const std::string plain = written(whole);
  GlbParts without(plain);
  EXPECT_EQ(plain.find("fracture"), std::string::npos);
  EXPECT_EQ(plain.find("pieces"), std::string::npos);
  EXPECT_EQ(without.json["scenes"], Json::parse(R"([{"nodes": [0]}])"));
  EXPECT_EQ(without.json["nodes"].size(), 1u);
  EXPECT_EQ(without.json["meshes"].size(), 1u);
  EXPECT_EQ(without.extension()["modalModels"].size(), 1u);

  GlbParts stripped = with;
  stripped.model()["extras"]["ringdown"].erase("fracture");
  EXPECT_EQ(stripped.model(), without.model());
  EXPECT_EQ(stripped.json["nodes"][0], without.json["nodes"][0]);
  EXPECT_EQ(stripped.json["meshes"][0], without.json["meshes"][0]);
  EXPECT_EQ(stripped.extension()["acousticMaterials"], without.extension()["acousticMaterials"]);
  for (std::size_t a = 0; a < without.json["accessors"].size(); ++a) {
    EXPECT_EQ(stripped.json["accessors"][a], without.json["accessors"][a]);
    EXPECT_EQ(stripped.json["bufferViews"][a], without.json["bufferViews"][a]);
  }
  const std::size_t bytes = without.json["buffers"][0]["byteLength"].get<std::size_t>();
  EXPECT_EQ(with.binary.substr(0, bytes), without.binary.substr(0, bytes));
}

// A reader that knows glTF and the extension, but no fracture, shows and plays the whole body.
TEST(FractureFile, TheFirstModelNodeAndSceneAreTheWholeBody) {
  GlbParts parts(written(breakable_bank()));
  const Json& json = parts.json;
  EXPECT_EQ(json["scene"], 0);
  ASSERT_EQ(json["scenes"].size(), 2u);
  EXPECT_EQ(json["scenes"][0]["nodes"], Json::array({0}));
  EXPECT_EQ(json["scenes"][1]["name"], "pieces");
  EXPECT_EQ(json["scenes"][1]["nodes"], Json::array({1, 2, 3, 4, 5}));
  ASSERT_EQ(json["nodes"].size(), 6u);
  EXPECT_EQ(json["nodes"][0]["name"], "body");
  std::vector<int> models;
  for (const Json& node : json["nodes"]) {
    EXPECT_LT(node["mesh"].get<std::size_t>(), json["meshes"].size());
    if (node.contains("extensions"))
      models.push_back(node["extensions"]["KHR_audio_rigid_bodies"]["modalModel"].get<int>());
  }
  EXPECT_EQ(models, (std::vector{0, 1, 2, 3})) << "two pieces are silent";
  EXPECT_EQ(parts.extension()["modalModels"].size(), 4u);
  EXPECT_EQ(parts.extension()["acousticMaterials"].size(), 1u);
  for (const Json& mesh : json["meshes"]) {
    const Json& primitive = mesh["primitives"][0];
    EXPECT_EQ(primitive["mode"], 4);
    EXPECT_EQ(json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()]["min"].size(), 3u);
  }
  const Json& pieces = parts.model()["extras"]["ringdown"]["fracture"]["patterns"][1]["pieces"];
  EXPECT_EQ(pieces[0]["model"], 2);
  EXPECT_FALSE(pieces[1].contains("model"));
  EXPECT_EQ(pieces[2]["model"], 3);
}

TEST(FractureFile, APieceIsReadAloneByItsModelsNumber) {
  const Bank bank = breakable_bank();
  const ringdown::test::TemporaryFolder folder;
  ASSERT_TRUE(write_bank(bank, folder / "body.glb"));
  const PieceBank& last = bank.fracture->patterns[1].pieces[2];
  const auto piece = read_bank((folder / "body.glb").string() + "#3");
  ASSERT_TRUE(piece) << piece.error().message;
  expect_same_piece(last, {.bank = *piece, .handover = last.handover, .near_m = last.near_m, .far_m = last.far_m},
                    true);
  EXPECT_FALSE(piece->fracture);
  const std::string bytes = written(bank);
  const auto chosen = parse_bank(std::as_bytes(std::span(bytes)), "x.glb", {.number = 3});
  ASSERT_TRUE(chosen) << chosen.error().message;
  EXPECT_EQ(chosen->name, "body.5");
  const auto whole = parse_bank(std::as_bytes(std::span(bytes)), "x.glb", {.number = 0});
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->fracture->patterns.size(), 2u);
  EXPECT_FALSE(parse_bank(std::as_bytes(std::span(bytes)), "x.glb", {.number = 4}));
}

TEST(FractureFile, AScaledBodyHasScaledPieces) {
  const Bank bank = breakable_bank();
  const MaterialScale scale{.density = 1.5, .stiffness = 0.7, .size = 2};
  const Bank larger = scaled(bank, scale);
  ASSERT_TRUE(larger.fracture);
  ASSERT_EQ(larger.mode_count(), kModes);
  for (std::size_t p = 0; p < 2; ++p) {
    const BreakPattern &a = bank.fracture->patterns[p], &b = larger.fracture->patterns[p];
    EXPECT_EQ(b.at_m, 2 * a.at_m);
    EXPECT_DOUBLE_EQ(b.crack_area_m2, 4 * a.crack_area_m2);
    ASSERT_EQ(b.pieces.size(), a.pieces.size());
    for (std::size_t i = 0; i < a.pieces.size(); ++i) {
      const PieceBank &before = a.pieces[i], &after = b.pieces[i];
      EXPECT_DOUBLE_EQ(after.near_m, 2 * before.near_m);
      EXPECT_DOUBLE_EQ(after.far_m, 2 * before.far_m);
      EXPECT_EQ(after.handover, before.handover) << "it has no unit";
      EXPECT_DOUBLE_EQ(after.bank.mass->mass_kg, 12 * before.bank.mass->mass_kg);
      EXPECT_EQ(after.bank.mass->center_of_mass_m, 2 * before.bank.mass->center_of_mass_m);
      EXPECT_DOUBLE_EQ(after.bank.mass->inertia_kg_m2.y, 48 * before.bank.mass->inertia_kg_m2.y);
      ASSERT_EQ(after.bank.mode_count(), before.bank.mode_count());
      for (std::size_t m = 0; m < before.bank.mode_count(); ++m) {
        const auto omega = [](const Bank& of, std::size_t k) {  // undamped
          return std::hypot(2 * 3.14159265358979324 * of.frequency_hz[k], of.decay_per_s[k]);
        };
        EXPECT_NEAR(omega(after.bank, m) / omega(before.bank, m), std::sqrt(0.7 / 1.5) / 2, 1e-9);
      }
      for (std::size_t n = 0; n < before.bank.point_count(); ++n) {
        for (int k = 0; k < 3; ++k) EXPECT_EQ(after.bank.positions[n][k], 2 * before.bank.positions[n][k]);
      }
    }
  }
  EXPECT_EQ(bank.fracture->patterns[0].crack_area_m2, 0.125) << "the bank itself stays";
}

TEST(FractureFile, AModeThatNoLongerRingsLeavesTheHandovers) {
  Bank bank = breakable_bank();
  Fracture fracture = *bank.fracture;
  Bank& piece = fracture.patterns[0].pieces[0].bank;
  // The highest of each would be over-damped if the material took 1e5 times as much.
  const auto damp = [](Bank& of, std::size_t mode) {
    for (double& decay : of.decay_per_s) decay = 1e-6;
    of.decay_per_s[mode] = 0.01 * of.frequency_hz[mode];
    of.material->damping = {0, 0};
  };
  damp(bank, 4);
  damp(piece, 2);
  bank.fracture = std::make_shared<const Fracture>(fracture);
  const Bank softer = scaled(bank, {.alpha = 1e5, .beta = 1e5});
  ASSERT_EQ(softer.mode_count(), kModes - 1);
  const PieceBank &before = fracture.patterns[0].pieces[0], &after = softer.fracture->patterns[0].pieces[0];
  ASSERT_EQ(after.bank.mode_count(), 4u);
  ASSERT_EQ(after.handover.size(), 10u * (kRigidMotions + kModes - 1));
  for (std::size_t row = 0; row < 10; ++row) {
    for (std::size_t column = 0; column < kRigidMotions + kModes - 1; ++column) {
      const std::size_t old_row = row < kRigidMotions + 2 ? row : row + 1;
      const std::size_t old_column = column < kRigidMotions + 4 ? column : column + 1;
      EXPECT_EQ(after.handover[row * (kRigidMotions + kModes - 1) + column],
                before.handover[old_row * (kRigidMotions + kModes) + old_column]);
    }
  }
  EXPECT_TRUE(parse(written(softer)));
}

TEST(FractureFile, ChosenModesTakeTheirColumnsAlong) {
  const Bank bank = breakable_bank();
  Bank few = bank;
  const std::vector<std::size_t> order = {7, 0, 3};
  take_modes(few, order);
  for (std::size_t p = 0; p < 2; ++p) {
    for (std::size_t i = 0; i < few.fracture->patterns[p].pieces.size(); ++i) {
      const PieceBank &before = bank.fracture->patterns[p].pieces[i], &after = few.fracture->patterns[p].pieces[i];
      const std::size_t rows = kRigidMotions + before.bank.mode_count();
      ASSERT_EQ(after.bank.mode_count(), before.bank.mode_count());
      ASSERT_EQ(after.handover.size(), rows * (kRigidMotions + order.size()));
      for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = 0; column < kRigidMotions + order.size(); ++column) {
          const std::size_t old = column < kRigidMotions ? column : kRigidMotions + order[column - kRigidMotions];
          ASSERT_EQ(after.handover[row * (kRigidMotions + order.size()) + column],
                    before.handover[row * (kRigidMotions + kModes) + old]);
        }
      }
    }
  }
  EXPECT_EQ(bank.fracture->patterns[0].pieces[0].handover, breakable_bank().fracture->patterns[0].pieces[0].handover);
  const auto back = parse(written(few));
  ASSERT_TRUE(back) << back.error().message;
}

TEST(FractureFile, ANodesScaleScalesThePieces) {
  GlbParts parts(written(breakable_bank()));
  parts.json["nodes"][0]["scale"] = {3, 3, 3};
  const auto bank = parse(parts.join());
  ASSERT_TRUE(bank) << bank.error().message;
  EXPECT_DOUBLE_EQ(bank->fracture->patterns[0].crack_area_m2, 9 * 0.125);
  EXPECT_NEAR(bank->fracture->patterns[0].pieces[1].bank.mass->mass_kg, 27 * 0.2, 1e-12);
}

TEST(FractureFile, PiecesThatOverflowAtTheNodesScaleAreRefused) {
  Bank whole = breakable_bank();
  whole.material->damping = {0, 0};
  whole.radiation.reset();
  whole.decay_per_s.assign(kModes, 0);
  Fracture fracture = *whole.fracture;
  fracture.patterns[0].pieces[kSilent].bank.positions[0][0] = 1e38F;
  whole.fracture = std::make_shared<const Fracture>(fracture);
  GlbParts parts(written(whole));
  parts.json["nodes"][0]["scale"] = {1000, 1000, 1000};
  const auto bank = parse(parts.join());
  ASSERT_FALSE(bank);
  EXPECT_NE(bank.error().message.find("overflow"), std::string::npos) << bank.error().message;
}

Json& handover_in(GlbParts& parts) { return parts.json["accessors"][pattern_in(parts)["handover"].get<std::size_t>()]; }

void set_entry(GlbParts& parts, float value) {
  const Json& view = parts.json["bufferViews"][handover_in(parts)["bufferView"].get<std::size_t>()];
  std::memcpy(parts.binary.data() + view["byteOffset"].get<std::size_t>() + 17 * sizeof(float), &value, sizeof value);
}

const std::vector<Damage>& damages() {
  static const std::vector<Damage> all = {
      {"HandoverTooShort", [](GlbParts& p) { handover_in(p)["count"] = handover_in(p)["count"].get<int>() - 1; },
       "handover"},
      {"HandoverOfTheOtherPattern",
       [](GlbParts& p) { pattern_in(p)["handover"] = fracture_in(p)["patterns"][1]["handover"]; }, "handover"},
      {"HandoverCountHuge", [](GlbParts& p) { handover_in(p)["count"] = 1e12; }, "count"},
      {"HandoverMissing", [](GlbParts& p) { pattern_in(p).erase("handover"); }, "handover"},
      {"HandoverPastTheEnd", [](GlbParts& p) { pattern_in(p)["handover"] = 999; }, "handover"},
      {"HandoverOfVectors", [](GlbParts& p) { handover_in(p)["type"] = "VEC3"; }, "type"},
      {"EntryOfTwo", [](GlbParts& p) { set_entry(p, 2); }, "handover"},
      {"EntryOfMinusTwo", [](GlbParts& p) { set_entry(p, -2); }, "handover"},
      {"EntryNan", [](GlbParts& p) { set_entry(p, std::numeric_limits<float>::quiet_NaN()); }, "handover: element 17"},
      {"EntryInfinite", [](GlbParts& p) { set_entry(p, INFINITY); }, "handover: element 17"},
      {"NoFractureButANumber", [](GlbParts& p) { fracture_in(p) = 3; }, "fracture"},
      {"NoPatterns", [](GlbParts& p) { fracture_in(p)["patterns"] = Json::array(); }, "patterns"},
      {"PatternsMissing", [](GlbParts& p) { fracture_in(p).erase("patterns"); }, "patterns"},
      {"PatternIsANumber", [](GlbParts& p) { pattern_in(p) = 7; }, "patterns"},
      {"TooManyPatterns",
       [](GlbParts& p) {
         const Json pattern = pattern_in(p);
         for (std::size_t n = 0; n < kMaxPatterns; ++n) fracture_in(p)["patterns"].push_back(pattern);
       },
       "patterns"},
      {"TooManyPieces",
       [](GlbParts& p) {
         const Json piece = piece_in(p);
         for (std::size_t n = 0; n < kMaxPieces; ++n) pattern_in(p)["pieces"].push_back(piece);
       },
       "`pieces`"},
      {"TooManyPiecesOfAllPatterns",
       [](GlbParts& p) {
         const Json piece = fracture_in(p)["patterns"][1]["pieces"][0];
         for (std::size_t n = 0; n < kMaxPieces - 4; ++n) fracture_in(p)["patterns"][1]["pieces"].push_back(piece);
       },
       "1024"},
      {"OnePieceOnly", [](GlbParts& p) { pattern_in(p)["pieces"].erase(1); }, "`pieces`"},
      {"PiecesMissing", [](GlbParts& p) { pattern_in(p).erase("pieces"); }, "`pieces`"},
      {"PieceIsANumber", [](GlbParts& p) { piece_in(p) = 7; }, "positions"},
      {"ModelPastTheEnd", [](GlbParts& p) { piece_in(p)["model"] = 4; }, "a model 4"},
      {"ModelHuge", [](GlbParts& p) { piece_in(p)["model"] = 1e300; }, "model"},
      {"ModelNegative", [](GlbParts& p) { piece_in(p)["model"] = -1; }, "model"},
      {"ModelText", [](GlbParts& p) { piece_in(p)["model"] = "one"; }, "model"},
      {"ModelWithMoreModes", [](GlbParts& p) { piece_in(p)["model"] = 3; }, "handover"},
      {"ModelWithoutFrequencies", [](GlbParts& p) { p.extension()["modalModels"][1].erase("frequencies"); },
       "frequencies"},
      {"ModelOfALaterVersion",
       [](GlbParts& p) { p.extension()["modalModels"][1]["extras"]["ringdown"]["version"] = 9; }, "version 9"},
      {"OpensReversed",
       [](GlbParts& p) {
         piece_in(p)["opens"] = {0.02, 0.01};
       },
       "opens"},
      {"OpensNegative",
       [](GlbParts& p) {
         piece_in(p)["opens"] = {-0.02, 0.01};
       },
       "opens"},
      {"OpensHuge",
       [](GlbParts& p) {
         piece_in(p)["opens"] = {0, 1e300};
       },
       "opens"},
      {"OpensOnce", [](GlbParts& p) { piece_in(p)["opens"] = Json::array({0.01}); }, "opens"},
      {"OpensMissing", [](GlbParts& p) { piece_in(p).erase("opens"); }, "opens"},
      {"OpensText",
       [](GlbParts& p) {
         piece_in(p)["opens"] = {"near", "far"};
       },
       "opens"},
      {"MassMissing", [](GlbParts& p) { p.extension()["modalModels"][1].erase("massProperties"); }, "massProperties"},
      {"MassOfASilentPieceMissing", [](GlbParts& p) { piece_in(p, 1).erase("massProperties"); }, "massProperties"},
      {"MassOfASilentPieceZero", [](GlbParts& p) { piece_in(p, 1)["massProperties"]["mass"] = 0; }, "mass"},
      {"MassOfTheBodyMissing", [](GlbParts& p) { p.model().erase("massProperties"); }, "massProperties"},
      {"InertiaMissing",
       [](GlbParts& p) { p.extension()["modalModels"][1]["massProperties"].erase("inertiaDiagonal"); }, "inertia"},
      {"InertiaOfASilentPieceZero",
       [](GlbParts& p) {
         piece_in(p, 1)["massProperties"]["inertiaDiagonal"] = {1e-4, 0, 1e-4};
       },
       "inertia"},
      {"InertiaOfTheBodyZero",
       [](GlbParts& p) {
         p.model()["massProperties"]["inertiaDiagonal"] = {0, 0, 0};
       },
       "inertia"},
      {"PositionsOfASilentPieceMissing", [](GlbParts& p) { piece_in(p, 1).erase("positions"); }, "positions"},
      {"CornerOfASilentPieceTooHigh",
       [](GlbParts& p) { piece_in(p, 1)["indices"] = fracture_in(p)["patterns"][1]["handover"]; }, "indices"},
      {"AreaNegative", [](GlbParts& p) { pattern_in(p)["crackArea"] = -0.1; }, "crackArea"},
      {"AreaHuge", [](GlbParts& p) { pattern_in(p)["crackArea"] = 1e300; }, "crackArea"},
      {"AreaMissing", [](GlbParts& p) { pattern_in(p).erase("crackArea"); }, "crackArea"},
      {"AreaText", [](GlbParts& p) { pattern_in(p)["crackArea"] = "large"; }, "crackArea"},
      {"PlaceOfTwoNumbers",
       [](GlbParts& p) {
         pattern_in(p)["at"] = {1, 2};
       },
       "at"},
      {"PlaceFarAway",
       [](GlbParts& p) {
         pattern_in(p)["at"] = {1, 1e9, 2};
       },
       "at is an array, expected a place"},
      {"PlaceMissing", [](GlbParts& p) { pattern_in(p).erase("at"); }, "at"},
  };
  return all;
}

class BrokenFracture : public testing::TestWithParam<std::size_t> {};

TEST_P(BrokenFracture, BrokenPiecesAreRefusedByTheNameOfTheirField) {
  const Damage& damage = damages()[GetParam()];
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    GlbParts parts(written(breakable_bank(), compression));
    damage.change(parts);
    const auto bank = parse(parts.join());
    ASSERT_FALSE(bank);
    EXPECT_EQ(bank.error().message.rfind("x.glb", 0), 0u) << bank.error().message;
    EXPECT_NE(bank.error().message.find(damage.expected), std::string::npos) << bank.error().message;
    EXPECT_LT(bank.error().message.size(), 300u) << "one sentence: " << bank.error().message;
  }
}

INSTANTIATE_TEST_SUITE_P(Each, BrokenFracture, testing::Range(std::size_t{0}, damages().size()),
                         [](const auto& each) { return std::string(damages()[each.param].name); });

// A million pieces are more values than a document may have.
TEST(BrokenFractureFile, AMillionPiecesAreRefused) {
  GlbParts parts(written(breakable_bank()));
  pattern_in(parts)["pieces"] = Json(std::vector<int>(1'000'000, 1));
  const auto bank = parse(parts.join());
  ASSERT_FALSE(bank);
  EXPECT_NE(bank.error().message.find("values"), std::string::npos) << bank.error().message;
  pattern_in(parts)["pieces"] = Json(std::vector<int>(100'000, 1));
  const auto fewer = parse(parts.join());
  ASSERT_FALSE(fewer);
  EXPECT_NE(fewer.error().message.find("`pieces`, at most 1024"), std::string::npos) << fewer.error().message;
}

// Pieces at the limit of their number are read.
TEST(BrokenFractureFile, AsManyPiecesAsAllowedAreRead) {
  Bank bank = breakable_bank();
  Fracture fracture = *bank.fracture;
  fracture.patterns.resize(1);
  fracture.patterns[0].pieces.resize(kMaxPieces, piece_of(6, 0));
  bank.fracture = std::make_shared<const Fracture>(fracture);
  const auto back = parse(written(bank));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->fracture->patterns[0].pieces.size(), kMaxPieces);
}

// A small file whose thousand pieces all name one large array must not fill the memory.
TEST(BrokenFractureFile, PiecesThatShareALargeArrayAreRefused) {
  Bank bank = breakable_bank();
  Fracture fracture = *bank.fracture;
  fracture.patterns.resize(1);
  bank.fracture = std::make_shared<const Fracture>(fracture);
  PieceBank large = piece_of(6, 0);
  large.bank.positions.resize(1'000'000, modal::Vec3f{0.1F, 0.2F, 0.3F});
  fracture.patterns[0].pieces[kSilent] = large;
  bank.fracture = std::make_shared<const Fracture>(fracture);
  GlbParts parts(written(bank, Compression::meshopt));
  const Json piece = piece_in(parts, kSilent);
  for (std::size_t n = 2; n < kMaxPieces; ++n) pattern_in(parts)["pieces"].push_back(piece);
  const std::string file = parts.join();
  EXPECT_LT(file.size(), 1u << 20);
  const auto read = parse(file);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("pieces of at most"), std::string::npos) << read.error().message;
}

}  // namespace
}  // namespace ringdown::modal::fracture_file_test
