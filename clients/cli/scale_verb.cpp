#include "clients/cli/verb.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/materials/material_change.h"
#include "engine/materials/material_library.h"
#include "engine/modal/bank_file.h"
#include "packaging/manual/command_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

namespace ringdown::cli {
namespace {

constexpr double kMinSize = 1e-3, kMaxSize = 1e3;

struct ScaleArguments {
  std::string bank, output;
  std::optional<std::string> material, name;
  std::filesystem::path folder;
  double size = 1;
};

Result<modal::Material> material_of(const ScaleArguments& arguments) {
  const auto folder = material_folder(arguments.folder);
  if (!folder) return fail(folder);
  auto entry = bake::find_material(*folder, *arguments.material);
  if (!entry) return fail(entry);
  return entry->material;
}

void print_summary(const modal::Bank& before, const bake::Changed& changed, const std::string& output) {
  const modal::Bank& bank = changed.bank;
  const auto [low, high] = std::ranges::minmax(bank.frequency_hz);
  std::printf("%s: %zu modes, %.0f to %.0f Hz, complete from %.4g to %.4g Hz", output.c_str(), bank.mode_count(), low,
              high, bank.provenance.band_low_hz, bank.provenance.band_high_hz);
  if (before.mass && bank.mass) std::printf(", %.4g kg instead of %.4g", bank.mass->mass_kg, before.mass->mass_kg);
  if (changed.over_damped > 0) std::printf("; %zu modes left out that no longer ring", changed.over_damped);
  std::printf("\n");
}

ExitCode scale(const ScaleArguments& arguments) {
  const auto path = preset_or_file(arguments.bank, PresetKind::bank);
  if (!path) return complain(path);
  const auto bank = modal::read_bank(*path);
  if (!bank) return complain(bank);
  bake::Change change{.size = arguments.size};
  if (arguments.material) {
    auto material = material_of(arguments);
    if (!material) return complain(material);
    change.material = std::move(*material);
  }
  auto changed = bake::change(*bank, change);
  if (!changed) return complain({changed.error().kind, arguments.bank + ": " + changed.error().message});
  if (arguments.name) changed->bank.name = *arguments.name;
  if (const auto written = modal::write_bank(changed->bank, arguments.output); !written) return complain(written);
  print_summary(*bank, *changed, arguments.output);
  if (change.material && change.material->poisson_ratio != bank->material->poisson_ratio) {
    const std::string text =
        formatted("its Poisson's ratio stays {:.3g}; only a new bake gives it {}'s {:.3g}",
                  bank->material->poisson_ratio, change.material->name, change.material->poisson_ratio);
    complain(text, ExitCode::ok);
  }
  if (change.material && bank->material->orthotropy)
    complain("its grain stays: stiffness and density change alike in all directions", ExitCode::ok);
  if (change.material && !bank->provenance.parts.empty())
    complain("the materials of its parts change by the same factors", ExitCode::ok);
  if (!bank->provenance.resonators.empty())
    complain("its tubes are scaled and tuned along with it; only a new bake keeps them", ExitCode::ok);
  if (bank->cavity) complain("the air in it is scaled along with it; only a new bake finds its note", ExitCode::ok);
  if (bank->held)
    complain("its springs and dampers change with it; clamps and sliding surfaces stay exact", ExitCode::ok);
  return ExitCode::ok;
}

}  // namespace

void add_scale_verb(manual::App& app, ExitCode& outcome) {
  auto arguments = std::make_shared<ScaleArguments>();
  manual::App* verb =
      app.add_subcommand("scale", "Writes a bank in another size or material; exact, without its mesh.");
  verb->add_option("bank", arguments->bank, "The bank: a .glb file, or the name of a preset.")
      ->type_name("FILE")
      ->required();
  verb->add_option("-o,--output", arguments->output, "The bank to write (.glb).")->type_name("FILE")->required();
  verb->add_option("--size", arguments->size, "Scale factor, in all directions.")
      ->check(manual::between(kMinSize, kMaxSize))
      ->capture_default_str();
  verb->add_option("-m,--material", arguments->material, "The new material; Poisson's ratio stays as it was.")
      ->type_name("NAME");
  verb->add_option("--materials", arguments->folder, "Folder of materials (default: the presets').")
      ->type_name("FOLDER");
  verb->add_option("--name", arguments->name, "Name kept in the bank (default: as it was).")->type_name("TEXT");
  verb->callback([arguments, &outcome] {
    keep_stdout_for(arguments->output);
    outcome = scale(*arguments);
  });
}

}  // namespace ringdown::cli
