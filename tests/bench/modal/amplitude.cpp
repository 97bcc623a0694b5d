#include "tests/bench/modal/amplitude.h"

#include "engine/bake/bake_object.h"
#include "engine/materials/material_library.h"
#include "engine/modal/bank_file.h"
#include "tests/bake/amplitude_error.h"
#include "tests/bake/bank_surface.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <utility>

namespace ringdown::bench {
namespace {

namespace fs = std::filesystem;

const fs::path kPresets = fs::path(RINGDOWN_SOURCE_DIR) / "presets";

struct Row {
  std::string object, bank;  // bank: "baked", "preset" or "given"
  std::size_t points = 0, triangles = 0, modes = 0;
  std::uintmax_t bytes = 0;
  std::vector<double> frequency_hz;  // of each mode
  test::AmplitudeErrors errors;
  test::BankSurface surface;
};

std::vector<fs::path> objects_of(const AmplitudePlan& plan) {
  if (!plan.objects.empty()) return plan.objects;
  std::vector<fs::path> objects;
  if (!plan.all) {
    for (const char* name : {"xylophone-key", "steel-plate", "wine-glass", "bronze-bell", "mug", "anvil"}) {
      objects.push_back(kPresets / "objects" / (std::string(name) + ".toml"));
      if (plan.quick && objects.size() == 2) break;
    }
    return objects;
  }
  for (const auto& entry : fs::recursive_directory_iterator(kPresets / "objects")) {
    if (entry.path().extension() == ".toml") objects.push_back(entry.path());
  }
  std::sort(objects.begin(), objects.end());
  return objects;
}

// The bank of a preset in the repository; an empty path when the object is none.
fs::path preset_bank(const fs::path& object) {
  std::error_code error;
  const fs::path inside = fs::relative(object, kPresets / "objects", error);
  const fs::path bank = (kPresets / "banks" / inside).replace_extension(".glb");
  return !error && fs::exists(bank) ? bank : fs::path();
}

// The bank in `file`, beside the solution it should agree with.
Result<Row> measure_bank(const fs::path& file, const test::Solution& solution, bool quick) {
  const auto bank = modal::read_bank(file);
  if (!bank) return fail(bank.error());
  test::AmplitudeSampling sampling;
  if (quick) sampling.points /= 10;
  auto errors = test::amplitude_errors(*bank, solution, sampling);
  if (!errors) return fail(errors.error());
  return Row{.object = {},
             .bank = {},
             .points = bank->point_count(),
             .triangles = bank->triangles.size(),
             .modes = bank->mode_count(),
             .bytes = fs::file_size(file),
             .frequency_hz = bank->frequency_hz,
             .errors = std::move(*errors),
             .surface = test::look_at_surface(*bank)};
}

// Bakes into `file`, and returns what the bake has solved.
Result<test::Solution> bake_into(const fs::path& file, bake::ObjectRecipe recipe, modal::Compression compression) {
  const auto object = bake::bake_object(recipe, kPresets / "materials");
  if (!object) return fail(object.error());
  const bake::Baked& baked = object->baked;
  if (!baked.report.cache_trouble.empty()) return fail(ErrorKind::input_output, baked.report.cache_trouble);
  if (auto written = modal::write_bank(baked.bank, file, {}, compression); !written) return fail(written.error());
  recipe.options.element = object->rounds.back().element;
  auto solution = test::kept_solution(object->mesh.mesh, *baked.bank.material, recipe.options);
  if (!solution) return fail(solution.error().kind, recipe.name + ": " + solution.error().message);
  return solution;
}

void write_modes(std::ofstream& out, const Row& row) {
  for (std::size_t m = 0; m < row.modes; ++m) {
    char text[64];
    std::snprintf(text, sizeof text, "\t%zu\t%.6f\t%.5f\n", row.points, row.frequency_hz[m], row.errors.by_mode[m]);
    out << row.object << '\t' << row.bank << text;
  }
}

void show(const Row& row) {
  const test::AmplitudeErrors& e = row.errors;
  const test::BankSurface& s = row.surface;
  std::printf("%-18s %-6s %6zu points %6zu triangles %5zu modes %9ju bytes  median %6.2f %%  largest %6.1f %%  ",
              row.object.c_str(), row.bank.c_str(), row.points, row.triangles, row.modes, row.bytes, 100 * e.median,
              100 * e.largest);
  std::printf("region %6.1f %% (median %.1f %%, near %.4g %.4g %.4g)  ", 100 * e.worst_region,
              100 * e.worst_region_median, e.worst_place[0], e.worst_place[1], e.worst_place[2]);
  std::printf("volume %+.2f %%, %zu open edges, %zu flat, %zu needles\n", 100 * s.volume_error, s.open_edges, s.flat,
              s.needles);
  std::fflush(stdout);
}

std::string as_csv(const Row& row) {
  const test::AmplitudeErrors& e = row.errors;
  const test::BankSurface& s = row.surface;
  char text[300];
  std::snprintf(text, sizeof text, "%s,%s,%zu,%zu,%zu,%ju,%.5f,%.5f,%.5f,%.5f,%.5f,%zu,%zu,%zu\n", row.object.c_str(),
                row.bank.c_str(), row.points, row.triangles, row.modes, row.bytes, e.median, e.largest, e.worst_region,
                e.worst_region_median, s.volume_error, s.open_edges, s.flat, s.needles);
  return text;
}

void add_promises(std::vector<Promise>& promises, const Row& row) {
  const std::string what = row.object + ", " + row.bank + ": amplitude of a strike anywhere, error of ";
  promises.push_back(at_most(what + "the median mode", 100 * row.errors.median, 3, " %"));
  promises.push_back(at_most(what + "the worst mode", 100 * row.errors.largest, 10, " %"));
  promises.push_back(at_most(what + "the worst region", 100 * row.errors.worst_region, 10, " %"));
}

class Measuring {
 public:
  explicit Measuring(const AmplitudePlan& plan) : plan_(plan), csv_(plan.csv) {
    csv_ << "object,bank,points,triangles,modes,bytes,median,largest,region,region_median,volume,open_edges,flat,"
            "needles\n";
    if (!plan.by_mode.empty()) modes_.open(plan.by_mode);
  }

