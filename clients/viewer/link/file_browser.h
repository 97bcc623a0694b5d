// The scenes and banks that the daemon can load. The answer to /browse comes as many datagrams, some of which may be
// lost, so the question is repeated until all files that the answer counts have arrived. [one thread: the window's]
#pragma once

#include "clients/viewer/link/question.h"
#include "protocol/reply.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::viewer {

// Returns a name for each path: the file's without its ending, and behind it the folder where another file has the same
// name: "chimes (scenes)", or "chimes (presets/scenes)" if the folders have the same name, too.
std::vector<std::string> names_of(const std::vector<std::string>& paths);

class FileBrowser {
 public:
  static constexpr std::size_t kMaxFiles = 8192;  // further ones are ignored

  void on(const protocol::BrowseReply& reply);
  void on(const protocol::BrowseFile& file);
  void add_requests(double now_s, Requests& requests);
  void browse_again() { answer_ = {}; }  // call when files may have changed

  // Return the paths of the last complete answer, in the form that the daemon accepts.
  [[nodiscard]] const std::vector<std::string>& scenes() const { return scenes_; }
  [[nodiscard]] const std::vector<std::string>& banks() const { return banks_; }

 private:
  // An answer that is still arriving.
  struct Answer {
    Question question;
    std::optional<std::int32_t> files;
    std::map<std::int32_t, protocol::BrowseFile> found;
    bool complete = false;
  };
  void finish();

  Answer answer_;
  std::vector<std::string> scenes_, banks_;
};

}  // namespace ringdown::viewer
