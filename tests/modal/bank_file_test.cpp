// Banks written and read again, and the glTF structure that other programs will see.
#include "tests/modal/glb_editor.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace ringdown::modal::test {
namespace {

using namespace ringdown::test;  // NOLINT: the synthetic banks

void expect_same(const Bank& a, const Bank& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.frequency_hz, b.frequency_hz);
  EXPECT_EQ(a.decay_per_s, b.decay_per_s);
  EXPECT_EQ(a.frequency_error, b.frequency_error);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.shapes, b.shapes);
  EXPECT_EQ(a.triangles, b.triangles);
  ASSERT_EQ(a.material.has_value(), b.material.has_value());
  if (a.material) {
    EXPECT_EQ(a.material->name, b.material->name);
    EXPECT_EQ(a.material->youngs_modulus_pa, b.material->youngs_modulus_pa);
    EXPECT_EQ(a.material->poisson_ratio, b.material->poisson_ratio);
    EXPECT_EQ(a.material->density_kg_m3, b.material->density_kg_m3);
    EXPECT_EQ(a.material->damping, b.material->damping);
  }
  ASSERT_EQ(a.mass.has_value(), b.mass.has_value());
  if (a.mass) {
    EXPECT_EQ(a.mass->mass_kg, b.mass->mass_kg);
    EXPECT_EQ(a.mass->center_of_mass_m, b.mass->center_of_mass_m);
    EXPECT_EQ(a.mass->inertia_kg_m2, b.mass->inertia_kg_m2);
    EXPECT_EQ(a.mass->orientation, b.mass->orientation);
  }
  EXPECT_EQ(a.provenance.generator, b.provenance.generator);
  EXPECT_EQ(a.provenance.wall_elements, b.provenance.wall_elements);
  EXPECT_EQ(a.provenance.element, b.provenance.element);
  EXPECT_EQ(a.provenance.unknowns, b.provenance.unknowns);
  EXPECT_EQ(a.provenance.rigid_modes, b.provenance.rigid_modes);
  EXPECT_EQ(a.provenance.counted_modes, b.provenance.counted_modes);
  EXPECT_EQ(a.provenance.band_low_hz, b.provenance.band_low_hz);
  EXPECT_EQ(a.provenance.band_high_hz, b.provenance.band_high_hz);
  EXPECT_EQ(a.provenance.largest_residual, b.provenance.largest_residual);
  EXPECT_EQ(a.provenance.dropped_modes, b.provenance.dropped_modes);
  EXPECT_EQ(a.provenance.floor_db, b.provenance.floor_db);
  EXPECT_EQ(a.provenance.loss_db, b.provenance.loss_db);
}

TEST(BankFile, ABankComesBackAsItWentIn) {
  for (Bank bank : {bar_bank(12), random_bank(1, 40, 100), single_mode_bank(440.5, 2.25)}) {
    bank.provenance.wall_elements = 0.25;
    const auto once = parse(written(bank));
    ASSERT_TRUE(once) << once.error().message;
    ASSERT_EQ(once->mode_count(), bank.mode_count());
    for (std::size_t m = 0; m < bank.mode_count(); ++m) {
      EXPECT_EQ(once->frequency_hz[m], static_cast<double>(static_cast<float>(bank.frequency_hz[m])));
      EXPECT_EQ(once->decay_per_s[m], static_cast<double>(static_cast<float>(bank.decay_per_s[m])));
    }
    Bank rounded = bank;
    rounded.frequency_hz = once->frequency_hz;
    rounded.decay_per_s = once->decay_per_s;
    expect_same(*once, rounded);
  }
}

TEST(BankFile, ABankIsBitExactAfterOneTrip) {
  const std::string once = written(random_bank(2, 40, 100));
  const std::string twice = written(parse(once).value());
  EXPECT_EQ(once, twice);
}

TEST(BankFile, ABankKeepsTheErrorOfEachMode) {
  Bank bank = bar_bank(3);
  bank.frequency_error = {1.23e-4, 0, 0.05};
  const std::string once = written(bank);
  const auto back = parse(once);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->frequency_error, bank.frequency_error);
  EXPECT_EQ(written(*back), once);
  EXPECT_EQ(error_spread(back->frequency_error)->median, 1.23e-4);
  EXPECT_EQ(error_spread(back->frequency_error)->largest, 0.05);
  bank.frequency_error.clear();
  EXPECT_TRUE(parse(written(bank))->frequency_error.empty());
  EXPECT_FALSE(error_spread(bank.frequency_error));
}

