#include "engine/mesh/body_reader.h"

#include "engine/base/atomic_file.h"
#include "engine/base/content_cache.h"
#include "engine/base/file_format.h"
#include "engine/base/process/child_process.h"

#include <gmsh.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <unistd.h>

namespace ringdown::mesh {
namespace {

constexpr const char* kProgram = "ringdown-mesher";

// The value of an environment variable that is a number above 0, else `usual`.
double from_environment(const char* name, double usual) {
  const char* text = std::getenv(name);
  const double value = text == nullptr ? 0 : std::strtod(text, nullptr);
  return value > 0 && value < 1e9 ? value : usual;
}

// Half of the computer's memory, but not more than any mesh needs that can be solved.
HelperLimits limits_here() {
  constexpr double kMax_mib = 16384;
  const double all_mib =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1048576;
  HelperLimits limits;
  limits.processor_s = from_environment("RINGDOWN_MESH_SECONDS", limits.processor_s);
  const double mib = from_environment("RINGDOWN_MESH_MIB", std::min(kMax_mib, all_mib / 2));
  limits.memory_bytes = static_cast<std::uint64_t>(mib * 1048576);
  return limits;
}

std::string whole_number(double value) { return std::to_string(static_cast<long long>(value)); }

}  // namespace

BodyReader::BodyReader(std::filesystem::path path, std::filesystem::path cache)
    : path_(std::move(path)), cache_(std::move(cache)), limits_(limits_here()) {}

bool BodyReader::is_surface() const { return is_surface_file(path_); }
bool BodyReader::meshes() const { return is_surface() || is_geometry_file(path_); }

// Asking
//
// The reading process is started for the first question and kept for the next ones, because it keeps a surface that it
// has read and mended. It runs on one thread of BLAS: threads that start with the program would stay outside of its
// sandbox, and matrices are small here.
Result<void> BodyReader::start() {
  const Result<std::filesystem::path> program = find_beside(kProgram);
  if (!program) return fail(program);
  return helper_.start({program->string(), path_.string()}, {"OPENBLAS_NUM_THREADS=1", "OMP_NUM_THREADS=1"}, limits_);
}

Error BodyReader::why(const HelperAnswer& answer) const {
  const std::string cannot = "cannot read " + path_.string() + ": ";
  switch (answer.end) {
    case HelperEnd::stopped:
      return {ErrorKind::cancelled, "cancelled"};
    case HelperEnd::out_of_time:
      return {ErrorKind::too_large, cannot + "it was not done in " + whole_number(limits_.processor_s) +
                                        " s of processor time; simplify it, or set RINGDOWN_MESH_SECONDS to more"};
    case HelperEnd::out_of_memory:
      return {ErrorKind::no_memory, cannot + "that takes more than " +
                                        whole_number(static_cast<double>(limits_.memory_bytes >> 20)) +
                                        " MiB of memory; simplify it, or set RINGDOWN_MESH_MIB to more"};
    case HelperEnd::too_long:
      return {ErrorKind::too_large, cannot + "its mesh is larger than " +
                                        whole_number(static_cast<double>(limits_.answer_bytes >> 20)) +
                                        " MiB; choose a larger mesh size"};
    case HelperEnd::crashed:
      return {ErrorKind::bad_input, cannot + "its reader crashed (" + ::strsignal(answer.signal) +
                                        "); the file is damaged, or its name has the wrong ending"};
    case HelperEnd::answered:
    case HelperEnd::silent:
      break;
  }
  return {ErrorKind::bad_input,
          cannot + "its reader ended without an answer; the file is damaged, or its name has the wrong ending"};
}

Result<std::string> BodyReader::ask(Question question, const GmshOptions& options, const Progress& progress) {
  if (!helper_.running()) {
    if (auto started = start(); !started) return fail(started);
  }
  HelperAnswer answer = helper_.ask(packed(question, options), [&](std::string_view stage, double fraction) {
    return !progress || progress(stage.empty() ? "mesh" : stage, fraction);
  });
  if (answer.end != HelperEnd::answered) return fail(why(answer));
  if (answer.bytes.starts_with(kGood)) return answer.bytes.substr(1);
  Error error;
  const bool told = answer.bytes.starts_with(kBad) && unpack(std::string_view(answer.bytes).substr(1), error);
  return fail(told ? error : why({.end = HelperEnd::silent}));
}

template <class Answer>
Result<Answer> BodyReader::unpacked(const std::string& bytes) const {
  Answer answer;
  if (unpack(bytes, answer)) return answer;
  return fail(ErrorKind::bad_input, "cannot read " + path_.string() + ": its reader returned no valid mesh");
}

Result<const PreparedSurface*> BodyReader::surface(const GmshOptions& options, const Progress& progress) {
  if (surface_ && surface_options_ == surface_options(options)) return &*surface_;
  Result<PreparedSurface> read = ask(Question::kSurface, options, progress).and_then([this](const std::string& bytes) {
    return unpacked<PreparedSurface>(bytes);
  });
  if (!read) return fail(read);
  surface_ = std::move(*read);
  surface_options_ = surface_options(options);
  return &*surface_;
}

Result<Sketch> BodyReader::sketch(const GmshOptions& options, const Progress& progress) {
  if (!is_surface()) return through_cache<Sketch>("sketch", Question::kSketch, options, progress);
  const Result<std::string> bytes = ask(Question::kSketch, options, progress);
  if (!bytes) return fail(bytes);
  return unpacked<Sketch>(*bytes);
}

Result<Body> BodyReader::read(const GmshOptions& options, const Progress& progress) {
  return through_cache<Body>("mesh", Question::kBody, options, progress);
}

// The cache
//
// It keeps the bytes that the reading process gave back, and they are checked in the same way when they come from it.
namespace {

constexpr int kFormat = 13;                                    // of an entry, and of how bodies are made
constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;  // bytes; a larger file is read each time

// Words of gmsh's language and of mesh formats by which a result depends on more than the file and its parameters. One
// in a comment costs no more than meshing anew.
constexpr std::array kElsewhere = {"include", "merge",     "shapefromfile", "systemcall",  "onelab",
                                   "getenv",  "getstring", "getnumber",     "exists",      "rand",
                                   "cpu",     "memory",    "currentdir",    "absolutepath"};

bool looks_elsewhere(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::any_of(kElsewhere.begin(), kElsewhere.end(),
                     [&text](const char* word) { return text.find(word) != std::string::npos; });
}

// Every option by name: a new one that is not in the key does not compile.
ContentHash key_of(const std::filesystem::path& path, const std::string& text, const GmshOptions& options,
                   const std::vector<std::string>& part_texts) {
  const auto& [unit_m, mesh_size_m, edge_size_m, order, force_coarse, cavities, quick, wall_scale, parameters, parts] =
      options;
  ContentHasher hasher;
  hasher.value(kFormat).text(GMSH_API_VERSION).text(path.extension().string()).text(text);
  hasher.value(unit_m.value_or(0))
      .value(mesh_size_m)
      .value(edge_size_m)
      .value(order)
      .value(force_coarse)
      .value(cavities)
      .value(quick);
  if (wall_scale != 1) hasher.text("wall").value(wall_scale);
  for (const auto& [name, value] : parameters) hasher.text(name).value(value);
  for (std::size_t p = 0; p < parts.size(); ++p) hasher.text(parts[p]).text(part_texts[p]);
  return hasher.hash();
}

// Returns true where the content of the file says all that its body depends on.
bool stands_alone(const std::filesystem::path& path, const std::string& text) {
  const FileFormat* format = format_of(path);
  if (!format || format->companions == Companions::none) return true;
  return format->companions == Companions::includes && !looks_elsewhere(text);
}

// The content of a file and of its parts' surfaces says all; none where it does not, or cannot be read.
std::optional<ContentHash> key_of(const std::filesystem::path& path, const GmshOptions& options) {
  const Result<std::string> text = read_whole_file(path, kMaxFileBytes);
  if (!text || !stands_alone(path, *text)) return std::nullopt;
  std::vector<std::string> part_texts;
  for (const std::string& part : options.parts) {
    const std::filesystem::path file = path.parent_path() / part;
    Result<std::string> own = read_whole_file(file, kMaxFileBytes);
    if (!own || !stands_alone(file, *own)) return std::nullopt;
    part_texts.push_back(std::move(*own));
  }
  return key_of(path, *text, options, part_texts);
}

}  // namespace

template <class Answer>
Result<Answer> BodyReader::through_cache(std::string_view kind, Question question, const GmshOptions& options,
                                         const Progress& progress) {
  std::optional<ContentHash> key;
  if (!cache_.empty()) key = key_of(path_, options);
  Answer answer;
  if (key) {
    if (const auto kept = ContentCache(cache_).find(kind, *key); kept && unpack(*kept, answer)) return answer;
  }
  const Result<std::string> bytes = ask(question, options, progress);
  if (!bytes) return fail(bytes);
  Result<Answer> made = unpacked<Answer>(*bytes);
  if (made && key)
    (void)ContentCache(cache_).store(kind, *key, *bytes);  // a cache that cannot be written costs time only
  return made;
}

}  // namespace ringdown::mesh
