#pragma once
// Reports mistakes together, so that a user with three mistakes need not start three times.

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "configs/errors/exit_code.hpp"

namespace wade {

class Problems {
 public:
    // One sentence, as of a ConfigurationError. A sentence that is there already is not noted again.
    void note(const std::string& sentence);

    // Notes what `check` throws as ConfigurationError; whether it threw nothing.
    template <typename Check>
    bool attempt(const Check& check) {
        try {
            check();
            return true;
        } catch (const ConfigurationError& error) {
            note(error.what());
            return false;
        }
    }

    [[nodiscard]] bool none() const { return count_ == 0; }
    // Returns true if a further sentence is only counted.
    [[nodiscard]] bool is_full() const { return sentences_.size() == most_shown; }

    // Throws a ConfigurationError of all sentences, a line each, if there are any; the first `most_shown` if there are more.
    void throw_if_any() const;

    static constexpr std::size_t most_shown = 12;

 private:
    std::vector<std::string> sentences_;  // at most most_shown
    std::size_t count_ = 0;
};

inline void Problems::note(const std::string& sentence) {
    if (std::find(sentences_.begin(), sentences_.end(), sentence) != sentences_.end()) return;
    ++count_;
    if (sentences_.size() < most_shown) sentences_.push_back(sentence);
}

inline void Problems::throw_if_any() const {
    if (none()) return;
    std::string text;
    for (const std::string& sentence : sentences_) text += (text.empty() ? "" : "\n") + sentence;
    if (count_ > sentences_.size()) {
        text += "\nand " + std::to_string(count_ - sentences_.size()) + " more mistakes.";
    }
    throw ConfigurationError(text);
}

}  // namespace wade
