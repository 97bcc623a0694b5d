// ringdown-check: what is wrong with a mesh, what would be repaired, and how it would be meshed. `ringdown check ...`
// runs this program.
//
// Exit codes (protocol/exit_codes.h): ok when the file can be baked, repaired or not; bad_input when it cannot; usage;
// failure when the repaired surface cannot be written; cancelled.
#include "clients/cli/bake/options.h"
#include "clients/cli/long_work.h"
#include "engine/bake/bake_object.h"
#include "engine/bake/body_shape.h"
#include "engine/bake/recipe_options.h"
#include "engine/base/content_cache.h"
#include "engine/base/file_format.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/materials/material_library.h"
#include "engine/mesh/body_reader.h"
#include "engine/mesh/tet_mesh.h"
#include "packaging/manual/command_line.h"

#include <cstdio>

namespace {

using namespace ringdown;
using protocol::complain;
using protocol::ExitCode;

const std::vector<manual::Section> kSections = {
    {"ENVIRONMENT",
     {{"RINGDOWN_MESH_SECONDS", "Processor time for reading or meshing a file (default 600)."},
      {"RINGDOWN_MESH_MIB", "Memory for reading or meshing a file (default: half of the computer's, at most 16384)."},
      {"RINGDOWN_PRESETS", "Folder of the presets, if it is not share/ringdown/presets beside bin."}}},
    {"EXAMPLES",
     {{"ringdown-check mesh cup.stl --unit mm", "Lists faults and repairs, and describes the mesh that would result."},
      {"ringdown-check mesh scan.ply -o repaired.ply", "Writes the repaired surface to a file."}}},
    {"SEE ALSO", {{"ringdown(1), ringdown-bake(1)", "The other programs."}}},
};

struct CheckRequest {
  std::filesystem::path file, output, materials;  // no output: nothing is written
  std::string material = "steel";
  std::optional<double> unit_m;
  bool cavities = false;
};

void print_findings(const mesh::SurfaceReport& report) {
  std::printf("  %-34s %8s  %s\n", "found", "count", "first places (m), triangles");
  if (report.findings.empty()) std::printf("  %-34s %8d\n", "nothing", 0);
  for (const mesh::Finding& finding : report.findings) {
    std::printf("  %-34s %8zu ", mesh::name_of(finding.fault).c_str(), finding.count);
    for (std::size_t i = 0; i < finding.places.size(); ++i) {
      const auto& at = finding.places[i];
      std::printf(" (%.4g %.4g %.4g)", at[0], at[1], at[2]);
      if (i < finding.triangles.size()) std::printf(" #%d", finding.triangles[i]);
    }
    if (finding.length_m > 0) std::printf("; the longest %.3g m around", finding.length_m);
    std::printf("\n");
  }
}

void print_surface(const mesh::PreparedSurface& surface) {
  std::printf("  surface: %.4g m long, %.4g m2, %.4g m3, %d shell%s\n", surface.found.diagonal_m, surface.found.area_m2,
              surface.found.volume_m3, surface.found.shells, surface.found.shells == 1 ? "" : "s");
  for (const std::string& note : surface.notes) std::printf("  note: %s\n", note.c_str());
  print_findings(surface.found);
  for (const std::string& action : surface.actions) std::printf("  repaired: %s\n", action.c_str());
  for (const mesh::Finding& finding : surface.left.findings) {
    if (!surface.actions.empty()) std::printf("  left: %s\n", mesh::describe(finding).c_str());
  }
  if (!mesh::hopeless(surface, "").empty()) return;
  std::printf("  meshed: %s\n",
              surface.left.sound() ? "filled by gmsh"
                                   : "stuffed, because faults remain after repair; gmsh fills the skin of the lattice");
}

void print_forecast(const bake::Forecast& forecast, const bake::BodyShape& shape, const modal::Material& material) {
  const int order = fem::order_of(forecast.element);
  if (const auto& choice = forecast.choice) {
    std::printf("  resolution: %.3g mm with order %d, for waves of %.3g mm at %.0f Hz in %s and walls of %.3g mm%s\n",
                1000 * choice->size_m, order, 1000 * choice->shortest_wave_m, bake::BakeOptions().band_high_hz,
                material.name.c_str(), 1000 * shape.wall_m,
                choice->bounded ? "; finer elements would be needed, but exceed the default limit of unknowns" : "");
  }
  const bake::BakeCost& cost = forecast.cost;
  std::printf("  %s: %td elements, %.0f unknowns\n", mesh::text_of(forecast.making).c_str(),
              forecast.mesh.mesh.elements.rows(), cost.unknowns);
  std::printf("  expected: %.2g modes, %.2g s of processor time after %.2g s for the mesh, %.2g GiB of memory\n",
              cost.modes, cost.processor_s, forecast.mesh_processor_s, cost.memory_bytes / 1073741824);
  std::printf("  %.3g kg, lowest note near %.2g Hz\n", shape.volume_m3 * material.density_kg_m3,
              bake::guessed_lowest_hz(shape, material));
}

void print_tetrahedra(const mesh::Body& body) {
  const mesh::CheckedMesh& checked = body.mesh;
  const mesh::TetQuality quality = mesh::quality_of(checked.mesh);
  std::printf("  %s: %td elements of order %d, %td nodes, %d piece%s\n", mesh::text_of(body.making).c_str(),
              checked.mesh.elements.rows(), checked.mesh.order(), checked.mesh.nodes.rows(), checked.pieces,
              checked.pieces == 1 ? "" : "s");
  std::printf("  repaired: %d inside out, %d duplicated, %d folded elements; %d unused nodes\n", checked.flipped,
              checked.duplicates, checked.straightened, checked.unused_nodes);
  std::printf("  dihedral angles %.3g to %.3g degrees, edges %.3g to %.3g mm\n", quality.smallest_angle_deg,
              quality.largest_angle_deg, 1000 * quality.shortest_edge_m, 1000 * quality.longest_edge_m);
}

// Prints to stdout: faults, repairs, how the body is meshed, and what baking it would take. Nothing is
// solved.
Result<void> check_mesh(const CheckRequest& request, const Progress& progress) {
  const Result<bake::MaterialEntry> material = bake::find_material(request.materials, request.material);
  if (!material) return fail(material);
  mesh::BodyReader reader(request.file);
  const mesh::GmshOptions options{.unit_m = request.unit_m, .order = 1, .cavities = request.cavities, .parameters = {}};
  std::printf("%s\n", request.file.c_str());
  if (reader.is_surface()) {
    const Result<const mesh::PreparedSurface*> surface = reader.surface(options, progress);
    if (!surface) return fail(surface);
    print_surface(**surface);
    const std::string why = mesh::hopeless(**surface, request.file.string());
    if (!why.empty()) return fail(ErrorKind::bad_input, why);
    if (!request.output.empty()) {
      const Result<void> written = mesh::write_ply((*surface)->mesh, request.output);
      if (!written) return written;
      std::printf("  repaired surface -> %s\n", request.output.c_str());
    }
  } else {
    const Result<mesh::Body> body = reader.read(options, progress);
    if (!body) return fail(body);
    print_tetrahedra(*body);
  }
  const Result<mesh::Sketch> sketch = reader.sketch(options, progress);
  if (!sketch) return fail(sketch);
  const bake::BodyShape shape = bake::measure_shape(sketch->skin, sketch->wall_m);
  bake::ObjectRecipe recipe{
      .name = request.file.stem().string(), .description = "", .material = "", .geometry = request.file};
  recipe.meshing.unit_m = request.unit_m;
  recipe.options.cache = cache_folder().value_or("");
  const Result<bake::Forecast> forecast = bake::forecast(recipe, material->material, progress);
  if (!forecast) return fail(forecast);
  print_forecast(*forecast, shape, material->material);
  const double unit_m = request.unit_m.value_or(mesh::unit_in_file(request.file));
  const bake::BakeOptions usual;
  const std::string question =
      bake::question_size(shape, material->material, usual.band_high_hz, usual.max_modes, request.file, unit_m);
  if (!question.empty()) std::printf("  is this size right? %s\n", question.c_str());
  std::fflush(stdout);
  return {};
}

ExitCode run(int argc, char** argv) {
  manual::App app("Looks at a file before it is baked.", "ringdown-check");
  app.require_subcommand(1);
  CheckRequest request;
  std::optional<std::string> unit;
  manual::App* verb =
      app.add_subcommand("mesh", "Lists faults of a surface, of tetrahedra or of a geometry, and their consequences.");
  verb->add_option("file", request.file,
                   "a surface (" + example_endings({FileKind::surface, FileKind::gltf}) + "), a geometry or a mesh")
      ->type_name("FILE")
      ->required();
  verb->add_option("--unit", unit, bake::kUnitSentence)->type_name("LENGTH")->check(cli::check_unit);
  verb->add_flag("--cavities", request.cavities, "shells inside others are cavities, whatever their orientation");
  verb->add_option("-m,--material", request.material, "the material that the mesh is chosen for (default steel)");
  verb->add_option("--materials", request.materials, "folder of materials (default: the presets')")
      ->type_name("FOLDER");
  verb->add_option("-o,--output", request.output, "where to write the repaired surface (.ply), in metres")
      ->type_name("FILE");
  if (const auto ended = manual::parse(app, argc, argv, kSections)) return *ended;
  if (!request.output.empty() && !mesh::is_surface_file(request.file)) {
    return manual::complain_of_usage(app,
                                     request.file.string() + " is not a surface; --output is for repaired surfaces");
  }
  if (unit) request.unit_m = cli::parse_unit(*unit);
  const Result<std::filesystem::path> materials = material_folder(request.materials);
  if (!materials) return complain(materials);
  request.materials = *materials;
  keep_stdout_for(request.output);
  cli::warn_of_open_sandbox();
  return cli::run_cancellable([&](const std::stop_token& stop) {
    const Result<void> checked =
        check_mesh(request, [&stop](std::string_view, double) { return !stop.stop_requested(); });
    return checked ? ExitCode::ok : complain(checked);
  });
}

}  // namespace

int main(int argc, char** argv) {
  return ringdown::protocol::exit_status([&] { return run(argc, argv); });
}
