#include "server/session/contact_report.h"

#include "engine/base/output_file.h"

#include <algorithm>
#include <utility>

namespace ringdown::session {
namespace {

// A name as a field: in quotation marks, which are doubled within.
std::string field_of(const std::string& name) {
  std::string field = "\"";
  for (const char c : name) field += c == '"' ? "\"\"" : std::string(1, c);
  return field + "\"";
}

}  // namespace

void ContactReport::add(std::span<const scene::HeardContact> contacts) {
  using scene::HeardContact;
  for (const HeardContact& contact : contacts) {
    const auto open = open_.find(contact.pair);
    if (contact.kind == HeardContact::end) {
      if (open == open_.end()) continue;
      open->second.row.end_s = contact.time_s;
      done_.push_back(row_of(open->second));
      open_.erase(open);
      continue;
    }
    ContactRow row{.start_s = contact.time_s,
                   .end_s = contact.time_s,
                   .kind = "impact",
                   .first = name_of(contact.pair.first),
                   .second = name_of(contact.pair.second),
                   .point_m = contact.point_m,
                   .push = length(contact.push),
                   .speed_m_s = contact.speed_m_s};
    if (contact.kind == HeardContact::blow) {
      done_.push_back(std::move(row));
      continue;
    }
    Lasting& lasting = open_.try_emplace(contact.pair, Lasting{.row = std::move(row)}).first->second;
    lasting.row.end_s = contact.time_s;
    lasting.reports += 1;
    lasting.force_n += length(contact.push);
    lasting.slip_m_s += contact.speed_m_s;
    lasting.roll_m_s += contact.roll_m_s;
  }
}

std::vector<ContactRow> ContactReport::rows() const {
  std::vector<ContactRow> rows = done_;
  for (const auto& [pair, lasting] : open_) rows.push_back(row_of(lasting));
  std::ranges::stable_sort(rows, {}, &ContactRow::start_s);
  return rows;
}

ContactRow ContactReport::row_of(const Lasting& lasting) {
  ContactRow row = lasting.row;
  row.kind = lasting.slip_m_s >= lasting.roll_m_s ? "slide" : "roll";
  row.push = lasting.force_n / lasting.reports;
  row.speed_m_s = std::max(lasting.slip_m_s, lasting.roll_m_s) / lasting.reports;
  return row;
}

std::string ContactReport::name_of(scene::BodyId id) const {
  const auto found = names_.find(id);
  return found == names_.end() ? std::to_string(id) : found->second;
}

Result<void> write_contacts(std::span<const ContactRow> rows, const std::filesystem::path& path) {
  std::string text = "start_s,end_s,kind,first,second,x_m,y_m,z_m,impulse_ns,force_n,speed_m_s\n";
  for (const ContactRow& row : rows) {
    const bool blow = row.kind == "impact";
    text += formatted("{:.5f},{:.5f},{},{},{},{:.5f},{:.5f},{:.5f},{:.6g},{:.6g},{:.4f}\n", row.start_s, row.end_s,
                      row.kind, field_of(row.first), field_of(row.second), row.point_m.x, row.point_m.y, row.point_m.z,
                      blow ? row.push : 0.0, blow ? 0.0 : row.push, row.speed_m_s);
  }
  return write_output(path, text);
}

}  // namespace ringdown::session
