#include "configs/program/run_control.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <sstream>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/program/program.hpp"

namespace wade {

namespace {

constexpr int poll_ms = 50;  // between two looks during a pause
constexpr std::uint64_t most_steps = 1'000'000'000;

std::atomic<unsigned> toggles_asked = 0;
std::atomic<unsigned> steps_asked = 0;
static_assert(std::atomic<unsigned>::is_always_lock_free);  // a signal handler may use it

extern "C" void ask_for_toggle(int) {
    toggles_asked.fetch_add(1);
}
extern "C" void ask_for_step(int) {
    steps_asked.fetch_add(1);
}

[[noreturn]] void refuse_line(std::string_view line, const std::string& why) {
    throw ConfigurationError("command \"" + std::string(line) + "\": " + why +
                             "; allowed: pause, resume, step [N], tau VALUE [agent ID | group NAME], quit, or an empty "
                             "line to pause or resume.");
}

template <typename Number>
Number number_of(const std::string& word, std::string_view line, const char* what, Number lo, Number hi) {
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !(lo <= value && value <= hi)) {
        std::ostringstream range;
        range << what << " \"" << word << "\" is not within " << lo << " to " << hi;
        refuse_line(line, range.str());
    }
    return value;
}

Command tau_command(const std::vector<std::string>& words, std::string_view line) {
    if (words.size() != 2 && words.size() != 4) refuse_line(line, "tau needs a value, and names an agent or a group");
    Command command{Command::Kind::tau, 1, {}};
    command.tau.tau = number_of(words[1], line, "tau", 0.0, 1.0);
    if (words.size() == 2) return command;
    if (words[2] == "agent") {
        command.tau.agent = number_of(words[3], line, "agent", 0, 999'999'999);
    } else if (words[2] == "group") {
        command.tau.group = words[3];
    } else {
        refuse_line(line, "\"" + words[2] + "\" is neither \"agent\" nor \"group\"");
    }
    return command;
}

std::filesystem::path make_fifo(const std::string& place) {
    if (::mkfifo(place.c_str(), 0600) == 0) return place;
    const int error = errno;
    struct stat about {};
    if (error == EEXIST && ::stat(place.c_str(), &about) == 0 && S_ISFIFO(about.st_mode)) return {};
    throw ConfigurationError("--commands: cannot make a FIFO at " + place + ": " +
                             (error == EEXIST ? "there is something else of this name" : std::strerror(error)));
}

}  // namespace

Command parse_command(std::string_view line) {
    std::istringstream stream{std::string(line)};
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.empty()) return {Command::Kind::toggle, 1, {}};
    const std::string& verb = words[0];
    if (verb == "tau") return tau_command(words, line);
    if (verb == "step" && words.size() <= 2) {
        const std::uint64_t steps =
            words.size() == 2 ? number_of(words[1], line, "number of steps", std::uint64_t{1}, most_steps) : 1;
        return {Command::Kind::step, steps, {}};
    }
    if (words.size() == 1) {
        if (verb == "pause") return {Command::Kind::pause, 1, {}};
        if (verb == "resume") return {Command::Kind::resume, 1, {}};
        if (verb == "quit") return {Command::Kind::quit, 1, {}};
    }
    refuse_line(line, "not understood");
}

