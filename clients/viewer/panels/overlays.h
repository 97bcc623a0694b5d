// Drawings over the panes: notes on the scene, the help of F1, and the bars that resize panes. [UI]
#pragma once

#include "clients/viewer/link/daemon_client.h"
#include "clients/viewer/link/known_scene.h"
#include "clients/viewer/link/model.h"
#include "clients/viewer/panels/skin.h"

#include <optional>
#include <string>

namespace ringdown::viewer {

// Returns the scene's name and clock: "demo   3.2 s of 12 s". The clock stops at the scene's duration, although bodies
// may still move. A duration of 0 means a scene without an end.
std::string scene_note(const std::string& name, double time_s, double duration_s, bool paused);

// Draws notes over the scene pane, which lies at `origin`: the scene's name and time. `shown_at_s` is the scene time on
// display; nothing: the time that the daemon reports.
void draw_notes(const Skin& skin, ImVec2 origin, ImVec2 size, const KnownScene& scene,
                std::optional<double> shown_at_s);

// If the daemon has neither a scene nor an object, says in the middle of a pane what to do. `is_connected` is whether
// there is a daemon.
void draw_welcome(const Skin& skin, ImVec2 origin, ImVec2 size, const Model& model, bool is_connected);

// If there is no daemon, draws advice in the middle of a pane that lies at `origin`.
void draw_connection(const Skin& skin, ImVec2 origin, ImVec2 size, const ConnectionState& state);

// Draws all keys, by pane, over everything else. Returns false when the user closes the help.
bool draw_help(const Skin& skin);

// Draws a bar at `x` between two panes, which the mouse can drag. `share` is the share of the window's width of one of
// them; `direction` is +1 if that is the pane at the left of the bar, -1 if it is the pane at the right. Returns the
// new share while the user drags.
std::optional<double> drag_splitter(const char* name, float x, double share, double direction);

}  // namespace ringdown::viewer
