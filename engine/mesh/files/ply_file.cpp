#include "engine/mesh/files/surface_formats.h"
#include "engine/mesh/files/text_lines.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

namespace ringdown::mesh {
namespace {

enum class Coding { text, little_endian, big_endian };
enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Type> type_of(std::string_view word) {
  constexpr std::array<std::pair<const char*, Type>, 16> kTypes = {{{"char", Type::int8},
                                                                    {"int8", Type::int8},
                                                                    {"uchar", Type::uint8},
                                                                    {"uint8", Type::uint8},
                                                                    {"short", Type::int16},
                                                                    {"int16", Type::int16},
                                                                    {"ushort", Type::uint16},
                                                                    {"uint16", Type::uint16},
                                                                    {"int", Type::int32},
                                                                    {"int32", Type::int32},
                                                                    {"uint", Type::uint32},
                                                                    {"uint32", Type::uint32},
                                                                    {"float", Type::float32},
                                                                    {"float32", Type::float32},
                                                                    {"double", Type::float64},
                                                                    {"float64", Type::float64}}};
  const auto* const found =
      std::ranges::find(kTypes, word, [](const auto& row) { return std::string_view(row.first); });
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

struct PlyProperty {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count;  // of a list
};

struct ElementKind {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  Coding coding = Coding::text;
  std::vector<ElementKind> kinds;
  std::size_t length = 0;  // bytes, with the end of its last line
};

Result<PlyProperty> read_property(const TextLines& lines) {
  const auto& words = lines.words();
  const bool list = words.size() == 5 && words[1] == "list";
  if (!list && words.size() != 3) return lines.wrong("a property should have a type and a name");
  const auto type = type_of(words[list ? 3 : 1]), count = list ? type_of(words[2]) : std::nullopt;
  if (!type || (list && !count)) return lines.wrong("the property has a type that PLY does not have");
  return PlyProperty{std::string(words.back()), *type, count};
}

Result<PlyHeader> read_header(std::string_view content, const std::string& name) {
  PlyHeader header;
  TextLines lines(content, name, TextLines::kBlanks);
  bool has_format = false;
  if (lines.next().empty() || lines.word() != "ply")
    return fail(ErrorKind::bad_input, name + " is not a PLY file: it does not begin with the line \"ply\"");
  while (!lines.next().empty()) {
    const std::string_view word = lines.word();
    const std::string_view second = lines.words().size() > 1 ? lines.words()[1] : "";
    if (word == "format") {
      has_format = second == "ascii" || second == "binary_little_endian" || second == "binary_big_endian";
      if (!has_format) return lines.wrong("the format should be ascii, binary_little_endian or binary_big_endian");
      header.coding = second == "ascii"               ? Coding::text
                      : second == "binary_big_endian" ? Coding::big_endian
                                                      : Coding::little_endian;
    } else if (word == "element") {
      ElementKind& kind = header.kinds.emplace_back();
      kind.name = second;
      if (!lines.read(2, kind.count)) return lines.wrong("an element should have a name and a number");
    } else if (word == "property") {
      Result<PlyProperty> property = read_property(lines);
      if (!property) return fail(property);
      if (header.kinds.empty()) return lines.wrong("a property should follow an element");
      header.kinds.back().properties.push_back(std::move(*property));
    } else if (word == "end_header") {
      header.length = content.size() - lines.characters_left();
      if (!has_format) return lines.wrong("the header does not state its format");
      return header;
    } else if (word != "comment" && word != "obj_info") {
      return lines.wrong("a line of the header should begin with element, property, comment or end_header");
    }
  }
  return lines.wrong("the header has no end (end_header)");
}

// The values after the header, one after the other.
class PlyValues {
 public:
  PlyValues(std::string_view content, Coding coding) : content_(content), coding_(coding) {}

  // False at the end, and at what is no number.
  bool read(Type type, double& value) { return coding_ == Coding::text ? read_word(value) : read_bytes(type, value); }

 private:
  bool read_word(double& value) {
    constexpr std::string_view kBetween = " \t\r\n\f\v";
    at_ = content_.find_first_not_of(kBetween, at_);
    if (at_ == content_.npos) return false;
    const std::size_t end = std::min(content_.find_first_of(kBetween, at_), content_.size());
    const std::string_view word = content_.substr(at_, end - at_);
    at_ = end;
    return TextLines::read_word(word, value);
  }

  template <class Number>
  bool take(double& value) {
    if (content_.size() - at_ < sizeof(Number)) return false;
    std::array<char, sizeof(Number)> bytes{};
    std::memcpy(bytes.data(), content_.data() + at_, bytes.size());
    if (coding_ == Coding::big_endian) std::ranges::reverse(bytes);
    Number number;
    std::memcpy(&number, bytes.data(), sizeof number);
    value = static_cast<double>(number);
    at_ += sizeof number;
    return true;
  }

  bool read_bytes(Type type, double& value) {
    switch (type) {
      case Type::int8:
        return take<std::int8_t>(value);
      case Type::uint8:
        return take<std::uint8_t>(value);
      case Type::int16:
        return take<std::int16_t>(value);
      case Type::uint16:
        return take<std::uint16_t>(value);
      case Type::int32:
        return take<std::int32_t>(value);
      case Type::uint32:
        return take<std::uint32_t>(value);
      case Type::float32:
        return take<float>(value);
      case Type::float64:
        return take<double>(value);
    }
    return false;
  }

  std::string_view content_;
  Coding coding_;
  std::size_t at_ = 0;
};

class PlyReader {
 public:
  PlyReader(const PlyHeader& header, std::string_view content, std::string name)
      : header_(header), values_(content.substr(header.length), header.coding), name_(std::move(name)) {}

  Result<TriangleSoup> read() {
    for (const ElementKind& kind : header_.kinds) {
      if (kind.name == "tristrips")
        return fail(ErrorKind::bad_input,
                    name_ + ": its triangles are strips, which are not supported; save it with faces");
      if (kind.properties.empty()) continue;
      for (std::uint64_t n = 0; n < kind.count; ++n) {
        if (auto good = read_element(kind, n); !good) return fail(good);
      }
    }
    for (const auto& [first, count] : faces_) {
      const std::span<const std::int32_t> corners(corners_.data() + first, count);
      const auto unknown = std::ranges::find_if(corners, [this](std::int32_t corner) {
        return corner < 0 || static_cast<std::size_t>(corner) >= soup_.points.size();
      });
      if (unknown != corners.end()) {
        return fail(ErrorKind::bad_input, "{}: a face names point {}, and the file has {}", name_, *unknown,
                    soup_.points.size());
      }
      add_polygon(soup_, corners);
    }
    if (is_single_) soup_.rounding = float_spacing(soup_.points);
    return std::move(soup_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> wrong(const ElementKind& kind, std::uint64_t n, const std::string& what) const {
    return fail(ErrorKind::bad_input, "{}: {} {} of {} {}", name_, kind.name, n, kind.count, what);
  }

  Result<void> read_element(const ElementKind& kind, std::uint64_t n) {
    const bool is_point = kind.name == "vertex", is_face = kind.name == "face";
    Eigen::RowVector3d at = Eigen::RowVector3d::Zero();
    for (const PlyProperty& property : kind.properties) {
      double count = 1;
      if (property.count && !values_.read(*property.count, count)) return wrong(kind, n, "is not whole");
      if (!(count >= 0)) return wrong(kind, n, "has a list with a negative length");
      const bool is_corners = property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
      const std::size_t first = corners_.size();
      for (double k = 0; k < count; ++k) {
        double value = 0;
        if (!values_.read(property.type, value))
          return wrong(kind, n, "is incomplete, or has something that is not a number");
        if (is_face && is_corners) corners_.push_back(whole(value));
        if (is_point && !property.count) set(at, property, value);
      }
      if (is_face && is_corners) faces_.emplace_back(first, corners_.size() - first);
    }
    if (is_point) soup_.points.push_back(at);
    return {};
  }

  static std::int32_t whole(double value) {
    const bool fits = value >= 0 && value <= std::numeric_limits<std::int32_t>::max();
    return fits ? static_cast<std::int32_t>(value) : -1;
  }

  void set(Eigen::RowVector3d& at, const PlyProperty& property, double value) {
    if (property.name.size() != 1 || property.name[0] < 'x' || property.name[0] > 'z') return;
    at[property.name[0] - 'x'] = value;
    is_single_ = is_single_ || (property.type == Type::float32 && header_.coding != Coding::text);
  }

  const PlyHeader& header_;
  PlyValues values_;
  std::string name_;
  TriangleSoup soup_;
  bool is_single_ = false;
  std::vector<std::int32_t> corners_;
  std::vector<std::pair<std::size_t, std::size_t>> faces_;  // the first of its corners, and their number
};

}  // namespace

Result<TriangleSoup> read_ply(std::string_view content, const std::string& name) {
  const Result<PlyHeader> header = read_header(content, name);
  if (!header) return fail(header);
  return PlyReader(*header, content, name).read();
}

}  // namespace ringdown::mesh
