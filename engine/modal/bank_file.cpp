#include "engine/modal/bank_file.h"

#include "engine/base/atomic_file.h"
#include "engine/base/file_format.h"
#include "engine/base/output_file.h"
#include "engine/base/version.h"
#include "engine/base/within_memory.h"
#include "engine/gltf/glb.h"
#include "engine/gltf/gltf_file.h"
#include "engine/modal/bank_extras.h"
#include "engine/modal/bank_model.h"
#include "engine/modal/fracture/fracture_file.h"
#include "engine/modal/levels/levels_file.h"
#include "engine/modal/scaled_bank.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

namespace ringdown::modal {
namespace {

constexpr const char* kExtension = "KHR_audio_rigid_bodies";
constexpr std::size_t kMaxTriangleCorners = 6 * kMaxPoints;
constexpr double kStepsPerRms = 64;
constexpr float kMaxRoundedShape = 1e24F;  // kg^-1/2; no real body comes near, but a damaged file may
static_assert(kMaxUnpackedBytes == kMaxBankFileBytes);
constexpr std::size_t kMaxModelNumber = 999'999'999;
constexpr double kMaxNodeScale = 1000;  // the smallest scale is its inverse: bells of a millimetre to a kilometre

std::vector<Vec3f> as_vectors(const std::vector<float>& values) {
  std::vector<Vec3f> vectors(values.size() / 3);
  std::memcpy(vectors.data(), values.data(), values.size() * sizeof(float));
  return vectors;
}

std::span<const float> as_floats(const std::vector<Vec3f>& vectors) {
  return {reinterpret_cast<const float*>(vectors.data()), 3 * vectors.size()};
}

// Reads a number that must lie in [low, high], or above `low` when `open`.
Result<void> read_number(const JsonPlace& field, double& target, double low, double high, bool open = false) {
  const auto value = field.number_or(target);
  if (!value) return fail(value);
  if (*value < low || (open && *value == low) || *value > high) {
    return field.wrong((open ? "more than " : "at least ") + Json(low).dump() +
                       (std::isinf(high) ? "" : ", at most " + Json(high).dump()));
  }
  target = *value;
  return {};
}

Result<std::optional<Material>> read_material(const JsonPlace& materials, const JsonPlace& reference) {
  if (!reference.present()) return std::nullopt;
  const auto number = reference.index();
  if (!number) return fail(number);
  const JsonPlace field = materials[*number];
  if (!field.present()) return reference.wrong("the number of an acoustic material in the file");
  Material material{.name = field["name"].text_or("")};
  for (const auto& outcome : {read_number(field["density"], material.density_kg_m3, 0, INFINITY),
                              read_number(field["youngsModulus"], material.youngs_modulus_pa, 0, INFINITY),
                              read_number(field["poissonRatio"], material.poisson_ratio, -1, 0.5, true),
                              read_number(field["alpha"], material.damping.alpha_per_s, 0, INFINITY),
                              read_number(field["beta"], material.damping.beta_s, 0, INFINITY)}) {
    if (!outcome) return fail(outcome);
  }
  return material;
}

Result<std::optional<MassProperties>> read_mass(const JsonPlace& field) {
  if (!field.present()) return std::nullopt;
  if (!field["mass"].present()) return field["mass"].wrong("a mass in kg");
  MassProperties mass;
  std::array<double, 3> center{}, inertia{};
  for (const auto& outcome :
       {read_number(field["mass"], mass.mass_kg, 0, INFINITY, true), field["centerOfMass"].numbers(center),
        field["inertiaDiagonal"].numbers(inertia), field["inertiaOrientation"].numbers(mass.orientation)}) {
    if (!outcome) return fail(outcome);
  }
  mass.center_of_mass_m = {center[0], center[1], center[2]};
  mass.inertia_kg_m2 = {inertia[0], inertia[1], inertia[2]};
  if (*std::min_element(inertia.begin(), inertia.end()) < 0) return field["inertiaDiagonal"].wrong("at least 0");
  double norm = 0;
  for (const double q : mass.orientation) norm += q * q;
  if (std::abs(norm - 1) > 1e-3) return field["inertiaOrientation"].wrong("a unit quaternion");
  return mass;
}

// The model that a node plays, with the node's uniform scale and gain.
struct Instance {
  std::size_t model = 0;
  double scale = 1, gain = 1;
  std::string name;
};

Result<Instance> find_instance(const Glb& glb) {
  const JsonPlace nodes = glb.root()["nodes"];
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const JsonPlace extension = nodes[i]["extensions"][kExtension];
    const JsonPlace reference = extension["modalModel"];
    if (!reference.present()) continue;
    const auto model = reference.index();
    if (!model) return fail(model);
    std::array<double, 3> scale{1, 1, 1};
    if (const auto read = nodes[i]["scale"].numbers(scale); !read) return fail(read);
    if (scale[0] < 1 / kMaxNodeScale || scale[0] > kMaxNodeScale || scale[1] != scale[0] || scale[2] != scale[0]) {
      return nodes[i]["scale"].wrong("three equal numbers from 0.001 to 1000: an uneven scale needs a new bake");
    }
    Instance instance{.model = *model, .scale = scale[0], .name = nodes[i]["name"].text_or("")};
    if (const auto read = read_number(extension["gain"], instance.gain, 0, INFINITY); !read) return fail(read);
    return instance;
  }
  return Instance{};
}

Result<void> read_modes(const Glb& glb, const JsonPlace& model, Bank& bank) {
  const auto frequencies = read_floats(glb, model["frequencies"], 1, kMaxModes);
  if (!frequencies) return fail(frequencies);
  const auto decays = read_floats(glb, model["decayRates"], 1, kMaxModes);
  if (!decays) return fail(decays);
  const auto positions = read_floats(glb, model["positions"], 3, kMaxPoints);
  if (!positions) return fail(positions);
  const std::size_t modes = frequencies->size(), points = positions->size() / 3;
  if (decays->size() != modes) {
    return fail(ErrorKind::bad_input, "{} has {} elements, expected {} as in frequencies", model["decayRates"].path(),
                decays->size(), modes);
  }
  const auto shapes = read_floats(glb, model["shapes"], 3, kMaxModes * kMaxPoints);
  if (!shapes) return fail(shapes);
  if (shapes->size() != 3 * modes * points) {
    return fail(ErrorKind::bad_input, "{} has {} elements, expected {} (modes times points)", model["shapes"].path(),
                shapes->size() / 3, modes * points);
  }
  for (std::size_t m = 0; m < modes; ++m) {
    if ((*frequencies)[m] <= 0) {
      return fail(ErrorKind::bad_input, "{}: element {} is not above 0 Hz", model["frequencies"].path(), m);
    }
    if ((*decays)[m] < 0) return fail(ErrorKind::bad_input, "{}: element {} is below 0", model["decayRates"].path(), m);
  }
  bank.frequency_hz.assign(frequencies->begin(), frequencies->end());
  bank.decay_per_s.assign(decays->begin(), decays->end());
  bank.positions = as_vectors(*positions);
  bank.shapes = as_vectors(*shapes);
  return {};
}

Result<void> read_triangles(const Glb& glb, const JsonPlace& reference, Bank& bank) {
  if (!reference.present()) return {};
  const auto corners = read_indices(glb, reference, kMaxTriangleCorners);
  if (!corners) return fail(corners);
  if (corners->size() % 3 != 0) return reference.wrong("an accessor whose count is a multiple of 3");
  for (std::size_t i = 0; i < corners->size(); ++i) {
    if ((*corners)[i] >= bank.point_count()) {
      return fail(ErrorKind::bad_input, "{}: element {} is {}, but there are only {} positions", reference.path(), i,
                  (*corners)[i], bank.point_count());
    }
  }
  bank.triangles.resize(corners->size() / 3);
  std::memcpy(bank.triangles.data(), corners->data(), corners->size() * sizeof(std::uint32_t));
  return {};
}

// The largest power of two that is at most 1 / kStepsPerRms of the rms of the numbers.
int step_exponent(std::span<const double> numbers) {
  double sum = 0;
  for (const double x : numbers) sum += x * x;
  const double step = std::sqrt(sum / static_cast<double>(numbers.size())) / kStepsPerRms;
  return step > 0 ? std::clamp(std::ilogb(step), -kMaxExponent, kMaxExponent) : -kMaxExponent;
}

// Rounds one mode's shape to whole multiples of its step. If rounding raises the rms so much that the step would be
// twice as large, the larger step is used, so that rounding a second time changes nothing.
std::vector<std::uint32_t> rounded(std::span<const float> shape) {
  std::vector<double> numbers(shape.begin(), shape.end());
  std::vector<std::int32_t> whole(shape.size());
  int exponent = 0, wanted = step_exponent(numbers);
  do {
    exponent = wanted;
    const double step = std::ldexp(1.0, exponent);
    for (std::size_t i = 0; i < shape.size(); ++i) {
      whole[i] = static_cast<std::int32_t>(std::lround(static_cast<double>(shape[i]) / step));
      numbers[i] = whole[i] * step;
    }
    wanted = step_exponent(numbers);
  } while (wanted > exponent);
  return exponential_words(whole, exponent);
}

// Adds shapes of `numbers` numbers each.
std::size_t add_rounded_shapes(GlbWriter& writer, std::span<const float> shapes, std::size_t numbers) {
  const auto fits = [](float x) { return std::abs(x) < kMaxRoundedShape; };
  if (!std::all_of(shapes.begin(), shapes.end(), fits)) return writer.add_packed_floats(shapes, 3);
  std::vector<std::uint32_t> words;
  words.reserve(shapes.size());
  for (std::size_t at = 0; at < shapes.size(); at += numbers) {
    const std::vector<std::uint32_t> mode = rounded(shapes.subspan(at, numbers));
    words.insert(words.end(), mode.begin(), mode.end());
  }
  return writer.add_exponentials(words, 3);
}

std::size_t add_shapes(GlbWriter& writer, std::span<const float> shapes, std::size_t points, bool packed) {
  return packed ? add_rounded_shapes(writer, shapes, 3 * points) : writer.add_floats(shapes, 3);
}

Json mass_json(const MassProperties& mass) {
  const auto triple = [](Vec3 v) { return Json::array({v.x, v.y, v.z}); };
  return {{"mass", mass.mass_kg},
          {"centerOfMass", triple(mass.center_of_mass_m)},
          {"inertiaDiagonal", triple(mass.inertia_kg_m2)},
          {"inertiaOrientation", mass.orientation}};
}

Json material_json(const Bank& bank) {
  const Material& material = *bank.material;
  Json json = {{"name", material.name},
               {"density", material.density_kg_m3},
               {"youngsModulus", material.youngs_modulus_pa},
               {"poissonRatio", material.poisson_ratio}};
  if (rayleigh_reproduces_material(bank)) {
    json["alpha"] = material.damping.alpha_per_s;
    json["beta"] = material.damping.beta_s;
  }
  return json;
}

Result<Bank> read_model(const Glb& glb, const JsonPlace& model, const std::string& name) {
  const JsonPlace extension = glb.root()["extensions"][kExtension];
  const auto version = model["extras"]["ringdown"]["version"].index().value_or(1);
  if (version > kBankVersion) {
    return fail(ErrorKind::bad_input,
                "{} is a bank of version {}, and this program, Ringdown {}, reads up to {}; a later Ringdown plays it",
                glb.name, version, kVersion, kBankVersion);
  }
  Bank bank{.name = model["name"].text_or(name)};
  if (const auto read = read_modes(glb, model, bank); !read) return fail(read);
  if (const auto read = read_triangles(glb, model["indices"], bank); !read) return fail(read);
  auto material = read_material(extension["acousticMaterials"], model["material"]);
  if (!material) return fail(material);
  auto mass = read_mass(model["massProperties"]);
  if (!mass) return fail(mass);
  bank.material = std::move(*material);
  bank.mass = *mass;
  if (const auto read = read_extras(glb, model["extras"]["ringdown"], bank); !read) return fail(read);
  bank.provenance.generator = glb.root()["asset"]["generator"].text_or("");
  return bank;
}

// Reads a piece without modes, which is of the body's material.
Result<Bank> read_silent_piece(const Glb& glb, const JsonPlace& piece, const std::optional<Material>& material) {
  Bank bank{.name = piece["name"].text_or(""), .material = material};
  const auto positions = read_floats(glb, piece["positions"], 3, kMaxPoints);
  if (!positions) return fail(positions);
  bank.positions = as_vectors(*positions);
  if (const auto read = read_triangles(glb, piece["indices"], bank); !read) return fail(read);
  auto mass = read_mass(piece["massProperties"]);
  if (!mass) return fail(mass);
  bank.mass = *mass;
  return bank;
}

Result<void> read_pieces(const Glb& glb, const JsonPlace& fracture, Bank& bank) {
  if (!fracture.present()) return {};
  const JsonPlace models = glb.root()["extensions"][kExtension]["modalModels"];
  const PieceReaders readers{
      .model = [&](std::size_t number) -> Result<Bank> {
        if (!models[number].present()) return models.wrong(formatted("a model {}", number));
        return read_model(glb, models[number], "");
      },
      .silent = [&](const JsonPlace& piece) { return read_silent_piece(glb, piece, bank.material); }};
  auto read = read_fracture(glb, fracture, bank, readers);
  if (!read) return fail(read);
  bank.fracture = std::make_shared<const Fracture>(std::move(*read));
  return {};
}

Result<Bank> piece_of(const Fracture* fracture, std::size_t pattern, std::size_t number, const std::string& name) {
  if (!fracture || pattern >= fracture->patterns.size() || number >= fracture->patterns[pattern].pieces.size())
    return fail(ErrorKind::bad_input, "{} has no piece {} in a pattern {}", name, number, pattern);
  Bank piece = fracture->patterns[pattern].pieces[number].bank;
  piece.fracture = fracture_of_piece(*fracture, pattern, number);
  return piece;
}

Result<Bank> bank_in(std::span<const std::byte> bytes, const std::string& name, const ModelChoice& chosen,
                     const ReadBeside& read_beside) {
  const auto glb = read_beside ? parse_gltf(bytes, name, read_beside) : parse_glb(bytes, name);
  if (!glb) return fail(glb);
  const JsonPlace extension = glb->root()["extensions"][kExtension];
  if (extension["modalModels"].size() == 0) {
    return fail(ErrorKind::bad_input, "{} holds no modal model (extension {}); make one with `ringdown bake`", name,
                kExtension);
  }
  const auto instance =
      chosen.number && !chosen.piece ? Result<Instance>(Instance{.model = *chosen.number}) : find_instance(*glb);
  if (!instance) return fail(instance);
  const JsonPlace model = extension["modalModels"][instance->model];
  if (!model.present())
    return fail(ErrorKind::bad_input, "{}: a node plays modal model {}, which the file does not have", name,
                instance->model);
  auto read = read_model(*glb, model, instance->name);
  if (!read) return read;
  Bank& bank = *read;
  bank.gain = instance->gain;
  if (const auto pieces = read_pieces(*glb, model["extras"]["ringdown"]["fracture"], bank); !pieces)
    return fail(pieces);
  if (const JsonPlace field = model["extras"]["ringdown"]["levels"]; field.present()) {
    auto levels = read_levels(*glb, field, bank);
    if (!levels) return fail(levels);
    bank.levels = std::make_shared<const LiquidLevels>(std::move(*levels));
  }
  if (chosen.scale != 1) spread_points(bank, chosen.scale);
  if (instance->scale != 1) {
    if (const auto scaled =
            scale_size(bank, instance->scale, name + ": at the node's scale of " + Json(instance->scale).dump());
        !scaled)
      return fail(scaled);
  }
  if (!chosen.piece) return bank;
  auto piece = piece_of(bank.fracture.get(), *chosen.number, *chosen.piece, name);
  if (piece) piece->gain = bank.gain;
  return piece;
}

}  // namespace