  void measure(const fs::path& object) {
    const auto recipe = bake::read_object(object);
    if (!recipe) return miss(recipe.error());
    const fs::path beside = plan_.bank.empty() ? preset_bank(object) : plan_.bank;
    const fs::path file = plan_.folder / (object.stem().string() + ".glb");
    const modal::Compression compression = plan_.compress ? modal::Compression::meshopt : modal::Compression::none;
    std::vector<std::size_t> sizes = plan_.max_points;
    if (sizes.empty()) sizes = {recipe->options.points};
    for (const std::size_t size : sizes) {
      bake::ObjectRecipe sized = *recipe;
      sized.options.cache = plan_.cache;
      sized.options.points = size;
      const auto solution = bake_into(file, sized, compression);
      if (!solution) return miss(solution.error());
      take(object, "baked", measure_bank(file, *solution, plan_.quick));
      if (size != sizes.back() || beside.empty()) continue;
      take(object, plan_.bank.empty() ? "preset" : "given", measure_bank(beside, *solution, plan_.quick));
    }
  }

  Result<std::vector<Promise>> finished() {
    if (!csv_.flush()) return fail(ErrorKind::input_output, "cannot write " + plan_.csv.string());
    return promises_;
  }

 private:
  void miss(const Error& error) {
    std::printf("%s\n", error.message.c_str());
    promises_.push_back({error.message, Promise::kMissed});
  }

  void take(const fs::path& object, const std::string& bank, Result<Row> row) {
    if (!row) return miss(row.error());
    row->object = object.stem().string();
    row->bank = bank;
    show(*row);
    csv_ << as_csv(*row) << std::flush;
    if (modes_.is_open()) write_modes(modes_, *row);
    if (!plan_.quick) add_promises(promises_, *row);
  }

  const AmplitudePlan& plan_;
  std::ofstream csv_, modes_;
  std::vector<Promise> promises_;
};

}  // namespace

Result<std::vector<Promise>> measure_amplitudes(const AmplitudePlan& plan) {
  Measuring measuring(plan);
  for (const fs::path& object : objects_of(plan)) measuring.measure(object);
  return measuring.finished();
}

}  // namespace ringdown::bench
