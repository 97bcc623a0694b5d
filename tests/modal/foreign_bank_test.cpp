// Files that another tool could write by the draft: they load, and mean what the draft says.
#include "tests/modal/glb_editor.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ringdown::modal::test {
namespace {

using namespace ringdown::test;  // NOLINT: the synthetic banks

class ForeignBank : public testing::Test {
 protected:
  ForeignBank() : parts(written(source)) {}

  Bank read() {
    auto bank = parse(parts.join());
    EXPECT_TRUE(bank) << bank.error().message;
    return bank.value_or(Bank{});
  }
  // The indices as an array of T.
  template <class T>
  std::string corners() const {
    std::string bytes;
    for (const auto& triangle : source.triangles) {
      for (const std::uint32_t corner : triangle) {
        const T narrow = static_cast<T>(corner);
        bytes.append(reinterpret_cast<const char*>(&narrow), sizeof narrow);
      }
    }
    return bytes;
  }

  const Bank source = [] {
    Bank bank = random_bank(8, 7, 40);
    bank.material = bar_bank(1).material;
    bank.mass = bar_bank(1).mass;
    return parse(written(bank)).value();  // as it stands in a file
  }();
  GlbParts parts;
};

TEST_F(ForeignBank, AForeignBankMayHaveNoIndices) {
  parts.model().erase("indices");
  const Bank bank = read();
  EXPECT_TRUE(bank.triangles.empty());
  EXPECT_EQ(bank.shapes, source.shapes);
}

TEST_F(ForeignBank, AForeignBankMayHaveIndicesOfTwoBytesOrOne) {
  parts.replace_data("indices", corners<std::uint16_t>());
  parts.accessor("indices")["componentType"] = 5123;
  EXPECT_EQ(read().triangles, source.triangles);
  parts.replace_data("indices", corners<std::uint8_t>());
  parts.accessor("indices")["componentType"] = 5121;
  EXPECT_EQ(read().triangles, source.triangles);
}

TEST_F(ForeignBank, AForeignBankMayInterleaveItsVertices) {
  std::string wide;
  for (const Vec3f& p : source.positions) {
    wide.append(reinterpret_cast<const char*>(p.data()), sizeof p);
    wide.append(20, '\x7f');
  }
  wide.resize(wide.size() - 20);  // the last element needs no padding
  parts.replace_data("positions", wide);
  parts.view("positions")["byteStride"] = 32;
  EXPECT_EQ(read().positions, source.positions);
}

TEST_F(ForeignBank, AForeignBankMayShareOneViewAmongAccessors) {
  const std::size_t offset = 4 * source.mode_count();
  std::string both(2 * offset, '\0');
  std::memcpy(both.data(), parts.binary.data() + parts.offset("frequencies"), offset);
  std::memcpy(both.data() + offset, parts.binary.data() + parts.offset("decayRates"), offset);
  parts.replace_data("frequencies", both);
  parts.accessor("decayRates")["bufferView"] = parts.accessor("frequencies")["bufferView"];
  parts.accessor("decayRates")["byteOffset"] = offset;
  const Bank bank = read();
  EXPECT_EQ(bank.frequency_hz, source.frequency_hz);
  EXPECT_EQ(bank.decay_per_s, source.decay_per_s);
}

TEST_F(ForeignBank, AForeignBankMayLackMaterialMassAndExtras) {
  parts.model().erase("material");
  parts.model().erase("massProperties");
  parts.model().erase("extras");
  parts.extension().erase("acousticMaterials");
  const Bank bank = read();
  EXPECT_FALSE(bank.material);
  EXPECT_FALSE(bank.mass);
  EXPECT_EQ(bank.provenance.element, "");
  EXPECT_EQ(bank.frequency_hz, source.frequency_hz);
}

TEST_F(ForeignBank, AForeignBankMayBePlayedByNoNode) {
  parts.json.erase("nodes");
  parts.json.erase("scenes");
  EXPECT_EQ(read().frequency_hz, source.frequency_hz);
}

TEST_F(ForeignBank, AForeignBankPlaysTheModelThatItsNodeNames) {
  Json other = parts.model();
  other["name"] = "second";
  other["frequencies"] = parts.model()["decayRates"];
  parts.extension()["modalModels"].push_back(other);
  parts.json["nodes"].insert(parts.json["nodes"].begin(), Json{{"name", "camera"}});
  parts.json["nodes"][1]["extensions"]["KHR_audio_rigid_bodies"]["modalModel"] = 1;
  const Bank bank = read();
  EXPECT_EQ(bank.name, "second");
  EXPECT_EQ(bank.frequency_hz, source.decay_per_s);
}

TEST_F(ForeignBank, AForeignBankTakesItsNodesNameWhenItHasNone) {
  parts.model().erase("name");
  parts.json["nodes"][0]["name"] = "vase";
  EXPECT_EQ(read().name, "vase");
}

TEST_F(ForeignBank, AForeignBankMayCarryChunksOfOtherProgramsAfterTheBinary) {
  const auto bank = parse(parts.join(std::string("\4\0\0\0XTRAabcd", 12)));
  ASSERT_TRUE(bank) << bank.error().message;
  EXPECT_EQ(bank->shapes, source.shapes);
}

// Twice the size, same material: half the frequency (lambda by 1/4), eight times the mass, shapes by 8^-1/2; the
// stiffness part of the decay falls with lambda, the mass part stays.
TEST_F(ForeignBank, AForeignBankIsRescaledByItsNodesScale) {
  parts.json["nodes"][0]["scale"] = {2, 2, 2};
  const Bank bank = read();
  const RayleighDamping damping = source.material->damping;
  for (std::size_t m = 0; m < source.mode_count(); ++m) {
    const double omega = 2 * M_PI * source.frequency_hz[m], d = source.decay_per_s[m];
    const double lambda = omega * omega + d * d;
    const double stiffness_part = std::min(damping.beta_s * lambda / 2, d);
    const double new_d = (d - stiffness_part) + stiffness_part / 4;
    EXPECT_NEAR(bank.decay_per_s[m], new_d, 1e-12 * d);
    EXPECT_NEAR(bank.frequency_hz[m], std::sqrt(lambda / 4 - new_d * new_d) / (2 * M_PI), 1e-12 * omega);
  }
  EXPECT_EQ(bank.positions[3][0], 2 * source.positions[3][0]);
  EXPECT_NEAR(bank.shape(2, 3)[1], source.shape(2, 3)[1] / std::sqrt(8.0f), 1e-6);
  EXPECT_NEAR(bank.mass->mass_kg, 8 * source.mass->mass_kg, 1e-12);
  EXPECT_NEAR(bank.mass->inertia_kg_m2.y, 32 * source.mass->inertia_kg_m2.y, 1e-12);
}

TEST_F(ForeignBank, AForeignBankIsRefusedAtAScaleThatLeavesAModeWithoutPitch) {
  parts.set("decayRates", 3, 5000.0f);
  parts.set("frequencies", 3, 1000.0f);
  parts.extension().erase("acousticMaterials");
  parts.model().erase("material");
  ASSERT_TRUE(parse(parts.join()));
  parts.json["nodes"][0]["scale"] = {10, 10, 10};
  const auto bank = parse(parts.join());
  ASSERT_FALSE(bank);
  EXPECT_NE(bank.error().message.find("mode 3"), std::string::npos) << bank.error().message;
}

}  // namespace
}  // namespace ringdown::modal::test
