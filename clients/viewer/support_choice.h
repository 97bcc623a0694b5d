// The part of an object's surface that the user chooses as a support, and its text for an object file. [UI]
//
//   support.toggle_flat("kalimba", bank, point_m);    // ctrl and click
//   support.add("kalimba", bank, is_in_rectangle);    // ctrl and drag
//   std::string text = support.text();                // [[support]] ...
//
// Triangles are those of the bank, in the frame of its file: that of the geometry, in metres before `scale`.
#pragma once

#include "clients/viewer/link/bank_transfer.h"
#include "engine/base/vec3.h"

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::viewer {

class SupportChoice {
 public:
  static constexpr std::array kKinds = {"clamped", "slides", "springs", "felt", "foam", "hand"};
  using Bank = std::shared_ptr<const KnownBank>;
  using Triangle = std::array<Vec3, 3>;

  // Toggles the choice of the flat piece of the surface that is nearest to a point. Drops a choice on another object or
  // bank first. Does nothing for a bank without triangles.
  void toggle_flat(const std::string& object, const Bank& bank, Vec3 point_m);

  // Adds all triangles for which `holds` returns true to the choice.
  void add(const std::string& object, const Bank& bank, const std::function<bool(const Triangle&)>& holds);

  void clear() { *this = {}; }
  void set_kind(std::size_t kind) { kind_ = kind < kKinds.size() ? kind : 0; }

  [[nodiscard]] bool empty() const { return chosen_.empty(); }
  [[nodiscard]] const std::string& object() const { return object_; }
  [[nodiscard]] std::size_t kind() const { return kind_; }
  [[nodiscard]] std::vector<Triangle> triangles() const;
  [[nodiscard]] double area_m2() const;

  // Returns a [[support]] for an object file: the faces on a plane, if all triangles of the bank on that plane are
  // chosen; otherwise the faces in the box around the choice, enlarged by a thousandth of the body. Empty if nothing is
  // chosen.
  [[nodiscard]] std::string text() const;

 private:
  void look_at(const std::string& object, const Bank& bank);
  [[nodiscard]] Triangle triangle(std::size_t t) const;
  [[nodiscard]] std::vector<std::size_t> flat_piece(std::size_t seed) const;
  [[nodiscard]] double diagonal_m() const;
  [[nodiscard]] std::string plane() const;
  [[nodiscard]] std::string box() const;

  std::string object_;
  Bank bank_;
  std::vector<std::size_t> chosen_;  // numbers of chosen triangles, ascending
  std::size_t kind_ = 0;
};

}  // namespace ringdown::viewer
