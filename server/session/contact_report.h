// The contacts of a rendering as a table: one row for each blow, and one for each contact that slid or rolled. [any
// thread]
#pragma once

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/scene/contact/heard_contact.h"

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace ringdown::session {

struct ContactRow {
  double start_s = 0, end_s = 0;  // equal for a blow
  std::string kind;               // impact, slide or roll
  std::string first, second;      // names of the bodies
  Vec3 point_m;                   // of a lasting contact where it begins
  double push = 0;                // impulse of a blow [N s], mean force of a lasting contact [N]
  double speed_m_s = 0;           // approach of a blow, mean speed of a lasting contact
};

class ContactReport {
 public:
  // Bodies and statics by their numbers.
  void set_names(std::map<scene::BodyId, std::string> names) { names_ = std::move(names); }

  void add(std::span<const scene::HeardContact> contacts);

  // The rows by time. Contacts that still last end with their last report.
  [[nodiscard]] std::vector<ContactRow> rows() const;

 private:
  struct Lasting {
    ContactRow row;
    double reports = 0, force_n = 0, slip_m_s = 0, roll_m_s = 0;  // sums
  };
  [[nodiscard]] static ContactRow row_of(const Lasting& lasting);
  [[nodiscard]] std::string name_of(scene::BodyId id) const;

  std::map<scene::BodyId, std::string> names_;
  std::map<scene::BodyPair, Lasting> open_;
  std::vector<ContactRow> done_;
};

// Writes the rows as comma-separated values with a line of titles.
Result<void> write_contacts(std::span<const ContactRow> rows, const std::filesystem::path& path);

}  // namespace ringdown::session
