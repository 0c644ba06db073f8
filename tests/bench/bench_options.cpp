#include "tests/bench/bench_options.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <thread>

namespace wade::bench {
namespace {

constexpr int most_threads = 1024;

Options parse(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const auto is = [&](const char* name) { return std::strcmp(argv[i], name) == 0; };
        if (is("--quick")) {
            options.quick = true;
        } else if (is("--json") && i + 1 < argc) {
            options.json = argv[++i];
        } else if (is("--only") && i + 1 < argc) {
            options.only = argv[++i];
        } else if (is("--threads") && i + 1 < argc) {
            char* end = nullptr;
            const long threads = std::strtol(argv[++i], &end, 10);
            if (*end != '\0' || threads < 1 || threads > most_threads)
                throw std::invalid_argument(std::string("--threads ") + argv[i] + ", allowed: 1 to 1024");
            options.threads = static_cast<int>(threads);
        } else {
            throw std::invalid_argument(std::string("unexpected argument ") + argv[i] +
                                        "; allowed: --quick, --json FILE, --only NAME, --threads N");
        }
    }
    return options;
}

}  // namespace

std::vector<int> Options::thread_counts() const {
    if (threads > 0) return {threads};
    const int all = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    return all > 1 ? std::vector<int>{1, all} : std::vector<int>{1};
}

int run_program(const char* program, int argc, char** argv,
                const std::function<void(const Options&, std::vector<Result>&)>& run) {
    try {
        const Options options = parse(argc, argv);
        std::printf("%s\n", machine().c_str());
        std::vector<Result> results;
        run(options, results);
        if (!options.json.empty()) write_json(options.json, results);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: %s\n", program, error.what());
        return dynamic_cast<const std::invalid_argument*>(&error) != nullptr ? 2 : 1;
    }
}

}  // namespace wade::bench
