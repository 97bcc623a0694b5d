// ringdown-frf: frequency responses of a bank, as tables and pictures. A program of its own because `ringdown` links no
// cairo.
#include "clients/cli/picture/answer.h"
#include "clients/cli/picture/response_picture.h"
#include "clients/cli/picture/response_table.h"
#include "engine/base/file_format.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/base/quote.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/damping.h"
#include "engine/modal/response/frequency_response.h"
#include "packaging/manual/command_line.h"
#include "protocol/exit_codes.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>

namespace {

using namespace ringdown;  // NOLINT: a program
using cli::ResponseTable;
using protocol::complain;
using protocol::ExitCode;

struct Arguments {
  std::string bank, kind = "mobility";
  std::filesystem::path output, residual;
  std::vector<double> at, direction, to, to_direction, air, band;
  int count = 2000;
  bool energy = false;
};

void add_vector(manual::App& app, const char* option, std::vector<double>& numbers, const char* sentence) {
  app.add_option(option, numbers, sentence)
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->expected(3)
      ->check(manual::any_number());
}

void add_options(manual::App& app, Arguments& arguments) {
  app.add_option("bank", arguments.bank, "The bank: a .glb file, or the name of a preset.")
      ->type_name("FILE")
      ->required();
  app.add_option("-o,--output", arguments.output,
                 "The file to write; its ending says which kind. .csv: a table. .uff and .unv: a dataset 58. .png and "
                 ".svg: magnitude, phase and Nyquist's curve.")
      ->type_name("FILE")
      ->required();
  add_vector(app, "--at", arguments.at,
             "The place of the force, in metres; default: the sample point with the strongest response.");
  add_vector(app, "--direction", arguments.direction,
             "Direction of the force; default: along the surface's normal, inwards.");
  add_vector(app, "--to", arguments.to, "The place of the response; default: the place of the force.");
  add_vector(app, "--to-direction", arguments.to_direction,
             "Direction of the response; default: that of the force, or the normal at --to.");
  add_vector(app, "--air", arguments.air,
             "A point in the air: the response is the sound pressure there. Needs a bank with radiation.");
  app.add_flag(
      "--energy", arguments.energy,
      "The energy that the body radiates per hertz after an impulse of 1 N s, over all directions. Needs a bank "
      "with radiation.");
  app.add_option("--kind", arguments.kind, "receptance (displacement), mobility (velocity) or accelerance.")
      ->type_name("receptance|mobility|accelerance")
      ->capture_default_str();
  app.add_option("--band", arguments.band,
                 "Lowest and highest frequency in Hz; default: from half the lowest mode to the highest.")
      ->type_name("LOW HIGH")
      ->expected(2)
      ->check(manual::above_zero());
  app.add_option("--count", arguments.count,
                 "Number of frequencies, evenly spaced by ratio; those of the modes come in addition.")
      ->check(manual::between(2, 1000000))
      ->capture_default_str();
  app.add_option("--residual", arguments.residual,
                 "The residual that `ringdown bake --export-residual` wrote with the bank (.npy): the modes that are "
                 "not in the bank.")
      ->type_name("FILE");
}

std::optional<Vec3> vector_of(const std::vector<double>& numbers) {
  return numbers.empty() ? std::nullopt : std::optional(Vec3{numbers[0], numbers[1], numbers[2]});
}

// A picture also gets frequencies around each mode, at which the phase of its resonance turns by even steps: Nyquist's
// circles are then round.
std::vector<double> frequencies_of(const modal::Bank& bank, const Arguments& arguments, bool is_picture) {
  constexpr int kSteps = 30;  // of half a turn
  const auto [lowest, highest] = std::ranges::minmax(bank.frequency_hz);
  const double low = arguments.band.empty() ? lowest / 2 : arguments.band[0];
  const double high = arguments.band.empty() ? highest : arguments.band[1];
  std::vector<double> frequencies;
  for (int n = 0; n < arguments.count; ++n)
    frequencies.push_back(low * std::pow(high / low, static_cast<double>(n) / (arguments.count - 1)));
  frequencies.back() = high;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double half_width_hz = modal::rad_per_s_to_hz(bank.decay_per_s[m]);
    for (int n = 1 - kSteps / 2; n < kSteps / 2; ++n) {
      if (n != 0 && !is_picture) continue;
      const double hz = bank.frequency_hz[m] + half_width_hz * std::tan(n * std::numbers::pi / kSteps);
      if (hz > low && hz < high) frequencies.push_back(hz);
    }
  }
  std::ranges::sort(frequencies);
  const auto [first, last] = std::ranges::unique(frequencies);
  frequencies.erase(first, last);
  return frequencies;
}

