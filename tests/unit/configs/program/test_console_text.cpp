#include <algorithm>
#include <catch2/catch.hpp>
#include <sstream>

#include "configs/program/console_text.hpp"

using wade::columns_of;
using wade::harmless;
using wade::shortened;
using wade::wrapped;

namespace {

std::size_t widest_line(const std::string& text) {
    std::istringstream lines(text);
    std::size_t widest = 0;
    for (std::string line; std::getline(lines, line);) widest = std::max(widest, columns_of(line));
    return widest;
}

}  // namespace

TEST_CASE("columns are characters, not bytes") {
    CHECK(columns_of("abc") == 3);
    CHECK(columns_of("\u00fc\u20ac") == 2);
}

TEST_CASE("long lines are broken at spaces and go on indented") {
    CHECK(wrapped("one two three", 2, 8) == "one two\n  three");
    CHECK(wrapped("one two", 2, 8) == "one two");
    CHECK(wrapped("one two three four five", 2, 9) == "one two\n  three\n  four\n  five");
    CHECK(wrapped("a b\nc d\n", 2, 8) == "a b\nc d\n");
    CHECK(wrapped("", 2, 8).empty());
}

TEST_CASE("no text has a line wider than the columns, and none of its words is lost") {
    const std::string path(250, 'p'), umlauts = "\u00e4\u00f6\u00fc\u00e4\u00f6\u00fc ";
    std::string long_text;
    for (int i = 0; i < 60; ++i) long_text += umlauts;
    for (const std::string& text :
         {path, "cannot read " + path + ": no such file", long_text, "    " + path, long_text + path}) {
        const std::string broken = wrapped(text);
        CHECK(widest_line(broken) <= 100);
        std::string before = text, after = broken;
        const auto squeeze = [](std::string& s) {
            s.erase(std::remove_if(s.begin(), s.end(), [](char c) { return c == ' ' || c == '\n'; }), s.end());
        };
        squeeze(before);
        squeeze(after);
        CHECK(before == after);
    }
}

TEST_CASE("what would act on a terminal is shown instead") {
    CHECK(harmless("a\x1b[2Jb") == "a\\x1b[2Jb");
    CHECK(harmless("a\x9b"
                   "2Jb") == "a\\x9b2Jb");  // a C1 control as a byte
    CHECK(harmless("a\xc2\x9b"
                   "b") == "a\\xc2\\x9bb");  // and as a character
    CHECK(harmless("\r\t\x7f") == "\\x0d\\x09\\x7f");
    CHECK(harmless("\xff\xc3") == "\\xff\\xc3");
    CHECK(harmless("line\nline \u00fc \u20ac") == "line\nline \u00fc \u20ac");
}

TEST_CASE("a progress line is cut") {
    CHECK(shortened("abcdefgh", 8) == "abcdefgh");
    CHECK(shortened("abcdefghi", 8) == "abcde...");
    CHECK(columns_of(shortened(std::string(300, 'x'))) == 100);
}