TEST(BankFile, ABankKeepsNamesInAnyScript) {
  Bank bank = bar_bank(1);
  bank.name = "колокол \"鐘\" \\ \n";
  bank.material->name = std::string("bad utf-8: \xff");
  const auto back = parse(written(bank));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->name, bank.name);
  EXPECT_EQ(back->material->name, "bad utf-8: \xef\xbf\xbd");
}

TEST(BankFile, TheOldBankStaysWhenTheNewCannotBeWritten) {
  const ringdown::test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "bank.glb" / "not-empty");
  const auto outcome = write_bank(bar_bank(2), folder / "bank.glb");
  ASSERT_FALSE(outcome);
  EXPECT_NE(outcome.error().message.find("bank.glb"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder / "bank.glb" / "not-empty"));
}

// A display name is not a path: what looks like a choice of a model in it chooses none, and scales no points.
TEST(BankFile, ADisplayNameChoosesNoModel) {
  const std::string bytes = written(random_bank(1, 4, 10));
  const Result<Bank> plain = parse(bytes);
  ASSERT_TRUE(plain) << plain.error().message;
  for (const char* name : {"cup.glb#2@0.5", "cup.glb#0@0.5", "#2@0.5", "my #2@0.5 cup.glb#7"}) {
    const Result<Bank> bank = parse_bank(std::as_bytes(std::span(bytes)), name);
    ASSERT_TRUE(bank) << bank.error().message;
    EXPECT_EQ(bank->frequency_hz, plain->frequency_hz) << name;
    EXPECT_EQ(bank->positions, plain->positions) << name;
  }
}

TEST(BankFile, AFileThatIsNotThereIsRefused) {
  const auto bank = read_bank("/nonexistent/x.glb");
  ASSERT_FALSE(bank);
  EXPECT_NE(bank.error().message.find("/nonexistent/x.glb"), std::string::npos);
}

// A bank of one mode at four points, made to have so many of both.
Bank large_bank(std::size_t modes, std::size_t points) {
  Bank bank = single_mode_bank(440, 2);
  bank.frequency_hz.assign(modes, 440);
  bank.radiation.reset();
  bank.decay_per_s.assign(modes, 2);
  bank.frequency_error.clear();
  bank.positions.resize(points);
  bank.shapes.assign(modes * points, Vec3f{0, 0, 1});
  return bank;
}

TEST(BankFile, ABankHoldsModesAndPointsUpToTheLimitAndNotOneMore) {
  const auto refusal = [](std::size_t modes, std::size_t points) {
    const auto bank = parse(written(large_bank(modes, points)));
    return bank ? "" : bank.error().message;
  };
  EXPECT_EQ(refusal(kMaxModes, 4), "");
  EXPECT_NE(refusal(kMaxModes + 1, 4).find(std::to_string(kMaxModes)), std::string::npos);
  EXPECT_EQ(refusal(1, kMaxPoints), "");
  EXPECT_NE(refusal(1, kMaxPoints + 1).find(std::to_string(kMaxPoints)), std::string::npos);
}

TEST(BankFile, ABankIsAWellFormedGlbContainer) {
  const std::string file = written(random_bank(3, 5, 30));
  EXPECT_EQ(file.substr(0, 4), "glTF");
  EXPECT_EQ(word(file, 4), 2u);
  EXPECT_EQ(word(file, 8), file.size());
  const std::size_t text = word(file, 12);
  EXPECT_EQ(text % 4, 0u);
  EXPECT_EQ(file.substr(16, 4), "JSON");
  const std::size_t data = word(file, 20 + text);
  EXPECT_EQ(data % 4, 0u);
  EXPECT_EQ(file.substr(24 + text, 4), std::string("BIN\0", 4));
  EXPECT_EQ(28 + text + data, file.size());
}

