// The loop of a long-lived thread, which continues even if there is not enough memory for one of its turns.
//
//   take_turns("serve OSC", stop, [&] { receive_and_answer(); });
#pragma once

#include <functional>
#include <stop_token>
#include <string>

namespace ringdown::server {

// Calls `turn` until `stop` is requested. A turn for which there is too little memory, or no thread, is abandoned and
// logged as "there is not enough memory to `what`"; the next one begins a tenth of a second later. [any but audio]
void take_turns(const std::string& what, const std::stop_token& stop, const std::function<void()>& turn);

}  // namespace ringdown::server
