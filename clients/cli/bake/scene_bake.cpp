#include "clients/cli/bake/scene_bake.h"

#include "engine/bake/bake_object.h"
#include "engine/base/atomic_file.h"
#include "engine/base/file_format.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/base/quote.h"
#include "engine/gltf/gltf_file.h"
#include "engine/materials/material_library.h"
#include "engine/materials/material_words.h"
#include "engine/mesh/triangle_mesh.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/gltf_models.h"
#include "engine/modal/hearing/masking.h"
#include "engine/modal/scaled_bank.h"
#include "engine/scene/gltf/silent.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::cli {
namespace {

namespace fs = std::filesystem;
using protocol::complain;
using protocol::ExitCode;
using scene::SilentBody;

// Bodies that share a model, by their places in the list of all.
using Alike = std::vector<std::size_t>;

// Points are read through the poses of their nodes, each of which rounds them differently.
bool same_surface(const scene::ShapeMesh& a, const scene::ShapeMesh& b) {
  constexpr double kRounding = 1e-6;  // of the size
  if (a.triangles != b.triangles || a.points_m.size() != b.points_m.size()) return false;
  double size_m = 0, off_m = 0;
  for (std::size_t k = 0; k < a.points_m.size(); ++k) {
    size_m = std::max(size_m, length(a.points_m[k] - a.points_m[0]));
    off_m = std::max(off_m, length(a.points_m[k] - b.points_m[k]));
  }
  return off_m <= kRounding * size_m;
}

bool same_sound(const SilentBody& a, const SilentBody& b) {
  return a.geo == b.geo && same_surface(a.surface, b.surface) && a.material.number == b.material.number &&
         a.material.name == b.material.name && a.scale == b.scale && a.mass_kg == b.mass_kg;
}

std::vector<Alike> groups_of(const std::vector<SilentBody>& bodies) {
  std::vector<Alike> groups;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (!bodies[k].trouble.empty()) continue;
    const auto found =
        std::ranges::find_if(groups, [&](const Alike& group) { return same_sound(bodies[group[0]], bodies[k]); });
    if (found == groups.end()) {
      groups.push_back({k});
    } else {
      found->push_back(k);
    }
  }
  return groups;
}

