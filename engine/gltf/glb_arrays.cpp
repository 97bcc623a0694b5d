#include "engine/gltf/glb.h"
#include "engine/gltf/glb_format.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace ringdown::modal {
namespace {

// The elements of an accessor with all bounds checked. They lie in the binary, or in `unpacked` if they were
// compressed.
struct Elements {
  std::vector<std::byte> unpacked;
  const std::byte* first = nullptr;
  std::size_t count = 0, stride = 0;
  std::size_t component_type = 0;
};

std::size_t component_size(std::size_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

// Returns the position in `names` of the field's text.
template <std::size_t N>
Result<std::size_t> choice(const JsonPlace& field, const std::array<const char*, N>& names) {
  const auto found = std::find(names.begin(), names.end(), field.text_or(""));
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  std::string expectation;
  for (const char* name : names) expectation += formatted("{}\"{}\"", expectation.empty() ? "" : " or ", name);
  return field.wrong(expectation);
}

const char* type_of_width(std::size_t width) {
  return width == 1 ? "SCALAR" : width == 2 ? "VEC2" : width == 3 ? "VEC3" : width == 4 ? "VEC4" : "MAT4";
}

// The type and number of the elements of an accessor, or of the indices or values of a sparse accessor.
struct Layout {
  std::size_t component_type = 0, width = 1, count = 0;

  [[nodiscard]] std::size_t bytes() const { return component_size(component_type) * width; }
};

// Returns a component as a number; normalized integers become fractions (glTF 2.0, section 3.11).
double component_at(const std::byte* at, std::size_t type, bool normalized) {
  const auto as = [at]<class Number>(Number number) {
    std::memcpy(&number, at, sizeof number);
    return static_cast<double>(number);
  };
  switch (type) {
    case kByte:
      return normalized ? std::max(as(std::int8_t{}) / 127, -1.0) : as(std::int8_t{});
    case kShort:
      return normalized ? std::max(as(std::int16_t{}) / 32767, -1.0) : as(std::int16_t{});
    case kUnsignedByte:
      return as(std::uint8_t{}) / (normalized ? 255 : 1);
    case kUnsignedShort:
      return as(std::uint16_t{}) / (normalized ? 65535 : 1);
    case kUnsignedInt:
      return as(std::uint32_t{});
    default:
      return as(float{});
  }
}

void read_element(const Elements& elements, std::size_t element, std::size_t width, bool normalized, double* out) {
  const std::byte* at = elements.first + element * elements.stride;
  const std::size_t size = component_size(elements.component_type);
  for (std::size_t k = 0; k < width; ++k) out[k] = component_at(at + k * size, elements.component_type, normalized);
}

// Reads the arrays of a document.
struct ArrayReader {
  const Glb& glb;

  // Returns the bytes of the binary chunk that `slice` names: a buffer view, or the extension's object in one.
  Result<std::span<const std::byte>> bytes_of(const JsonPlace& slice) const {
    const auto buffer = slice["buffer"].index(), offset = slice["byteOffset"].index_or(0);
    const auto length = slice["byteLength"].index();
    for (const auto* value : {&buffer, &offset, &length}) {
      if (!*value) return fail(value->error());
    }
    if (*buffer != 0) return slice["buffer"].wrong("0, the file's own binary chunk");
    const JsonPlace chunk = glb.root()["buffers"][0];
    if (chunk["uri"].present()) return chunk["uri"].wrong("absent: the data must be inside the .glb file");
    if (*offset > glb.binary.size() || *length > glb.binary.size() - *offset) {
      return slice["byteLength"].wrong(formatted("inside the binary chunk of {} bytes", glb.binary.size()));
    }
    return glb.binary.subspan(*offset, *length);
  }

  // Returns the `length` bytes of a compressed buffer view. The view's own `buffer` is a placeholder and need not
  // exist.
  Result<std::vector<std::byte>> unpack_view(const JsonPlace& view, std::size_t length) const {
    const JsonPlace packing = view["extensions"][kMeshopt];
    const auto stream = bytes_of(packing);
    if (!stream) return fail(stream);
    const auto mode = choice(packing["mode"], kMeshoptModes);
    const auto filter =
        packing["filter"].present() ? choice(packing["filter"], kMeshoptFilters) : Result<std::size_t>(0);
    const auto count = packing["count"].index(), stride = packing["byteStride"].index();
    for (const auto* value : {&mode, &filter, &count, &stride}) {
      if (!*value) return fail(value->error());
    }
    const MeshoptLayout layout{.mode = static_cast<MeshoptMode>(*mode),
                               .filter = static_cast<MeshoptFilter>(*filter),
                               .count = *count,
                               .stride = *stride};
    if (!is_allowed(layout)) {
      return packing["byteStride"].wrong(formatted("what {} allows with this mode, filter and count", kMeshopt));
    }
    if (view["byteStride"].index_or(*stride).value_or(0) != *stride)
      return view["byteStride"].wrong(std::string("as in its ") + kMeshopt);
    // count * stride cannot overflow: count <= 10^15, stride <= 256.
    if (length != layout.bytes())
      return view["byteLength"].wrong(std::string("count times byteStride of its ") + kMeshopt);
    if (length > kMaxUnpackedBytes) return view["byteLength"].wrong(formatted("at most {}", kMaxUnpackedBytes));
    if (length / kMaxMeshoptRatio > stream->size()) {
      return packing["byteLength"].wrong(formatted("enough for the view's {} bytes", length));
    }
    std::vector<std::byte> elements(length);
    if (!unpack(layout, *stream, elements)) {
      return fail(ErrorKind::bad_input, packing.path() +
                                            ": the compressed data are damaged, or of a later version of the " +
                                            "codec; make the file again, or without compression");
    }
    return elements;
  }

  // Finds the elements in the buffer view that `holder` names.
  Result<Elements> locate_in_view(const JsonPlace& holder, const Layout& layout) const {
    const auto offset = holder["byteOffset"].index_or(0), view_number = holder["bufferView"].index();
    for (const auto* value : {&offset, &view_number}) {
      if (!*value) return fail(value->error());
    }
    const JsonPlace view = glb.root()["bufferViews"][*view_number];
    if (!view.present()) return holder["bufferView"].wrong("the number of a buffer view in the file");
    const std::size_t size = layout.bytes();
    const auto length = view["byteLength"].index();
    const auto stride = view["byteStride"].index_or(size);
    for (const auto* value : {&length, &stride}) {
      if (!*value) return fail(value->error());
    }
    if (*stride < size || *stride > 252) return view["byteStride"].wrong("from the element's size to 252");
    // count * stride cannot overflow: count <= limit <= 2^34, stride <= 252.
    if (*offset > *length || (layout.count - 1) * *stride + size > *length - *offset) {
      return holder["count"].wrong(formatted("small enough to fit its buffer view of {} bytes", *length));
    }
    Elements elements{.unpacked = {},
                      .first = nullptr,
                      .count = layout.count,
                      .stride = *stride,
                      .component_type = layout.component_type};
    if (view["extensions"][kMeshopt].present()) {
      auto unpacked = unpack_view(view, *length);
      if (!unpacked) return fail(unpacked);
      elements.unpacked = std::move(*unpacked);
      elements.first = elements.unpacked.data() + *offset;
    } else {
      const auto bytes = bytes_of(view);
      if (!bytes) return fail(bytes);
      elements.first = bytes->data() + *offset;
    }
    return elements;
  }

  Result<Layout> layout_of(const JsonPlace& reference, std::size_t width, std::size_t limit) const {
    const auto number = reference.index();
    if (!number) return fail(number);
    const JsonPlace accessor = glb.root()["accessors"][*number];
    if (!accessor.present()) return reference.wrong("the number of an accessor in the file");
    const std::string type = type_of_width(width);
    if (accessor["type"].text_or("") != type) return accessor["type"].wrong('"' + type + '"');
    const auto component = accessor["componentType"].index();
    const auto count = accessor["count"].index();
    for (const auto* value : {&component, &count}) {
      if (!*value) return fail(value->error());
    }
    if (*count < 1 || *count > limit) return accessor["count"].wrong(formatted("from 1 to {}", limit));
    if (component_size(*component) == 0) return accessor["componentType"].wrong("a glTF component type");
    return Layout{.component_type = *component, .width = width, .count = *count};
  }

  JsonPlace accessor_of(const JsonPlace& reference) const {
    return glb.root()["accessors"][reference.index().value_or(0)];
  }

  Result<Elements> locate(const JsonPlace& reference, std::size_t width, std::size_t limit) const {
    const auto layout = layout_of(reference, width, limit);
    if (!layout) return fail(layout);
    const JsonPlace accessor = accessor_of(reference);
    if (accessor["sparse"].present())
      return accessor["sparse"].wrong("absent: sparse accessors are not supported here");
    return locate_in_view(accessor, *layout);
  }

  // Replaces elements of `values` by those of a sparse accessor.
  Result<void> read_sparse(const JsonPlace& accessor, const Layout& layout, bool normalized,
                           std::vector<double>& values) const {
    const JsonPlace sparse = accessor["sparse"];
    const auto count = sparse["count"].index(), type = sparse["indices"]["componentType"].index();
    for (const auto* value : {&count, &type}) {
      if (!*value) return fail(value->error());
    }
    if (*count < 1 || *count > layout.count) return sparse["count"].wrong("from 1 to the accessor's count");
    if (*type != kUnsignedByte && *type != kUnsignedShort && *type != kUnsignedInt)
      return sparse["indices"]["componentType"].wrong("that of unsigned integers");
    const auto indices = locate_in_view(sparse["indices"], {.component_type = *type, .width = 1, .count = *count});
    const auto placed = locate_in_view(
        sparse["values"], {.component_type = layout.component_type, .width = layout.width, .count = *count});
    for (const auto* part : {&indices, &placed}) {
      if (!*part) return fail(part->error());
    }
    for (std::size_t k = 0; k < *count; ++k) {
      double index = 0;
      read_element(*indices, k, 1, false, &index);
      if (!(index < static_cast<double>(layout.count))) return sparse["indices"].wrong("numbers of elements");
      read_element(*placed, k, layout.width, normalized, &values[static_cast<std::size_t>(index) * layout.width]);
    }
    return {};
  }
};

}  // namespace

Result<std::vector<float>> read_floats(const Glb& glb, const JsonPlace& reference, std::size_t width,
                                       std::size_t limit) {
  const ArrayReader arrays{glb};
  const auto elements = arrays.locate(reference, width, limit);
  if (!elements) return fail(elements);
  if (elements->component_type != kFloat) return reference.wrong("an accessor of component type 5126 (FLOAT)");
  std::vector<float> values(elements->count * width);
  for (std::size_t i = 0; i < elements->count; ++i) {
    std::memcpy(&values[i * width], elements->first + i * elements->stride, width * sizeof(float));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      return fail(ErrorKind::bad_input, "{}: element {} is not a finite number", reference.path(), i / width);
    }
  }
  return values;
}

