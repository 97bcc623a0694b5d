#include "protocol/bulk.h"

#include "protocol/convert.h"
#include "protocol/names.h"
#include "protocol/schema.h"

#include <bit>
#include <utility>

namespace ringdown::protocol {
namespace {

constexpr std::int32_t kNoVertex = -1;

// Takes 32-bit words off a record, checks each, and keeps the first complaint.
class RecordReader {
 public:
  explicit RecordReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  std::int32_t integer() {
    std::uint32_t word = 0;
    for (const std::byte byte : rest_.first(4)) word = word << 8 | std::to_integer<std::uint32_t>(byte);
    rest_ = rest_.subspan(4);
    return static_cast<std::int32_t>(word);
  }
  double number(const ArgumentSpec& spec) {
    const Value value = check(spec, std::bit_cast<float>(integer()));
    return complaint_.empty() ? std::get<double>(value) : 0;
  }
  Value check(const ArgumentSpec& spec, const wire::Argument& argument) {
    auto value = convert(spec, argument);
    if (value) return *std::move(value);
    if (complaint_.empty()) complaint_ = formatted("({}) {}", spec.name, value.error().message);
    return {};
  }
  [[nodiscard]] const std::string& complaint() const { return complaint_; }

 private:
  std::span<const std::byte> rest_;
  std::string complaint_;
};

const std::vector<ArgumentSpec>& arguments_of(std::string_view address) { return (*find_address(address))->arguments; }

BulkStrike read_strike(RecordReader& record) {
  static const std::vector<ArgumentSpec> strike = arguments_of("/object/0/strike");
  static const ArgumentSpec vertex = arguments_of("/object/0/strike_vertex")[1];
  static const ArgumentSpec delay{.name = "delay", .unit = "s", .min = 0, .max = kMaxDelay_s};
  BulkStrike read;
  const std::int32_t object = record.integer(), at = record.integer();
  record.check(strike[0], object);
  read.object = static_cast<std::uint32_t>(object);
  if (at != kNoVertex) {
    record.check(vertex, at);
    read.vertex = static_cast<std::uint32_t>(at);
  }
  double* const numbers[] = {&read.point_m.x,    &read.point_m.y,    &read.point_m.z,     &read.impulse_ns.x,
                             &read.impulse_ns.y, &read.impulse_ns.z, &read.contact_time_s};
  for (std::size_t i = 0; i < std::size(numbers); ++i) *numbers[i] = record.number(strike[i + 1]);
  read.delay_s = record.number(delay);
  return read;
}

BulkPose read_pose(RecordReader& record) {
  static const std::vector<ArgumentSpec> pose = arguments_of("/object/0/pose");
  static const ArgumentSpec delay{.name = "delay", .unit = "s", .min = 0, .max = kMaxDelay_s};
  BulkPose read;
  const std::int32_t object = record.integer();
  record.check(pose[0], object);
  read.object = static_cast<std::uint32_t>(object);
  Vec3& p = read.pose.position_m;
  Rotation& q = read.pose.rotation;
  double* const numbers[] = {&p.x, &p.y, &p.z, &q.w, &q.x, &q.y, &q.z};
  for (std::size_t i = 0; i < std::size(numbers); ++i) *numbers[i] = record.number(pose[i + 1]);
  read.delay_s = record.number(delay);
  return read;
}

// All records of a blob, or a sentence about the first wrong one.
template <class Record>
Result<std::vector<Record>> decode(const wire::Blob& records, std::size_t bytes, Record (*read)(RecordReader&)) {
  std::vector<Record> all;
  all.reserve(records.size() / bytes);
  for (std::size_t at = 0; at + bytes <= records.size(); at += bytes) {
    RecordReader record(std::span<const std::byte>(records).subspan(at, bytes));
    all.push_back(read(record));
    if (!record.complaint().empty()) {
      return fail(ErrorKind::bad_input, "record {} {}", all.size(), record.complaint());
    }
  }
  return all;
}

void append(wire::Blob& bytes, std::int32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::byte>(static_cast<std::uint32_t>(value) >> shift));
  }
}

}  // namespace

Result<std::vector<BulkStrike>> decode_strikes(const wire::Blob& records) {
  return decode(records, kBytesPerStrike, &read_strike);
}

Result<std::vector<BulkPose>> decode_poses(const wire::Blob& records) {
  return decode(records, kBytesPerPose, &read_pose);
}

wire::Blob encode_strikes(std::span<const BulkStrike> strikes) {
  wire::Blob bytes;
  for (const BulkStrike& strike : strikes) {
    append(bytes, static_cast<std::int32_t>(strike.object));
    append(bytes, strike.vertex ? static_cast<std::int32_t>(*strike.vertex) : kNoVertex);
    for (const double number : {strike.point_m.x, strike.point_m.y, strike.point_m.z, strike.impulse_ns.x,
                                strike.impulse_ns.y, strike.impulse_ns.z, strike.contact_time_s, strike.delay_s}) {
      append(bytes, std::bit_cast<std::int32_t>(static_cast<float>(number)));
    }
  }
  return bytes;
}

wire::Blob encode_poses(std::span<const BulkPose> poses) {
  wire::Blob bytes;
  for (const BulkPose& placed : poses) {
    append(bytes, static_cast<std::int32_t>(placed.object));
    const Vec3& p = placed.pose.position_m;
    const Rotation& q = placed.pose.rotation;
    for (const double number : {p.x, p.y, p.z, q.w, q.x, q.y, q.z, placed.delay_s}) {
      append(bytes, std::bit_cast<std::int32_t>(static_cast<float>(number)));
    }
  }
  return bytes;
}

}  // namespace ringdown::protocol