// A terminal shares its open file with other programs, so it is asked with poll() and not made non-blocking.
CommandLines::CommandLines(const std::string& place) {
    if (place == "-" || (place.empty() && ::isatty(STDIN_FILENO) == 1)) {
        fd_ = STDIN_FILENO;
    } else if (!place.empty()) {
        own_fifo_ = make_fifo(place);
        // Opened for writing as well, so that it does not end when a writer goes.
        fd_ = ::open(place.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
        if (fd_ < 0) throw ConfigurationError("--commands: cannot read " + place + ": " + std::strerror(errno));
    }
}

CommandLines::CommandLines(CommandLines&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      own_fifo_(std::exchange(other.own_fifo_, {})),
      begun_(std::move(other.begun_)) {}

CommandLines& CommandLines::operator=(CommandLines&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(own_fifo_, other.own_fifo_);
    std::swap(begun_, other.begun_);
    return *this;
}

CommandLines::~CommandLines() {
    if (fd_ > STDIN_FILENO) ::close(fd_);
    if (!own_fifo_.empty()) ::unlink(own_fifo_.c_str());
}

// A program in the background that reads its terminal is stopped by the kernel.
int CommandLines::fd() const {
    const bool background = fd_ >= 0 && ::isatty(fd_) == 1 && ::tcgetpgrp(fd_) != ::getpgrp();
    return background ? -1 : fd_;
}

std::vector<std::string> CommandLines::take() {
    std::vector<std::string> lines;
    pollfd ready{fd(), POLLIN, 0};
    while (ready.fd >= 0 && ::poll(&ready, 1, 0) == 1) {
        char bytes[512];
        const ssize_t got = ::read(fd_, bytes, sizeof bytes);
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) break;
        if (got <= 0) {  // the pipe or terminal was closed
            fd_ = ready.fd = -1;
            ended_ = true;
            if (!begun_.empty() && begun_.back() != '\n')
                begun_ += '\n';  // the last line counts without its end as well
            break;
        }
        begun_.append(bytes, static_cast<std::size_t>(got));
    }
    for (std::size_t end = begun_.find('\n'); end != std::string::npos; end = begun_.find('\n')) {
        lines.push_back(begun_.substr(0, end));
        begun_.erase(0, end + 1);
    }
    return lines;
}

bool CommandLines::have_ended() {
    return std::exchange(ended_, false);
}

RunControl::RunControl(const std::string& commands) {
    struct sigaction action {};
    sigemptyset(&action.sa_mask);
    action.sa_handler = ask_for_toggle;
    sigaction(SIGUSR1, &action, nullptr);
    action.sa_handler = ask_for_step;
    sigaction(SIGUSR2, &action, nullptr);
    lines_ = CommandLines(commands);
}

void RunControl::obey(const Command& command) {
    switch (command.kind) {
        case Command::Kind::pause:
            paused_ = true;
            break;
        case Command::Kind::resume:
            paused_ = false;
            steps_left_ = 0;
            break;
        case Command::Kind::toggle:
            paused_ = !paused_;
            steps_left_ = 0;
            break;
        case Command::Kind::step:
            paused_ = true;
            steps_left_ += command.steps;
            break;
        case Command::Kind::tau:
            tau_commands_.push_back(command.tau);
            break;
        case Command::Kind::quit:
            quit_ = true;
            break;
    }
}

void RunControl::take_all(const Hooks& hooks) {
    if (toggles_asked.exchange(0) % 2 == 1) obey({Command::Kind::toggle, 1, {}});
    if (const unsigned steps = steps_asked.exchange(0); steps > 0) obey({Command::Kind::step, steps, {}});
    for (const std::string& line : lines_.take()) {
        try {
            obey(parse_command(line));
        } catch (const ConfigurationError& error) {
            if (hooks.message) hooks.message(error.what());
        }
    }
    if (lines_.have_ended() && paused_) {
        obey({Command::Kind::resume, 1, {}});
        if (hooks.message) hooks.message("the commands have ended; the run goes on");
    }
}

void RunControl::wait_while_paused(const Hooks& hooks) {
    take_all(hooks);
    bool told = false;
    while (paused_ && steps_left_ == 0 && !quit_ && !(hooks.interrupted && hooks.interrupted())) {
        if (!told && hooks.message) hooks.message("paused; resume, step [N] or an empty line go on");
        if (hooks.paused) hooks.paused(true);
        told = true;
        pollfd ready{lines_.fd(), POLLIN, 0};
        ::poll(&ready, lines_.fd() >= 0 ? 1 : 0, poll_ms);
        take_all(hooks);
    }
    if (told && hooks.paused) hooks.paused(false);
    if (steps_left_ > 0) --steps_left_;
}

std::vector<TauCommand> RunControl::take_tau_commands() {
    return std::exchange(tau_commands_, {});
}

}  // namespace wade