TEST(BankFile, ABankIsAValidGltfDocument) {
  GlbParts parts(written(random_bank(3, 5, 30)));
  const Json& json = parts.json;
  EXPECT_EQ(json["asset"]["version"], "2.0");
  EXPECT_EQ(json["extensionsUsed"], Json::array({"KHR_audio_rigid_bodies"}));
  EXPECT_FALSE(json.contains("extensionsRequired")) << "a viewer without the extension must show the mesh";
  EXPECT_EQ(json["buffers"].size(), 1u);
  EXPECT_LE(json["buffers"][0]["byteLength"], parts.binary.size());
  for (const Json& view : json["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(),
              json["buffers"][0]["byteLength"]);
  }
  const Json& primitive = json["meshes"][0]["primitives"][0];
  const Json& position = json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(position["type"], "VEC3");
  EXPECT_EQ(position["min"].size(), 3u) << "required by the glTF specification for POSITION";
  EXPECT_EQ(position["max"].size(), 3u);
  EXPECT_EQ(primitive["indices"], parts.model()["indices"]);
  EXPECT_EQ(primitive["attributes"]["POSITION"], parts.model()["positions"]);
  EXPECT_EQ(json["nodes"][0]["extensions"]["KHR_audio_rigid_bodies"]["modalModel"], 0);
  EXPECT_EQ(parts.accessor("shapes")["count"],
            parts.accessor("frequencies")["count"].get<std::size_t>() * position["count"].get<std::size_t>());
}

TEST(BankFile, ABankWithoutTrianglesShowsPoints) {
  GlbParts parts(written(bar_bank(3)));
  EXPECT_EQ(parts.json["meshes"][0]["primitives"][0]["mode"], 0);
  EXPECT_FALSE(parts.model().contains("indices"));
}

TEST(BankFile, TheHashOfTheInputsIsReadBackAndChangesNothingElse) {
  const ringdown::test::TemporaryFolder folder;
  const std::string hash(32, 'a');
  const Bank bank = bar_bank(3);
  ASSERT_TRUE(write_bank(bank, folder / "hashed.glb", hash));
  const std::string whole = file_content(folder / "hashed.glb");
  EXPECT_EQ(read_input_hash(folder / "hashed.glb"), hash);
  ASSERT_TRUE(parse(whole));
  expect_same(*parse(whole), *parse(written(bank)));
  EXPECT_FALSE(read_input_hash(folder.write("short.glb", whole.substr(0, whole.size() - 1)))) << "it was cut off";
  EXPECT_FALSE(read_input_hash(folder.write("plain.glb", written(bank)))) << "it has none";
  EXPECT_FALSE(read_input_hash(folder / "none.glb"));
}

// Banks of earlier versions have a checksum beside the hash.
TEST(BankFile, AnOldBankWithASealIsReadAsBefore) {
  const ringdown::test::TemporaryFolder folder;
  const std::string hash(32, 'a');
  GlbParts parts(written(bar_bank(3)));
  parts.model()["extras"]["ringdown"]["inputHash"] = hash;
  parts.model()["extras"]["ringdown"]["seal"] = std::string(32, 'b');
  const auto path = folder.write("sealed.glb", parts.join());
  const auto bank = read_bank(path);
  ASSERT_TRUE(bank) << bank.error().message;
  expect_same(*bank, *parse(written(bar_bank(3))));
  EXPECT_EQ(read_input_hash(path), hash);
}

TEST(BankFile, ABankSaysItsVersionAndOneThatSaysNoneIsOfTheFirst) {
  GlbParts parts(written(bar_bank(3)));
  EXPECT_EQ(parts.model()["extras"]["ringdown"]["version"], 1);
  parts.model()["extras"]["ringdown"].erase("version");
  const auto bank = parse(parts.join());
  ASSERT_TRUE(bank) << bank.error().message;
  expect_same(*bank, *parse(written(bar_bank(3))));
}

TEST(BankFile, ABankOfALaterVersionIsRefused) {
  GlbParts parts(written(bar_bank(3)));
  parts.model()["extras"]["ringdown"]["version"] = 2;
  const auto bank = parse(parts.join());
  ASSERT_FALSE(bank);
  EXPECT_NE(bank.error().message.find("is a bank of version 2"), std::string::npos) << bank.error().message;
  EXPECT_NE(bank.error().message.find("reads up to 1"), std::string::npos) << bank.error().message;
}

}  // namespace
}  // namespace ringdown::modal::test
