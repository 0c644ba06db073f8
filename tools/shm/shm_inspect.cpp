// shm_inspect [SESSION]: what the participants of a session are doing, seen from outside.

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "configs/errors/exit_code.hpp"
#include "configs/program/program.hpp"
#include "tools/shm/observer.hpp"
#include "tools/shm/tool_arguments.hpp"

namespace {

using namespace wade;

struct Options {
    std::string session;
    bool all = false, watch = false, json = false;
    double interval_s = 0.5;
    double count = 0;
};

std::vector<std::string> names_of(const Options& o) {
    if (o.session.empty()) return segment_names();
    return {shm::segment_name(o.session, shm::stream_fluid), shm::segment_name(o.session, shm::stream_agents)};
}

std::vector<SegmentView> look(const Options& o) {
    std::vector<SegmentView> views;
    for (const std::string& name : names_of(o)) {
        SegmentView view = look_at(name);
        if (view.condition != Condition::absent) views.push_back(std::move(view));
    }
    return views;
}

void sleep_for(double s) {
    const auto whole = static_cast<time_t>(s);
    const timespec pause{whole, static_cast<long>(1e9 * (s - static_cast<double>(whole)))};
    ::nanosleep(&pause, nullptr);  // a signal ends it early
}

std::vector<Sample> with_rates(const std::vector<SegmentView>& before, std::vector<SegmentView> now) {
    std::vector<Sample> samples;
    for (SegmentView& view : now) {
        Sample sample;
        for (const SegmentView& old : before)
            if (old.name == view.name) sample.frames_per_s = frame_rate(old, view);
        sample.segment = std::move(view);
        samples.push_back(std::move(sample));
    }
    return samples;
}

void show(const Options& o, const std::vector<Sample>& samples) {
    std::string text;
    if (o.json) {
        text = json_of(samples, !o.watch);
    } else {
        if (o.watch && ::isatty(STDOUT_FILENO) != 0) text = "\033[H\033[J";
        for (const Sample& sample : samples) text += text_of(sample);
        if (samples.empty()) text += "no segments\n";
    }
    std::cout << text << std::flush;
}

// Of a named session: 3 if there is none, 6 if it is no segment or its header is refused, 4 if its producer is dead, else 0.
int verdict(const Options& o, const std::vector<Sample>& samples) {
    if (o.session.empty()) return 0;
    if (samples.empty()) return static_cast<int>(ExitCode::attach_timeout);
    int code = 0;
    for (const Sample& s : samples) {
        if (s.segment.condition == Condition::refused || s.segment.condition == Condition::foreign)
            return static_cast<int>(ExitCode::protocol_violation);
        if (!s.segment.producer_alive) code = static_cast<int>(ExitCode::peer_dead);
    }
    return code;
}

int inspect(const Options& o) {
    std::vector<SegmentView> before = look(o);
    if (before.empty() && !o.session.empty()) {
        show(o, {});
        return verdict(o, {});
    }
    if (o.interval_s > 0 && !before.empty()) sleep_for(o.interval_s);
    for (std::uint64_t shown = 1;; ++shown) {
        std::vector<SegmentView> now = look(o);
        // A segment that vanished during the interval is shown as it was seen last.
        const bool gone = !o.session.empty() && now.empty();
        const std::vector<Sample> samples = with_rates(gone ? std::vector<SegmentView>{} : before, gone ? before : now);
        if (!gone || shown == 1) show(o, samples);
        const bool last = gone || !o.watch || shown == static_cast<std::uint64_t>(o.count);
        if (last || received_signal() != 0) return gone ? 0 : verdict(o, samples);
        before = std::move(now);
        sleep_for(std::max(o.interval_s, 0.05));
        if (received_signal() != 0) return 0;
    }
}

}  // namespace

int main(int argc, char** argv) {
    Options o;
    ToolArguments arguments(
        "shm_inspect", "Shows sessions: header, state, frame, rate, and how far each participant is. Holds up no run.");
    arguments.positional("SESSION", o.session, "Name of the session [all]", false);
    arguments.flag("--all", o.all, "All segments of this machine");
    arguments.flag("--watch", o.watch, "Show again after each interval, until the session is gone or Ctrl-C");
    arguments.number("--interval-s", o.interval_s, "Interval over which the rate is measured, s; 0: no rate", "S",
                     {0, 3600});
    arguments.number("--count", o.count, "With --watch: end after N times; 0: go on", "N", {0, 1e9}, Whole::yes);
    arguments.flag("--json", o.json, "One JSON array of segments, with --watch one a line");
    return run_tool(arguments, argc, argv, [&](Console&) {
        if (o.all && !o.session.empty()) throw ConfigurationError("SESSION and --all exclude one another.");
        catch_signals();
        return inspect(o);
    });
}
