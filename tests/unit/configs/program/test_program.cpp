// Pace of progress, memory that is there, texts of the console.

#include <sys/resource.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/program/console_text.hpp"
#include "configs/program/memory.hpp"
#include "configs/program/program.hpp"

using namespace wade;

namespace {

std::size_t widest_line(const std::string& text) {
    std::istringstream lines(text);
    std::size_t widest = 0;
    for (std::string line; std::getline(lines, line);) widest = std::max(widest, columns_of(line));
    return widest;
}

}  // namespace

TEST_CASE("progress in a log is due at the first frame and every ten simulated seconds") {
    ProgressPacer plain(false);
    int lines = 0;
    for (int f = 1; f <= 900; ++f) {
        lines += plain.due(f / 30.0, 0.001 * f) ? 1 : 0;
    }
    CHECK(lines == 4);  // at the first frame, 10, 20 and 30 s
}

TEST_CASE("progress on a terminal is due five times a second of wall time") {
    ProgressPacer terminal(true);
    int lines = 0;
    for (int f = 1; f <= 1000; ++f) {
        lines += terminal.due(f / 30.0, 0.01 * f + 0.005) ? 1 : 0;
    }
    CHECK(lines == 51);  // at once, then in 10 s at each multiple of 0.2 s
}

TEST_CASE("memory that is not there is refused with what is needed and what is left", "[program]") {
    CHECK_NOTHROW(check_memory(2e9, 2e9, "x.json", "y"));
    CHECK_THROWS_WITH(check_memory(16.8e9, 2e9, "x.json", "lower /fluid/max_particles"),
                      "x.json: needs about 16.8 GB of memory, 2 GB are left; lower /fluid/max_particles");
    CHECK_THROWS_AS(check_memory(3e9, 2e9, "x.json", "y"), ConfigurationError);
    CHECK_THROWS_AS(check_memory(HUGE_VAL, 2e9, "x.json", "y"), ConfigurationError);
}

TEST_CASE("what is left is not more than the limit of the process", "[program]") {
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_AS, &before) == 0);
    std::ifstream status("/proc/self/status");
    double used = 0;
    for (std::string word; used == 0 && status >> word;) {
        if (word == "VmSize:") status >> used;
    }
    REQUIRE(used > 0);
    const double free = available_memory();
    rlimit limit = before;
    limit.rlim_cur = static_cast<rlim_t>(1024 * used + 5e7);
    REQUIRE(::setrlimit(RLIMIT_AS, &limit) == 0);
    const double left = available_memory();
    REQUIRE(::setrlimit(RLIMIT_AS, &before) == 0);
    CHECK(free > 5e7);
    CHECK(left > 0);
    CHECK(left <= 5e7);
}

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