Result<ResponseTable> table_of(const modal::Bank& bank, const Arguments& arguments, bool is_picture) {
  const cli::Answer struck = cli::answer_of(bank, vector_of(arguments.at));
  ResponseTable table;
  table.name = bank.name;
  table.at_m = vector_of(arguments.at).value_or(cli::wide(bank.positions[struck.point]));
  table.direction = vector_of(arguments.direction).value_or(struck.direction);
  table.to_m = vector_of(arguments.air.empty() ? arguments.to : arguments.air).value_or(table.at_m);
  const Vec3 normal = arguments.to.empty() ? table.direction : cli::answer_of(bank, table.to_m).direction;
  table.to_direction = vector_of(arguments.to_direction).value_or(normal);
  table.frequencies_hz = frequencies_of(bank, arguments, is_picture);
  const modal::SurfaceIndex surface(bank);
  const modal::Place from{table.at_m, table.direction}, to{table.to_m, table.to_direction};
  std::optional<modal::Residual> residual;
  if (!arguments.residual.empty()) {
    auto read = modal::read_residual(arguments.residual, bank.point_count());
    if (!read) return fail(read);
    residual = std::move(*read);
  }
  using enum ResponseTable::Kind;
  if (arguments.energy) {
    table.kind = energy;
    const auto energies = modal::energy_spectrum(bank, surface, from, table.frequencies_hz);
    if (!energies) return fail(energies);
    table.values.assign(energies->begin(), energies->end());
    return table;
  }
  table.kind = !arguments.air.empty()           ? pressure
               : arguments.kind == "receptance" ? receptance
               : arguments.kind == "mobility"   ? mobility
                                                : accelerance;
  auto response = table.kind == pressure
                      ? modal::pressure_response(bank, surface, from, table.to_m, table.frequencies_hz)
                      : modal::frequency_response(bank, surface, from, to, static_cast<modal::Motion>(table.kind),
                                                  table.frequencies_hz, residual ? &*residual : nullptr);
  if (!response) return fail(response);
  table.values = std::move(*response);
  return table;
}

ExitCode compute(const Arguments& arguments, const std::string& ending) {
  const auto path = preset_or_file(arguments.bank, PresetKind::bank);
  if (!path) return complain(path.error());
  const auto bank = modal::read_bank(*path);
  if (!bank) return complain(bank.error());
  const Result<ResponseTable> table = table_of(*bank, arguments, ending == ".png" || ending == ".svg");
  if (!table) return complain({table.error().kind, arguments.bank + ": " + table.error().message});
  const auto kind = ending == ".png" ? cli::Canvas::Kind::png : cli::Canvas::Kind::svg;
  const std::string bytes = ending == ".csv"                       ? cli::response_csv(*table)
                            : ending == ".uff" || ending == ".unv" ? cli::response_uff(*table)
                                                                   : cli::draw_response(kind, *table);
  if (bytes.empty())
    return complain({ErrorKind::no_memory, "cannot draw " + arguments.output.string() + ": there is no memory for it"});
  const auto written = write_output(arguments.output, std::string_view(bytes));
  return written ? ExitCode::ok : complain(written.error());
}

// The text of the man page in addition to the options.
const std::vector<manual::Section> kSections = {
    {"EXAMPLES",
     {{"ringdown frf bell.glb -o bell.png", "Mobility at the point that answers most, as a picture."},
      {"ringdown frf bell.glb -o bell.csv --at 0.1,0,0.05 --to -0.1,0,0.05 --kind accelerance",
       "From one side to the other, as a table."},
      {"ringdown frf bell.glb -o bell.csv --air 1,0,0", "The sound pressure 1 m away per newton."}}},
    {"SEE ALSO",
     {{"ringdown(1), ringdown-bake(1)", "`ringdown bake --export-residual` writes what --residual reads."}}},
};

ExitCode run(int argc, char** argv) {
  manual::App app("Computes frequency responses of a bank, as a table or a picture.", "ringdown-frf");
  Arguments arguments;
  add_options(app, arguments);
  if (const auto ended = manual::parse(app, argc, argv, kSections)) return *ended;
  const std::string ending = ending_of(arguments.output);
  const auto is_one_of = [](const std::string& word, std::initializer_list<const char*> words) {
    return std::ranges::find(words, word) != words.end();
  };
  if (!is_one_of(ending, {".csv", ".uff", ".unv", ".png", ".svg"}))
    return manual::complain_of_usage(app, "--output must end in .csv, .uff, .unv, .png or .svg, not " + quote(ending));
  if (!is_one_of(arguments.kind, {"receptance", "mobility", "accelerance"}))
    return manual::complain_of_usage(app,
                                     "--kind is receptance, mobility or accelerance, not " + quote(arguments.kind));
  if (!arguments.band.empty() && !(arguments.band[0] < arguments.band[1]))
    return manual::complain_of_usage(app, "--band takes two frequencies, the lower first");
  if (!arguments.air.empty() && !(arguments.to.empty() && arguments.to_direction.empty()))
    return manual::complain_of_usage(app, "--air takes the place of --to and --to-direction");
  if (arguments.energy && (!arguments.air.empty() || !arguments.to.empty() || app.count("--kind") > 0))
    return manual::complain_of_usage(app, "--energy goes with neither --air nor --to nor --kind");
  if (arguments.energy && (ending == ".uff" || ending == ".unv"))
    return manual::complain_of_usage(app, "--energy is written as .csv, .png or .svg");
  keep_stdout_for(arguments.output);
  return compute(arguments, ending);
}

}  // namespace

int main(int argc, char** argv) {
  return ringdown::protocol::exit_status([&] { return run(argc, argv); });
}
