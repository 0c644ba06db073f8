#include <unistd.h>

#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "configs/program/command_line.hpp"
#include "configs/program/version.hpp"
#include "scene_texts.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::Equals;
using Catch::Matchers::StartsWith;
using wade::ProgramStart;
using namespace wade::test;

namespace {

const wade::ProgramDescription program{
    "crowd_client",
    "Simulates the crowd of a scene.",
    {{"--no-figure", "Do not draw figure.png"},
     {"--water-every-s", "Interval, s", wade::NumberRange{0.1, 100}, 5},
     {.name = "--clock", .help = "Pace", .word = wade::Word{"MODE", "fast", {"fast", "real_time"}}},
     {.name = "--list", .help = "A list", .word = wade::Word{"FILE"}}}};

const std::string s05 = std::string(WADE_SCENES) + "/paper/s05.json";

ProgramStart start(const std::vector<std::string>& arguments) {
    std::vector<const char*> argv{"crowd_client"};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    return wade::start_program(program, static_cast<int>(argv.size()), argv.data());
}

std::string usage_error(const std::vector<std::string>& arguments) {
    try {
        static_cast<void>(start(arguments));
    } catch (const wade::ConfigurationError& error) {
        CHECK(static_cast<int>(error.code()) == 2);
        return error.what();
    }
    FAIL("the command line was accepted");
    return "";
}

}  // namespace

TEST_CASE("without options a run has the documented defaults") {
    const ProgramStart run = start({s05});
    CHECK_FALSE(run.answer);
    CHECK(run.options.scene_file == s05);
    CHECK(run.options.threads == 0);
    CHECK(run.options.attach_timeout == 10);
    CHECK(run.options.step_timeout == 60);
    CHECK_FALSE(run.options.reproducible);
    CHECK_FALSE(run.options.out);
    CHECK_FALSE(run.options.has("--no-figure"));
    CHECK(run.options.extra("--water-every-s") == 5);
    CHECK(run.options.arguments == std::vector<std::string>{"crowd_client", s05});
}

TEST_CASE("the default session is named after the user and the scene hash") {
    const ProgramStart run = start({s05});
    const std::string digits = wade::hash_text(run.loaded.scene.hash).substr(0, 8);
    CHECK(run.options.session == "wade-" + std::to_string(getuid()) + "-" + digits);
    CHECK(wade::default_session_name(0x0123456789abcdefu) == "wade-" + std::to_string(getuid()) + "-01234567");
}

TEST_CASE("options are read, before or after the scene") {
    const ProgramStart run =
        start({"--threads", "3", "--session=river-1", s05, "--out", "/tmp/run", "--reproducible", "--attach-timeout-s",
               "2.5", "--step-timeout-s", "0", "--no-figure", "--water-every-s", "1"});
    CHECK(run.options.threads == 3);
    CHECK(run.options.session == "river-1");
    CHECK(run.options.out == std::filesystem::path("/tmp/run"));
    CHECK(run.options.reproducible);
    CHECK(run.options.attach_timeout == 2.5);
    CHECK(run.options.step_timeout == 0);
    CHECK(run.options.has("--no-figure"));
    CHECK(run.options.extra("--water-every-s") == 1);
}

TEST_CASE("--seed and --until-s change the scene as --set does, and win over it") {
    const auto hash = start({s05, "--set", "/seed=7", "--set", "/duration_s=3"}).loaded.scene.hash;
    const ProgramStart run = start({s05, "--seed", "7", "--until-s", "3", "--set", "/seed=9"});
    CHECK(run.loaded.scene.seed == 7);
    CHECK(run.loaded.scene.duration == 3);
    CHECK(run.loaded.scene.hash == hash);
    CHECK(hash != start({s05}).loaded.scene.hash);
}

TEST_CASE("--seed and --until-s are refused by their own name") {
    CHECK_THAT(usage_error({s05, "--seed", "abc"}),
               Equals("--seed abc: /seed: expected a whole number, found \"abc\" (string)."));
    CHECK_THAT(usage_error({s05, "--until-s", "-5"}),
               Equals("--until-s -5: /duration_s: -5 is out of range; allowed: > 0 and <= 1000000 s."));
}