// The material of the file. What the file leaves out comes from the library's material of the same name, if there is
// one.
Result<modal::Material> material_of(const scene::GltfMaterial& given, const fs::path& library) {
  std::string name = given.name;
  std::ranges::transform(name, name.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  std::ranges::replace(name, ' ', '-');
  const bool whole = given.density_kg_m3 && given.young_pa && given.poisson && (given.alpha_per_s || given.beta_s);
  modal::Material known;
  const std::vector<std::string> names = bake::names_in(library);
  const bool in_library = std::ranges::find(names, name) != names.end();
  if (!whole && !in_library) {
    std::string missing;
    for (const auto& [is_there, what] : {std::pair(given.density_kg_m3.has_value(), "density"),
                                         {given.young_pa.has_value(), "youngsModulus"},
                                         {given.poisson.has_value(), "poissonRatio"},
                                         {given.alpha_per_s || given.beta_s, "alpha and beta"}}) {
      if (!is_there) missing += (missing.empty() ? "" : ", ") + std::string(what);
    }
    return fail(
        ErrorKind::bad_input,
        "its acoustic material {} has no {}; add them, or name it as one of `ringdown materials`, which then fills in",
        quote(given.name), missing);
  }
  if (!whole) {
    const auto entry = bake::find_material(library, name);
    if (!entry) return fail(entry);
    known = entry->material;
  }
  modal::Material material = known;
  material.name = given.name;
  material.density_kg_m3 = given.density_kg_m3.value_or(known.density_kg_m3);
  material.youngs_modulus_pa = given.young_pa.value_or(known.youngs_modulus_pa);
  material.poisson_ratio = given.poisson.value_or(known.poisson_ratio);
  if (given.alpha_per_s || given.beta_s) {
    material.damping = {.alpha_per_s = given.alpha_per_s.value_or(0), .beta_s = given.beta_s.value_or(0)};
    material.loss_factors.clear();
  }
  return material;
}

// Writes the body's geometry as a file that the baker reads.
Result<fs::path> write_geometry(const SilentBody& body, const fs::path& folder, std::size_t number) {
  const fs::path path = folder / (std::to_string(number) + (body.geo.empty() ? ".ply" : ".geo"));
  if (!body.geo.empty()) {
    if (const auto written = write_file_atomically(path, body.geo); !written) return fail(written);
    return path;
  }
  mesh::TriangleMesh surface;
  surface.nodes.resize(static_cast<Eigen::Index>(body.surface.points_m.size()), 3);
  surface.triangles.resize(static_cast<Eigen::Index>(body.surface.triangles.size()), 3);
  for (Eigen::Index k = 0; k < surface.nodes.rows(); ++k) {
    const Vec3& p = body.surface.points_m[static_cast<std::size_t>(k)];
    surface.nodes.row(k) << p.x, p.y, p.z;
  }
  for (Eigen::Index k = 0; k < surface.triangles.rows(); ++k) {
    const auto& [a, b, c] = body.surface.triangles[static_cast<std::size_t>(k)];
    surface.triangles.row(k) << static_cast<int>(a), static_cast<int>(b), static_cast<int>(c);
  }
  if (const auto written = mesh::write_ply(surface, path); !written) return fail(written);
  return path;
}

// The bank as the file is to hold it: of the mass that the file gives the body, and with its points in the node's own
// frame. What radiates is left out under a scale, because the file has no place for the size that it holds for.
modal::Bank as_in_file(modal::Bank bank, const SilentBody& body) {
  if (body.mass_kg && bank.mass) {
    const double ratio = *body.mass_kg / bank.mass->mass_kg;
    bank = modal::scaled(bank, {.density = ratio, .stiffness = ratio});
  }
  if (body.scale == 1) return bank;
  const auto part = [&](float x) { return static_cast<float>(static_cast<double>(x) / body.scale); };
  for (modal::Vec3f& p : bank.positions) p = {part(p[0]), part(p[1]), part(p[2])};
  if (bank.mass) bank.mass->center_of_mass_m = (1 / body.scale) * bank.mass->center_of_mass_m;
  bank.radiation.reset();
  return bank;
}

class SceneBaker {
 public:
  SceneBaker(const SceneBake& request, const std::stop_token& stop) : request_(request), stop_(stop) {}

  ExitCode run() {
    const auto bytes = read_whole_file(request_.input, modal::kMaxBankFileBytes);
    if (!bytes) return complain(bytes);
    auto found = find(*bytes);
    if (!found) return complain(found);
    for (const std::string& note : found->notes)
      if (!request_.quiet) std::printf("%s: %s\n", request_.input.c_str(), note.c_str());
    if (const auto named = name_materials(*found); !named) return complain(named);
    for (const SilentBody& body : found->bodies)
      if (!body.trouble.empty()) complain_of(body, body.trouble);
    const std::vector<Alike> groups = groups_of(found->bodies);
    const PrivateFolder folder("ringdown-scene");
    if (folder.path().empty()) return complain({ErrorKind::input_output, "cannot make a folder for temporary files"});
    std::vector<modal::Bank> banks;
    std::vector<modal::AddedModel> models;
    banks.reserve(groups.size());
    for (std::size_t k = 0; k < groups.size(); ++k) {
      auto bank = bake(found->bodies, groups, k, folder.path());
      if (!bank && bank.error().kind == ErrorKind::cancelled) return complain(bank);
      if (!bank) {
        for (const std::size_t member : groups[k]) complain_of(found->bodies[member], bank.error().message);
        continue;
      }
      banks.push_back(*std::move(bank));
      modal::AddedModel model{.bank = &banks.back(), .material = found->bodies[groups[k][0]].material.number};
      for (const std::size_t member : groups[k]) model.nodes.push_back(found->bodies[member].node);
      baked_ += groups[k].size();
      models.push_back(std::move(model));
    }
    if (!models.empty() || request_.input != request_.output) {
      if (const auto written = write(*bytes, models); !written) return complain(written);
    }
    if (!request_.quiet) {
      std::printf("%s: %zu of %zu bodies got a model, %zu models in all\n", request_.output.c_str(), baked_,
                  found->bodies.size(), models.size());
    }
    return failed_ ? ExitCode::bad_input : ExitCode::ok;
  }

 private:
  [[nodiscard]] Result<scene::SilentBodies> find(const std::string& bytes) const {
    const auto glb = modal::parse_gltf(std::as_bytes(std::span(bytes)), request_.input.string(),
                                       modal::files_beside(request_.input));
    if (!glb) return fail(glb);
    return scene::find_silent_bodies(*glb);
  }

  // Gives every body the material that the command line names for it, and a body with an ordinary material the one that
  // its name means. Bodies whose material is not known are removed; they stay silent.
  Result<void> name_materials(scene::SilentBodies& found) const {
    const std::vector<std::string> known = bake::names_in(request_.materials);
    for (const auto& [name, material] : request_.body_materials) {
      if (std::ranges::find(found.bodies, name, &SilentBody::name) == found.bodies.end())
        return fail(ErrorKind::bad_input, "--body {}={}: {} has no silent body of that name", name, material,
                    request_.input.string());
      if (std::ranges::find(known, material) == known.end())
        return fail(ErrorKind::bad_input, "--body {}={}: no such material; `ringdown materials` lists them", name,
                    material);
    }
    std::erase_if(found.bodies, [&](SilentBody& body) {
      const auto given = request_.body_materials.find(body.name);
      if (given != request_.body_materials.end()) {
        body.material = {.name = given->second};
        return false;
      }
      if (body.material.number) return false;
      const auto understood = bake::understood_material(body.material.name, known);
      if (!request_.quiet) {
        const std::string of = body.material.name.empty() ? "no material" : "the material " + quote(body.material.name);
        std::printf(
            "%s: %s, %s\n", body.name.c_str(), of.c_str(),
            understood
                ? ("taken for " + *understood).c_str()
                : ("not known; it stays silent, or name one with --body " + quote(body.name + "=glass")).c_str());
      }
      if (understood) body.material.name = *understood;
      return !understood;
    });
    return {};
  }

  void complain_of(const SilentBody& body, const std::string& why) {
    failed_ = true;
    complain({ErrorKind::bad_input, request_.input.string() + ": body " + quote(body.name) + ": " + why});
  }

  Result<modal::Bank> bake(const std::vector<SilentBody>& bodies, const std::vector<Alike>& groups, std::size_t k,
                           const fs::path& folder) {
    const SilentBody& body = bodies[groups[k][0]];
    const auto material = material_of(body.material, request_.materials);
    if (!material) return fail(material);
    const auto geometry = write_geometry(body, folder, k);
    if (!geometry) return fail(geometry);
    auto recipe = request_.recipe_for(*geometry);
    if (!recipe) return fail(recipe);
    recipe->name = body.name;
    recipe->meshing.unit_m = 1;
    recipe->options.raise_band = true;
    const std::string title = formatted(" ({} of {})", k + 1, groups.size());
    ProgressLine line(body.name + title, request_.style);
    const auto progress = [&](std::string_view stage, double fraction) {
      line.show(stage, fraction);
      return !stop_.stop_requested();
    };
    try {
      auto object = bake::bake_recipe(*recipe, *material, progress);
      line.clear();
      if (!object) return fail(object);
      report(bodies, groups[k], *object);
      return as_in_file(std::move(object->baked.bank), body);
    } catch (const std::bad_alloc&) {
      return fail(ErrorKind::no_memory, "there is not enough memory; a larger --mesh-size needs less");
    }
  }

  void report(const std::vector<SilentBody>& bodies, const Alike& group, const bake::BakedObject& object) const {
    if (request_.quiet) return;
    const modal::Bank& bank = object.baked.bank;
    const auto [low, high] = std::ranges::minmax_element(bank.frequency_hz);
    std::printf("%s: %zu modes, %.1f to %.1f Hz, %s", bodies[group[0]].name.c_str(), bank.mode_count(), *low, *high,
                object.baked.report.from_cache ? "from the cache" : "solved");
    if (group.size() > 1) std::printf(", for %zu bodies alike", group.size());
    if (*low > modal::kHighestHeard_hz)
      std::printf("; it rings above hearing, and is heard by the click of its blows alone");
    std::printf("\n");
  }

  // Nothing is written over a file that somebody has written since it was read.
  Result<void> write(const std::string& bytes, const std::vector<modal::AddedModel>& models) {
    const fs::path& output = request_.output;
    auto extended = modal::add_models(bytes, request_.input.string(), output.stem().string() + "-banks", models);
    if (!extended) return fail(extended);
    const bool elsewhere = fs::absolute(output).parent_path() != fs::absolute(request_.input).parent_path();
    if (elsewhere && !extended->buffer_name.empty()) {
      return fail(
          ErrorKind::bad_input,
          request_.input.string() + " keeps its buffers in files beside it; write the scene into the same folder");
    }
    const auto now = read_whole_file(request_.input, modal::kMaxBankFileBytes);
    if (!now || *now != bytes) {
      return fail(
          ErrorKind::refused,
          request_.input.string() +
              " changed while its bodies were baked and was not overwritten; bake it again, which uses the cache");
    }
    if (!extended->buffer_name.empty()) {
      const auto written = write_file_atomically(output.parent_path() / extended->buffer_name, extended->buffer);
      if (!written) return fail(written);
    }
    return write_output(output, extended->file);
  }

  const SceneBake& request_;
  const std::stop_token& stop_;
  std::size_t baked_ = 0;
  bool failed_ = false;
};

}  // namespace

bool has_surfaces(const fs::path& path) {
  if (!is_of_kind(path, FileKind::gltf)) return false;
  const auto bytes = read_whole_file(path, modal::kMaxBankFileBytes);
  if (!bytes) return false;
  modal::Json json;
  if (bytes->starts_with("glTF")) {
    auto glb = modal::parse_glb(std::as_bytes(std::span(*bytes)), path.string());
    if (!glb) return false;
    json = std::move(glb->json);
  } else {
    auto text = modal::parse_gltf_json(*bytes, path.string());
    if (!text) return false;
    json = *std::move(text);
  }
  const modal::JsonPlace root(&json, "");
  if (root["extensions"]["KHR_audio_rigid_bodies"]["acousticSurfaces"].size() > 0) return true;
  if (root["animations"].size() == 0) return false;
  const auto glb = modal::parse_gltf(std::as_bytes(std::span(*bytes)), path.string(), modal::files_beside(path));
  return glb && scene::has_mesh_bodies(*glb);
}

ExitCode bake_scene(const SceneBake& request, const std::stop_token& stop) { return SceneBaker(request, stop).run(); }

}  // namespace ringdown::cli
