#pragma once
// HTTP and WebSocket on 127.0.0.1: files for GET, questions and answers over /stream. Knows nothing of water or people.
//
// A client asks and gets one answer for each question, so that nothing piles up for who is slow: of each kind of question only the
// last one counts, and what cannot be answered yet waits.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "viewer/message.hpp"

namespace wade::view {

struct WebFile {
    std::string type, body;  // "text/html"
};

// One line of JSON of a client, understood.
struct Question {
    std::string kind;      // of which a client has one at a time
    double time = 0;       // s
    double after = -1;     // a frame
    std::uint32_t id = 0;  // of a person
    std::string command;
};

struct Answer {
    bool is_binary = false;
    Message bytes;
};

struct Site {
    std::function<std::optional<WebFile>(const std::string& path)> file;         // none: 404
    std::function<std::optional<Question>(const std::string& text)> understand;  // none: the client is told so
    std::function<std::optional<Answer>(const Question&)> answer;                // none: not yet
    std::function<std::string()> status;                                         // text for all, twice a second
    std::function<bool()> work;  // 60 times a second; false ends the server
};

// Serves until work() says false. `opened` gets the port that was taken, once it listens; port 0: any that is free.
// Errors: ConfigurationError if the port cannot be had.
void serve(std::uint16_t port, const Site& site, const std::function<void(std::uint16_t)>& opened);

}  // namespace wade::view
