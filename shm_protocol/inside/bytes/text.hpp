#pragma once
// Texts in fixed fields of a segment.

#include <cstddef>
#include <string>
#include <string_view>

namespace wade::shm {

// A text that another process wrote, fit for a terminal and for JSON: ends at the first zero; '?' stands for each byte of
// what is not UTF-8, and for each character that controls a terminal or the direction of writing.
std::string printable(const char* text, std::size_t bytes);

// Copies a text into a zero-terminated field, cut where it does not fit, before a character and not in it.
void store_text(char* field, std::size_t bytes, std::string_view text);

}  // namespace wade::shm