BankPath split_bank_path(const std::filesystem::path& path) {
  const std::string text = path.string();
  const std::size_t mark = text.rfind('#');
  if (mark == std::string::npos) return {path, {}};
  BankPath split{text.substr(0, mark), {0}};
  auto& [model, factor, piece] = split.model;
  const std::string file = split.file.string();
  const char *at = text.data() + mark + 1, *const end = text.data() + text.size();
  auto number = std::from_chars(at, end, *model);
  bool good = number.ec == std::errc() && *model <= kMaxModelNumber;
  if (good && number.ptr != end && *number.ptr == '.') {
    number = std::from_chars(number.ptr + 1, end, piece.emplace());
    good = number.ec == std::errc() && *piece <= kMaxModelNumber;
  }
  if (good && number.ptr != end) {
    const auto scale = std::from_chars(number.ptr + 1, end, factor);
    good = *number.ptr == '@' && scale.ec == std::errc() && scale.ptr == end && kBankPathScale.holds(factor);
  }
  return good && is_of_kind(split.file, FileKind::gltf) ? split : BankPath{path, {}};
}

std::filesystem::path bank_path(const BankPath& path) {
  const auto& [number, scale, piece] = path.model;
  if (!number) return path.file;
  std::string text = formatted("{}#{}", path.file.string(), *number);
  if (piece) text += formatted(".{}", *piece);
  return scale == 1 ? text : text + "@" + Json(scale).dump();
}

