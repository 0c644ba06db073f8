// Commands to a run that goes on: their words, where they come from, and what they hold up.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/program/run_control.hpp"
#include "scene_texts.hpp"

using namespace wade;
using wade::test::TemporaryFolder;

namespace {

void write_to(const std::filesystem::path& fifo, const std::string& text) {
    const int fd = ::open(fifo.c_str(), O_WRONLY);
    REQUIRE(fd >= 0);
    REQUIRE(::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()));
    ::close(fd);
}

std::string refusal_of(const std::string& line) {
    try {
        (void)parse_command(line);
    } catch (const ConfigurationError& error) {
        return error.what();
    }
    return "";
}

// A run that is asked `looks` times whether it is still paused; then it is interrupted.
struct Waiter {
    explicit Waiter(int looks = 3) {
        hooks.paused = [this](bool paused) { paused ? ++times_paused : ++times_resumed; };
        hooks.interrupted = [this, looks] { return times_paused >= looks; };
        hooks.message = [this](const std::string& text) { messages.push_back(text); };
    }
    // Whether the run was held up.
    bool waits(RunControl& control) {
        times_paused = 0;
        control.wait_while_paused(hooks);
        return times_paused > 0;
    }

    RunControl::Hooks hooks;
    int times_paused = 0, times_resumed = 0;
    std::vector<std::string> messages;
};

struct Controlled {
    TemporaryFolder folder;
    std::filesystem::path fifo = folder.path() / "commands";
    RunControl control{fifo.string()};
    Waiter run;

    bool waits_after(const std::string& lines) {
        write_to(fifo, lines);
        return run.waits(control);
    }
};

}  // namespace

TEST_CASE("each command is understood, with any spaces between its words") {
    using Kind = Command::Kind;
    CHECK(parse_command("pause").kind == Kind::pause);
    CHECK(parse_command("  resume \t").kind == Kind::resume);
    CHECK(parse_command("").kind == Kind::toggle);
    CHECK(parse_command(" \r").kind == Kind::toggle);
    CHECK(parse_command("quit").kind == Kind::quit);
    CHECK(parse_command("step").kind == Kind::step);
    CHECK(parse_command("step").steps == 1);
    CHECK(parse_command("step 250").steps == 250);
}

TEST_CASE("a tau command is for all, for an agent or for a group") {
    const TauCommand all = parse_command("tau 0.25").tau;
    CHECK(all.tau == 0.25);
    CHECK_FALSE(all.agent);
    CHECK_FALSE(all.group);
    CHECK(parse_command("tau 1 agent 17").tau.agent == 17);
    CHECK(parse_command("tau  0  group  left.bank").tau.group == "left.bank");
}

TEST_CASE("a line that is not understood is refused with the line and what is allowed") {
    for (const char* line : {"go", "pause now", "step 0", "step -1", "step 1.5", "step 1 2", "step 9999999999", "tau",
                             "tau x", "tau 1.01", "tau -0.1", "tau nan", "tau 0.5 agent", "tau 0.5 agent -1",
                             "tau 0.5 agent one", "tau 0.5 person 1", "tau 0.5 agent 1 group a", "TAU 1", "tau 0,5"}) {
        INFO(line);
        const std::string refusal = refusal_of(line);
        CHECK_THAT(refusal, Catch::Contains(std::string("command \"").append(line).append("\":")) &&
                                Catch::Contains("allowed: pause"));
    }
}

TEST_CASE("lines come from a FIFO that is made and goes again") {
    TemporaryFolder folder;
    const std::filesystem::path fifo = folder.path() / "fifo";
    {
        CommandLines lines(fifo.string());
        struct stat about {};
        REQUIRE(::stat(fifo.c_str(), &about) == 0);
        CHECK(S_ISFIFO(about.st_mode));
        CHECK((about.st_mode & 0777) == 0600);
        CHECK(lines.take().empty());
        write_to(fifo, "one\ntwo\nthr");
        CHECK(lines.take() == std::vector<std::string>{"one", "two"});
        write_to(fifo, "ee\n");
        CHECK(lines.take() == std::vector<std::string>{"three"});
        write_to(fifo, std::string(2000, 'x') + "\n");
        CHECK(lines.take() == std::vector<std::string>{std::string(2000, 'x')});
    }
    CHECK_FALSE(std::filesystem::exists(fifo));
}

TEST_CASE("a FIFO that was there before stays") {
    TemporaryFolder folder;
    const std::filesystem::path fifo = folder.path() / "fifo";
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    {
        CommandLines lines(fifo.string());
        write_to(fifo, "one\n");
        CHECK(lines.take().size() == 1);
    }
    CHECK(std::filesystem::exists(fifo));
}

TEST_CASE("a place where no FIFO can be is a usage error that names it") {
    TemporaryFolder folder;
    const std::filesystem::path file = folder.write("file", "not a FIFO");
    for (const std::filesystem::path& place : {file, file / "below"}) {
        try {
            CommandLines lines(place.string());
            FAIL("it was taken");
        } catch (const RunError& error) {
            CHECK(error.code() == ExitCode::bad_configuration);
            CHECK_THAT(error.what(), Catch::Contains("--commands") && Catch::Contains(place.string()));
        }
    }
    CHECK(std::filesystem::exists(file));
}

