// Everything in the window: the browser, the object with its modes below, and the controls. Knows ImGui and the
// renderer, but no plug-in interface. Every call needs the window's ImGui context, and draw() its OpenGL context, to be
// the present one. [UI]
#pragma once

#include "clients/plugin/window/body_view.h"
#include "clients/plugin/window/browser.h"
#include "clients/plugin/window/edits.h"
#include "clients/plugin/window/material_row.h"
#include "clients/plugin/window/mode_glow.h"
#include "clients/plugin/window/shown_body.h"
#include "clients/plugin/window/sliders.h"
#include "clients/viewer/panels/drop_panel.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace ringdown::plugin {

class MainPanel {
 public:
  // `binary` is a file near which presets may lie, as for find_source().
  MainPanel(HostLink& host, std::filesystem::path binary);

  [[nodiscard]] Edits& edits() { return edits_; }
  void on_level(double level_db);
  void release_key();  // that the mouse holds
  // A file was dropped onto the window: plays a bank or a note map, bakes a mesh and plays its bank.
  void drop(const std::filesystem::path& file);

  // Returns whether the next picture differs although nothing was done: something rings, a held peak is to
  // fall, or a mesh is baked.
  [[nodiscard]] bool is_moving() const;

  // Draws into a window of this size in pixels; `now_s` is a time that only grows.
  void draw(float width, float height, double scale, double now_s);

 private:
  void update_body();
  void update_glow(double now_s);
  void draw_body(float width, float height, double now_s);
  void point_at_body(float x, float y);
  [[nodiscard]] int velocity_of_click(bool is_second) const;
  void draw_strike_points(float x, float y);
  void draw_modes(float width, float height);
  void draw_toolbar(double scale);
  void take_shortcuts();

  HostLink& host_;
  std::filesystem::path binary_;
  Edits edits_;
  Sliders sliders_;
  Browser browser_;
  LevelMeter meter_;
  MaterialRow material_;
  viewer::DropPanel drops_;

  std::optional<BodyView> view_;
  std::string complaint_;  // why the object is not shown; may be empty
  bool tried_view_ = false;
  std::shared_ptr<const ShownBody> body_;
  std::optional<Source> source_;  // what was read last
  std::size_t read_key_ = 0;      // the key for which it was read
  ModeGlow glow_;
  std::string blow_;                                // for what glow_'s blow was computed
  double level_db_ = -120, drawn_level_db_ = -120;  // now; in the last picture
  double glow_at_s_ = 0;                            // time of that picture

  int key_ = 60, velocity_ = 100;  // of a click
  bool turns_ = false;             // the mouse was pressed beside the object, or with its right button
  std::optional<std::uint8_t> pressed_;
};

}  // namespace ringdown::plugin
