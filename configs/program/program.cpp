#include "configs/program/program.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "configs/files/plain_file.hpp"
#include "configs/program/console_text.hpp"

namespace wade {

namespace {

// Read by threads other than the one that the signal interrupts.
std::atomic<int> signal_received = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void remember_signal(int signal) {
    signal_received = signal;
}

// Whether stderr goes to this very file.
bool is_stderr(const std::filesystem::path& file) {
    struct stat here {};
    struct stat there {};
    return ::fstat(STDERR_FILENO, &here) == 0 && ::stat(file.c_str(), &there) == 0 && here.st_dev == there.st_dev &&
           here.st_ino == there.st_ino;
}

double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void catch_signals() {
    struct sigaction action {};
    action.sa_handler = remember_signal;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    action.sa_handler = SIG_IGN;
    sigaction(SIGXFSZ, &action, nullptr);
    sigaction(SIGPIPE, &action, nullptr);
}

int received_signal() {
    return signal_received;
}

int exit_code_of_signal() {
    return static_cast<int>(signal_received == SIGTERM ? ExitCode::terminated : ExitCode::interrupted);
}

void let_threads_spin_briefly(char** argv) {
    const bool chosen = std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr;
    if (!chosen && ::setenv("GOMP_SPINCOUNT", "2000", 1) == 0) {
        // By its own path, so that lists of processes go on naming it. Where neither is possible it goes on as it is.
        std::error_code ignored;
        ::execv(std::filesystem::read_symlink("/proc/self/exe", ignored).c_str(), argv);
        ::execv("/proc/self/exe", argv);
    }
}

Console::Console(std::string program)
    : program_(std::move(program)), terminal_(::isatty(STDERR_FILENO) != 0), pacer_(terminal_) {}

void Console::copy_to(const std::filesystem::path& file) {
    if (is_stderr(file)) return;
    std::error_code ignored;
    std::filesystem::create_directories(file.parent_path(), ignored);
    clear_name(file);
    copy_.open(file);
    if (!copy_) {
        throw ConfigurationError("--out: cannot write " + file.string());
    }
}

void Console::line(const std::string& text) {
    const std::string prefix = program_ + ": ";
    std::istringstream lines(harmless(text));
    for (std::string line; std::getline(lines, line);) {
        write(wrapped(line.rfind(prefix, 0) == 0 ? line : prefix + line), true);  // some name the program themselves
    }
}

void Console::progress(const std::string& text) {
    write(terminal_ ? shortened(harmless(text)) : wrapped(harmless(text)), !terminal_);
}

void Console::write(const std::string& text, bool stays) {
    if (shown_) {
        std::cerr << "\r\033[K";
    }
    std::cerr << text;
    if (stays) {
        std::cerr << '\n';
    }
    std::cerr << std::flush;
    shown_ = !stays;
    if (copy_.is_open() && stays) {
        copy_ << text << '\n' << std::flush;
    }
}

bool Console::progress_due(double simulated) {
    return pacer_.due(simulated, wall_seconds());
}

bool ProgressPacer::due(double simulated, double wall) {
    const double interval = terminal_ ? 0.2 : 10;
    // A frame's time is a multiple of 1/rate and may round below the mark.
    const double now = terminal_ ? wall : simulated + 1e-9;
    if (now < next_) {
        return false;
    }
    next_ = interval * (std::floor(now / interval) + 1);
    return true;
}

}  // namespace wade