Result<std::vector<double>> read_numbers(const Glb& glb, const JsonPlace& reference, std::size_t width,
                                         std::size_t limit) {
  const ArrayReader arrays{glb};
  const auto layout = arrays.layout_of(reference, width, limit);
  if (!layout) return fail(layout);
  const JsonPlace accessor = arrays.accessor_of(reference);
  const JsonPlace flag = accessor["normalized"];
  const bool normalized = flag.present() && flag.json().is_boolean() && flag.json().get<bool>();
  std::vector<double> values;
  if (accessor["bufferView"].present()) {
    const auto elements = arrays.locate_in_view(accessor, *layout);
    if (!elements) return fail(elements);
    values.resize(layout->count * width);
    for (std::size_t i = 0; i < layout->count; ++i) read_element(*elements, i, width, normalized, &values[i * width]);
  }
  values.resize(layout->count * width, 0);
  if (accessor["sparse"].present()) {
    if (auto read = arrays.read_sparse(accessor, *layout, normalized, values); !read) return fail(read);
  }
  const auto wrong = std::ranges::find_if(values, [](double value) { return !std::isfinite(value); });
  if (wrong == values.end()) return values;
  return fail(ErrorKind::bad_input, "{}: element {} is not a finite number", reference.path(),
              static_cast<std::size_t>(wrong - values.begin()) / width);
}

