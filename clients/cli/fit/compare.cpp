// ringdown-compare: holds recordings of a thing against its baked bank.
#include "clients/cli/fit/baker.h"
#include "clients/cli/fit/compare_page.h"
#include "clients/cli/fit/mode_list.h"
#include "clients/cli/fit/sound.h"
#include "clients/cli/long_work.h"
#include "engine/base/file_format.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/fit/band_powers.h"
#include "engine/fit/burst.h"
#include "engine/fit/comparison.h"
#include "engine/fit/identification.h"
#include "engine/mesh/files/file_kinds.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/scaled_bank.h"
#include "packaging/manual/command_line.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <utility>

namespace {

using namespace ringdown;  // NOLINT: a program
using protocol::complain;
using protocol::ExitCode;
namespace fs = std::filesystem;

struct CompareArguments {
  fs::path folder, output, bank, materials;
  std::string material;
  double top_hz = 12000;
  bool top_given = false, keep_nu = false;
  std::vector<std::string> fitted;
  std::vector<cli::Figure> figures;  // of `fitted`
  double weight_kg = 0;
  fit::Options options;
  fit::CalibrateOptions match{.tolerance_cents = 30, .max_tuning_cents = 250};
};

void add_compare_options(manual::App& app, CompareArguments& arguments) {
  app.add_option("folder", arguments.folder,
                 "A folder with recordings of one blow each, or a list of measured modes (modes.csv), and with the "
                 "object's shape: one object file (.toml), or one mesh and --material.")
      ->type_name("FOLDER")
      ->required();
  app.add_option("-o,--output", arguments.output, "The page to write (.html); default: compare.html in the folder.")
      ->type_name("FILE");
  app.add_option("--bank", arguments.bank, "Also write the bank with the fitted E, nu and damping.")->type_name("FILE");
  app.add_option("-m,--material", arguments.material, "The material to begin with; default: the object file's.")
      ->type_name("NAME");
  app.add_option("--materials", arguments.materials, "Folder of the materials; default: the presets'.")
      ->type_name("FOLDER");
  app.add_option("--top", arguments.top_hz,
                 "Modes are compared up to this frequency in Hz; default: 12000, or all of a list.")
      ->check(manual::between(100.0, 1e8))
      ->capture_default_str();
  app.add_option("--tolerance", arguments.match.tolerance_cents,
                 "Largest error of a matching mode in cents, after the common tuning is removed.")
      ->check(manual::between(0.1, 200.0))
      ->capture_default_str();
  app.add_option(
         "--fit", arguments.fitted,
         "Besides E/rho, fit these figures in place of nu, beginning with these values: constants of the material "
         "(shear_modulus_12_pa=5e9, poisson_ratio=0.3), parameters of the geometry (thickness=6), or the factor on the "
         "thickness of all walls (wall_scale=1).")
      ->type_name("NAME=NUMBER");
  app.add_option("--weight", arguments.weight_kg,
                 "The weight of the object in kg, which tells its density, and so E itself.")
      ->check(manual::between(1e-9, 1e6));
  app.add_flag("--keep-nu", arguments.keep_nu,
               "Keep the material's Poisson's ratio, which takes two bakes in place of five or more.");
}

struct Inputs {
  fs::path shape, list;  // list: modes.csv, or ""
  std::vector<fs::path> sounds;
};

std::optional<double> number_in(const std::string& text) {
  double value = 0;
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (wrong != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// `bank` is where the fitted bank goes: no mesh.
Result<Inputs> find_inputs(const fs::path& folder, const fs::path& bank) {
  std::error_code error;
  Inputs inputs;
  std::vector<fs::path> objects, meshes;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    if (is_of_kind(file, FileKind::sound)) inputs.sounds.push_back(file);
    if (file.filename() == "modes.csv") inputs.list = file;
    if (is_of_kind(file, FileKind::table)) objects.push_back(file);
    if (mesh::is_body_file(file) || is_of_kind(file, FileKind::gltf)) meshes.push_back(file);
  }
  if (meshes.size() > 1) {  // a bank that was written beside the mesh
    std::erase_if(meshes, [&](const fs::path& path) { return path.filename() == bank.filename(); });
  }
  if (error) return fail(ErrorKind::bad_input, "cannot read the folder {}: {}", folder.string(), error.message());
  std::ranges::sort(inputs.sounds);
  if (!inputs.list.empty()) inputs.sounds.clear();  // the list is what counts
  if (inputs.sounds.empty() && inputs.list.empty()) {
    return fail(ErrorKind::bad_input, folder.string() +
                                          " has no recording: put a WAV or FLAC file of one blow into it, or a list of "
                                          "measured modes, modes.csv");
  }
  const std::vector<fs::path>& shapes = objects.empty() ? meshes : objects;
  if (shapes.size() != 1) {
    return fail(ErrorKind::bad_input,
                "{} has {} object files and {} meshes: it needs one object file (.toml), or one mesh and --material",
                folder.string(), objects.size(), meshes.size());
  }
  inputs.shape = shapes.front();
  return inputs;
}

constexpr double kSearchBakes = 5 + cli::Baker::kWellShare,
                 kSoundShare = 1;  // quick bakes of a search; of a recording, in quick bakes

Result<std::vector<cli::ComparedSound>> read_sounds(const Inputs& inputs, const CompareArguments& arguments,
                                                    const std::stop_token& stop, cli::Work& work) {
  fit::Options options = arguments.options;
  // merge() leaves out faint modes, so only loud bands count; searching the noise takes half of the time.
  options.quietest_band_db = fit::kFaint_db + 12;
  options.high_hz = std::min(options.high_hz, std::exp2(arguments.match.max_tuning_cents / 1200) * arguments.top_hz);
  std::vector<cli::ComparedSound> sounds;
  for (const fs::path& path : inputs.sounds) {
    if (stop.stop_requested()) return fail(ErrorKind::cancelled, "cancelled; nothing was written");
    work.begin("listening to " + path.filename().string(), kSoundShare);
    Result<cli::Sound> sound = cli::read_sound(path, std::nullopt);
    if (!sound) return fail(sound);
    if (!sound->note.empty()) complain("warning: " + path.string() + ": " + sound->note, ExitCode::ok);
    Result<fit::Fit> found = fit::fit_modes(sound->samples, sound->sample_rate_hz, options);
    if (!found) return fail(path.string(), found);
    if (found->modes.empty()) {
      std::fprintf(stderr, "ringdown-compare: %s has no mode above its noise and is left out\n", path.c_str());
      continue;
    }
    sounds.push_back({path.filename().string(), std::move(*sound), std::move(*found), {}, 0});
  }
  if (sounds.empty())
    return fail(ErrorKind::bad_input, "no recording in " + arguments.folder.string() + " has a mode above its noise");
  return sounds;
}

const std::string kNu = "poisson_ratio";

// Takes what was measured: modes of all recordings, or a list.
Result<void> hear(const Inputs& inputs, CompareArguments& arguments, const std::stop_token& stop, cli::Work& work,
                  cli::Comparison& c) {
  if (!inputs.list.empty()) {
    auto modes = cli::read_mode_list(inputs.list);
    if (!modes) return fail(modes);
    c.heard = std::move(*modes);
    c.decays_known = std::ranges::all_of(c.heard, [](const fit::Mode& mode) { return mode.decay_per_s > 0; });
    if (!arguments.top_given) arguments.top_hz = 1.02 * c.heard.back().frequency_hz;
    return {};
  }
  auto sounds = read_sounds(inputs, arguments, stop, work);
  if (!sounds) return fail(sounds);
  c.sounds = std::move(*sounds);
  std::vector<std::vector<fit::Mode>> each;
  for (const cli::ComparedSound& s : c.sounds) each.push_back(s.found.modes);
  c.heard = fit::merge(each);
  return {};
}

using QuickBakes = std::map<double, modal::Bank>;  // by Poisson's ratio

fit::NuCurves curves_of(const QuickBakes& bakes) {
  std::vector<fit::NuBank> banks;
  for (const auto& [nu, bank] : bakes) banks.push_back({nu, &bank});
  return fit::NuCurves(banks);
}

constexpr double kMinNu = 0.02, kLowNu = 0.05, kMiddleNu = 0.25, kHighNu = 0.45, kMaxNu = 0.47;  // of quick bakes

Result<void> bake_at(cli::Baker& baker, double nu, QuickBakes& bakes) {
  Result<modal::Bank> bank = baker.bake_quickly({{kNu, nu}});
  if (!bank) return fail(bank);
  bakes.insert_or_assign(nu, std::move(*bank));
  return {};
}

// Returns the ratio at which a further bake makes the curves most exact near `nu`: `nu` itself, or a ratio beside it if
// a bake is there already, or one beyond all bakes if `nu` lies at their end.
double next_ratio(const QuickBakes& bakes, double nu) {
  constexpr double kNear = 0.015, kAside = 0.06;
  const double lowest = bakes.begin()->first, highest = bakes.rbegin()->first;
  const double first = nu > highest - kNear ? kMaxNu : nu < lowest + kNear ? kMinNu : nu;
  for (const double at : {first, nu + kAside, nu - kAside}) {
    const bool is_new = std::ranges::none_of(bakes, [&](const auto& b) { return std::abs(b.first - at) < kNear; });
    if (is_new && at <= kMaxNu) return at;
  }
  return nu;
}

fit::CalibrateOptions around(fit::CalibrateOptions match, double tuning_cents) {
  match.max_tuning_cents = 2 * match.tolerance_cents;
  match.around_cents = tuning_cents;
  return match;
}

std::vector<double> ascending(const modal::Bank& bank) {
  std::vector<double> frequencies = bank.frequency_hz;
  std::ranges::sort(frequencies);
  return frequencies;
}

// d ln f / d figure of each frequency by rank, from two bakes.
std::vector<double> slopes_of(const modal::Bank& low, const modal::Bank& high, double step) {
  const std::vector<double> below = ascending(low), above = ascending(high);
  std::vector<double> slopes;
  for (std::size_t k = 0; k < std::min(below.size(), above.size()); ++k)
    slopes.push_back(std::log(above[k] / below[k]) / step);
  return slopes;
}

std::vector<double> heard_hz(const cli::Comparison& c) {
  std::vector<double> hz;
  for (const fit::Mode& mode : c.heard) hz.push_back(mode.frequency_hz);
  return hz;
}

// Searches Poisson's ratio, first over all ratios that solids have, among the curves `wide`, and then near the best of
// them, with a quick bake there. Exact bakes correct the curves until the choice stays. If the frequencies do not tell
// the ratio, the result has the material's. `own` is the quick bake at the material's ratio.
Result<void> find_nu(cli::Baker& baker, CompareArguments& arguments, cli::Comparison& c, modal::Bank own,
                     std::optional<fit::NuCurves>& wide) {
  constexpr double kApart = 0.07, kNarrow = 0.06, kEdge = 0.003, kSame = 0.001;
  constexpr int kMaxNarrow = 2, kMaxExact = 3;
  const double given = c.given_poisson_ratio;
  const bool in_middle = given > kLowNu + kApart && given < kHighNu - kApart;
  QuickBakes quick;
  if (in_middle) quick.emplace(given, std::move(own));
  for (const double nu : {kLowNu, in_middle ? given : kMiddleNu, kHighNu}) {
    if (quick.contains(nu)) continue;
    if (auto baked = bake_at(baker, nu, quick); !baked) return baked;
  }
  std::optional<fit::NuCurves> curves = wide = curves_of(quick);
  fit::NuChoice choice = fit::choose_nu(c.heard, *curves, arguments.match);
  bool inside = false;
  for (int searches = 0; searches < kMaxNarrow && !inside; ++searches) {
    if (auto baked = bake_at(baker, next_ratio(quick, choice.poisson_ratio), quick); !baked) return baked;
    curves = curves_of(quick).around(choice.poisson_ratio, kNarrow);
    choice = fit::choose_nu(c.heard, *curves, around(arguments.match, choice.tuning_cents));
    inside = choice.poisson_ratio > curves->lowest() + kEdge && choice.poisson_ratio < curves->highest() - kEdge;
  }
  if (!choice.told && (given < curves->lowest() || given > curves->highest())) curves = curves_of(quick);
  for (int bakes = 0; bakes < kMaxExact; ++bakes) {
    const double nu = choice.told ? choice.poisson_ratio : given;
    if (bakes > 0 && std::abs(nu - c.poisson_ratio) < kSame) break;
    Result<modal::Bank> bank = baker.bake_well({{kNu, nu}});
    if (!bank) return fail(bank);
    c.bank = std::move(*bank);
    c.poisson_ratio = nu;
    c.nu_told = choice.told;
    curves = curves->through(c.bank, nu);
    choice = fit::choose_nu(c.heard, *curves, around(arguments.match, choice.tuning_cents));
  }
  arguments.match.around_cents = choice.tuning_cents;
  if (!c.nu_told) return {};
  c.slopes = curves->slopes(c.poisson_ratio);
  c.figures = {{kNu, c.poisson_ratio}};
  return {};
}

// Modes of a list without decays get those of the nearest baked modes, so that the material's losses stay.
std::vector<fit::Mode> with_decays(std::vector<fit::Mode> heard, const modal::Bank& bank) {
  for (fit::Mode& mode : heard) {
    const auto nearest = std::ranges::min_element(
        bank.frequency_hz, {}, [&](double hz) { return std::abs(std::log(hz / mode.frequency_hz)); });
    constexpr double kMin = 1e-5;  // of the frequency: a material without loss has no logarithm
    mode.decay_per_s = std::max(bank.decay_per_s[static_cast<std::size_t>(nearest - bank.frequency_hz.begin())],
                                kMin * mode.frequency_hz);
  }
  return heard;
}

double log_volume(const modal::Bank& bank) {
  return bank.mass && bank.material ? std::log(bank.mass->mass_kg / bank.material->density_kg_m3) : 0;
}

// How the figures move frequencies and volume: from exact bakes at the figures and at each a hundredth further. Quick
// bakes would do for slopes if they did not, in thin walls, put modes in another order.
Result<fit::Slopes> bake_slopes(cli::Baker& baker, cli::Comparison& c, const modal::Bank& base) {
  constexpr double kStep = 0.01;
  fit::Slopes slopes{ascending(base), {}};
  c.volume_slopes.clear();
  for (std::size_t k = 0; k < c.figures.size(); ++k) {
    std::vector<cli::Figure> further = c.figures;
    further[k].value *= 1 + kStep;
    const double step = further[k].value - c.figures[k].value;
    const Result<modal::Bank> stepped = baker.bake_finely(further);
    if (!stepped) return fail(stepped);
    slopes.slopes.push_back(slopes_of(base, *stepped, step));
    c.volume_slopes.push_back((log_volume(*stepped) - log_volume(base)) / step);
  }
  return slopes;
}

// Takes the frequencies of another bank, and keeps as many ranks as all lists have.
void take_frequencies(fit::Slopes& slopes, const modal::Bank& bank) {
  slopes.frequency_hz = ascending(bank);
  std::size_t ranks = slopes.frequency_hz.size();
  for (const std::vector<double>& of_figure : slopes.slopes) ranks = std::min(ranks, of_figure.size());
  slopes.frequency_hz.resize(ranks);
  for (std::vector<double>& of_figure : slopes.slopes) of_figure.resize(ranks);
}

constexpr std::array<double, 2> kFitReaches = {0.2, 0.05};  // of a figure, in the rounds that search
constexpr std::size_t kFitRounds = 7;

// Moves the figures of --fit, and E/rho, to the heard frequencies: first by searches for the best match, then by least
// squares of the modes that match, whose rounds share their slopes.
Result<void> find_figures(cli::Baker& baker, CompareArguments& arguments, cli::Comparison& c) {
  constexpr double kDone = 0.001;                                // of a figure
  constexpr double kCentsOfStiffness = 600 / std::numbers::ln2;  // of a frequency, by ln(E/rho)
  fit::Slopes slopes;
  double largest = 0;
  for (std::size_t round = 0; round < kFitRounds; ++round) {
    const Result<modal::Bank> base = baker.bake_finely(c.figures);
    if (!base) return fail(base);
    if (round <= kFitReaches.size()) {
      Result<fit::Slopes> baked = bake_slopes(baker, c, *base);
      if (!baked) return fail(baked);
      slopes = std::move(*baked);
    }
    take_frequencies(slopes, *base);
    std::vector<double> changes;
    if (round < kFitReaches.size()) {
      std::vector<double> reach;
      for (const cli::Figure& figure : c.figures) reach.push_back(kFitReaches[round] * std::abs(figure.value));
      const fit::FigureChoice choice = fit::search_figures(c.heard, slopes, reach, arguments.match);
      changes = choice.changes;
      arguments.match = around(arguments.match, choice.tuning_cents);
    } else {
      const auto found =
          fit::determine(heard_hz(c), slopes, {arguments.match.tolerance_cents, arguments.match.around_cents});
      if (!found) return fail(found);
      changes.assign(found->changes.begin() + 1, found->changes.end());
      arguments.match.around_cents = kCentsOfStiffness * found->changes[0];
    }
    largest = 0;
    for (std::size_t k = 0; k < c.figures.size(); ++k) {
      double& value = c.figures[k].value;
      const double most = kFitReaches.front() * std::abs(value), change = std::clamp(changes[k], -most, most);
      largest = std::max(largest, std::abs(change / value));
      value += change;
    }
    c.slopes = slopes;
    if (round >= kFitReaches.size() && largest < kDone) return {};
  }
  complain(
      formatted("warning: the fit has not settled: in its last round a figure still moved by {:.2g} %; begin again "
                "with the values that it prints",
                100 * largest),
      ExitCode::ok);
  return {};
}

// The bank at the figures that the recordings ask for, or at the files' own where they do not tell. Sets the search of
// the tuning, and `wide` if nu was searched.
Result<void> find_bank(cli::Baker& baker, CompareArguments& arguments, cli::Comparison& c,
                       std::optional<fit::NuCurves>& wide) {
  Result<modal::Bank> own = baker.bake_quickly(arguments.figures);
  if (!own) return fail(own);
  if (!own->material) return fail(ErrorKind::bad_input, "the bank of " + c.name + " has no material");
  c.material = own->material->name;
  c.poisson_ratio = c.given_poisson_ratio = own->material->poisson_ratio;
  const bool keep_nu = arguments.keep_nu || own->material->orthotropy;  // a grain's constants leave nothing to nu
  if (arguments.figures.empty() && !keep_nu) {
    if (const auto found = find_nu(baker, arguments, c, std::move(*own), wide); !found) return found;
  } else {
    c.figures = arguments.figures;
    if (!c.figures.empty()) {
      if (const auto found = find_figures(baker, arguments, c); !found) return found;
    }
    Result<modal::Bank> best = baker.bake_well(c.figures);
    if (!best) return fail(best);
    c.bank = std::move(*best);
  }
  if (!c.nu_told) take_frequencies(c.slopes, c.bank);
  return {};
}

double distance_of(const cli::ComparedSound& s) {
  const double rate = s.sound.sample_rate_hz;
  const auto onset = static_cast<std::size_t>(s.found.onset_s * rate);
  const auto end = std::min(s.sound.samples.size(), static_cast<std::size_t>(s.found.end_s * rate));
  const auto part = std::span(s.sound.samples).first(end);
  const auto model = fit::played_from(s.baked, rate, onset, end);
  return fit::distance_db(fit::band_powers(part, rate, onset), fit::band_powers(model, rate, onset),
                          fit::band_noise(part, rate, onset));
}

// The bank with the fitted modulus and loss factors.
modal::Bank fitted_bank(const cli::Comparison& c) {
  modal::Bank bank = modal::scaled(c.bank, {.stiffness = c.stiffness()});
  return c.decays_known ? fit::with_losses(bank, c.calibration) : bank;
}

ExitCode compare(CompareArguments& arguments, const std::stop_token& stop) {
  for (const std::string& text : arguments.fitted) {
    const auto equals = text.find('=');
    const auto value = equals == text.npos ? std::nullopt : number_in(text.substr(equals + 1));
    if (!value || *value == 0)
      return complain("--fit " + text + " is not NAME=NUMBER, with a number that is not 0", ExitCode::usage);
    arguments.figures.push_back({text.substr(0, equals), *value});
  }
  if (arguments.output.empty()) arguments.output = arguments.folder / "compare.html";
  const Result<Inputs> inputs = find_inputs(arguments.folder, arguments.bank);
  if (!inputs) return complain(inputs);
  const double fine_bakes = static_cast<double>(kFitRounds + (kFitReaches.size() + 1) * arguments.figures.size());
  const double search = !arguments.figures.empty() ? 1 + cli::Baker::kFineShare * fine_bakes
                        : arguments.keep_nu        ? 1
                                                   : kSearchBakes;
  cli::Work work(kSoundShare * static_cast<double>(inputs->sounds.size()) + search + cli::Baker::kWellShare);
  cli::Comparison c{.name = inputs->shape.stem().string(), .weight_kg = arguments.weight_kg};
  if (const auto heard = hear(*inputs, arguments, stop, work, c); !heard) return complain(heard);
  std::erase_if(c.heard, [&](const fit::Mode& mode) { return mode.frequency_hz > arguments.top_hz; });
  if (c.heard.size() < fit::kMinMatches) {
    return complain({ErrorKind::bad_input, formatted("{}: the recordings have {} modes below --top, and {} are needed",
                                                     arguments.folder.string(), c.heard.size(), fit::kMinMatches)});
  }
  const PrivateFolder folder("ringdown-compare");
  if (folder.path().empty()) return complain({ErrorKind::input_output, "cannot make a folder for temporary files"});
  const fit::CalibrateOptions wide_match = arguments.match;
  std::optional<fit::NuCurves> wide;
  {
    const double top_hz = std::exp2(arguments.match.max_tuning_cents / 1200) * arguments.top_hz;
    cli::Baker baker({inputs->shape, arguments.materials, arguments.material, top_hz, !arguments.bank.empty()},
                     folder.path(), stop, work);
    const auto found = find_bank(baker, arguments, c, wide);
    if (!found) return complain(found);
  }
  if (arguments.match.around_cents != 0) {  // E/rho and nu were searched together, with errors of quick bakes
    arguments.match.max_tuning_cents = arguments.match.tolerance_cents;
  }
  if (stop.stop_requested()) return complain({ErrorKind::cancelled, "cancelled; nothing was written"});
  if (!c.decays_known) c.heard = with_decays(std::move(c.heard), c.bank);
  Result<fit::Calibration> calibration = fit::calibrate(c.heard, c.bank, arguments.match);
  if (!calibration)
    return complain({calibration.error().kind, arguments.folder.string() + ": " + calibration.error().message});
  c.calibration = std::move(*calibration);
  const auto determined =
      fit::determine(heard_hz(c), c.slopes, {arguments.match.tolerance_cents, c.calibration.tuning_cents});
  if (determined) c.determined = *determined;
  if (wide) c.chance = fit::chance_of(c.heard, *wide, wide_match, c.calibration.matches.size());
  for (cli::ComparedSound& s : c.sounds) {
    s.baked = fit::as_recorded(s.found.modes, c.bank, c.calibration, arguments.match);
    s.distance_db = distance_of(s);
  }
  std::fputs(cli::verdict(c).c_str(), stdout);
  if (!arguments.bank.empty()) {
    const auto written = modal::write_bank(fitted_bank(c), arguments.bank);
    if (!written) return complain(written);
  }
  const auto written = write_output(arguments.output, std::string_view(cli::compare_page(c)));
  return written ? ExitCode::ok : complain(written);
}

// The text of the man page in addition to the options.
const std::vector<manual::Section> kCompareSections = {
    {"EXAMPLES",
     {{"ringdown compare my-bowl",
       "A folder with bowl.toml, or with bowl.obj and --material porcelain, and with blows as WAV files."}}},
    {"SEE ALSO",
     {{"ringdown-fit(1), ringdown-bake(1)", "The programs that analyse each recording and bake the shape."}}},
};

ExitCode run_compare(int argc, char** argv) {
  manual::App app("Compares recordings of an object with its baked bank.", "ringdown-compare");
  CompareArguments arguments;
  add_compare_options(app, arguments);
  if (const auto ended = manual::parse(app, argc, argv, kCompareSections)) return *ended;
  arguments.top_given = app.count("--top") > 0;
  for (const fs::path& path : {arguments.output, arguments.bank}) keep_stdout_for(path);
  return cli::run_cancellable([&arguments](const std::stop_token& stop) { return compare(arguments, stop); });
}

}  // namespace

int main(int argc, char** argv) {
  return ringdown::protocol::exit_status([&] { return run_compare(argc, argv); });
}