Result<Bank> parse_bank(std::span<const std::byte> bytes, const std::string& name, const ModelChoice& model,
                        const ReadBeside& read_beside) {
  return within_memory("read " + name, [&] { return bank_in(bytes, name, model, read_beside); });
}

Result<Bank> read_bank(const std::filesystem::path& path) {
  const auto [file, model] = split_bank_path(path);
  const auto text = read_whole_file(file, kMaxBankFileBytes);
  if (!text) return fail(text);
  const bool is_text = has_ending(file, ".gltf");
  return parse_bank(std::as_bytes(std::span(*text)), path.string(), model, is_text ? files_beside(file) : ReadBeside());
}

namespace {

// Adds the surface of a bank to a document.
struct SurfaceWriter {
  GlbWriter& writer;
  bool packed = false;

  std::size_t add_positions(const Bank& bank) const {
    const auto add = packed ? &GlbWriter::add_packed_floats : &GlbWriter::add_floats;
    return (writer.*add)(as_floats(bank.positions), 3, GlbWriter::Use::vertices);
  }

  // Adds the bank's triangles, if it has any, and names them in `owner`, the JSON of a model or a piece. Returns the
  // mesh primitive of the bank's surface.
  Json add_triangles(const Bank& bank, Json& owner) const {
    Json primitive = {{"attributes", {{"POSITION", owner["positions"]}}}, {"mode", 0}};
    if (bank.triangles.empty()) return primitive;
    const std::span corners(bank.triangles.front().data(), 3 * bank.triangles.size());
    owner["indices"] = primitive["indices"] = packed ? writer.add_packed_indices(corners) : writer.add_indices(corners);
    primitive["mode"] = 4;
    return primitive;
  }
};

}  // namespace

