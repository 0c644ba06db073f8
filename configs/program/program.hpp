#pragma once
// What both programs need to be well-behaved processes: signals, and a log with a progress line on stderr.

#include <filesystem>
#include <fstream>
#include <string>

namespace wade {

// From now on SIGINT and SIGTERM are remembered and can be asked for; a file that outgrows a limit and a closed
// terminal become errors of the calls that meet them instead of ending the process.
void catch_signals();

// The signal that asks to stop, 0 = none yet.
[[nodiscard]] int received_signal();

// Exit code of a run that received_signal() ended: 130 or 143.
[[nodiscard]] int exit_code_of_signal();

// Starts the program once more with GOMP_SPINCOUNT=2000, unless it or OMP_WAIT_POLICY is set; libgomp reads them at start-up
// only. Threads that wait for one another then spin for some ten microseconds and sleep. By default they spin so long that
// they lose whole time slices as soon as anything else, such as the peer of the run, needs a processor: measured with two
// busy processes beside it, less than half the speed.
void let_threads_spin_briefly(char** argv);

// Decides when a progress line is due: five times a second of wall time on a terminal, else at the start and after
// every ten seconds of simulated time.
class ProgressPacer {
 public:
    explicit ProgressPacer(bool terminal) : terminal_(terminal) {}
    // Both in s and growing.
    [[nodiscard]] bool due(double simulated, double wall);

 private:
    bool terminal_;
    double next_ = 0;  // s of wall time on a terminal, else of simulated time
};

// Log and progress on stderr, in lines of at most 100 columns without control characters; a progress line on a terminal is
// overwritten by what comes next.
class Console {
 public:
    // `program` starts each line.
    explicit Console(std::string program);

    // Copies all lines, progress as well, to a file from now on, unless stderr goes to this file already. Throws
    // ConfigurationError if it cannot be written.
    void copy_to(const std::filesystem::path& file);

    void line(const std::string& text);
    void warning(const std::string& text) { line("warning: " + text); }
    void progress(const std::string& text);

    // Whether a progress line is due at this simulated time, s.
    [[nodiscard]] bool progress_due(double simulated_s);

 private:
    void write(const std::string& text, bool stays);

    std::string program_;
    bool terminal_;
    bool shown_ = false;
    ProgressPacer pacer_;
    std::ofstream copy_;
};

}  // namespace wade
