#include "tests/bench/modal/amplitude.h"

#include "engine/bake/bake_object.h"
#include "engine/bake/material_library.h"
#include "engine/modal/bank_file.h"
#include "tests/bake/amplitude_error.h"
#include "tests/bake/bank_surface.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

namespace ringdown::bench {
namespace {

namespace fs = std::filesystem;

const fs::path kPresets = fs::path(RINGDOWN_SOURCE_DIR) / "presets";

struct Row {
  std::string object, bank;  // bank: "baked", "preset" or "given"
  std::size_t points = 0, triangles = 0, modes = 0;
  std::uintmax_t bytes = 0;
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

struct BakedBody {
  modal::Bank bank;
  test::Solution solution;
};

Result<BakedBody> bake_body(const fs::path& object, const AmplitudePlan& plan) {
  auto recipe = bake::read_object(object);
  if (!recipe) return fail(recipe.error());
  recipe->options.cache = plan.cache;
  if (plan.most_points > 0) recipe->options.most_points = plan.most_points;
  const auto baked = bake::bake_object(*recipe, kPresets / "materials");
  if (!baked) return fail(baked.error());
  if (!baked->baked.report.cache_trouble.empty())
    return fail(ErrorKind::input_output, baked->baked.report.cache_trouble);
  bake::BakeOptions options = recipe->options;
  options.element = baked->rounds.back().element;
  auto solution = test::kept_solution(baked->mesh.mesh, *baked->baked.bank.material, options);
  if (!solution) return fail(solution.error().kind, recipe->name + ": " + solution.error().message);
  return BakedBody{baked->baked.bank, std::move(*solution)};
}

Result<Row> measure_bank(const fs::path& file, const test::Solution& solution,
                         const test::AmplitudeSampling& sampling) {
  const auto bank = modal::read_bank(file);
  if (!bank) return fail(bank.error());
  auto errors = test::amplitude_errors(*bank, solution, sampling);
  if (!errors) return fail(errors.error());
  return Row{.object = {},
             .bank = {},
             .points = bank->point_count(),
             .triangles = bank->triangles.size(),
             .modes = bank->mode_count(),
             .bytes = fs::file_size(file),
             .errors = std::move(*errors),
             .surface = test::look_at_surface(*bank)};
}

// `file` again, for the frequencies that belong to row.errors.by_mode.
void write_modes(std::ofstream& out, const Row& row, const fs::path& file) {
  const auto bank = modal::read_bank(file);
  if (!bank) return;
  for (std::size_t m = 0; m < bank->mode_count(); ++m) {
    char text[64];
    std::snprintf(text, sizeof text, "%.6f\t%.5f\n", bank->frequency_hz[m], row.errors.by_mode[m]);
    out << row.object << '\t' << row.bank << '\t' << text;
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

}  // namespace

Result<std::vector<Promise>> measure_amplitudes(const AmplitudePlan& plan) {
  std::ofstream csv(plan.csv), modes;
  csv << "object,bank,points,triangles,modes,bytes,median,largest,region,region_median,volume,open_edges,flat,"
         "needles\n";
  if (!plan.by_mode.empty()) modes.open(plan.by_mode);
  std::vector<Promise> promises;
  for (const fs::path& object : objects_of(plan)) {
    const auto body = bake_body(object, plan);
    if (!body) return fail(body.error());
    const fs::path baked = plan.folder / (object.stem().string() + ".glb");
    if (auto written = modal::write_bank(body->bank, baked); !written) return fail(written.error());
    std::vector<std::pair<std::string, fs::path>> banks = {{"baked", baked}};
    const fs::path preset = preset_bank(object);
    if (!plan.bank.empty()) {
      banks.emplace_back("given", plan.bank);
    } else if (!preset.empty()) {
      banks.emplace_back("preset", preset);
    }
    for (const auto& [kind, file] : banks) {
      test::AmplitudeSampling sampling;
      if (plan.quick) sampling.points /= 10;
      auto row = measure_bank(file, body->solution, sampling);
      if (!row) return fail(row.error());
      row->object = object.stem().string();
      row->bank = kind;
      show(*row);
      csv << as_csv(*row) << std::flush;
      if (modes.is_open()) write_modes(modes, *row, file);
      if (!plan.quick) add_promises(promises, *row);
    }
  }
  if (!csv) return fail(ErrorKind::input_output, "cannot write " + plan.csv.string());
  return promises;
}

}  // namespace ringdown::bench