TEST_CASE("wrong usage is refused with exit code 2") {
    CHECK_THAT(usage_error({}), StartsWith("crowd_client: a scene file is required"));
    CHECK_THAT(usage_error({"--thread", "4", s05}),
               StartsWith("crowd_client: unknown option \"--thread\"; the nearest is \"--threads\""));
    CHECK_THAT(usage_error({s05, "--until=3"}), Contains("unknown option \"--until=3\"; the nearest is \"--until-s\""));
    CHECK_THAT(usage_error({s05, "other.json"}),
               Equals("crowd_client: unexpected argument \"other.json\"; one scene file is allowed."));
    CHECK_THAT(usage_error({s05, "--threads"}), StartsWith("crowd_client: --threads: a value is missing"));
    CHECK_THAT(usage_error({s05, "--threads", "2000"}),
               Contains("--threads: 2000 is not allowed; allowed: whole numbers from 0 to 1024"));
    CHECK_THAT(usage_error({s05, "--threads", "1.5"}), Contains("--threads: 1.5 is not allowed"));
    CHECK_THAT(usage_error({s05, "--attach-timeout-s", "nan"}), Contains("--attach-timeout-s: nan is not allowed"));
    CHECK_THAT(usage_error({s05, "--water-every-s", "0"}),
               Contains("--water-every-s: 0 is not allowed; allowed: 0.1 to 100"));
    CHECK_THAT(usage_error({s05, "--session", "a/b"}),
               StartsWith("--session: \"a/b\" is not allowed; allowed: 1 to 200 letters"));
    CHECK_THAT(usage_error({"gone.json"}), StartsWith("gone.json cannot be read: "));
}

TEST_CASE("an option that takes one of several words refuses any other and names them") {
    CHECK(start({s05}).options.word("--clock") == "fast");
    CHECK(start({s05, "--clock", "real_time"}).options.word("--clock") == "real_time");
    CHECK_THAT(usage_error({s05, "--clock", "slow"}),
               Contains("--clock: slow is not allowed; allowed: fast, real_time"));
}

TEST_CASE("an option that takes any word refuses an empty one, which would read as if it were not given") {
    CHECK(start({s05}).options.word("--list").empty());
    CHECK(start({s05, "--list", "a.json"}).options.word("--list") == "a.json");
    CHECK_THAT(usage_error({s05, "--list", ""}), Contains("--list: the value is empty; allowed: FILE"));
    CHECK_THAT(usage_error({s05, "--list="}), Contains("--list: "));
}

TEST_CASE("--help names every option with its default, and needs no scene") {
    const ProgramStart help = start({"--help"});
    REQUIRE(help.answer);
    for (const std::string option : {"SCENE",
                                     "--session",
                                     "--out",
                                     "--reproducible",
                                     "--threads",
                                     "--seed",
                                     "--until-s",
                                     "--set",
                                     "--attach-timeout-s",
                                     "[10]",
                                     "--step-timeout-s",
                                     "[60]",
                                     "--check",
                                     "--print-config",
                                     "--version",
                                     "--no-figure",
                                     "--water-every-s",
                                     "[5]",
                                     "--clock",
                                     "MODE",
                                     "[fast]"}) {
        CHECK_THAT(*help.answer, Contains(option));
    }
}

TEST_CASE("no line of --help is wider than 100 columns") {
    std::istringstream lines(start({"--help"}).answer.value());
    for (std::string line; std::getline(lines, line);) CHECK(line.size() <= 100);
}

TEST_CASE("--version names program, version and commit") {
    const ProgramStart answer = start({"--version"});
    REQUIRE(answer.answer);
    CHECK_THAT(*answer.answer, StartsWith("crowd_client " + std::string(wade::version()) + " (git ") &&
                                   Contains(std::string(wade::git_hash())));
    CHECK_FALSE(wade::git_hash().empty());
}

TEST_CASE("--check says what the scene holds") {
    const ProgramStart answer = start({s05, "--check"});
    REQUIRE(answer.answer);
    CHECK(*answer.answer == s05 + ": valid; scene paper_s05, 50 agents, 27619 of 100000 particles needed, hash " +
                                wade::hash_text(answer.loaded.scene.hash) + "\n");
    CHECK_THAT(usage_error({s05, "--check", "--set", "/fluid/max_particles=5"}), Contains("allowed: >= 27619."));
}

TEST_CASE("--print-config prints a scene that loads again to the same hash") {
    const ProgramStart answer = start({s05, "--print-config", "--seed", "4"});
    REQUIRE(answer.answer);
    CHECK(wade::load_scene_text(*answer.answer, "printed.json").scene.hash == answer.loaded.scene.hash);
}
