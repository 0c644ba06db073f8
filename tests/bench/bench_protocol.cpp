// bench_protocol: the cost of handing a frame over, beside that of other transports.
//
// Every transport is measured in every round, one after the other, so that the ratios within a round do not depend on
// what else the machine does; shown are medians over the rounds.

#include <sched.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <map>
#include <stdexcept>

#include "shm_protocol/publisher.hpp"
#include "shm_protocol/subscriber.hpp"
#include "tests/bench/bench_options.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/transports.hpp"

namespace {

using namespace wade;
using namespace wade::bench;

double now_s() {
    return wall_seconds();
}

struct Case {
    const char* name;
    const char* title;
    std::uint32_t particles;
    int exchanges;      // timed in a round
    double unit_per_s;  // 1e6 for us
    const char* unit;
};

struct Series {
    std::vector<double> p50, p99;  // one of each a round
};

// The times of single exchanges after some that warm up caches, page tables and sockets.
void measure(const Case& c, const std::string& way, Series& series) {
    Payload payload(std::size_t{7} * c.particles);
    for (std::size_t k = 0; k < payload.size(); ++k) payload[k] = static_cast<float>(1 + k % 1000);
    const auto transport = make_transport(way, c.particles);
    for (int i = 0; i < c.exchanges / 10 + 3; ++i) transport->exchange(payload);
    std::vector<double> times;
    for (int i = 0; i < c.exchanges; ++i) {
        const double start = now_s();
        transport->exchange(payload);
        times.push_back((now_s() - start) * c.unit_per_s);
    }
    series.p50.push_back(quantile(times, 0.5));
    series.p99.push_back(quantile(times, 0.99));
}

void show_case(const Case& c, int rounds, std::vector<Result>& results) {
    std::map<std::string, Series> all;
    for (int round = 0; round < rounds; ++round)
        for (const std::string& way : transport_names()) {
            // The limit of a handshake is nothing at all.
            if (c.particles > 0 || way != "memcpy") measure(c, way, all[way]);
        }
    std::printf("\n%s, %s a round trip, medians of %d rounds of %d\n", c.title, c.unit, rounds, c.exchanges);
    std::printf("  %-14s %10s %10s %12s\n", "", "p50", "p99", "of memcpy");
    std::vector<double> limit = all["memcpy"].p50;
    for (const std::string& way : transport_names()) {
        Series& series = all[way];
        if (series.p50.empty()) continue;
        std::vector<double> ratios;
        for (std::size_t i = 0; i < limit.size(); ++i) ratios.push_back(series.p50[i] / limit[i]);
        const std::vector<double> p50 = series.p50;
        std::printf("  %-14s %10.3f %10.3f", way.c_str(), quantile(series.p50, 0.5), quantile(series.p99, 0.5));
        std::printf(ratios.empty() ? "\n" : " %12.2f\n", ratios.empty() ? 0 : quantile(ratios, 0.5));
        const std::string name = std::string("protocol/") + c.name + (way == "wade" ? "" : " " + way);
        results.push_back(result_of(name, c.particles, 1, p50, c.unit));
    }
}

double cpu_seconds_of_children() {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

shm::StreamInfo handshake_info() {
    shm::StreamInfo info;
    info.producer_name = "bench";
    info.capacity = 1;
    return info;
}

// The share of a processor that a consumer takes while its producer computes for 100 ms a frame.
void show_waiting(int frames, std::vector<Result>& results) {
    const double before = cpu_seconds_of_children();
    const double start = now_s();
    {
        const std::string session = "wade-bench-wait-" + std::to_string(getpid());
        shm::Publisher publisher(session, handshake_info());
        const Child child([&] {
            shm::Subscriber subscriber(session, "bench");
            while (subscriber.acquire()) subscriber.release();
        });
        publisher.wait_for_consumers(1);
        for (int f = 0; f < frames; ++f) {
            static_cast<void>(publisher.begin_frame());
            usleep(100'000);
            publisher.end_frame(0);
        }
        publisher.close();
    }
    const double share = 100 * (cpu_seconds_of_children() - before) / (now_s() - start);
    std::printf("\nA consumer that waits for frames of 100 ms takes %.2f %% of a processor (its start included)\n",
                share);
    results.push_back({"protocol/waiting_cpu_percent", 0, 1, share, share, share, "percent"});
}

// From the kill of a consumer to the error of the producer that waits for it.
void show_death(int deaths, std::vector<Result>& results) {
    std::vector<double> times;
    for (int i = 0; i < deaths; ++i) {
        const std::string session = "wade-bench-death-" + std::to_string(getpid()) + "-" + std::to_string(i);
        shm::Publisher publisher(session, handshake_info());
        const Child child([&] {
            shm::Subscriber subscriber(session, "bench");
            static_cast<void>(subscriber.acquire());
            pause();
        });
        publisher.wait_for_consumers(1);
        if (const auto slot = publisher.begin_frame()) publisher.end_frame(0);
        usleep(20'000);
        kill(child.pid(), SIGKILL);
        const double start = now_s();
        try {
            static_cast<void>(publisher.begin_frame());
        } catch (const shm::Error&) {
            times.push_back(1e3 * (now_s() - start));
        }
    }
    const Result result = result_of("protocol/death_noticed_ms", 0, 1, times, "ms");
    std::printf("\nThe death of a consumer is noticed after %.0f ms (median of %d, at most %.0f ms)\n", result.median,
                deaths, result.max);
    results.push_back(result);
}

void use_first_processor_only() {
    cpu_set_t all, first;
    sched_getaffinity(0, sizeof all, &all);
    CPU_ZERO(&first);
    for (std::size_t i = 0; i < CPU_SETSIZE; ++i)
        if (CPU_ISSET(i, &all)) {
            CPU_SET(i, &first);
            break;
        }
    sched_setaffinity(0, sizeof first, &first);
}

// The same handshake with one processor for both sides, in a process of its own: a program looks at its processors once.
void show_one_processor(int rounds, std::vector<Result>& results) {
    std::fflush(stdout);
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    {
        const Child child([&] {
            use_first_processor_only();
            std::vector<Result> own;
            show_case({"handshake_one_cpu_us", "Handshake, both on one processor", 0, 20'000, 1e6, "us"}, rounds, own);
            std::fflush(stdout);
            std::FILE* const out = fdopen(ends[1], "w");
            for (const Result& r : own)
                std::fprintf(out, "%s\t%.9g %.9g %.9g\n", r.name.c_str(), r.median, r.min, r.max);
            std::fclose(out);
        });
        close(ends[1]);
    }
    std::FILE* const in = fdopen(ends[0], "r");
    char name[128];
    Result r{"", 0, 1, 0, 0, 0, "us"};
    while (std::fscanf(in, "%127[^\t]\t%lf %lf %lf ", name, &r.median, &r.min, &r.max) == 4) {
        r.name = name;
        results.push_back(r);
    }
    std::fclose(in);
}

void run(const Options& options, std::vector<Result>& results) {
    const int rounds = options.quick ? 3 : 9;
    if (options.wanted("protocol/handshake_one_cpu_us")) show_one_processor(rounds, results);
    for (const Case& c : {Case{"handshake_us", "Handshake", 0, 20'000, 1e6, "us"},
                          Case{"frame_100k_ms", "100,000 particles", 100'000, 200, 1e3, "ms"},
                          Case{"frame_1m_ms", "1,000,000 particles", 1'000'000, 20, 1e3, "ms"}}) {
        if (options.wanted(std::string("protocol/") + c.name)) show_case(c, rounds, results);
    }
    if (options.wanted("protocol/waiting_cpu_percent")) show_waiting(options.quick ? 10 : 30, results);
    if (options.wanted("protocol/death_noticed_ms")) show_death(options.quick ? 5 : 21, results);
}

}  // namespace

int main(int argc, char** argv) {
    return run_program("bench_protocol", argc, argv, run);
}