WrittenModel add_model(GlbWriter& writer, const Bank& bank, bool packed) {
  const std::vector<float> frequencies(bank.frequency_hz.begin(), bank.frequency_hz.end());
  const std::vector<float> decays(bank.decay_per_s.begin(), bank.decay_per_s.end());
  const SurfaceWriter surface{writer, packed};
  const std::size_t positions = surface.add_positions(bank);
  WrittenModel written;
  written.model = {{"name", bank.name},
                   {"positions", positions},
                   {"frequencies", writer.add_floats(frequencies, 1)},
                   {"decayRates", writer.add_floats(decays, 1)},
                   {"shapes", add_shapes(writer, as_floats(bank.shapes), bank.point_count(), packed)},
                   {"extras", {{"ringdown", extras_json(bank, writer)}}}};
  written.primitive = surface.add_triangles(bank, written.model);
  if (bank.material) written.material = material_json(bank);
  if (bank.mass) written.model["massProperties"] = mass_json(*bank.mass);
  return written;
}

Result<void> write_bank(const Bank& bank, const std::filesystem::path& path, std::string_view input_hash,
                        Compression compression) {
  return write_output(path, to_glb(bank, input_hash, compression));
}

namespace {

// Collects the models, nodes and meshes of a bank's document.
struct Document {
  GlbWriter writer;
  bool packed = false;
  Json models = Json::array(), nodes = Json::array(), meshes = Json::array(), materials = Json::array();

