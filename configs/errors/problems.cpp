#include "configs/errors/problems.hpp"

#include <algorithm>

namespace wade {

void Problems::note(const std::string& sentence) {
    if (std::find(sentences_.begin(), sentences_.end(), sentence) != sentences_.end()) return;
    ++count_;
    if (sentences_.size() < most_shown) sentences_.push_back(sentence);
}

void Problems::throw_if_any() const {
    if (none()) return;
    std::string text;
    for (const std::string& sentence : sentences_) text += (text.empty() ? "" : "\n") + sentence;
    if (count_ > sentences_.size()) {
        text += "\nand " + std::to_string(count_ - sentences_.size()) + " more mistakes.";
    }
    throw ConfigurationError(text);
}

}  // namespace wade
