// Materials as text: presets/materials/NAME.toml. [worker]
//
//   name = "bronze"
//   description = "Bell metal, about 78 % copper and 22 % tin"
//   [youngs_modulus_pa]      # and [poisson_ratio] [density_kg_m3] [alpha_per_s] [beta_s]
//   value = 100e9
//   source = "where the figure is from, or that it is our choice and why"
//
// Every figure has a source. What a material loses stands in the file as its loss factor eta at one frequency or more,
// and each mode gets that of its own frequency (modal/losses.h); a list of one holds everywhere. Alpha and beta are
// fitted to the list for readers that know no others. A file may give Rayleigh's two constants instead, as the course
// report of 2011 does; then a mode's loss grows with the square of its frequency, which is seldom so.
//
//   uncertainty = 2          # the factor within which an alloy or a piece may lie, 1 at least; of the loss factors
//   [[loss_factor]]          # without what flows as heat
//   frequency_hz = 250
//   eta = 0.01
//   source = "where the figure is from"
//   [thermal.expansion_per_k]             # and conductivity_w_mk, heat_capacity_j_kgk: how it warms, from which the
//   value = 11.7e-6                       # loss to heat is computed; without them there is none
//   source = "..."
//
// A brittle material says when it breaks (modal/fracture/strength.h); one without [brittle] never breaks:
//
//   [brittle.strength_pa]                 # and weibull_modulus, toughness_pa_sqrt_m; strength_area_m2 may be left out
//   value = 60e6
//   source = "..."
//
// A material with a grain says as well what it is along it and across (modal/orthotropy.h), for objects that give their
// grain (object_file.h): nine figures in [orthotropic], or five in [transversely_isotropic], which is alike in all
// directions across its axis 1; each with its source, and if they are known, loss factors of a modulus over those
// above:
//
//   [orthotropic.youngs_modulus_1_pa]    # _2_pa _3_pa, poisson_ratio_12 _13 _23, shear_modulus_12_pa _13_pa _23_pa
//   value = 11e9
//   source = "where the figure is from"
//   [orthotropic.loss_2]                 # loss_1 loss_3 loss_12 loss_13 loss_23; default 1
//   value = 2.5
//   source = "..."
//   [transversely_isotropic.youngs_modulus_1_pa]    # youngs_modulus_2_pa poisson_ratio_12 _23 shear_modulus_12_pa;
//                                                   # loss_1 loss_2 loss_12
// docs/use/materials.md lists all of them. A library of its own, without finite elements: `ringdown` has it too.
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/modal/damping.h"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::bake {

// Words in a source that docs/use/materials.md marks.
inline constexpr std::string_view kOurChoice = "our choice";
inline constexpr std::string_view kToBeChecked = "to be checked against the original";

struct MaterialEntry {
  modal::Material material;
  std::string description;
  double uncertainty = 0;                      // factor of the loss factors, at least 1; 0: not given
  std::map<std::string, std::string> sources;  // key of the figure -> where it is from
};

// Checks that the name is the file's, that the constants are a stable solid's, and that every figure has its
// source. A sentence about one figure begins with path:line.
Result<MaterialEntry> read_material(const std::filesystem::path& path);

// `folder`/`name`.toml; when there is none, the error lists those that are there.
Result<MaterialEntry> find_material(const std::filesystem::path& folder, const std::string& name);

// Another value for the figure of that key in a material's file; refused when it is out of its range there.
// "loss_factor" replaces the list by one that holds at all frequencies; with alpha_per_s or beta_s a list no longer
// counts.
Result<void> set_figure(modal::Material& material, const std::string& key, double value);

// The second table of docs/use/materials.md: the constants along the grain and across, of the materials that have them.
Result<std::string> grains_as_markdown(const std::filesystem::path& folder);

// The third table of docs/use/materials.md: when the brittle materials break.
Result<std::string> strengths_as_markdown(const std::filesystem::path& folder);

// Names of the .toml files in a folder, sorted; empty when there is no such folder.
std::vector<std::string> names_in(const std::filesystem::path& folder);

// The table of docs/use/materials.md: every material in `folder` with its figures, as Markdown. Their sources stand in
// the files. Figures that are our own choice are in italics, figures that are yet to be checked carry a question mark
// (kOurChoice and kToBeChecked). Fails with the first file that cannot be read, or when there is none.
Result<std::string> materials_as_markdown(const std::filesystem::path& folder);

}  // namespace ringdown::bake