  // Adds a node with the mesh, and returns the node's number.
  std::size_t add_node(const std::string& name, Json primitive) {
    nodes.push_back({{"name", name}, {"mesh", meshes.size()}});
    meshes.push_back({{"name", name}, {"primitives", Json::array({std::move(primitive)})}});
    return nodes.size() - 1;
  }

  // Adds the bank's model and a node that plays it. All models of a document have its first material.
  Json& add_bank(const Bank& bank) {
    auto [model, primitive, material] = add_model(writer, bank, packed);
    if (material && materials.empty()) materials.push_back(std::move(*material));
    if (bank.material) model["material"] = 0;
    const std::size_t node = add_node(bank.name, std::move(primitive));
    nodes[node]["extensions"][kExtension] = {{"modalModel", models.size()}, {"gain", bank.gain}};
    models.push_back(std::move(model));
    return models.back();
  }

  // Adds a piece of the body, and returns the JSON that names it.
  Json add_piece(const PieceBank& piece) {
    if (piece.bank.mode_count() > 0) {
      add_bank(piece.bank);
      return {{"model", models.size() - 1}};
    }
    const SurfaceWriter surface{writer, packed};
    Json json = {{"name", piece.bank.name},
                 {"positions", surface.add_positions(piece.bank)},
                 {"massProperties", mass_json(*piece.bank.mass)}};
    add_node(piece.bank.name, surface.add_triangles(piece.bank, json));
    return json;
  }
};

}  // namespace

