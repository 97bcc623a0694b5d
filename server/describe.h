// Answers questions, which are requests that change nothing: /object/.../describe and bank, /scene/describe, /browse,
// /sync. [worker]
#pragma once

#include "engine/base/result.h"
#include "protocol/lanes.h"
#include "protocol/reply.h"
#include "server/session/session.h"

#include <vector>

namespace ringdown::server {

// Returns the messages of the answer, in order. An error names the wrong argument.
Result<std::vector<protocol::Reply>> answer_to(const protocol::Question& question, const session::Session& session);

// Returns /broken and the pieces.
std::vector<protocol::Reply> news_of(const session::BrokenObject& object);

}  // namespace ringdown::server