TEST_CASE("standard input is read until it ends") {
    int ends[2];
    REQUIRE(::pipe(ends) == 0);
    const int before = ::dup(STDIN_FILENO);
    REQUIRE(::dup2(ends[0], STDIN_FILENO) == STDIN_FILENO);
    {
        CommandLines lines("-");
        CHECK(lines.take().empty());
        REQUIRE(::write(ends[1], "one\n", 4) == 4);
        ::close(ends[1]);
        CHECK(lines.take() == std::vector<std::string>{"one"});
        CHECK(lines.take().empty());
        CHECK(lines.fd() == -1);
    }
    CHECK(CommandLines("").fd() == -1);  // a pipe is no terminal
    ::dup2(before, STDIN_FILENO);
    ::close(before);
    ::close(ends[0]);
}

TEST_CASE("a run goes on unless it is paused, and is told when a pause begins and ends") {
    Controlled c;
    CHECK_FALSE(c.run.waits(c.control));
    CHECK(c.run.times_resumed == 0);
    CHECK(c.waits_after("pause\n"));
    CHECK(c.run.times_resumed == 1);
    CHECK(c.run.messages.size() == 1);
    CHECK(c.run.waits(c.control));
    CHECK_FALSE(c.waits_after("resume\n"));
    CHECK_FALSE(c.run.waits(c.control));
}

TEST_CASE("an empty line and SIGUSR1 pause and resume in turn") {
    Controlled c;
    CHECK(c.waits_after("\n"));
    CHECK_FALSE(c.waits_after("\n"));
    CHECK_FALSE(c.waits_after("\n\n"));
    std::raise(SIGUSR1);
    CHECK(c.run.waits(c.control));
    std::raise(SIGUSR1);
    CHECK_FALSE(c.run.waits(c.control));
}

TEST_CASE("N steps let the run go on N times, then it is paused") {
    Controlled c;
    CHECK_FALSE(c.waits_after("step 3\n"));
    CHECK_FALSE(c.run.waits(c.control));
    CHECK_FALSE(c.run.waits(c.control));
    CHECK(c.run.waits(c.control));
    std::raise(SIGUSR2);
    CHECK_FALSE(c.run.waits(c.control));
    CHECK(c.run.waits(c.control));
    CHECK_FALSE(c.waits_after("step\nstep 2\nresume\n"));
    for (int i = 0; i < 10; ++i) CHECK_FALSE(c.run.waits(c.control));
}

TEST_CASE("a command during the pause ends it") {
    Controlled c;
    c.run.hooks.paused = [&](bool paused) {
        if (paused && ++c.run.times_paused == 2) write_to(c.fifo, "resume\n");
    };
    c.run.hooks.interrupted = [] { return false; };
    CHECK(c.waits_after("pause\n"));
    CHECK(c.run.times_paused == 2);
}

TEST_CASE("commands for tau are kept in their order until they are taken") {
    Controlled c;
    CHECK_FALSE(c.waits_after("tau 0.1\ntau 0.2 agent 4\n"));
    CHECK_FALSE(c.waits_after("tau 0.3 group a\n"));
    const std::vector<TauCommand> commands = c.control.take_tau_commands();
    REQUIRE(commands.size() == 3);
    CHECK(commands[0].tau == 0.1);
    CHECK(commands[1].agent == 4);
    CHECK(commands[2].group == "a");
    CHECK(c.control.take_tau_commands().empty());
}

TEST_CASE("a wrong line is a message and no end, and the lines after it count") {
    Controlled c;
    CHECK(c.waits_after("tau 7\npause\n"));
    REQUIRE_FALSE(c.run.messages.empty());
    CHECK_THAT(c.run.messages[0], Catch::Contains("tau 7") && Catch::Contains("0 to 1"));
    CHECK(c.control.take_tau_commands().empty());
}

TEST_CASE("quit asks the run to end, also during a pause") {
    Controlled c;
    CHECK_FALSE(c.control.quit_asked());
    CHECK_FALSE(c.waits_after("pause\nquit\n"));
    CHECK(c.control.quit_asked());
}

TEST_CASE("the end of the commands ends a pause that nobody could end any more, and only then") {
    int ends[2];
    REQUIRE(::pipe(ends) == 0);
    const int before = ::dup(STDIN_FILENO);
    REQUIRE(::dup2(ends[0], STDIN_FILENO) == STDIN_FILENO);
    RunControl control("-");
    ::dup2(before, STDIN_FILENO);
    REQUIRE(::write(ends[1], "pause", 5) == 5);
    ::close(ends[1]);
    std::vector<std::string> messages;
    RunControl::Hooks hooks;
    hooks.message = [&](const std::string& text) { messages.push_back(text); };
    REQUIRE(::dup2(ends[0], STDIN_FILENO) == STDIN_FILENO);
    control.wait_while_paused(hooks);
    REQUIRE_FALSE(messages.empty());
    CHECK_THAT(messages.back(), Catch::Contains("commands have ended"));
    std::raise(SIGUSR1);
    bool looked = false;
    hooks.interrupted = [&] { return std::exchange(looked, true); };
    control.wait_while_paused(hooks);
    CHECK(looked);  // a pause by a signal lasts
    ::dup2(before, STDIN_FILENO);
    ::close(before);
    ::close(ends[0]);
}