std::vector<std::byte> to_glb(const Bank& bank, std::string_view input_hash, Compression compression) {
  Document document{.packed = compression == Compression::meshopt};
  document.add_bank(bank);
  Json scenes = Json::array({{{"nodes", Json::array({0})}}});
  Json extras;
  if (!input_hash.empty()) extras["inputHash"] = input_hash;
  if (bank.fracture) {
    extras["fracture"] = fracture_json(*bank.fracture, document.writer, document.packed,
                                       [&document](const PieceBank& piece) { return document.add_piece(piece); });
    Json pieces = Json::array();
    for (std::size_t node = 1; node < document.nodes.size(); ++node) pieces.push_back(node);
    scenes.push_back({{"name", "pieces"}, {"nodes", std::move(pieces)}});
  }
  if (bank.levels) {
    extras["levels"] = levels_json(*bank.levels, document.writer, document.packed, [&](std::span<const float> shapes) {
      return add_shapes(document.writer, shapes, bank.point_count(), document.packed);
    });
  }
  if (!extras.is_null()) document.models.front()["extras"]["ringdown"].update(extras);
  Json extension = {{"modalModels", std::move(document.models)}};
  if (!document.materials.empty()) extension["acousticMaterials"] = std::move(document.materials);
  return std::move(document.writer)
      .finish({{"asset", {{"version", "2.0"}, {"generator", bank.provenance.generator}}},
               {"extensionsUsed", Json::array({kExtension})},
               {"extensions", {{kExtension, std::move(extension)}}},
               {"scene", 0},
               {"scenes", std::move(scenes)},
               {"nodes", std::move(document.nodes)},
               {"meshes", std::move(document.meshes)}});
}

std::optional<std::string> read_input_hash(const std::filesystem::path& path) {
  const Result<std::string> text = read_whole_file(path, kMaxBankFileBytes);
  if (!text) return std::nullopt;
  const Result<Glb> glb = parse_glb(std::as_bytes(std::span(*text)), path.string());
  if (!glb) return std::nullopt;
  const JsonPlace model = glb->root()["extensions"][kExtension]["modalModels"][0];
  const std::string hash = model["extras"]["ringdown"]["inputHash"].text_or("");
  return hash.empty() ? std::nullopt : std::optional(hash);
}

}  // namespace ringdown::modal