Result<std::vector<std::uint32_t>> read_indices(const Glb& glb, const JsonPlace& reference, std::size_t limit) {
  const ArrayReader arrays{glb};
  const auto elements = arrays.locate(reference, 1, limit);
  if (!elements) return fail(elements);
  constexpr std::array kUnsigned = {kUnsignedByte, kUnsignedShort, kUnsignedInt};
  if (std::ranges::find(kUnsigned, elements->component_type) == kUnsigned.end())
    return reference.wrong("an accessor of unsigned integers");
  std::vector<std::uint32_t> values(elements->count, 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::memcpy(&values[i], elements->first + i * elements->stride, component_size(elements->component_type));
  }
  return values;
}

Result<std::vector<std::byte>> read_bytes(const Glb& glb, const JsonPlace& reference, std::size_t limit) {
  const ArrayReader arrays{glb};
  const auto elements = arrays.locate(reference, 1, limit);
  if (!elements) return fail(elements);
  if (elements->component_type != kUnsignedByte)
    return reference.wrong("an accessor of component type 5121 (UNSIGNED_BYTE)");
  std::vector<std::byte> bytes(elements->count);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = elements->first[i * elements->stride];
  return bytes;
}

Result<std::span<const std::byte>> read_view(const Glb& glb, const JsonPlace& reference) {
  const ArrayReader arrays{glb};
  const auto number = reference.index();
  if (!number) return fail(number);
  const JsonPlace view = glb.root()["bufferViews"][*number];
  if (!view.present() || view["extensions"][kMeshopt].present())
    return reference.wrong("the number of a buffer view in the file that is not compressed");
  return arrays.bytes_of(view);
}

}  // namespace ringdown::modal
