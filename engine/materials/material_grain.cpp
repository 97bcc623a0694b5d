#include "engine/materials/material_grain.h"

#include <array>
#include <string_view>

namespace ringdown::bake {
namespace {

constexpr Range kModulus_pa{1e3, 1e13}, kRatio{-10, 10}, kLoss{0, 100};
constexpr const char* kUnstable =
    "no stable solid has these constants: every nu_ij must stay below sqrt(E_i / E_j), and the three together must "
    "leave it stiff in all directions";

struct Constant {
  const char* key;
  Range range;
  double table_unit;
  double& (*in)(modal::Orthotropy&);
};

// The nine, in the order of tables.
constexpr std::array<Constant, 9> kNine = {{
    {"youngs_modulus_1_pa", kModulus_pa, 1e9, [](modal::Orthotropy& o) -> double& { return o.youngs_modulus_pa[0]; }},
    {"youngs_modulus_2_pa", kModulus_pa, 1e9, [](modal::Orthotropy& o) -> double& { return o.youngs_modulus_pa[1]; }},
    {"youngs_modulus_3_pa", kModulus_pa, 1e9, [](modal::Orthotropy& o) -> double& { return o.youngs_modulus_pa[2]; }},
    {"poisson_ratio_12", kRatio, 1, [](modal::Orthotropy& o) -> double& { return o.poisson_ratio[0]; }},
    {"poisson_ratio_13", kRatio, 1, [](modal::Orthotropy& o) -> double& { return o.poisson_ratio[1]; }},
    {"poisson_ratio_23", kRatio, 1, [](modal::Orthotropy& o) -> double& { return o.poisson_ratio[2]; }},
    {"shear_modulus_12_pa", kModulus_pa, 1e9, [](modal::Orthotropy& o) -> double& { return o.shear_modulus_pa[0]; }},
    {"shear_modulus_13_pa", kModulus_pa, 1e9, [](modal::Orthotropy& o) -> double& { return o.shear_modulus_pa[1]; }},
    {"shear_modulus_23_pa", kModulus_pa, 1e9, [](modal::Orthotropy& o) -> double& { return o.shear_modulus_pa[2]; }},
}};
constexpr std::array kFive = {0, 1, 3, 5, 6};  // of kNine, that a transversely isotropic solid is given by
constexpr std::array kLosses = {"loss_1", "loss_2", "loss_3", "loss_12", "loss_13", "loss_23"};

class Reader {
 public:
  Reader(TomlTable& table, std::map<std::string, std::string>& sources) : table_(table), sources_(sources) {}

  void figure(const char* key, double& target, const Range& range) {
    std::optional<TomlTable> one = table_.table(key);
    if (!one) return;
    one->require({"value", "source"});
    one->number("value", target, range);
    one->text("source", sources_[std::string("grain.") + key]);
  }

  void constant(const Constant& constant, modal::Orthotropy& solid) {
    table_.require({constant.key});
    figure(constant.key, constant.in(solid), constant.range);
  }

 private:
  TomlTable& table_;
  std::map<std::string, std::string>& sources_;
};

// "shear_modulus_12_pa" is one of "shear_modulus_all_pa".
std::string name_of_all(std::string key) {
  const auto first = key.find_first_of("123"), last = key.find_last_of("123");
  return key.replace(first, last + 1 - first, "all");
}

modal::Orthotropy read_nine(TomlTable& table, std::map<std::string, std::string>& sources) {
  modal::Orthotropy solid;
  Reader reader(table, sources);
  for (const Constant& constant : kNine) reader.constant(constant, solid);
  for (std::size_t k = 0; k < kLosses.size(); ++k) reader.figure(kLosses[k], solid.loss[k], kLoss);
  return solid;
}

modal::Orthotropy read_five(TomlTable& table, std::map<std::string, std::string>& sources) {
  modal::Orthotropy solid;
  Reader reader(table, sources);
  for (const int k : kFive) reader.constant(kNine[k], solid);
  for (const int k : {0, 1, 3}) reader.figure(kLosses[k], solid.loss[k], kLoss);
  auto& [e, nu, g, loss] = solid;
  e[2] = e[1];
  nu[1] = nu[0];
  g[1] = g[0];
  g[2] = e[1] / (2 * (1 + nu[2]));
  loss[2] = loss[5] = loss[1];
  loss[4] = loss[3];
  return solid;
}

}  // namespace

std::vector<GrainFigure> grain_figures(const modal::Orthotropy& solid) {
  modal::Orthotropy copy = solid;
  std::vector<GrainFigure> figures;
  for (const Constant& constant : kNine) figures.push_back({constant.key, constant.in(copy), constant.table_unit});
  return figures;
}

void read_grain_constants(TomlTable& file, std::optional<modal::Orthotropy>& solid,
                          std::map<std::string, std::string>& sources) {
  std::optional<TomlTable> nine = file.table("orthotropic"), five = file.table("transversely_isotropic");
  if (nine && five) file.complain("orthotropic", "give either [orthotropic] or [transversely_isotropic], not both");
  if (!nine && !five) return;
  solid = nine ? read_nine(*nine, sources) : read_five(*five, sources);
  if (!is_stable(*solid)) file.complain(nine ? "orthotropic" : "transversely_isotropic", kUnstable);
}

std::optional<Result<void>> set_grain_constant(modal::Material& material, const std::string& key, double value) {
  if (!material.orthotropy) return std::nullopt;
  bool known = false;
  for (const Constant& constant : kNine) {
    if (key != constant.key && key != name_of_all(constant.key)) continue;
    if (auto good = check_range(value, constant.range); !good) return Result<void>(fail(key, good));
    constant.in(*material.orthotropy) = value;
    known = true;
  }
  if (!known) return std::nullopt;
  if (!is_stable(*material.orthotropy)) return Result<void>(fail(ErrorKind::bad_input, kUnstable));
  return Result<void>();
}

}  // namespace ringdown::bake
