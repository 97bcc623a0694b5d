// ringdown-fill: a finished bank with a liquid in its body, without its mesh. `ringdown fill ...` runs this program.
//
// Exit codes (protocol/exit_codes.h): ok; bad_input when the bank cannot be filled to that level; usage; failure when
// the bank cannot be written.
#include "engine/bake/liquid/fill_bank.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/materials/material_library.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/levels/level_bank.h"
#include "packaging/manual/command_line.h"
#include "protocol/exit_codes.h"

#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace ringdown;
using protocol::complain;
using protocol::ExitCode;

const std::vector<manual::Section> kSections = {
    {"ENVIRONMENT", {{"RINGDOWN_PRESETS", "Folder of the presets, if it is not share/ringdown/presets beside bin."}}},
    {"EXAMPLES",
     {{"ringdown-fill wine-glass --level 0.12 -o glass.glb", "Fills the preset wine glass up to a height of 12 cm."},
      {"ringdown-fill bowl.glb --volume 200 --liquid ethanol -o bowl-full.glb",
       "Fills a bowl with 200 ml of ethanol."}}},
    {"SEE ALSO", {{"ringdown(1), ringdown-bake(1)", "The other programs."}}},
};

struct FillRequest {
  std::string bank, output, liquid = "water";
  std::filesystem::path materials;
  std::optional<double> level_m, depth_m, volume_ml;
  bool full = false;
  std::string up = "0,0,1";
};

int amounts_of(const FillRequest& request) {
  return static_cast<int>(request.level_m.has_value()) + static_cast<int>(request.depth_m.has_value()) +
         static_cast<int>(request.volume_ml.has_value()) + static_cast<int>(request.full);
}

bake::Filling filling_of(const FillRequest& request) {
  using Kind = liquid::Amount::Kind;
  bake::Filling filling;
  const std::vector<std::string> up = manual::split_at_commas(request.up);
  filling.up = {std::stod(up[0]), std::stod(up[1]), std::stod(up[2])};
  if (request.level_m) filling.amount = {Kind::kLevel, *request.level_m};
  if (request.depth_m) filling.amount = {Kind::kDepth, *request.depth_m};
  if (request.volume_ml) filling.amount = {Kind::kVolume, 1e-6 * *request.volume_ml};
  return filling;
}

// By the levels that the bank knows, or from its shapes.
Result<bake::FilledBank> filled_bank(const modal::Bank& bank, const FillRequest& request,
                                     const bake::Filling& filling) {
  if (!bank.levels) return bake::fill_bank(bank, filling);
  if ((!request.level_m && !request.full) || request.liquid != bank.provenance.liquids.front().liquid)
    return fail(ErrorKind::bad_input, "it knows the levels of its own liquid; say --level or --full");
  auto there = modal::at_level(bank, request.level_m.value_or(bank.levels->range_m().high));
  if (!there) return fail(there);
  return bake::FilledBank{std::move(there->bank), 0};
}

ExitCode fill(const FillRequest& request, bake::Filling filling) {
  const auto path = preset_or_file(request.bank, PresetKind::bank);
  if (!path) return complain(path.error());
  const auto bank = modal::read_bank(*path);
  if (!bank) return complain(bank.error());
  const auto materials = material_folder(request.materials);
  if (!materials) return complain(materials.error());
  auto liquid = liquid::find_liquid(bake::liquid_folder(*materials), request.liquid);
  if (!liquid) return complain(liquid.error());
  filling.liquid = std::move(*liquid);
  const auto filled = filled_bank(*bank, request, filling);
  if (!filled) return complain({filled.error().kind, request.bank + ": " + filled.error().message});
  if (const auto written = modal::write_bank(filled->bank, request.output); !written) return complain(written.error());
  const modal::LiquidNote& note = filled->bank.provenance.liquids.front();
  const auto errors = modal::error_spread(filled->bank.frequency_error);
  std::printf("%s: %.4g ml of %s up to %.4g m; %zu modes, errors of frequencies %.2g %% (median), %.2g %% at most",
              request.output.c_str(), 1e6 * note.volume_m3, note.liquid.c_str(), note.level_m,
              filled->bank.mode_count(), 100 * errors->median, 100 * errors->largest);
  if (filled->left_out > 0) std::printf("; %zu modes left out that only a bake with [fill] can find", filled->left_out);
  std::printf("\n");
  return ExitCode::ok;
}

ExitCode run(int argc, char** argv) {
  manual::App app("Fills the body of a finished bank with a liquid, without its mesh.", "ringdown-fill");
  FillRequest request;
  app.add_option("bank", request.bank, "the bank: a .glb file, or the name of a preset")->type_name("FILE")->required();
  app.add_option("-o,--output", request.output, "the bank to write (.glb)")->type_name("FILE")->required();
  app.add_option("--level", request.level_m, "height of the surface along --up, in m")
      ->check(manual::between(-1e6, 1e6));
  app.add_option("--depth", request.depth_m, "depth over the basin's lowest point, in m")
      ->check(manual::between(1e-9, 1e6));
  app.add_option("--volume", request.volume_ml, "volume, in ml")->check(manual::between(1e-6, 1e15));
  app.add_flag("--full", request.full, "to the rim");
  app.add_option("--liquid", request.liquid, "water (default), ethanol, glycerol, mercury, or a file of your own")
      ->type_name("NAME");
  app.add_option("--materials", request.materials, "folder of materials; that of liquids lies beside it")
      ->type_name("FOLDER");
  app.add_option("--up", request.up, "direction against gravity (default 0,0,1)")
      ->type_name("X,Y,Z")
      ->check(manual::any_vector());
  if (const auto ended = manual::parse(app, argc, argv, kSections)) return *ended;
  const bake::Filling filling = filling_of(request);
  if (!(dot(filling.up, filling.up) > 0)) return manual::complain_of_usage(app, "--up must be a direction, not 0");
  if (amounts_of(request) != 1)
    return manual::complain_of_usage(app, "say how far it is filled by one of --level, --depth, --volume or --full");
  keep_stdout_for(request.output);
  return fill(request, filling);
}

}  // namespace

int main(int argc, char** argv) {
  return ringdown::protocol::exit_status([&] { return run(argc, argv); });
}
