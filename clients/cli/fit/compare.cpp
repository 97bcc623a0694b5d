// ringdown-compare: holds recordings of a thing against its baked bank.
#include "clients/cli/fit/compare_page.h"
#include "clients/cli/fit/sound.h"
#include "clients/cli/long_work.h"
#include "engine/base/file_format.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/base/process/child_process.h"
#include "engine/fit/band_powers.h"
#include "engine/fit/burst.h"
#include "engine/fit/comparison.h"
#include "engine/mesh/files/file_kinds.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/scaled_bank.h"
#include "packaging/manual/command_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>
#include <unistd.h>

namespace {

using namespace ringdown;  // NOLINT: a program
using protocol::complain;
using protocol::ExitCode;
namespace fs = std::filesystem;

struct CompareArguments {
  fs::path folder, output, bank, materials;
  std::string material;
  double top_hz = 12000;
  bool keep_nu = false;
  fit::Options options;
  fit::CalibrateOptions match{.tolerance_cents = 30, .max_tuning_cents = 250};
};

void add_compare_options(manual::App& app, CompareArguments& arguments) {
  app.add_option("folder", arguments.folder,
                 "A folder with recordings of one blow each, and with the object's shape: one object file (.toml), or "
                 "one mesh and --material.")
      ->type_name("FOLDER")
      ->required();
  app.add_option("-o,--output", arguments.output, "The page to write (.html); default: compare.html in the folder.")
      ->type_name("FILE");
  app.add_option("--bank", arguments.bank, "Also write the bank with the fitted E, nu and damping.")->type_name("FILE");
  app.add_option("-m,--material", arguments.material, "The material to begin with; default: the object file's.")
      ->type_name("NAME");
  app.add_option("--materials", arguments.materials, "Folder of the materials; default: the presets'.")
      ->type_name("FOLDER");
  app.add_option("--top", arguments.top_hz, "Modes are compared up to this frequency in Hz.")
      ->check(manual::between(100.0, 20000.0))
      ->capture_default_str();
  app.add_option("--tolerance", arguments.match.tolerance_cents,
                 "Largest error of a matching mode in cents, after the common tuning is removed.")
      ->check(manual::between(0.1, 200.0))
      ->capture_default_str();
  app.add_flag("--keep-nu", arguments.keep_nu, "Keep the material's Poisson's ratio, which takes two bakes in place of seven.");
}

struct Inputs {
  fs::path shape;
  std::vector<fs::path> sounds;
};

// `bank` is where the fitted bank goes: no mesh.
Result<Inputs> find_inputs(const fs::path& folder, const fs::path& bank) {
  std::error_code error;
  Inputs inputs;
  std::vector<fs::path> objects, meshes;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    if (is_of_kind(file, FileKind::sound)) inputs.sounds.push_back(file);
    if (is_of_kind(file, FileKind::table)) objects.push_back(file);
    if (mesh::is_body_file(file) || is_of_kind(file, FileKind::gltf)) meshes.push_back(file);
  }
  if (meshes.size() > 1) {  // a bank that was written beside the mesh
    std::erase_if(meshes, [&](const fs::path& path) { return path.filename() == bank.filename(); });
  }
  if (error) return fail(ErrorKind::bad_input, "cannot read the folder {}: {}", folder.string(), error.message());
  std::ranges::sort(inputs.sounds);
  if (inputs.sounds.empty()) {
    return fail(ErrorKind::bad_input,
                folder.string() + " has no recording: put a WAV or FLAC file of one blow into it");
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

// Shows how far the work is: a share of all that has to be done.
class Work {
 public:
  Work(std::size_t sounds, bool keeps_nu)
      : all_(kOfSound * static_cast<double>(sounds) + (keeps_nu ? 1 : kSearchBakes) + kOfLastBake),
        line_("ringdown-compare",
              isatty(STDERR_FILENO) == 1 ? cli::ProgressLine::Style::bar : cli::ProgressLine::Style::none) {}

  void begin(const std::string& stage, double share) {
    line_.show(stage, done_ / all_);
    done_ += share;
  }

  static constexpr double kOfSound = 1.5, kSearchBakes = 6, kOfLastBake = 3;  // in quick bakes

 private:
  double all_, done_ = 0;
  cli::ProgressLine line_;
};

// Bakes the shape again and again. A search needs nothing but frequencies, and their errors are much alike in all of its
// bakes: it takes elements of order 2, and lets no heat flow.
class Baker {
 public:
  Baker(const Inputs& inputs, const CompareArguments& arguments, fs::path folder, std::stop_token stop, Work& work)
      : inputs_(inputs), arguments_(arguments), folder_(std::move(folder)), stop_(std::move(stop)), work_(work) {}

  // With this Poisson's ratio, or the material's own.
  Result<modal::Bank> bake_quickly(std::optional<double> nu) {
    work_.begin(nu ? formatted("baking with nu {:.3f}", *nu) : "baking", 1);
    return bake(nu, {"--element", "tet10", "--set-material", "expansion_per_k=0"});
  }
  // The same, as it is heard: with elements that leave no error that counts, unless those of `quick` do, and with heat.
  Result<modal::Bank> bake_well(std::optional<double> nu, const modal::Bank& quick) {
    constexpr double kOfTolerance = 0.25;
    work_.begin("baking at last", Work::kOfLastBake);
    const auto errors = modal::error_spread(quick.frequency_error);
    const double limit = std::exp2(kOfTolerance * arguments_.match.tolerance_cents / 1200) - 1;
    if (errors && errors->median < limit) return bake(nu, {"--element", "tet10"});
    return bake(nu, {});
  }

 private:
  Result<modal::Bank> bake(std::optional<double> nu, const std::vector<std::string>& options) {
    const Result<fs::path> program = find_beside("ringdown-bake");
    if (!program) return fail(program);
    const fs::path to = folder_ / "baked.glb";
    const double top_hz = std::exp2(arguments_.match.max_tuning_cents / 1200) * arguments_.top_hz;
    ChildRequest request{.command = {program->string(), inputs_.shape.string(), "-o", to.string(), "--quiet", "--band",
                                     "20", std::to_string(top_hz)},
                         .keep_going = [this] { return !stop_.stop_requested(); }};
    request.command.insert(request.command.end(), options.begin(), options.end());
    const auto add = [&request](const std::string& option, const std::string& value) {
      request.command.insert(request.command.end(), {option, value});
    };
    if (!arguments_.material.empty()) add("--material", arguments_.material);
    if (!arguments_.materials.empty()) add("--materials", arguments_.materials.string());
    if (nu) add("--set-material", formatted("poisson_ratio={:f}", *nu));
    if (arguments_.bank.empty()) add("--shape-error", "50%");  // nobody asked for shapes
    const Result<ChildOutcome> done = run_child(request);
    if (!done) return fail(done);
    if (done->stopped) return fail(ErrorKind::cancelled, "cancelled; nothing was written");
    if (done->exit_code != 0) return fail(ErrorKind::bad_input, last_line(done->errors));
    return modal::read_bank(to);
  }

  const Inputs& inputs_;
  const CompareArguments& arguments_;
  fs::path folder_;
  std::stop_token stop_;
  Work& work_;
};

Result<std::vector<cli::ComparedSound>> read_sounds(const Inputs& inputs, const CompareArguments& arguments,
                                                    const std::stop_token& stop, Work& work) {
  std::vector<cli::ComparedSound> sounds;
  for (const fs::path& path : inputs.sounds) {
    if (stop.stop_requested()) return fail(ErrorKind::cancelled, "cancelled; nothing was written");
    work.begin("listening to " + path.filename().string(), Work::kOfSound);
    Result<cli::Sound> sound = cli::read_sound(path, std::nullopt);
    if (!sound) return fail(sound);
    if (!sound->note.empty()) complain("warning: " + path.string() + ": " + sound->note, ExitCode::ok);
    Result<fit::Fit> found = fit::fit_modes(sound->samples, sound->sample_rate_hz, arguments.options);
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

// A search for Poisson's ratio: three bakes, and the choice between them.
struct Search {
  std::array<modal::Bank, 3> banks;
  std::array<fit::NuBank, 3> choices{};
  fit::NuChoice choice;
};

// Bakes with three ratios around `middle`, and chooses between them.
Result<Search> search_nu(Baker& baker, const fit::CalibrateOptions& match, std::span<const fit::Mode> heard,
                         double middle, double aside) {
  constexpr double kMin = 0.02, kMax = 0.47;
  const double centre = std::clamp(middle, kMin + aside, kMax - aside);
  Search search;
  for (std::size_t i = 0; i < 3; ++i) {
    const double nu = centre + aside * (static_cast<double>(i) - 1);
    Result<modal::Bank> bank = baker.bake_quickly(nu);
    if (!bank) return fail(bank);
    search.banks[i] = std::move(*bank);
    search.choices[i] = {nu, &search.banks[i]};
  }
  search.choice = fit::choose_nu(heard, search.choices, match);
  return search;
}

fit::CalibrateOptions around(fit::CalibrateOptions match, double tuning_cents) {
  match.max_tuning_cents = 2 * match.tolerance_cents;
  match.around_cents = tuning_cents;
  return match;
}

// The bank at the Poisson's ratio that the recordings ask for, or at the material's own where they do not tell. Sets the
// search of the tuning, and the wide search in which chance may be tried.
Result<void> find_bank(Baker& baker, CompareArguments& arguments, cli::Comparison& c, Search& wide) {
  constexpr double kMiddle = 0.25, kWide = 0.2, kNarrow = 0.06;  // of what solids have
  Result<modal::Bank> own = baker.bake_quickly(std::nullopt);
  if (!own) return fail(own);
  if (!own->material) return fail(ErrorKind::bad_input, "the bank of " + c.name + " has no material");
  c.material = own->material->name;
  c.poisson_ratio = c.given_poisson_ratio = own->material->poisson_ratio;
  std::optional<double> nu;
  if (!arguments.keep_nu && !own->material->orthotropy) {  // a grain's constants leave nothing to nu
    auto found = search_nu(baker, arguments.match, c.heard, kMiddle, kWide);
    if (!found) return fail(found);
    wide = std::move(*found);
    for (std::size_t i = 0; i < 3; ++i) wide.choices[i].bank = &wide.banks[i];
    const auto narrow = search_nu(baker, around(arguments.match, wide.choice.tuning_cents), c.heard,
                                  wide.choice.poisson_ratio, kNarrow);
    if (!narrow) return fail(narrow);
    arguments.match.around_cents = narrow->choice.tuning_cents;
    c.nu_told = narrow->choice.told;
    if (c.nu_told) nu = c.poisson_ratio = narrow->choice.poisson_ratio;
  }
  Result<modal::Bank> best = baker.bake_well(nu, *own);
  if (!best) return fail(best);
  c.bank = std::move(*best);
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
  return fit::with_losses(modal::scaled(c.bank, {.stiffness = c.stiffness()}), c.calibration);
}

ExitCode compare(CompareArguments& arguments, const std::stop_token& stop) {
  if (arguments.output.empty()) arguments.output = arguments.folder / "compare.html";
  const Result<Inputs> inputs = find_inputs(arguments.folder, arguments.bank);
  if (!inputs) return complain(inputs);
  Work work(inputs->sounds.size(), arguments.keep_nu);
  Result<std::vector<cli::ComparedSound>> sounds = read_sounds(*inputs, arguments, stop, work);
  if (!sounds) return complain(sounds);
  cli::Comparison c{.name = inputs->shape.stem().string(), .sounds = std::move(*sounds)};
  std::vector<std::vector<fit::Mode>> each;
  for (const cli::ComparedSound& s : c.sounds) each.push_back(s.found.modes);
  c.heard = fit::merge(each);
  std::erase_if(c.heard, [&](const fit::Mode& mode) { return mode.frequency_hz > arguments.top_hz; });
  if (c.heard.size() < fit::kMinMatches) {
    return complain({ErrorKind::bad_input, formatted("{}: the recordings have {} modes below --top, and {} are needed",
                                                     arguments.folder.string(), c.heard.size(), fit::kMinMatches)});
  }
  const PrivateFolder folder("ringdown-compare");
  if (folder.path().empty()) return complain({ErrorKind::input_output, "cannot make a folder for temporary files"});
  const fit::CalibrateOptions wide_match = arguments.match;
  Search wide;
  {
    Baker baker(*inputs, arguments, folder.path(), stop, work);
    const auto found = find_bank(baker, arguments, c, wide);
    if (!found) return complain(found);
  }
  if (arguments.match.around_cents != 0) {  // E/rho and nu were searched together, with errors of quick bakes
    arguments.match.max_tuning_cents = arguments.match.tolerance_cents;
  }
  if (stop.stop_requested()) return complain({ErrorKind::cancelled, "cancelled; nothing was written"});
  Result<fit::Calibration> calibration = fit::calibrate(c.heard, c.bank, arguments.match);
  if (!calibration)
    return complain({calibration.error().kind, arguments.folder.string() + ": " + calibration.error().message});
  c.calibration = std::move(*calibration);
  if (wide.choices[0].bank != nullptr)
    c.chance = fit::chance_of(c.heard, wide.choices, wide_match, c.calibration.matches.size());
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
  for (const fs::path& path : {arguments.output, arguments.bank}) keep_stdout_for(path);
  return cli::run_cancellable([&arguments](const std::stop_token& stop) { return compare(arguments, stop); });
}

}  // namespace

int main(int argc, char** argv) {
  return ringdown::protocol::exit_status([&] { return run_compare(argc, argv); });
}
